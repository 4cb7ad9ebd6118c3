//! Stretched time: a trajectory that is executed more slowly than planned, on the same path.
//!
//! Law      with t the elapsed time, s the stretch and tau the elapsed time of the trajectory: tau = t / s, exactly,
//!          with s a multiple of 2^-32; q = q(tau), velocity q'(tau) / s, acceleration q''(tau) / s^2

use super::Reach;
use crate::profile::Motion;
use serde::{Deserialize, Serialize};

/// A stretch of 1.
const ONE: u64 = 1 << 32;

/// A time of a trajectory: whole nanoseconds and the fraction of the next one, 0 or more and less than 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Whole nanoseconds.
    pub ns: u64,
    /// Fraction of a nanosecond.
    pub fraction: f64,
}

impl Moment {
    /// Returns the nanoseconds from an earlier whole nanosecond to this moment.
    pub fn since(self, begin_ns: u64) -> f64 {
        self.ns.saturating_sub(begin_ns) as f64 + self.fraction
    }
}

/// Factor by which a trajectory takes longer than planned: 1 or more, in steps of 2^-32.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Stretch(u64);

impl Stretch {
    /// Without stretching.
    pub const NONE: Self = Self(ONE);

    /// Returns the smallest stretch that is not below a factor.
    pub fn at_least(factor: f64) -> Self {
        // A float beyond the range of u64 becomes its nearest value.
        Self(((factor * ONE as f64).ceil() as u64).max(ONE))
    }

    /// Returns the factor.
    pub fn factor(self) -> f64 {
        self.0 as f64 / ONE as f64
    }

    /// Returns the time of the trajectory after `begin_ns`, once `elapsed_ns` of real time have passed since then.
    pub fn time_after(self, begin_ns: u64, elapsed_ns: u64) -> Moment {
        let scaled = u128::from(elapsed_ns) << 32;
        // The result does not exceed the elapsed time, as the stretch is at least 1.
        let divisor = u128::from(self.0.max(ONE));
        let (whole, rest) = (scaled / divisor, scaled % divisor);
        Moment { ns: begin_ns.saturating_add(whole as u64), fraction: rest as f64 / divisor as f64 }
    }

    /// Returns the real time for a time of the trajectory, rounded up (ns).
    pub fn real_ns(self, time_ns: u64) -> u64 {
        let real = (u128::from(time_ns) * u128::from(self.0)).div_ceil(u128::from(ONE));
        u64::try_from(real).unwrap_or(u64::MAX)
    }

    /// Returns the real motion for a motion in the time of the trajectory.
    pub fn real(self, motion: Motion) -> Motion {
        scaled(motion, 1.0 / self.factor())
    }

    /// Returns the motion in the time of the trajectory for a real one.
    pub fn planned(self, motion: Motion) -> Motion {
        scaled(motion, self.factor())
    }

    /// Returns the real range and rates of a stretched motion.
    pub fn real_reach(self, reach: Reach) -> Reach {
        let rate = 1.0 / self.factor();
        Reach {
            slowest: reach.slowest * rate,
            fastest: reach.fastest * rate,
            acceleration: reach.acceleration * rate * rate,
            deceleration: reach.deceleration * rate * rate,
            ..reach
        }
    }
}

fn scaled(motion: Motion, rate: f64) -> Motion {
    Motion {
        velocity: motion.velocity * rate,
        acceleration: motion.acceleration * rate * rate,
        jerk: motion.jerk * rate * rate * rate,
        ..motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn unstretched_time_is_real_time() {
        let moment = Stretch::NONE.time_after(7, 1_000_000_007);
        assert_eq!(moment, Moment { ns: 1_000_000_014, fraction: 0.0 });
        let motion = Motion { velocity: 0.1, acceleration: -0.3, jerk: 0.7, ..Motion::default() };
        assert_eq!(Stretch::NONE.real(motion), motion);
        assert_eq!(Stretch::NONE.planned(motion), motion);
        assert_eq!(Stretch::NONE.real_ns(u64::MAX), u64::MAX);
    }

    /// 3 ns stretched by 1.5 are 2 ns; 1 ns is 2/3 of a nanosecond. With twice the time the velocity is half, the
    /// acceleration a quarter, the jerk an eighth.
    #[test]
    fn stretched_time_keeps_its_fraction() {
        let stretch = Stretch::at_least(1.5);
        assert_eq!(stretch.time_after(10, 3), Moment { ns: 12, fraction: 0.0 });
        assert_eq!(stretch.time_after(10, 1), Moment { ns: 10, fraction: 2.0 / 3.0 });
        assert_eq!((stretch.real_ns(2), stretch.real_ns(1)), (3, 2));
        let motion = Motion { velocity: 2.0, acceleration: 4.0, jerk: 8.0, ..Motion::default() };
        let half = Motion { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ..Motion::default() };
        assert_eq!(Stretch::at_least(2.0).real(motion), half);
        assert_eq!(Stretch::at_least(2.0).planned(half), motion);
    }

    #[test]
    fn invalid_factors_become_the_nearest_valid_one() {
        assert_eq!(Stretch::at_least(f64::NAN), Stretch::NONE);
        assert_eq!(Stretch::at_least(0.5), Stretch::NONE);
        assert_eq!(Stretch::at_least(f64::INFINITY), Stretch(u64::MAX));
        assert_eq!(Stretch(u64::MAX).real_ns(u64::MAX), u64::MAX);
    }

    proptest! {
        /// A stretch is at least the requested factor and at most 2^-32 above it; the time of the trajectory never
        /// exceeds the real one, and a time of it has passed exactly after its real time.
        #[test]
        fn real_time_and_time_of_the_trajectory_agree(factor in 1.0..10.0_f64, time_ns in 0..1_u64 << 60) {
            let stretch = Stretch::at_least(factor);
            prop_assert!(stretch.factor() >= factor && stretch.factor() - factor <= 1.0 / ONE as f64);
            let real = stretch.real_ns(time_ns);
            prop_assert!(stretch.time_after(0, real).ns >= time_ns);
            prop_assert!(real == 0 || stretch.time_after(0, real - 1).ns < time_ns);
            prop_assert!(stretch.time_after(0, time_ns).ns <= time_ns);
        }
    }
}
