//! The trapezoid: constant acceleration, constant velocity, constant deceleration.
//!
//! Law      v to V with acceleration a: time |V - v| / a, distance (V^2 - v^2) / (2 a)
//! Reads    the motion at the start (its acceleration may jump)
//! Writes   a plan that ends exactly at the target, or continues at a velocity without end
//! Refuses  nothing: the caller has checked that all limits are finite and above 0
//! Source   MACS-PROF-08

use super::plan::{Draft, Plan};
use super::{Limits, Motion, distance, is_met};
use crate::position::Position;

/// A change of velocity without change of sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    pub(super) from: f64,
    pub(super) to: f64,
    /// Acceleration (inc/s^2).
    pub(super) rate: f64,
}

impl Leg {
    fn time(&self) -> f64 {
        (self.to - self.from).abs() / self.rate
    }

    pub(super) fn way(&self) -> f64 {
        (self.to - self.from).abs() * (self.from + self.to) / (2.0 * self.rate)
    }
}

/// Rates while |velocity| increases and decreases (inc/s^2).
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates {
    pub(super) up: f64,
    pub(super) down: f64,
}

impl Rates {
    fn of(limits: &Limits) -> Self {
        Self { up: limits.acceleration, down: limits.deceleration }
    }

    /// Returns the legs from one velocity to another; through zero in two legs.
    pub(super) fn legs(&self, from: f64, to: f64) -> [Leg; 2] {
        let middle = if from * to < 0.0 { 0.0 } else { from };
        let rate = if to.abs() > middle.abs() { self.up } else { self.down };
        [Leg { from, to: middle, rate: self.down }, Leg { from: middle, to, rate }]
    }

    /// Returns the distance (inc).
    pub(super) fn way(&self, from: f64, to: f64) -> f64 {
        self.legs(from, to).iter().map(Leg::way).sum()
    }
}

/// Intermediate velocity on the way to a target, and the time for which the plan keeps it (s).
#[derive(Clone, Copy, Debug)]
pub(super) struct Over {
    pub(super) velocity: f64,
    pub(super) time: f64,
}

/// Returns the intermediate velocity for a motion of `distance` from velocity `from` to velocity `to`; none if the
/// direct change of velocity covers this distance.
pub(super) fn middle_velocity(distance: f64, from: f64, to: f64, top: f64, rates: Rates) -> Option<Over> {
    let direct = rates.way(from, to);
    if is_met(distance, direct) {
        return None;
    }
    // From here on the target is above the end of the direct change.
    let sign = if distance > direct { 1.0 } else { -1.0 };
    let (distance, from, to) = (sign * distance, sign * from, sign * to);
    let top = top.max(to);
    let Rates { up, down } = rates;
    // Distances from a velocity to zero, backward in time for the acceleration and forward for the deceleration.
    let climb = from * from / (2.0 * if from < 0.0 { down } else { up });
    let descent = to * to / (2.0 * if to < 0.0 { up } else { down });
    let square = 2.0 * up * down * (distance + climb + descent) / (up + down);
    let peak = square.max(0.0).sqrt().max(from.max(to));
    if peak < top {
        return Some(Over { velocity: sign * peak, time: 0.0 });
    }
    let way = rates.way(from, top) + rates.way(top, to);
    Some(Over { velocity: sign * top, time: ((distance - way) / top).max(0.0) })
}

fn forward(draft: &mut Draft<'_>, legs: [Leg; 2]) {
    for leg in legs {
        draft.forward(leg.time(), leg.from, leg.rate.copysign(leg.to - leg.from), 0.0);
    }
}

fn backward(draft: &mut Draft<'_>, legs: [Leg; 2]) {
    for leg in legs.iter().rev() {
        draft.backward(leg.time(), leg.to, leg.rate.copysign(leg.to - leg.from), 0.0);
    }
}

/// As [`super::to_pass`].
pub(super) fn to_pass(start: Motion, target: Position, end_velocity: f64, limits: &Limits, cycle_ns: u64) -> Plan {
    let rates = Rates::of(limits);
    let mut plan = Plan::new(start.position, cycle_ns);
    let mut draft = Draft::new(&mut plan);
    let distance = distance(start.position, target);
    let over = middle_velocity(distance, start.velocity, end_velocity, limits.velocity, rates);
    let before = over.map_or(start.velocity, |over| over.velocity);
    forward(&mut draft, rates.legs(start.velocity, before));
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
    let legs = Rates::of(limits).legs(start.velocity, velocity);
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
    start.velocity * start.velocity.abs() / (2.0 * limits.deceleration)
}

/// Returns a plan from `start` to rest exactly at `target` ahead, with the constant deceleration necessary for that.
pub fn stop_at(start: Motion, target: Position, cycle_ns: u64) -> Plan {
    let way = distance(start.position, target).abs();
    let mut plan = Plan::new(start.position, cycle_ns);
    let mut draft = Draft::new(&mut plan);
    if start.velocity != 0.0 {
        let time = 2.0 * way / start.velocity.abs();
        draft.backward(time, 0.0, -start.velocity / time, 0.0);
    }
    draft.finish(Some(target), 0.0);
    plan
}
