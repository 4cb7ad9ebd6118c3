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
    closed: bool,
    /// Cycle in which the brake was closed.
    closed_at: u64,
    edges: Edges,
    /// Whether I_ERRCLR waits until the axis is at rest.
    clears: bool,
    /// Whether I_CONTINUE waits until the axis is at rest.
    resumes: bool,
    /// Cycle since which a reset waits until an axis without power is at rest.
    coasts_since: Option<u64>,
    /// Cycle since which the command has been at rest; the power or the brake may act once the axis is at rest, too.
    settles_since: Option<u64>,
    /// Whether the axis had power at the start of this cycle.
    had_power: bool,
    /// Whether an event of this cycle requests the brake.
    asks_anew: bool,
    /// Whether I_BREAK has stopped the axis.
    interrupted: bool,
    /// Whether an abort has stopped the axis.
    aborted: bool,
    /// Cycle and code of the last stop that locks.
    locked: Option<(u64, Code)>,
    /// Whether the second drive of a gantry moves relative to the first one (squaring).
    second_moves: bool,
    /// Change of position of the second drive with its last fresh value (inc).
    second_change: i64,
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

    /// Whether the own brake of the axis is closed.
    #[inline]
    pub(in crate::axis) fn is_closed(&self) -> bool {
        self.closed
    }

    /// Returns the cycle in which the brake was closed; none if it is open.
    #[inline]
    pub(in crate::axis) fn closed_since(&self) -> Option<u64> {
        self.closed.then_some(self.closed_at)
    }

    /// Opens the brake if the drive `holds` the axis in that cycle, and closes it otherwise.
    pub(in crate::axis) fn hold(&mut self, holds: bool, cycle: u64) {
        if !holds && !self.closed {
            self.closed_at = cycle;
        }
        self.closed = !holds;
    }

    /// Stores the edges of the machine inputs of this cycle.
    #[inline]
    pub(in crate::axis) fn set_edges(&mut self, edges: Edges) {
        self.edges = edges;
    }

    /// Returns the edges of the machine inputs of this cycle, and clears them.
    #[inline]
    pub(in crate::axis) fn take_edges(&mut self) -> Edges {
        std::mem::take(&mut self.edges)
    }

    /// Whether I_ERRCLR waits until the axis is at rest.
    #[inline]
    pub(in crate::axis) fn clears(&self) -> bool {
        self.clears
    }

    /// Lets I_ERRCLR wait until the axis is at rest.
    #[inline]
    pub(in crate::axis) fn wait_to_clear(&mut self) {
        self.clears = true;
    }

    /// Ends the wait of I_ERRCLR unless there is something to clear.
    #[inline]
    pub(in crate::axis) fn keep_clearing(&mut self, keeps: bool) {
        self.clears &= keeps;
    }

    /// Whether I_CONTINUE waits until the axis is at rest.
    #[inline]
    pub(in crate::axis) fn resumes(&self) -> bool {
        self.resumes
    }

    /// Lets I_CONTINUE wait if it `asks`, as long as I_BREAK has stopped the axis and it has no error.
    pub(in crate::axis) fn wait_to_resume(&mut self, asks: bool, is_healthy: bool) {
        self.resumes |= asks;
        self.resumes &= self.interrupted && is_healthy;
    }

    /// Ends the waits of I_ERRCLR and I_CONTINUE.
    #[inline]
    pub(in crate::axis) fn end_waits(&mut self) {
        (self.clears, self.resumes) = (false, false);
    }

    /// Returns the cycle since which a reset waits for an axis that `coasts` without power; the present one at first.
    pub(in crate::axis) fn coasts_since(&mut self, coasts: bool, cycle: u64) -> u64 {
        let since = self.coasts_since.unwrap_or(cycle);
        self.coasts_since = coasts.then_some(since);
        since
    }

    /// Notes that no reset waits for a coasting axis.
    #[inline]
    pub(in crate::axis) fn forget_coasting(&mut self) {
        self.coasts_since = None;
    }

    /// Returns the cycle since which the command has been at rest; the present one at first.
    #[inline]
    pub(in crate::axis) fn settles_since(&mut self, cycle: u64) -> u64 {
        *self.settles_since.get_or_insert(cycle)
    }

    /// Notes that the command is not at rest.
    #[inline]
    pub(in crate::axis) fn forget_settling(&mut self) {
        self.settles_since = None;
    }

    /// Begins a cycle of an axis with or without power: nothing has requested the brake in it.
    #[inline]
    pub(in crate::axis) fn begin_cycle(&mut self, has_power: bool) {
        (self.had_power, self.asks_anew) = (has_power, false);
    }

    /// Whether the axis had power at the start of this cycle.
    #[inline]
    pub(in crate::axis) fn had_power(&self) -> bool {
        self.had_power
    }

    /// Whether an event of this cycle requests the brake.
    #[inline]
    pub(in crate::axis) fn is_requested_now(&self) -> bool {
        self.asks_anew
    }

    /// Notes that an event of this cycle requests the brake if it `asks`.
    #[inline]
    pub(in crate::axis) fn request_now(&mut self, asks: bool) {
        self.asks_anew |= asks;
    }

    /// Whether I_BREAK has stopped the axis.
    #[inline]
    pub(in crate::axis) fn is_interrupted(&self) -> bool {
        self.interrupted
    }

    #[inline]
    pub(in crate::axis) fn set_interrupted(&mut self, interrupted: bool) {
        self.interrupted = interrupted;
    }

    /// Whether an abort has stopped the axis.
    #[inline]
    pub(in crate::axis) fn is_aborted(&self) -> bool {
        self.aborted
    }

    #[inline]
    pub(in crate::axis) fn set_aborted(&mut self, aborted: bool) {
        self.aborted = aborted;
    }

    /// Notes a stop that locks.
    #[inline]
    pub(in crate::axis) fn lock(&mut self, cycle: u64, code: Code) {
        self.locked = Some((cycle, code));
    }

    /// Returns the code of the stop that locks in that cycle.
    #[inline]
    pub(in crate::axis) fn locked_in(&self, cycle: u64) -> Option<Code> {
        self.locked.filter(|(locked, _)| *locked == cycle).map(|(_, code)| code)
    }

    /// Whether the second drive of a gantry moves relative to the first one.
    #[inline]
    pub(in crate::axis) fn second_moves(&self) -> bool {
        self.second_moves
    }

    #[inline]
    pub(in crate::axis) fn set_second_moves(&mut self, moves: bool) {
        self.second_moves = moves;
    }

    /// Returns the change of position of the second drive with its last fresh value (inc).
    #[inline]
    pub(in crate::axis) fn second_change(&self) -> i64 {
        self.second_change
    }

    #[inline]
    pub(in crate::axis) fn set_second_change(&mut self, change: i64) {
        self.second_change = change;
    }
}
