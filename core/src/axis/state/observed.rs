//! What an axis has observed around its motion.

use super::power::Watch;
use super::switches::Switches;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Observations: the machine, the idle drive, switches, index pulses, moves of the coordinate, the override.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Observed {
    /// Whether the machine is active, so that the axis may be switched on and moved.
    active: bool,
    watch: Watch,
    /// Its limit and reference switches.
    switches: Switches,
    /// The switches of the cycle before.
    switches_before: Switches,
    /// Number of index pulses so far, and position of the last one.
    index: (u32, Position),
    /// Move of its coordinate that followers have not taken into account yet: it is no motion.
    moved: Position,
    /// The override of the active plan (%).
    override_seen: f64,
}

impl Observed {
    /// Returns the observations before the first cycle, with that override (%).
    pub(in crate::axis) fn new(override_seen: f64) -> Self {
        Self {
            active: true,
            watch: Watch::default(),
            switches: Switches::default(),
            switches_before: Switches::default(),
            index: (0, Position::ZERO),
            moved: Position::ZERO,
            override_seen,
        }
    }

    /// Whether the machine is active, so that the axis may be switched on and moved.
    #[inline]
    pub(in crate::axis) fn is_active(&self) -> bool {
        self.active
    }

    #[inline]
    pub(in crate::axis) fn set_active(&mut self, active: bool) {
        self.active = active;
    }

    /// Returns the supervision of a drive whose axis is off.
    #[inline]
    pub(in crate::axis) fn watch(&self) -> &Watch {
        &self.watch
    }

    #[inline]
    pub(in crate::axis) fn watch_mut(&mut self) -> &mut Watch {
        &mut self.watch
    }

    /// Returns the switches of this cycle.
    #[inline]
    pub(in crate::axis) fn switches(&self) -> Switches {
        self.switches
    }

    /// Returns the switches of the cycle before.
    #[inline]
    pub(in crate::axis) fn switches_before(&self) -> Switches {
        self.switches_before
    }

    /// Sets the switches of a new cycle.
    #[inline]
    pub(in crate::axis) fn read_switches(&mut self, switches: Switches) {
        self.switches_before = std::mem::replace(&mut self.switches, switches);
    }

    /// Sets the reference switch of this cycle.
    #[inline]
    pub(in crate::axis) fn set_home(&mut self, is_on: bool) {
        self.switches.home = is_on;
    }

    /// Returns the number of index pulses so far.
    #[inline]
    pub(in crate::axis) fn index_count(&self) -> u32 {
        self.index.0
    }

    /// Returns the position of the last index pulse.
    #[inline]
    pub(in crate::axis) fn index_position(&self) -> Position {
        self.index.1
    }

    /// Counts an index pulse at a position.
    #[inline]
    pub(in crate::axis) fn note_index(&mut self, position: Position) {
        self.index = (self.index.0.wrapping_add(1), position);
    }

    /// Mirrors positions: the counting direction was changed.
    #[inline]
    pub(in crate::axis) fn mirror(&mut self) {
        self.index.1 = -self.index.1;
    }

    /// Moves positions with the coordinate, and notes the move for followers.
    pub(in crate::axis) fn shift(&mut self, by: Position) {
        self.index.1 += by;
        self.note_moved(by);
    }

    /// Returns the move of the coordinate that followers have not taken into account yet.
    #[inline]
    pub(in crate::axis) fn moved(&self) -> Position {
        self.moved
    }

    /// Notes a move of the coordinate for followers.
    #[inline]
    pub(in crate::axis) fn note_moved(&mut self, by: Position) {
        self.moved += by;
    }

    /// Returns the move of the coordinate, and clears it.
    #[inline]
    pub(in crate::axis) fn take_moved(&mut self) -> Position {
        std::mem::take(&mut self.moved)
    }

    /// Returns the override of the active plan (%).
    #[inline]
    pub(in crate::axis) fn override_seen(&self) -> f64 {
        self.override_seen
    }

    /// Sets the override of the active plan (%).
    #[inline]
    pub(in crate::axis) fn set_override_seen(&mut self, share: f64) {
        self.override_seen = share;
    }
}
