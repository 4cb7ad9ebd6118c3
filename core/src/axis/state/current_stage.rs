//! The current loop, the innermost loop for a drive with voltage command.
//!
//! Law      setpoint = output of the outer loop * full_current, within AMPMAXCUR. Actual current = effort reported by
//!          the drive / torque_constant. [`CurrentLoop`] calculates the voltage from the difference, as a fraction of
//!          the voltage of max_effort
//! Reads    the output of the outer loop, the effort that the drive reports, both in the direction of the axis
//! Writes   the voltage, -1 to 1
//! Refuses  nothing: parameters without full_current and torque_constant are refused
//! Source   MACS-AMP-01, MACS-AMP-07, MACS-AMP-08

use crate::parameter::{Amplifier, PowerStage};
use crate::regulator::CurrentLoop;
use serde::{Deserialize, Serialize};

/// State of the current loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct CurrentStage {
    law: CurrentLoop,
    /// Setpoint of the current (A).
    setpoint: f64,
}

impl CurrentStage {
    /// Advances by one cycle and returns the voltage, -1 to 1, from the output of the outer loop and the effort that
    /// the drive reports.
    pub(in crate::axis) fn step(&mut self, stage: &PowerStage, amplifier: &Amplifier, output: f64, told: f64) -> f64 {
        self.setpoint = stage.setpoint(output, amplifier);
        self.law.step(&stage.gains(), self.setpoint - told / amplifier.torque_constant)
    }

    /// Returns the setpoint of the current (A).
    pub(in crate::axis) fn setpoint(&self) -> f64 {
        self.setpoint
    }

    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.law.is_sound() && self.setpoint.is_finite()
    }
}
