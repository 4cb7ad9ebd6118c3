//! The difference of two positions.
//!
//! Law      velocity = change of the cycle
//! Reads    the change (inc)
//! Writes   the velocity (inc/cycle), of the middle of the cycle: its delay is half a cycle
//! Refuses  nothing

use serde::{Deserialize, Serialize};

/// The estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Difference {
    pub(super) velocity: f64,
}

impl Difference {
    pub(super) fn step(&mut self, change: f64) {
        self.velocity = change;
    }
}
