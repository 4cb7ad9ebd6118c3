//! Data that an axis exchanges with its drive in a cycle.

use super::drive_shown::DriveShown;
use crate::drive::{DriveOutput, Mode};
use serde::{Deserialize, Serialize};

/// Data reported by the drive, and the command to it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub(in crate::axis) struct DriveData {
    shown: DriveShown,
    output: DriveOutput,
}

impl DriveData {
    /// Returns the data before the first reading.
    pub(in crate::axis) fn new(is_virtual: bool) -> Self {
        Self { shown: DriveShown::new(is_virtual), output: DriveOutput::default() }
    }

    /// Returns the data reported by the drive.
    #[inline]
    pub(in crate::axis) fn shown(&self) -> &DriveShown {
        &self.shown
    }

    #[inline]
    pub(in crate::axis) fn shown_mut(&mut self) -> &mut DriveShown {
        &mut self.shown
    }

    /// Returns the command to the drive.
    #[inline]
    pub(in crate::axis) fn output(&self) -> &DriveOutput {
        &self.output
    }

    /// Replaces the command to the drive.
    #[inline]
    pub(in crate::axis) fn set_output(&mut self, output: DriveOutput) {
        self.output = output;
    }

    /// Sets control word and mode.
    #[inline]
    pub(in crate::axis) fn set_control(&mut self, control: u16, mode: Mode) {
        self.output = DriveOutput { control, mode, ..self.output };
    }

    /// Sets what changes during motion: position (inc of the drive), velocity (inc/s), effort, acceleration (inc/s^2).
    #[inline]
    pub(in crate::axis) fn set_motion(&mut self, position: i64, velocity: f64, effort: f64, acceleration: f64) {
        self.output.position = position;
        self.output.velocity = velocity;
        self.output.effort = effort;
        self.output.acceleration = acceleration;
    }

    /// Adds a compensation to the commanded position (inc of the drive).
    #[inline]
    pub(in crate::axis) fn add_position(&mut self, by: i64) {
        self.output.position = self.output.position.wrapping_add(by);
    }
}
