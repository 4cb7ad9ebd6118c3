//! Profiles: plans of the command position to a target or a velocity.
//!
//! A profile is planned once, from the motion at t_k, as a few phases in continuous time, and then read in each cycle;
//! it is not rounded to cycles. The phases up to the highest velocity are evaluated from the start of the plan, those
//! after it from its end, so that the target is reached exactly at any distance.

mod jerk;
mod plan;
mod sine;
mod trapezoid;

pub use plan::Plan;
pub use trapezoid::stop_at;

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Position, velocity, acceleration and jerk at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Position (inc).
    pub position: Position,
    /// Velocity (inc/s).
    pub velocity: f64,
    /// Acceleration (inc/s^2).
    pub acceleration: f64,
    /// Jerk (inc/s^3).
    pub jerk: f64,
}

impl Motion {
    /// Returns a motion at rest.
    pub fn at_rest(position: Position) -> Self {
        Self { position, ..Self::default() }
    }

    /// Whether all rates are finite.
    pub fn is_sound(&self) -> bool {
        [self.velocity, self.acceleration, self.jerk].iter().all(|rate| rate.is_finite())
    }
}

/// Ramp type (MACS-PROF-07).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// Constant acceleration.
    #[default]
    Trapezoid,
    /// Sinusoidal velocity with peak acceleration within the limit (MACS-PROF-09).
    SRamp,
    /// Acceleration with these jerk limits (MACS-PROF-10).
    Jerk(Jerks),
}

/// The four jerks of a jerk-limited profile (inc/s^3), all above 0 (MACS-PROF-11).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Jerks {
    /// Jerk from acceleration 0 to its limit (JERKMIN).
    pub rise: f64,
    /// Jerk from the acceleration limit to 0 (JERKMIN2).
    pub fall: f64,
    /// Jerk from deceleration 0 to its limit (JERKMIN3).
    pub brake_rise: f64,
    /// Jerk from the deceleration limit to 0 (JERKMIN4).
    pub brake_fall: f64,
}

/// Limits of one profile, all above 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Largest velocity (inc/s).
    pub velocity: f64,
    /// Largest acceleration while |velocity| increases (inc/s^2).
    pub acceleration: f64,
    /// Largest deceleration while |velocity| decreases (inc/s^2).
    pub deceleration: f64,
    /// Ramp type.
    pub shape: Shape,
}

impl Limits {
    /// Whether a profile exists for these limits.
    pub fn is_sound(&self) -> bool {
        let jerks = match self.shape {
            Shape::Jerk(jerks) => [jerks.rise, jerks.fall, jerks.brake_rise, jerks.brake_fall],
            Shape::Trapezoid | Shape::SRamp => [1.0; 4],
        };
        let rates = [self.velocity, self.acceleration, self.deceleration];
        rates.into_iter().chain(jerks).all(|rate| rate > 0.0 && rate.is_finite())
    }

    /// Returns these limits with acceleration, deceleration and jerk not below those of `other`.
    #[must_use]
    pub fn at_least(self, other: &Self) -> Self {
        let shape = match (self.shape, other.shape) {
            (Shape::Jerk(mine), Shape::Jerk(other)) => Shape::Jerk(Jerks {
                rise: mine.rise.max(other.rise),
                fall: mine.fall.max(other.fall),
                brake_rise: mine.brake_rise.max(other.brake_rise),
                brake_fall: mine.brake_fall.max(other.brake_fall),
            }),
            // A motion without jerk limit must not get one during its ramp: its acceleration would take too long to
            // end.
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

/// Returns a plan from `start` to rest at `target`. A start beyond a limit returns to the limit monotonically. If the
/// target is before the stopping point, the plan stops and comes back.
pub fn to_rest(start: Motion, target: Position, limits: &Limits, cycle_ns: u64) -> Plan {
    to_pass(start, target, 0.0, limits, cycle_ns)
}

/// Returns a plan from `start` that reaches `target` with `end_velocity` (inc/s) and without acceleration, and then
/// continues so.
/// |`end_velocity`| is within the limit.
pub fn to_pass(start: Motion, target: Position, end_velocity: f64, limits: &Limits, cycle_ns: u64) -> Plan {
    match limits.shape {
        Shape::Trapezoid => trapezoid::to_pass(start, target, end_velocity, limits, cycle_ns),
        Shape::SRamp => sine::to_pass(start, target, end_velocity, limits, cycle_ns),
        Shape::Jerk(jerks) => jerk::to_pass(start, target, end_velocity, limits, &jerks, cycle_ns),
    }
}

/// Returns a plan from `start` to `velocity` (inc/s), which then continues without end.
pub fn to_velocity(start: Motion, velocity: f64, limits: &Limits, cycle_ns: u64) -> Plan {
    match limits.shape {
        Shape::Trapezoid => trapezoid::to_velocity(start, velocity, limits, cycle_ns),
        Shape::SRamp => sine::to_velocity(start, velocity, limits, cycle_ns),
        Shape::Jerk(jerks) => jerk::to_velocity(start, velocity, limits, &jerks, cycle_ns),
    }
}

/// Returns a plan from `start` to rest with the deceleration and the ramp type of `limits`, at any position.
pub fn stop(start: Motion, limits: &Limits, cycle_ns: u64) -> Plan {
    to_velocity(start, 0.0, limits, cycle_ns)
}

/// Returns the distance of [`stop`] from `start` to rest (inc, signed).
pub fn stopping_distance(start: Motion, limits: &Limits) -> f64 {
    match limits.shape {
        Shape::Trapezoid => trapezoid::stopping_distance(start, limits),
        Shape::SRamp => sine::stopping_distance(start, limits),
        Shape::Jerk(jerks) => jerk::stopping_distance(start, limits, &jerks),
    }
}

/// Whether a plan with distance `way` reaches a target at `distance` (inc). A millionth of an increment is rounding,
/// and so are the last digits of long distances.
fn is_met(distance: f64, way: f64) -> bool {
    (distance - way).abs() <= 1e-6 + 1e-15 * (distance.abs() + way.abs())
}

/// Returns the difference of two positions (inc).
fn distance(from: Position, to: Position) -> f64 {
    let raw = (to - from).raw();
    // The conversion of 64 bits is several times faster, with the same result.
    i64::try_from(raw).map_or_else(|_| Position::from_raw(raw).to_f64(), |raw| raw as f64 / plan::ONE)
}

#[cfg(test)]
mod tests;
