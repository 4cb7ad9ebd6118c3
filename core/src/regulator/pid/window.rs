//! The control window: near the command the loop is off.
//!
//! Law      |error| <= REGWMIN switches the loop off, |error| > REGWMAX on again, between them it does not change; both
//!          0: always on. A REGWMAX below REGWMIN counts as REGWMIN
//! Reads    the error (inc)
//! Writes   on or off
//! Refuses  nothing: the rows do
//! Source   MACS-REG-11, A-26

use serde::{Deserialize, Serialize};

/// Bounds of the window (inc).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Window {
    /// REGWMIN: lower bound.
    pub min: i64,
    /// REGWMAX: upper bound.
    pub max: i64,
}

impl Window {
    /// Whether the loop is on, given whether it was `on` before.
    pub(super) fn step(self, on: bool, error: f64) -> bool {
        let (min, max) = (self.min as f64, self.max.max(self.min) as f64);
        let far = error.abs();
        if self == Self::default() {
            true
        } else if far <= min {
            false
        } else {
            on || far > max
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run<const N: usize>(window: Window, errors: [f64; N]) -> [bool; N] {
        let mut on = true;
        errors.map(|error| {
            on = window.step(on, error);
            on
        })
    }

    /// Proves: MACS-REG-11, MACS-O-23
    #[test]
    fn it_goes_off_inside_and_on_beyond_and_keeps_between() {
        let window = Window { min: 5, max: 20 };
        assert_eq!(run(window, [3.0, 10.0, 21.0, 10.0, 4.0]), [false, false, true, true, false]);
        assert_eq!(run(window, [-3.0, -10.0, -21.0, -10.0, -4.0]), [false, false, true, true, false]);
        // At the bounds themselves: inside, and not exceeded yet.
        assert_eq!(run(window, [5.0, 20.0, 20.5, 5.5]), [false, false, true, true]);
    }

    #[test]
    fn both_0_are_no_window_and_a_lone_bound_is_one() {
        assert_eq!(run(Window::default(), [0.0, 1e18]), [true, true]);
        assert_eq!(run(Window { min: 0, max: 20 }, [1.0, 0.0, 20.0, 21.0]), [true, false, false, true]);
        assert_eq!(run(Window { min: 9, max: 0 }, [9.0, 10.0, 9.0]), [false, true, false]);
    }
}
