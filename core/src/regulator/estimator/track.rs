//! A track that an observer with fixed gains corrects.
//!
//! Law      ahead: place + velocity + acceleration/2, velocity + acceleration; residual = position - place ahead; each of the three
//!          then takes its gain of the residual
//! Reads    the change of the cycle (inc)
//! Writes   velocity (inc/cycle), acceleration (inc/cycle^2)
//! Refuses  nothing
//!
//! The place is counted from the last position: it is a few increments wherever the axis is, and nothing of it is lost.

use serde::{Deserialize, Serialize};

/// What the three take of a residual.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Gains {
    /// Above 0 up to 1.
    pub(super) place: f64,
    /// 1/cycle.
    pub(super) velocity: f64,
    /// 1/cycle^2; 0 of a track without acceleration.
    pub(super) acceleration: f64,
}

impl Gains {
    /// Are they those of an observer that settles? The conditions of Jury for its characteristic polynomial, which is
    /// z^3 + (a + b + c/2 - 3) z^2 + (3 - 2 a - b + c/2) z + a - 1.
    pub(super) fn is_sound(&self) -> bool {
        let Self { place, velocity, acceleration } = *self;
        let range = place > 0.0 && place <= 1.0 && velocity > 0.0 && acceleration >= 0.0;
        range && 2.0 * place + velocity < 4.0 && 2.0 * place * velocity > acceleration * (2.0 - place)
    }
}

/// The track.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Track {
    /// From the last position (inc).
    pub(super) place: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
}

/// Beyond what changes of 64 bits leave in a track that settles.
const MOST: f64 = 1e24;

impl Track {
    pub(super) fn step(&mut self, gains: &Gains, change: f64) {
        let residual = change - (self.place + self.velocity + self.acceleration / 2.0);
        // place ahead + gain * residual - change, without the difference of large numbers.
        self.place = (gains.place - 1.0) * residual;
        self.velocity += self.acceleration + gains.velocity * residual;
        self.acceleration += gains.acceleration * residual;
    }

    pub(super) fn is_sound(&self) -> bool {
        [self.place, self.velocity, self.acceleration].iter().all(|value| value.abs() <= MOST)
    }
}
