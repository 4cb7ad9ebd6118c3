//! State of the brake of an axis, and of the inputs of the machine that act on it.

use crate::code::Code;
use serde::{Deserialize, Serialize};

/// A brake that its axis closes before the power is switched off, and opens after it is switched on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrakeConfig {
    /// Index of its output in section `io`.
    pub output: u16,
    /// Whether the output is 1 while the brake is closed; otherwise it is 1 while the brake is open.
    pub closes_with_one: bool,
    /// Time that the brake needs to open (ns). Until then the axis holds its position.
    pub release_ns: u64,
    /// Time that the brake needs to close (ns). Until then the drive holds the axis.
    pub engage_ns: u64,
}

/// Edges of the machine inputs of this cycle, for all axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edges {
    /// I_ERRCLR: clears errors.
    pub clears: bool,
    /// I_BREAK: aborts the motion.
    pub interrupts: bool,
    /// I_CONTINUE: resumes after I_BREAK.
    pub resumes: bool,
}

/// State of the brake and of the machine inputs of an axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct BrakeState {
    /// Whether the own brake of the axis is closed.
    pub(in crate::axis) closed: bool,
    /// Cycle in which the brake was closed.
    pub(in crate::axis) closed_at: u64,
    pub(in crate::axis) edges: Edges,
    /// Whether I_ERRCLR waits until the axis is at rest.
    pub(in crate::axis) clears: bool,
    /// Whether I_CONTINUE waits until the axis is at rest.
    pub(in crate::axis) resumes: bool,
    /// Cycle since which a reset waits until an axis without power is at rest.
    pub(in crate::axis) coasts_since: Option<u64>,
    /// Cycle since which the command has been at rest; the power or the brake may act once the axis is at rest, too.
    pub(in crate::axis) settles_since: Option<u64>,
    /// Whether the axis had power at the start of this cycle.
    pub(in crate::axis) had_power: bool,
    /// Whether an event of this cycle requests the brake.
    pub(in crate::axis) asks_anew: bool,
    /// Whether I_BREAK has stopped the axis.
    pub(in crate::axis) interrupted: bool,
    /// Whether an abort has stopped the axis.
    pub(in crate::axis) aborted: bool,
    /// Cycle and code of the last stop that locks.
    pub(in crate::axis) locked: Option<(u64, Code)>,
    /// Whether the second drive of a gantry moves relative to the first one (squaring).
    pub(in crate::axis) second_moves: bool,
    /// Change of position of the second drive with its last fresh value (inc).
    pub(in crate::axis) second_change: i64,
}

impl Default for BrakeState {
    fn default() -> Self {
        Self {
            closed: true,
            closed_at: 0,
            edges: Edges::default(),
            clears: false,
            resumes: false,
            coasts_since: None,
            settles_since: None,
            had_power: false,
            asks_anew: false,
            interrupted: false,
            aborted: false,
            locked: None,
            second_moves: false,
            second_change: 0,
        }
    }
}

impl BrakeState {
    /// Whether nothing is pending and nothing has been requested in this cycle.
    pub(in crate::axis) fn is_settled(&self, has_power: bool) -> bool {
        let waits = self.clears || self.resumes || self.coasts_since.is_some() || self.settles_since.is_some();
        let is_stopped = self.interrupted || self.aborted;
        !waits && !is_stopped && !self.asks_anew && self.had_power == has_power && self.edges == Edges::default()
    }
}
