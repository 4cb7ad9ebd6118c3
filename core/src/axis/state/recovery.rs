//! State of the supervision of a loop that is closed here.

use serde::{Deserialize, Serialize};

/// State of a stop by the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::axis) struct Stop {
    /// Following error at its start (inc).
    pub(in crate::axis) begun: u64,
    /// Smallest following error since (inc).
    pub(in crate::axis) least: u64,
    /// Cycles with new data in which it did not become smaller.
    pub(in crate::axis) waits: u64,
}

/// Supervision of an axis whose loop is closed here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Recovery {
    pub(in crate::axis) stop: Option<Stop>,
    /// Distance commanded since the encoder last moved (inc).
    pub(in crate::axis) way: f64,
    /// Cycles of the largest effort since then.
    pub(in crate::axis) pushes: u64,
}

impl Recovery {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.way >= 0.0 && self.way.is_finite()
    }
}
