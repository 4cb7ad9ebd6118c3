//! Switches of homing that are wired to the drive of an axis only.
//!
//! Source   CiA 402-2 (60FDh, homing methods), MACS-IO-01

use super::AxisConfig;
use crate::axis::homing_methods::{SWITCHES, is_macs, squares, without_input};

impl AxisConfig {
    /// Returns a switch that its homing needs and that has no digital input: its name and the parameter that assigns
    /// one. `None` if the drive homes by itself, and for a sequence of MACS, which always needs its input.
    pub fn switch_at_drive(&self) -> Option<(&'static str, &'static str)> {
        let p = self.power_on();
        let method = p.homing.method;
        if p.homing.in_drive || is_macs(method) {
            return None;
        }
        SWITCHES.get(without_input(method, &p.assigned)? as usize).copied()
    }

    /// Returns true if its homing searches for the reference switch of each of two drives.
    pub fn seeks_reference_switch(&self) -> bool {
        let method = self.power_on().homing.method;
        squares(method) && !matches!(method, 35 | 37)
    }
}
