//! State of the encoder of the velocity loop.

use crate::encoder::{Form, Reader};
use serde::{Deserialize, Serialize};

/// Share of the longer travel that is no difference: a ratio between half and twice the given one is tolerated.
const SHARE: f64 = 0.5;

/// Travel of two encoders that should be equal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Pair {
    /// Difference at the start of this section (inc).
    start_difference: f64,
    /// Travel of both since then (inc).
    load: f64,
    motor: f64,
}

impl Pair {
    fn is_sound(&self) -> bool {
        [self.start_difference, self.load, self.motor].iter().all(|way| way.is_finite())
    }

    /// Returns the difference of both.
    pub(in crate::axis) fn distance(&self) -> f64 {
        self.start_difference + self.load - self.motor
    }

    /// Adds these changes, in sections of length `piece`.
    pub(in crate::axis) fn step(&mut self, load: f64, motor: f64, piece: f64) {
        (self.load, self.motor) = (self.load + load, self.motor + motor);
        let (longer, shorter) = (self.load.abs().max(self.motor.abs()), self.load.abs().min(self.motor.abs()));
        if longer < piece {
            return;
        }
        let apart = self.distance();
        let goes_together = self.load * self.motor > 0.0 && shorter >= (1.0 - SHARE) * longer;
        let borne = if goes_together { SHARE * longer } else { 0.0 };
        let left = (apart.abs() - borne).max(0.0);
        *self = Self { start_difference: if apart < 0.0 { -left } else { left }, ..Self::default() };
        if !self.start_difference.is_finite() {
            *self = Self::default();
        }
    }
}

/// State of the encoder of the velocity loop.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct VelocityFeedback {
    pub(in crate::axis) reader: Reader,
    /// Change in this cycle (inc of this encoder, in its own direction).
    pub(in crate::axis) change: i64,
    /// Whether its value is invalid.
    pub(in crate::axis) is_lost: bool,
    /// Travel of position and motor under power.
    pub(in crate::axis) ways: Pair,
}

impl Default for VelocityFeedback {
    fn default() -> Self {
        Self { reader: Reader::new(Form::Incremental(64)), change: 0, is_lost: false, ways: Pair::default() }
    }
}

impl VelocityFeedback {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.reader.is_sound() && self.ways.is_sound()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Applies changes and returns the largest difference.
    fn most(changes: impl IntoIterator<Item = (f64, f64)>) -> f64 {
        let mut pair = Pair::default();
        let distances = changes.into_iter().map(|(load, motor)| {
            pair.step(load, motor, 100.0);
            pair.distance().abs()
        });
        distances.fold(0.0, f64::max)
    }

    proptest! {
        /// With a ratio between half and twice the given one, and changes in one direction, the difference is at most a
        /// section and a change.
        #[test]
        fn ratio_accumulates_no_error(ratio in 0.51..1.95_f64, changes in prop::collection::vec(0.0..50.0_f64, 1..500)) {
            prop_assert!(most(changes.iter().map(|change| (*change, change * ratio))) <= 200.0);
            prop_assert!(most(changes.iter().map(|change| (-change, -change * ratio))) <= 200.0);
        }

        /// If one encoder stops while the other one moves in any direction, the difference is the whole travel.
        #[test]
        fn motion_of_one_encoder_alone_counts_fully(changes in prop::collection::vec(-50.0..80.0_f64, 1..500), is_motor in any::<bool>()) {
            let mut pair = Pair::default();
            let mut way = 0.0;
            for change in changes {
                way += change;
                let (load, motor) = if is_motor { (0.0, change) } else { (change, 0.0) };
                pair.step(load, motor, 100.0);
                let distance = if is_motor { -pair.distance() } else { pair.distance() };
                prop_assert!((distance - way).abs() < 1e-6);
            }
        }
    }

    /// Motion in opposite directions adds up; infinite values reset the difference.
    #[test]
    fn half_as_far_is_together_and_less_is_not() {
        let mut pair = Pair::default();
        for _ in 0..100 {
            pair.step(5.0, -3.0, 100.0);
        }
        assert_eq!(pair.distance(), 800.0);
        pair.step(f64::INFINITY, 1.0, 100.0);
        assert_eq!(pair, Pair::default());
        assert!(!Pair { start_difference: f64::INFINITY, ..Pair::default() }.is_sound());
        assert_eq!(most([(100.0, 50.0)]), 0.0);
        assert_eq!(most([(100.0, 49.0)]), 51.0);
        assert_eq!(most([(99.0, 0.0)]), 99.0);
    }
}
