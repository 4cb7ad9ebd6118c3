//! Velocities in such parts of an increment that every one is a whole number of them.
//!
//! Law      target = override * step, override in 1/1024; a call changes the velocity by at most a ramp, then adds it to the way, whose whole
//!          increments go out and whose rest stays. step = increments * call / (time * 1024), or 1/1024 of the source's way in the call;
//!          ramp = accel * call^2. The unit is the least common one of both, so nothing is rounded but a velocity and a rest that pass to
//!          another unit, once each
//! Source   AMK-FGEN-16 to -20, -22

use super::super::time::{HALF_MS, floor_ratio};
use serde::{Deserialize, Serialize};

/// An override of 100 %.
pub(super) const FULL: i64 = 1024;
/// So many calls of one ns have a second twice as a factor.
const SECOND_SQUARED: i128 = 1_000_000_000_000_000_000;
/// Calls are shorter (ns): cycles by far.
const CALL_BOUND: u64 = 1 << 40;

/// A rate that a time gives: increments in so many half milliseconds, both above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rate {
    pub increments: i64,
    pub half_ms: i64,
}

impl Rate {
    /// Increments in a call, times a factor, rounded up.
    pub(super) fn per_call(self, factor: i64, call_ns: u64) -> i64 {
        let dividend = i128::from(self.increments).saturating_mul(i128::from(call_ns)).saturating_mul(factor.into());
        let divisor = i128::from(self.half_ms) * i128::from(HALF_MS);
        floor_ratio(dividend.saturating_add(divisor - 1), divisor)
    }
}

/// What the set makes of a call.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Pace {
    /// Parts of an increment.
    unit: i128,
    /// Way of a call by an override of 1; where a source gives the velocity, of one increment of it.
    step: i128,
    /// By how much a call may change the velocity, while E2 is 0 and while it is 1.
    ramps: [i128; 2],
}

impl Pace {
    /// One of a rate, or of a source; accelerations (inc/s^2) are 0 or more.
    pub(super) fn new(rate: Option<Rate>, accelerations: [i64; 2], call_ns: u64) -> Self {
        // Times: 2^40, its square 2^80. 10^18 is below 2^60, a time of a cycle in 1024 parts below 2^44: the unit is below 2^104, in truth
        // below 2^75, as both have their twos and fives in common.
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
        // A rate is held to 2^15 inc in a call before it is used. A ramp that saturates is beyond all velocities.
        let of = |ratio: i128, parts: i128| ratio.saturating_mul(unit.checked_div(parts).unwrap_or(0));
        Self {
            unit,
            step: of(way, time),
            ramps: accelerations.map(|accel| of(square.saturating_mul(accel.into()), seconds)),
        }
    }
}

impl Default for Pace {
    fn default() -> Self {
        Self { unit: 1, step: 0, ramps: [0; 2] }
    }
}

/// How the generator moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Motion {
    pace: Pace,
    /// Way of a call, in the parts of its pace.
    velocity: i128,
    /// Of the way so far, in 0..unit.
    rest: i128,
}

impl Motion {
    /// One at rest.
    pub(super) fn new(pace: Pace) -> Self {
        Self { pace, ..Self::default() }
    }

    /// It goes on with another pace.
    pub(super) fn renew(&mut self, pace: Pace) {
        let (from, to) = (self.pace.unit, pace.unit);
        if from != to {
            let [less, more] = reduced(from, to);
            // What both have in common is at least as large as the first part of a unit, so that `more` is below 2^44 and a rest below 2^75.
            let pass = |parts: i128| {
                let (whole, rest) = (parts.div_euclid(from.max(1)), parts.rem_euclid(from.max(1)));
                let rest = rest.saturating_mul(more).checked_div(less).unwrap_or(0);
                whole.saturating_mul(to).saturating_add(rest)
            };
            (self.velocity, self.rest) = (pass(self.velocity), pass(self.rest));
        }
        self.pace = pace;
    }

    /// The velocity that an override, or the override of a way of the source, asks for.
    #[inline]
    pub(super) fn target(&self, by: i64) -> i128 {
        // What was checked goes at most 2^15 inc in a call, a source 2^32: far from wrapping.
        self.pace.step.wrapping_mul(by.into())
    }

    /// Takes a velocity at once.
    pub(super) fn jump(&mut self, target: i128) {
        self.velocity = target;
    }

    /// Comes to a velocity by one of the ramps.
    #[inline]
    pub(super) fn approach(&mut self, target: i128, second: bool) {
        let [ramp, other] = self.pace.ramps;
        let ramp = if second { other } else { ramp };
        let change = target.saturating_sub(self.velocity);
        self.velocity = self.velocity.saturating_add(change.max(-ramp).min(ramp));
    }

    /// The whole increments of a call.
    #[inline]
    pub(super) fn advance(&mut self) -> i64 {
        let sum = self.rest.saturating_add(self.velocity);
        let whole = floor_ratio(sum, self.pace.unit);
        // No sound velocity is beyond 2^44 inc: nothing wraps.
        self.rest = sum.wrapping_sub(self.pace.unit.wrapping_mul(whole.into()));
        whole
    }

    /// Stands; what is no whole increment is dropped.
    pub(super) fn stop(&mut self) {
        (self.velocity, self.rest) = (0, 0);
    }

    /// Which way it moves: -1, 0 or 1.
    pub(super) fn sense(&self) -> i128 {
        self.velocity.signum()
    }

    /// Is there more than whole increments?
    pub(super) fn has_rest(&self) -> bool {
        self.rest != 0
    }

    pub(super) fn is_of(&self, pace: Pace) -> bool {
        self.pace == pace
    }

    /// Within these nothing that is computed of it saturates.
    pub(super) fn is_sound(&self) -> bool {
        let Pace { unit, step, ramps } = self.pace;
        let most = |parts: i128| (1_i128 << 44).saturating_mul(parts);
        (1..1 << 76).contains(&unit)
            && (0..=most(unit)).contains(&step)
            && ramps.into_iter().all(|ramp| ramp >= 0)
            && (0..unit).contains(&self.rest)
            && self.velocity.saturating_abs() <= most(unit)
    }
}

/// A ratio in lowest terms; the divisor is above 0.
fn reduced(dividend: i128, divisor: i128) -> [i128; 2] {
    let (mut a, mut b) = (dividend, divisor);
    while b != 0 {
        (a, b) = (b, a.checked_rem(b).unwrap_or(0));
    }
    [dividend, divisor].map(|part| part.checked_div(a).unwrap_or(0))
}
