//! A step of an output that is made up for, and then faded away.
//!
//! Law      output = what the law says + rest; rest becomes smaller by the same part in each sample, and is 0 after [`SAMPLES`]
//! Reads    by how much a change of gains would make the output step
//! Writes   the rest
//! Refuses  nothing: what is no number is no rest

use serde::{Deserialize, Serialize};

/// Samples until the new values act alone.
pub(super) const SAMPLES: u16 = 64;

/// What is left of steps that were made up for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Fade {
    rest: f64,
    left: u16,
}

impl Fade {
    /// The law would step by this: its output goes on from where it was.
    pub(super) fn make_up_for(&mut self, step: f64) {
        if step.is_finite() && step != 0.0 {
            // What is left of another change goes on, too.
            (self.rest, self.left) = ((self.rest - step).clamp(-2.0, 2.0), SAMPLES);
        }
    }

    /// What is added to the output in this sample.
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

    /// Could it have come about?
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
    fn what_is_no_number_is_no_step() {
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
