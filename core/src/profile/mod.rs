//! Profiles: how a command position gets to a target or a velocity in time.
//!
//! A profile is planned once, from the motion at t_k, as a few phases in continuous time, and then read at each cycle; it
//! is not stretched to the grid. The phases up to the fastest place count from the start of the plan, those after it from
//! its end, so that the target is met exactly however far it is.

mod jerk;
mod plan;
mod sine;
mod trapezoid;

pub use plan::Plan;
pub use trapezoid::stop_at;

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Position, velocity and acceleration at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// (inc)
    pub position: Position,
    /// (inc/s)
    pub velocity: f64,
    /// (inc/s^2)
    pub acceleration: f64,
    /// (inc/s^3)
    pub jerk: f64,
}

impl Motion {
    /// At rest.
    pub fn at_rest(position: Position) -> Self {
        Self { position, ..Self::default() }
    }

    /// Numbers that can be computed with?
    pub fn is_sound(&self) -> bool {
        [self.velocity, self.acceleration, self.jerk].iter().all(|rate| rate.is_finite())
    }
}

/// Shape of the ramps (MACS-PROF-07).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// Constant acceleration.
    #[default]
    Trapezoid,
    /// Sinusoidal velocity, its peak acceleration within the limit (MACS-PROF-09).
    SRamp,
    /// Acceleration that changes no faster than these jerks (MACS-PROF-10).
    Jerk(Jerks),
}

/// The four jerks of a limited profile (inc/s^3), all above 0 (MACS-PROF-11).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Jerks {
    /// Acceleration 0 to max (JERKMIN).
    pub rise: f64,
    /// Acceleration max to 0 (JERKMIN2).
    pub fall: f64,
    /// Deceleration 0 to max (JERKMIN3).
    pub brake_rise: f64,
    /// Deceleration max to 0 (JERKMIN4).
    pub brake_fall: f64,
}

/// Limits of one profile, all above 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// (inc/s)
    pub velocity: f64,
    /// While |velocity| grows (inc/s^2).
    pub acceleration: f64,
    /// While |velocity| falls (inc/s^2).
    pub deceleration: f64,
    /// How the acceleration may change.
    pub shape: Shape,
}

impl Limits {
    /// Rates that a profile can be made with?
    pub fn is_sound(&self) -> bool {
        let jerks = match self.shape {
            Shape::Jerk(jerks) => [jerks.rise, jerks.fall, jerks.brake_rise, jerks.brake_fall],
            Shape::Trapezoid | Shape::SRamp => [1.0; 4],
        };
        let rates = [self.velocity, self.acceleration, self.deceleration];
        rates.into_iter().chain(jerks).all(|rate| rate > 0.0 && rate.is_finite())
    }

    /// The same, but with no less acceleration, deceleration and jerk than `other` has.
    #[must_use]
    pub fn at_least(self, other: &Self) -> Self {
        let shape = match (self.shape, other.shape) {
            (Shape::Jerk(mine), Shape::Jerk(other)) => Shape::Jerk(Jerks {
                rise: mine.rise.max(other.rise),
                fall: mine.fall.max(other.fall),
                brake_rise: mine.brake_rise.max(other.brake_rise),
                brake_fall: mine.brake_fall.max(other.brake_fall),
            }),
            // What has no limit of jerk must not get one in its ramp: there its acceleration would never end.
            (Shape::Jerk(_), other) => other,
            (shape, _) => shape,
        };
        Self {
            acceleration: self.acceleration.max(other.acceleration),
            deceleration: self.deceleration.max(other.deceleration),
            shape,
            ..self
        }
    }
}

/// A plan from `start` to rest at `target`. What is beyond its limit at the start goes back monotonically; where the target
/// lies behind the stopping point the plan stops and comes back.
pub fn to_rest(start: Motion, target: Position, limits: &Limits, cycle_ns: u64) -> Plan {
    to_pass(start, target, 0.0, limits, cycle_ns)
}

/// A plan from `start` that reaches `target` with `end_velocity` (inc/s) and without acceleration, and then goes on so.
/// |`end_velocity`| is within the limit.
pub fn to_pass(start: Motion, target: Position, end_velocity: f64, limits: &Limits, cycle_ns: u64) -> Plan {
    match limits.shape {
        Shape::Trapezoid => trapezoid::to_pass(start, target, end_velocity, limits, cycle_ns),
        Shape::SRamp => sine::to_pass(start, target, end_velocity, limits, cycle_ns),
        Shape::Jerk(jerks) => jerk::to_pass(start, target, end_velocity, limits, &jerks, cycle_ns),
    }
}

/// A plan from `start` to `velocity` (inc/s), which then goes on for ever.
pub fn to_velocity(start: Motion, velocity: f64, limits: &Limits, cycle_ns: u64) -> Plan {
    match limits.shape {
        Shape::Trapezoid => trapezoid::to_velocity(start, velocity, limits, cycle_ns),
        Shape::SRamp => sine::to_velocity(start, velocity, limits, cycle_ns),
        Shape::Jerk(jerks) => jerk::to_velocity(start, velocity, limits, &jerks, cycle_ns),
    }
}

/// A plan from `start` to rest with the deceleration and the shape of `limits`, wherever that is.
pub fn stop(start: Motion, limits: &Limits, cycle_ns: u64) -> Plan {
    to_velocity(start, 0.0, limits, cycle_ns)
}

/// The way that [`stop`] takes from `start` to rest (inc, with its sign).
pub fn stopping_way(start: Motion, limits: &Limits) -> f64 {
    match limits.shape {
        Shape::Trapezoid => trapezoid::stopping_way(start, limits),
        Shape::SRamp => sine::stopping_way(start, limits),
        Shape::Jerk(jerks) => jerk::stopping_way(start, limits, &jerks),
    }
}

/// Is a target that lies `distance` away met by a plan whose way is `way` (inc)? A millionth of an increment is rounding,
/// and so are the last digits of long ways.
fn is_met(distance: f64, way: f64) -> bool {
    (distance - way).abs() <= 1e-6 + 1e-15 * (distance.abs() + way.abs())
}

/// The difference of two positions (inc).
fn distance(from: Position, to: Position) -> f64 {
    let raw = (to - from).raw();
    // The narrow conversion is several times faster, and gives the same.
    i64::try_from(raw).map_or_else(|_| Position::from_raw(raw).to_f64(), |raw| raw as f64 / plan::ONE)
}

#[cfg(test)]
mod tests;
