//! Velocities in a unit of which every velocity is a whole multiple.
//!
//! Law      target = override * step, override in 1/1024; a call changes the velocity by at most a ramp, then adds it
//!          to the travel, whose whole increments are output and whose fraction is kept. step = increments * call /
//!          (time * 1024), or 1/1024 of the travel of the source in the call; ramp = accel * call^2. The unit is the
//!          common denominator of both. Rounding occurs only when a velocity and a fraction are converted to another
//!          unit, once each
//! Source   AMK-FGEN-16 to -20, -22

use crate::function::time::{HALF_MS, floor_ratio};
use serde::{Deserialize, Serialize};

/// An override of 100 %.
pub(super) const FULL: i64 = 1024;
/// Square of the nanoseconds per second.
const SECOND_SQUARED: i128 = 1_000_000_000_000_000_000;
/// Upper bound of the time between calls (ns), far above any cycle.
const CALL_BOUND: u64 = 1 << 40;

/// A rate defined by a time: increments per number of half milliseconds, both above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rate {
    pub increments: i64,
    pub half_ms: i64,
}

impl Rate {
    /// Returns the increments per call, times a factor, rounded up.
    pub(super) fn per_call(self, factor: i64, call_ns: u64) -> i64 {
        let dividend = i128::from(self.increments).saturating_mul(i128::from(call_ns)).saturating_mul(factor.into());
        let divisor = i128::from(self.half_ms) * i128::from(HALF_MS);
        floor_ratio(dividend.saturating_add(divisor - 1), divisor)
    }
}

/// Velocity step and ramps per call of a parameter set.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct VelocityStep {
    /// Parts per increment.
    unit: i128,
    /// Travel per call for an override of 1; if a source gives the velocity, per increment of the source.
    step: i128,
    /// Maximum change of velocity per call, while E2 is 0 and while it is 1.
    ramps: [i128; 2],
}

impl VelocityStep {
    /// Returns the pace of a rate, or of a source (`None`); accelerations (inc/s^2) are 0 or more.
    pub(super) fn new(rate: Option<Rate>, accelerations: [i64; 2], call_ns: u64) -> Self {
        // The call time is below 2^40, its square below 2^80. 10^18 is below 2^60, a cycle time in 1024 parts below
        // 2^44: the unit is below 2^104, in practice below 2^75, as both have factors of two and five in common.
        let call = i128::from(call_ns.clamp(1, CALL_BOUND));
        let [square, seconds] = reduced(call * call, SECOND_SQUARED);
        let full = i128::from(FULL);
        let [way, time] = match rate {
            Some(rate) => reduced(
                call * i128::from(rate.increments),
                i128::from(rate.half_ms.max(1)) * i128::from(HALF_MS) * full,
            ),
            None => [1, full],
        };
        let [_, more] = reduced(seconds, time);
        let unit = seconds.saturating_mul(more);
        // A rate is checked to be at most 2^15 inc per call before use. A saturated ramp exceeds all velocities.
        let of = |ratio: i128, parts: i128| ratio.saturating_mul(unit.checked_div(parts).unwrap_or(0));
        Self {
            unit,
            step: of(way, time),
            ramps: accelerations.map(|accel| of(square.saturating_mul(accel.into()), seconds)),
        }
    }
}

impl Default for VelocityStep {
    fn default() -> Self {
        Self { unit: 1, step: 0, ramps: [0; 2] }
    }
}

/// Motion of the generator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Motion {
    pace: VelocityStep,
    /// Travel per call, in the parts of its pace.
    velocity: i128,
    /// Fraction of the travel, in 0..unit.
    fraction: i128,
}

impl Motion {
    /// Creates a motion at rest.
    pub(super) fn new(pace: VelocityStep) -> Self {
        Self { pace, ..Self::default() }
    }

    /// Changes to another pace.
    pub(super) fn set_pace(&mut self, pace: VelocityStep) {
        let (from, to) = (self.pace.unit, pace.unit);
        if from != to {
            let [less, more] = reduced(from, to);
            // The common factor is at least as large as the first factor of a unit, so that `more` is below 2^44 and a
            // fraction below 2^75.
            let pass = |parts: i128| {
                let (whole, rest) = (parts.div_euclid(from.max(1)), parts.rem_euclid(from.max(1)));
                let rest = rest.saturating_mul(more).checked_div(less).unwrap_or(0);
                whole.saturating_mul(to).saturating_add(rest)
            };
            (self.velocity, self.fraction) = (pass(self.velocity), pass(self.fraction));
        }
        self.pace = pace;
    }

    /// Returns the target velocity for an override, or for the travel of the source times the override.
    #[inline]
    pub(super) fn target(&self, by: i64) -> i128 {
        // A checked set is at most 2^15 inc per call, a source 2^32: far from wrapping.
        self.pace.step.wrapping_mul(by.into())
    }

    /// Sets the velocity at once.
    pub(super) fn set_velocity(&mut self, target: i128) {
        self.velocity = target;
    }

    /// Changes the velocity towards a target by one of the ramps.
    #[inline]
    pub(super) fn approach(&mut self, target: i128, second: bool) {
        let [ramp, other] = self.pace.ramps;
        let ramp = if second { other } else { ramp };
        let change = target.saturating_sub(self.velocity);
        self.velocity = self.velocity.saturating_add(change.max(-ramp).min(ramp));
    }

    /// Returns the whole increments of a call.
    #[inline]
    pub(super) fn advance(&mut self) -> i64 {
        let sum = self.fraction.saturating_add(self.velocity);
        let whole = floor_ratio(sum, self.pace.unit);
        // No valid velocity exceeds 2^44 inc: nothing wraps.
        self.fraction = sum.wrapping_sub(self.pace.unit.wrapping_mul(whole.into()));
        whole
    }

    /// Stops at once and drops the fraction of an increment.
    pub(super) fn stop(&mut self) {
        (self.velocity, self.fraction) = (0, 0);
    }

    /// Returns the direction of motion: -1, 0 or 1.
    pub(super) fn direction(&self) -> i128 {
        self.velocity.signum()
    }

    /// Returns true if the travel has a fraction of an increment.
    pub(super) fn has_rest(&self) -> bool {
        self.fraction != 0
    }

    pub(super) fn is_of(&self, pace: VelocityStep) -> bool {
        self.pace == pace
    }

    /// Returns true if no result of these values can saturate.
    pub(super) fn is_sound(&self) -> bool {
        let VelocityStep { unit, step, ramps } = self.pace;
        let most = |parts: i128| (1_i128 << 44).saturating_mul(parts);
        (1..1 << 76).contains(&unit)
            && (0..=most(unit)).contains(&step)
            && ramps.into_iter().all(|ramp| ramp >= 0)
            && (0..unit).contains(&self.fraction)
            && self.velocity.saturating_abs() <= most(unit)
    }
}

/// Returns a ratio in lowest terms; the divisor is above 0.
fn reduced(dividend: i128, divisor: i128) -> [i128; 2] {
    let (mut a, mut b) = (dividend, divisor);
    while b != 0 {
        (a, b) = (b, a.checked_rem(b).unwrap_or(0));
    }
    [dividend, divisor].map(|part| part.checked_div(a).unwrap_or(0))
}
