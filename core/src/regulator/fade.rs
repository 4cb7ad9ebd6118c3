//! Compensation of a step of an output, which then fades.
//!
//! Law      output = output of the law + rest; the rest decreases by the same amount in each sample, and is 0 after
//!          [`SAMPLES`]
//! Reads    the step that a change of gains would cause at the output
//! Writes   the rest
//! Refuses  nothing: NaN adds no rest

use serde::{Deserialize, Serialize};

/// Number of samples until only the new values act.
pub(super) const SAMPLES: u16 = 64;

/// Rest of compensated steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Fade {
    rest: f64,
    left: u16,
}

impl Fade {
    /// Compensates a step of the law: the output continues from its old value.
    pub(super) fn make_up_for(&mut self, step: f64) {
        if step.is_finite() && step != 0.0 {
            // The rest of an earlier change continues, too.
            (self.rest, self.left) = ((self.rest - step).clamp(-2.0, 2.0), SAMPLES);
        }
    }

    /// Returns the value added to the output in this sample.
    pub(super) fn step(&mut self) -> f64 {
        let now = self.rest;
        if self.left > 1 {
            self.rest -= self.rest / f64::from(self.left);
            self.left -= 1;
        } else {
            *self = Self::default();
        }
        now
    }

    /// Whether the state is possible.
    pub(super) fn is_sound(&self) -> bool {
        self.left <= SAMPLES && self.rest.abs() <= 2.0 && (self.left > 0 || self.rest == 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_made_up_for_at_once_and_gone_after_64_samples_in_equal_parts() {
        let mut fade = Fade::default();
        fade.make_up_for(0.64);
        for sample in 0..64 {
            let expected = -0.64 + 0.01 * f64::from(sample);
            assert!((fade.step() - expected).abs() < 1e-12, "sample {sample}");
            assert!(fade.is_sound());
        }
        assert_eq!((fade.step(), fade.rest), (0.0, 0.0));
    }

    #[test]
    fn nan_causes_no_step() {
        let mut fade = Fade::default();
        for step in [f64::NAN, f64::INFINITY, 0.0] {
            fade.make_up_for(step);
            assert_eq!(fade, Fade::default());
        }
    }

    #[test]
    fn a_second_step_takes_over_what_is_left_of_the_first() {
        let mut fade = Fade::default();
        fade.make_up_for(0.5);
        for _ in 0..32 {
            fade.step();
        }
        let rest = fade.rest;
        fade.make_up_for(0.25);
        assert!((fade.rest - (rest - 0.25)).abs() < 1e-15);
    }
}
