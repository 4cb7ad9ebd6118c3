//! Parameters of the loops below the position loop: those of the power stage of MACS, and additional ones.

use crate::code::Code;
use crate::regulator::{EstimatorError, I2tSettings, MotionModel, VelocityEstimator, VelocityGains, VelocityMethod};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

mod encoder;

pub use encoder::VelocityEncoder;

/// Methods of finding the velocity for the velocity loop.
pub const ESTIMATORS: &[&str] = &["difference", "filtered", "alpha_beta", "kalman"];

/// Default of AMPMAXCUR (mA).
pub(in crate::parameter) const MAX_CURRENT: i64 = 2000;

/// Parameters of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Amplifier {
    /// Effort of the full output, in the unit of the drive.
    pub max_effort: Option<f64>,
    /// Effort per ampere, in the unit of the drive; 0: currents are unknown.
    pub torque_constant: f64,
    /// AMPMODE
    pub mode: i64,
    /// AMPMAXCUR (mA)
    pub max_current: i64,
    /// VELKPROP
    pub proportional: i64,
    /// VELKINT
    pub integral: i64,
    /// VELKILIM
    pub limit: i64,
    /// Index in [`ESTIMATORS`].
    pub estimator: i64,
    /// Bandwidth of the filter or the observer (Hz).
    pub bandwidth: f64,
    /// Standard deviation of the acceleration for the Kalman filter (inc/s^2).
    pub acceleration: f64,
    /// I2TFTIME (ms)
    pub heat_time: i64,
    /// I2TLIMIT (A^2/1000)
    pub heat_limit: i64,
    /// CURFTIME (ms)
    pub current_time: i64,
    /// Separate encoder of the velocity loop.
    pub encoder: VelocityEncoder,
}

impl Amplifier {
    /// Returns the gains of the velocity loop, with one sample per cycle.
    pub fn velocity_gains(&self, cycle_ns: u64) -> VelocityGains {
        VelocityGains {
            proportional: whole(self.proportional),
            integral: whole(self.integral),
            limit: whole(self.limit),
            cycle: milliseconds(cycle_ns),
        }
    }

    /// Returns the settings of the I2t monitoring of the current.
    pub fn i2t_settings(&self, cycle_ns: u64) -> I2tSettings {
        I2tSettings {
            time: whole(self.heat_time),
            limit: whole(self.heat_limit),
            shown_time: whole(self.current_time),
            cycle: milliseconds(cycle_ns),
        }
    }

    /// Returns true if the axis has a velocity loop in this program.
    pub fn has_velocity_loop(&self) -> bool {
        matches!(self.mode, 0 | 1)
    }

    /// Returns true if the axis has a current loop, in this program or in its drive.
    pub fn has_current_loop(&self) -> bool {
        matches!(self.mode, 0 | 2)
    }

    /// Returns the method of finding the velocity.
    pub fn method(&self) -> VelocityMethod {
        match self.estimator {
            1 => VelocityMethod::Filtered { time: 1.0 / (TAU * self.bandwidth) },
            2 => VelocityMethod::AlphaBeta { bandwidth: TAU * self.bandwidth },
            3 => VelocityMethod::Kalman { model: MotionModel::ConstantVelocity { acceleration: self.acceleration } },
            _ => VelocityMethod::Difference,
        }
    }

    /// Creates the velocity estimator, at rest.
    ///
    /// # Errors
    /// A setting that does not fit the cycle time.
    pub fn estimator(&self, cycle_ns: u64) -> Result<VelocityEstimator, EstimatorError> {
        VelocityEstimator::new(self.method(), cycle_ns as f64 / 1e9)
    }

    /// Checks that the loops can run with these parameters on a drive that closes the current loop.
    ///
    /// # Errors
    /// The key of the invalid parameter, and the reason.
    pub fn check(&self, cycle_ns: u64) -> Result<(), (&'static str, Code)> {
        if !self.has_current_loop() {
            return Err(("ampmode", Code::NO_POWER_STAGE));
        }
        self.check_loops(cycle_ns)
    }

    /// Checks that the loops can run with these parameters on any drive.
    ///
    /// # Errors
    /// The key of the invalid parameter, and the reason.
    pub fn check_loops(&self, cycle_ns: u64) -> Result<(), (&'static str, Code)> {
        if self.max_effort.is_none() {
            return Err(("max_effort", Code::EFFORT_MISSING));
        }
        if self.estimator(cycle_ns).is_err() {
            return Err(("velocity_loop.acceleration", Code::ESTIMATOR_RANGE));
        }
        let currents = [
            ("ampmaxcur", self.max_current, MAX_CURRENT),
            ("i2tftime", self.heat_time, 0),
            ("i2tlimit", self.heat_limit, 0),
            ("curftime", self.current_time, 0),
        ];
        let asked = currents.into_iter().find(|(_, value, usual)| self.torque_constant == 0.0 && value != usual);
        asked.map_or(Ok(()), |(key, ..)| Err((key, Code::CURRENT_UNKNOWN)))
    }

    /// Returns the maximum output, 0 to 1: AMPMAXCUR, if currents are known.
    pub fn max_output(&self) -> f64 {
        let full = self.max_effort.unwrap_or_default();
        if self.torque_constant == 0.0 || full == 0.0 {
            return 1.0;
        }
        (self.torque_constant * self.max_current as f64 / 1000.0 / full).clamp(0.0, 1.0)
    }
}

/// The rows limit the value to 32 bits.
fn whole(value: i64) -> i32 {
    value.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

fn milliseconds(cycle_ns: u64) -> f64 {
    cycle_ns as f64 / 1e6
}
