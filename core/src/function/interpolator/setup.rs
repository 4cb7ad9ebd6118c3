//! What a set makes of an interpolator.

use super::register::Marks;
use crate::cam::Scale;
use serde::{Deserialize, Serialize};

/// What begins a movement, and what ends it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Movement {
    /// One table, for ever.
    #[default]
    Cyclic,
    /// A rising E1 begins at once, at x = 0; it ends with its table.
    Immediate,
    /// A rising E1 begins at a zero of x; it ends with its last table.
    Sequence,
    /// E1 = 1 clocks in at a zero of x: start tables, then the working table; E1 = 0 clocks out by the stop tables.
    Coupled,
}

/// A set, taken at START.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Setup {
    pub movement: Movement,
    /// By so much x goes on in each call; none: by the way of the source.
    pub step: Option<i64>,
    /// Of a table at equal distances.
    pub length: i64,
    /// Units of x in a unit of the tables' places: more than one where calls are no whole half milliseconds.
    pub parts: i64,
    pub scale: Scale,
    /// Tables of a movement.
    pub tables: u8,
    /// Place of the working table.
    pub working: u8,
    /// Passes of the working table, where a movement ends by itself.
    pub passes: i64,
    pub offset: i64,
    pub start_angle: i64,
    pub stop_angle: i64,
    pub sak: i64,
    /// x begins at the next zero pulse of the master.
    pub waits_for_zero: bool,
    /// The slave is where x is already.
    pub sets_on: bool,
    /// Coupled: E1 = 1 is enough once it has risen.
    pub by_level: bool,
    /// An edge of E1 in a movement counts at its end.
    pub retriggers: bool,
    /// Inputs select a set of tables.
    pub switches_sets: bool,
    /// At each end of a table, not only where the working table is repeated.
    pub switches_everywhere: bool,
    /// An output tells that the last pass had a mark.
    pub tells_marks: bool,
    pub marks: Marks,
}

impl Setup {
    #[inline]
    pub(super) fn is_started_by_e1(&self) -> bool {
        self.movement != Movement::Cyclic
    }
}
