//! Velocity of an axis from its counted positions.
//!
//! Law      one of four: [`VelocityMethod`]. Each uses the exact change of the position since the last cycle
//! Reads    a position each cycle (inc)
//! Writes   the velocity (inc/s) at the instant of the cycle, apart from the delay of the method
//! Refuses  settings beyond their range ([`EstimatorError`])
//!
//! The first position causes no motion: an estimator begins at rest. All four find a constant velocity without bias.
//! Their noise by quantization and their delays are printed by the test `table`.

mod alpha_beta;
mod difference;
mod filtered;
mod kalman;
mod track;

use crate::position::Position;
use difference::Difference;
use filtered::Filtered;
use serde::{Deserialize, Serialize};
use track::{Gains, Track};

/// Method for calculating the velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum VelocityMethod {
    /// The change of the cycle.
    Difference,
    /// The change of the cycle with a first-order lag.
    Filtered {
        /// Time constant of the lag (s): 0 to 1000; 0 is no lag.
        time: f64,
    },
    /// An observer of position and velocity, critically damped.
    AlphaBeta {
        /// Bandwidth of its double pole (rad/s): 0.001 to 1000000.
        bandwidth: f64,
    },
    /// A Kalman filter in its steady state, for positions that are rounded to whole increments.
    Kalman {
        /// Model of the motion.
        model: MotionModel,
    },
}

/// Model of the changes of a motion in a Kalman filter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum MotionModel {
    /// The velocity is constant, apart from an independent acceleration in each cycle.
    ConstantVelocity {
        /// Standard deviation of the acceleration (inc/s^2): an index acceleration T^2 sqrt(12) of 1e-10 to 1000 inc.
        acceleration: f64,
    },
    /// The acceleration is constant, apart from an independent jerk in each cycle.
    ConstantAcceleration {
        /// Standard deviation of the jerk (inc/s^3): an index jerk T^3 sqrt(12) of 1e-10 to 1000 inc.
        jerk: f64,
    },
}

/// Error in the settings of an estimator.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum EstimatorError {
    /// A setting is out of range.
    #[error("{name} is {value} {unit}; {least} to {most} {unit} is permitted")]
    Range {
        /// Name of the setting.
        name: &'static str,
        /// Given value.
        value: f64,
        /// Unit of all three values.
        unit: &'static str,
        /// Smallest allowed value.
        least: f64,
        /// Largest allowed value.
        most: f64,
    },
    /// The gains of a Kalman filter were not found. No allowed setting is known to cause this.
    #[error("{name} is {value} {unit}, for which a Kalman filter has no steady state in double precision")]
    Unsettled {
        /// Name of the setting.
        name: &'static str,
        /// Given value.
        value: f64,
        /// Unit of the value.
        unit: &'static str,
    },
}

/// Indices of a Kalman filter for which its gains are found to ten digits.
const INDEX: (f64, f64) = (1e-10, 1e3);

/// Returns an error if the value is out of range; NaN is out of every range.
fn check_range(
    name: &'static str,
    value: f64,
    unit: &'static str,
    least: f64,
    most: f64,
) -> Result<(), EstimatorError> {
    let error = EstimatorError::Range { name, value, unit, least, most };
    if (least..=most).contains(&value) { Ok(()) } else { Err(error) }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Law {
    Difference(Difference),
    Filtered(Filtered),
    Observer(Gains, Track),
}

/// State of an estimator between two cycles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VelocityEstimator {
    /// Cycle time (s).
    cycle: f64,
    /// Position of the last cycle; none before the first.
    last: Option<i64>,
    law: Law,
}

