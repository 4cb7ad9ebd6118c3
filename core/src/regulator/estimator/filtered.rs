//! The difference of two positions with a first-order low-pass filter.
//!
//! Law      velocity += (1 - e^(-T/time)) (change - velocity): the response of a lag to a change that is held over the
//!          cycle. A time of 0 is no filter
//! Reads    the change of the cycle (inc)
//! Writes   the velocity (inc/cycle); its delay for a ramp is T / (e^(T/time) - 1) + T/2, nearly the time
//! Refuses  nothing: the settings are checked before

use serde::{Deserialize, Serialize};

/// The estimator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Filtered {
    /// Share of the difference that is added per cycle: above 0 up to 1.
    pub(super) share: f64,
    pub(super) velocity: f64,
}

impl Filtered {
    /// Returns a filter with a time in cycles.
    pub(super) fn new(time: f64) -> Self {
        let share = if time > 0.0 { -libm::expm1(-1.0 / time) } else { 1.0 };
        Self { share, velocity: 0.0 }
    }

    pub(super) fn step(&mut self, change: f64) {
        self.velocity += self.share * (change - self.velocity);
    }
}
