//! Settings of an interpolator, converted from its parameter set.

use super::register::Marks;
use crate::cam::Scale;
use serde::{Deserialize, Serialize};

/// Start and end conditions of a movement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Movement {
    /// One table, repeated endlessly.
    #[default]
    Cyclic,
    /// A rising E1 begins at once, at x = 0; the movement ends with its table.
    Immediate,
    /// A rising E1 begins at a zero of x; the movement ends with its last table.
    Sequence,
    /// E1 = 1 clocks in at a zero of x: start tables, then the working table; E1 = 0 clocks out through the stop
    /// tables.
    Coupled,
}

/// Settings, taken at START.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Setup {
    pub movement: Movement,
    /// Change of x per call; `None`: the travel of the source.
    pub step: Option<i64>,
    /// Length of a table at equal distances.
    pub length: i64,
    /// Units of x per unit of the table positions: more than one if a call is no multiple of half a millisecond.
    pub parts: i64,
    pub scale: Scale,
    /// Number of tables of a movement.
    pub tables: u8,
    /// Index of the working table.
    pub working: u8,
    /// Passes of the working table, if a movement ends by itself.
    pub passes: i64,
    pub offset: i64,
    pub start_angle: i64,
    pub stop_angle: i64,
    pub sak: i64,
    /// Whether x starts at the next zero pulse of the master.
    pub waits_for_zero: bool,
    /// Whether the slave already is at the position of x.
    pub sets_on: bool,
    /// Coupled: whether E1 = 1 is enough after the first edge.
    pub by_level: bool,
    /// Whether an edge of E1 in a movement takes effect at its end.
    pub retriggers: bool,
    /// Whether inputs select a set of tables.
    pub switches_sets: bool,
    /// Whether the set may change at each end of a table, not only where the working table is repeated.
    pub switches_everywhere: bool,
    /// Whether an output shows that the last pass had a mark.
    pub shows_marks: bool,
    pub marks: Marks,
}

impl Setup {
    #[inline]
    pub(super) fn is_started_by_e1(&self) -> bool {
        self.movement != Movement::Cyclic
    }
}