impl VelocityEstimator {
    /// Returns an estimator at rest, for a cycle time (s) of 0.000001 to 1.
    ///
    /// # Errors
    /// A value beyond its range.
    pub fn new(method: VelocityMethod, cycle: f64) -> Result<Self, EstimatorError> {
        check_range("cycle", cycle, "s", 1e-6, 1.0)?;
        let law = match method {
            VelocityMethod::Difference => Law::Difference(Difference::default()),
            VelocityMethod::Filtered { time } => {
                check_range("time", time, "s", 0.0, 1e3)?;
                Law::Filtered(Filtered::new(time / cycle))
            }
            VelocityMethod::AlphaBeta { bandwidth } => {
                check_range("bandwidth", bandwidth, "rad/s", 1e-3, 1e6)?;
                Law::Observer(alpha_beta::gains(bandwidth * cycle), Track::default())
            }
            VelocityMethod::Kalman { model } => Law::Observer(kalman_gains(model, cycle)?, Track::default()),
        };
        Ok(Self { cycle, last: None, law })
    }

    /// Advances by one cycle with this position (inc) and returns the velocity (inc/s).
    pub fn step(&mut self, position: i64) -> f64 {
        // Differences of positions within +-2^62 fit; beyond, at least the sign is right.
        let change = self.last.map_or(0, |last| position.saturating_sub(last)) as f64;
        self.last = Some(position);
        match &mut self.law {
            Law::Difference(law) => law.step(change),
            Law::Filtered(law) => law.step(change),
            Law::Observer(gains, track) => track.step(gains, change),
        }
        self.velocity()
    }

    /// Returns the velocity of the last cycle (inc/s).
    pub fn velocity(&self) -> f64 {
        let velocity = match &self.law {
            Law::Difference(law) => law.velocity,
            Law::Filtered(law) => law.velocity,
            Law::Observer(_, track) => track.velocity,
        };
        velocity / self.cycle
    }

    /// Returns the acceleration of the method (inc/s^2); 0 if it has none.
    pub fn acceleration(&self) -> f64 {
        match &self.law {
            Law::Observer(_, track) => track.acceleration / (self.cycle * self.cycle),
            Law::Difference(_) | Law::Filtered(_) => 0.0,
        }
    }

    /// Increases all positions by `by` (inc). The velocity does not change.
    pub fn shift(&mut self, by: i64) {
        self.last = self.last.map(|last| last.saturating_add(by));
    }

    /// Resets to rest, with the next position as the first.
    pub fn restart(&mut self) {
        self.last = None;
        match &mut self.law {
            Law::Difference(law) => law.velocity = 0.0,
            Law::Filtered(law) => law.velocity = 0.0,
            Law::Observer(_, track) => *track = Track::default(),
        }
    }

    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        // A change has 64 bits, and a lag does not exceed it.
        let moves = |velocity: f64| velocity.abs() <= 2.0 * Position::LIMIT as f64;
        let law = match &self.law {
            Law::Difference(law) => moves(law.velocity),
            Law::Filtered(law) => law.share > 0.0 && law.share <= 1.0 && moves(law.velocity),
            Law::Observer(gains, track) => gains.is_sound() && track.is_sound(),
        };
        law && (1e-6..=1.0).contains(&self.cycle)
    }
}

fn kalman_gains(model: MotionModel, cycle: f64) -> Result<Gains, EstimatorError> {
    let square = cycle * cycle;
    let (name, value, unit, inc) = match model {
        MotionModel::ConstantVelocity { acceleration } => ("acceleration", acceleration, "inc/s^2", square),
        MotionModel::ConstantAcceleration { jerk } => ("jerk", jerk, "inc/s^3", square * cycle),
    };
    let unit_index = inc / kalman::QUANTISATION;
    check_range(name, value, unit, INDEX.0 / unit_index, INDEX.1 / unit_index)?;
    let gains = match model {
        MotionModel::ConstantVelocity { .. } => kalman::constant_velocity(value * unit_index),
        MotionModel::ConstantAcceleration { .. } => kalman::constant_acceleration(value * unit_index),
    };
    gains.filter(Gains::is_sound).ok_or(EstimatorError::Unsettled { name, value, unit })
}

#[cfg(test)]
mod tests;
