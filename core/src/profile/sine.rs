//! The S-ramp: the velocity follows half a wave of cosine.
//!
//! Law      v(t) = v0 + (v1 - v0) (1 - cos(pi t / T)) / 2, T = pi / 2 |v1 - v0| / A: the peak acceleration is A. An
//!          acceleration at the start first ends along a quarter of a wave, a(t) = a0 cos(w t)
//! Reads    the motion at the start
//! Writes   a plan that ends exactly at the target, or continues at a velocity without end
//! Refuses  nothing: the caller has checked that all limits are finite and above 0
//! Source   MACS-PROF-09, as interpreted in A-20

use super::plan::{Draft, Plan};
use super::trapezoid::{Leg, Rates, middle_velocity};
use super::{Limits, Motion, distance};
use crate::position::Position;
use std::f64::consts::FRAC_PI_2;

/// Mean rates of the ramps: their distances are those of a trapezoid with 2 / pi of the acceleration.
fn rates(limits: &Limits) -> Rates {
    Rates { up: limits.acceleration / FRAC_PI_2, down: limits.deceleration / FRAC_PI_2 }
}

/// The quarter wave in which the acceleration at the start ends.
struct Fade {
    /// Angular frequency (1/s); infinite if there is no acceleration to end, or no room for it.
    frequency: f64,
    /// Velocity after it (inc/s).
    velocity: f64,
    /// Distance (inc).
    way: f64,
}

impl Fade {
    /// Uses the whole range up to the velocity limit, as at the end of a full ramp.
    fn whole(start: Motion, limits: &Limits) -> Self {
        Self::new(start, limits, f64::INFINITY)
    }

    /// Uses a tenth of the velocity: an axis that has to slow down must not accelerate for long.
    fn short(start: Motion, limits: &Limits) -> Self {
        Self::new(start, limits, 0.1)
    }

    /// Returns the fade for a motion that ends with `end_velocity` after `distance`.
    fn towards(start: Motion, distance: f64, end_velocity: f64, limits: &Limits) -> Self {
        let fade = Self::whole(start, limits);
        let needed = fade.way + rates(limits).way(fade.velocity, end_velocity);
        let passes = if start.velocity > 0.0 { needed > distance } else { needed < distance };
        if passes { Self::short(start, limits) } else { fade }
    }

    fn new(start: Motion, limits: &Limits, share: f64) -> Self {
        let (velocity, acceleration) = (start.velocity, start.acceleration);
        let grows = velocity * acceleration > 0.0;
        // The velocity ends between zero and its limit, or between its present value and zero.
        let (rate, room) = if grows {
            (limits.acceleration, (limits.velocity - velocity.abs()).max(0.0).min(share * velocity.abs()))
        } else {
            (limits.deceleration, velocity.abs())
        };
        let frequency = (2.0 * rate / limits.velocity).max(acceleration.abs() / room);
        if acceleration == 0.0 || room == 0.0 || !frequency.is_finite() {
            return Self { frequency: f64::INFINITY, velocity, way: 0.0 };
        }
        let change = acceleration / frequency;
        let after = velocity + change;
        let after = if grows || after * velocity > 0.0 { after } else { 0.0 };
        Self { frequency, velocity: after, way: (velocity * FRAC_PI_2 + change) / frequency }
    }
}

/// Returns both legs as one wave if their rates are equal.
fn waves(legs: [Leg; 2]) -> [Leg; 2] {
    let [first, second] = legs;
    if first.rate == second.rate { [Leg { to: first.from, ..first }, Leg { from: first.from, ..second }] } else { legs }
}

fn time(leg: &Leg) -> f64 {
    (leg.to - leg.from).abs() / leg.rate
}

fn forward(draft: &mut Draft<'_>, legs: [Leg; 2]) {
    for leg in waves(legs) {
        draft.wave_forward(time(&leg), leg.from, leg.to);
    }
}

fn backward(draft: &mut Draft<'_>, legs: [Leg; 2]) {
    for leg in waves(legs).iter().rev() {
        draft.wave_backward(time(leg), leg.from, leg.to);
    }
}

fn begin(draft: &mut Draft<'_>, start: Motion, fade: Fade) -> Fade {
    draft.push_quarter_wave(start.velocity, start.acceleration, fade.frequency);
    fade
}

/// As [`super::to_pass`].
pub(super) fn to_pass(start: Motion, target: Position, end_velocity: f64, limits: &Limits, cycle_ns: u64) -> Plan {
    let rates = rates(limits);
    let mut plan = Plan::new(start.position, cycle_ns);
    let mut draft = Draft::new(&mut plan);
    let whole = distance(start.position, target);
    let fade = begin(&mut draft, start, Fade::towards(start, whole, end_velocity, limits));
    let distance = whole - draft.way;
    let over = middle_velocity(distance, fade.velocity, end_velocity, limits.velocity, rates);
    let before = over.map_or(fade.velocity, |over| over.velocity);
    forward(&mut draft, rates.legs(fade.velocity, before));
    backward(&mut draft, rates.legs(before, end_velocity));
    if let Some(over) = over {
        draft.cruise(over.time, over.velocity);
    }
    draft.finish(Some(target), end_velocity);
    plan
}

/// As [`super::to_velocity`].
pub(super) fn to_velocity(start: Motion, velocity: f64, limits: &Limits, cycle_ns: u64) -> Plan {
    let mut plan = Plan::new(start.position, cycle_ns);
    let mut draft = Draft::new(&mut plan);
    let slows = velocity * start.velocity <= 0.0 || velocity.abs() < start.velocity.abs();
    let fade = if slows { Fade::short(start, limits) } else { Fade::whole(start, limits) };
    let fade = begin(&mut draft, start, fade);
    let legs = rates(limits).legs(fade.velocity, velocity);
    if velocity == 0.0 {
        backward(&mut draft, legs)
    } else {
        forward(&mut draft, legs)
    }
    draft.finish(None, velocity);
    plan
}

/// As [`super::stopping_distance`].
pub(super) fn stopping_distance(start: Motion, limits: &Limits) -> f64 {
    let fade = Fade::short(start, limits);
    fade.way + rates(limits).way(fade.velocity, 0.0)
}
