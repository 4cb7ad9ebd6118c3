//! The trapezoid: constant acceleration, cruise, constant deceleration.
//!
//! Law      v to V with acceleration a: time |V - v| / a, distance (V^2 - v^2) / (2 a)
//! Reads    the motion at the start (its acceleration is free to jump)
//! Writes   a plan that ends at rest exactly at the target, or at a velocity for ever
//! Refuses  nothing: the caller has checked that all limits are finite and above 0
//! Source   MACS-PROF-08

use super::{Motion, Plan};
use crate::position::Position;

/// Limits of one profile, all above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// (inc/s)
    pub velocity: f64,
    /// While |velocity| grows (inc/s^2).
    pub acceleration: f64,
    /// While |velocity| falls (inc/s^2).
    pub deceleration: f64,
}

/// A plan from `start` to rest at `target`. Beyond its velocity limit it slows down first; where the target lies behind
/// the stopping point it stops and comes back.
pub fn to_rest(start: Motion, target: Position, limits: Limits, cycle_ns: u64) -> Plan {
    let Limits { velocity: top, acceleration: up, deceleration: down } = limits;
    let distance = (target - start.position).to_f64();
    let stopping = start.velocity * start.velocity.abs() / (2.0 * down);
    let sign = if distance >= stopping { 1.0 } else { -1.0 };
    // From here on the target lies ahead of the stopping point, upwards.
    let (mut ahead, mut velocity) = (sign * distance, sign * start.velocity);
    let mut plan = Plan::new(start, cycle_ns);
    if velocity < 0.0 {
        plan.push(-velocity / down, 0.0);
        ahead += velocity * velocity / (2.0 * down);
        velocity = 0.0;
    } else if velocity > top {
        plan.push((velocity - top) / down, sign * top);
        ahead -= (velocity * velocity - top * top) / (2.0 * down);
        velocity = top;
    }
    let peak = peak(ahead, velocity, up, down).clamp(velocity, top.max(velocity));
    plan.push((peak - velocity) / up, sign * peak);
    let cruise = ahead - (peak * peak - velocity * velocity) / (2.0 * up) - peak * peak / (2.0 * down);
    // Below the top velocity there is no cruise; what the subtraction leaves is rounding.
    if peak >= top && peak > 0.0 {
        plan.push(cruise / peak, sign * peak);
    }
    plan.push(peak / down, 0.0);
    plan.land(target);
    plan
}

/// Velocity at which speeding up from `velocity` has to turn into slowing down, to stop after `ahead`.
fn peak(ahead: f64, velocity: f64, up: f64, down: f64) -> f64 {
    ((2.0 * up * down * ahead.max(0.0) + down * velocity * velocity) / (up + down)).sqrt()
}

/// A plan from `start` to `velocity`, which then goes on for ever.
pub fn to_velocity(start: Motion, velocity: f64, limits: Limits, cycle_ns: u64) -> Plan {
    let mut plan = Plan::new(start, cycle_ns);
    let mut now = start.velocity;
    if now * velocity < 0.0 {
        plan.push(now.abs() / limits.deceleration, 0.0);
        now = 0.0;
    }
    let rate = if velocity.abs() > now.abs() { limits.acceleration } else { limits.deceleration };
    plan.push((velocity - now).abs() / rate, velocity);
    plan
}

/// A plan from `start` to rest with constant deceleration, wherever that is.
pub fn stop(start: Motion, deceleration: f64, cycle_ns: u64) -> Plan {
    let mut plan = Plan::new(start, cycle_ns);
    plan.push(start.velocity.abs() / deceleration, 0.0);
    plan
}

/// A plan from `start` to rest exactly at `target`, which lies ahead, with the constant deceleration that this takes.
pub fn stop_at(start: Motion, target: Position, cycle_ns: u64) -> Plan {
    let way = (target - start.position).to_f64().abs();
    let mut plan = Plan::new(start, cycle_ns);
    if start.velocity != 0.0 {
        plan.push(2.0 * way / start.velocity.abs(), 0.0);
    }
    plan.land(target);
    plan
}
