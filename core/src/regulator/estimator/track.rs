//! A track that an observer with fixed gains corrects.
//!
//! Law      prediction: position + velocity + acceleration/2, velocity + acceleration; residual = position - predicted
//!          position; each of the three is then corrected by its gain times the residual
//! Reads    the change of the cycle (inc)
//! Writes   velocity (inc/cycle), acceleration (inc/cycle^2)
//! Refuses  nothing
//!
//! The position is relative to the last one: it is a few increments for an axis at any position, without loss of
//! accuracy.

use serde::{Deserialize, Serialize};

/// Gains of the three values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Gains {
    /// Gain of the position, above 0 up to 1.
    pub(super) place: f64,
    /// Gain of the velocity (1/cycle).
    pub(super) velocity: f64,
    /// Gain of the acceleration (1/cycle^2); 0 for a track without acceleration.
    pub(super) acceleration: f64,
}

impl Gains {
    /// Whether the observer settles. Jury's conditions for its characteristic polynomial z^3 + (a + b + c/2 - 3)
    /// z^2 + (3 - 2 a - b + c/2) z + a - 1.
    pub(super) fn is_sound(&self) -> bool {
        let Self { place, velocity, acceleration } = *self;
        let range = place > 0.0 && place <= 1.0 && velocity > 0.0 && acceleration >= 0.0;
        range && 2.0 * place + velocity < 4.0 && 2.0 * place * velocity > acceleration * (2.0 - place)
    }
}

/// State of the track.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Track {
    /// Position relative to the last one (inc).
    pub(super) place: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
}

/// Bound of a track that settles, for changes of 64 bits.
const MOST: f64 = 1e24;

impl Track {
    pub(super) fn step(&mut self, gains: &Gains, change: f64) {
        let residual = change - (self.place + self.velocity + self.acceleration / 2.0);
        // Predicted position + gain * residual - change, without the difference of large numbers.
        self.place = (gains.place - 1.0) * residual;
        self.velocity += self.acceleration + gains.velocity * residual;
        self.acceleration += gains.acceleration * residual;
    }

    pub(super) fn is_sound(&self) -> bool {
        [self.place, self.velocity, self.acceleration].iter().all(|value| value.abs() <= MOST)
    }
}
