//! The current loop below the others, for a drive that takes a voltage.
//!
//! Law      setpoint = output of the loop above times full_current, within AMPMAXCUR; the current is what the drive tells, effort over
//!          torque_constant. The loop of [`CurrentLoop`] makes a voltage of what is missing, in parts of that of max_effort
//! Reads    the output of the loop above, the effort that the drive tells, both in the user's sense
//! Writes   the voltage, -1 to 1
//! Refuses  nothing: parameters without full_current and torque_constant are refused
//! Source   MACS-AMP-01, MACS-AMP-07, MACS-AMP-08

use crate::parameter::{Amplifier, PowerStage};
use crate::regulator::CurrentLoop;
use serde::{Deserialize, Serialize};

/// What the loop keeps from cycle to cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct CurrentStage {
    law: CurrentLoop,
    /// (A)
    setpoint: f64,
}

impl CurrentStage {
    /// One cycle: the voltage, -1 to 1, behind an output of the loop above and the effort that the drive tells.
    pub(super) fn step(&mut self, stage: &PowerStage, amplifier: &Amplifier, output: f64, told: f64) -> f64 {
        self.setpoint = stage.setpoint(output, amplifier);
        self.law.step(&stage.gains(), self.setpoint - told / amplifier.torque_constant)
    }

    /// What is asked for (A).
    pub(super) fn setpoint(&self) -> f64 {
        self.setpoint
    }

    pub(super) fn is_sound(&self) -> bool {
        self.law.is_sound() && self.setpoint.is_finite()
    }
}
