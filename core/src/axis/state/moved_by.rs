//! The function that moves an axis.

use crate::object::Leader;
use serde::{Deserialize, Serialize};

/// The function that moves an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MovedBy {
    /// Sink of the function.
    pub sink: Leader,
    /// Velocity per unit of the sink (inc/s), for a sink of speeds. None: the sink is a position.
    pub speed: Option<f64>,
}

impl MovedBy {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        matches!(self.sink, Leader::Sink(_)) && self.speed.is_none_or(f64::is_finite)
    }
}
