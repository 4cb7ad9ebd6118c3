//! Conversion of machine data of an axis to limits and speeds.

use crate::parameter::Row;
use crate::parameter::wf::Parameters;
use crate::profile::Limits;

impl Parameters {
    /// Returns the limits of a motion at `velocity` (inc/s), within the maximum limits of the axis.
    pub(super) fn limits(&self, velocity: f64, largest: Limits) -> Limits {
        Limits {
            velocity: velocity.min(largest.velocity),
            acceleration: self.md1.map_or(largest.acceleration, |rate| rate.min(largest.acceleration)),
            deceleration: self.md2.map_or(largest.deceleration, |rate| rate.min(largest.deceleration)),
            ..largest
        }
    }

    /// Returns the setup speed of the fixed-speed bits: index of its row, and its speed value.
    pub(super) fn fixed_speed(&self, choice: u8) -> (u16, f64) {
        match choice {
            2 => (const { Row::place("wf.fixed_speed_2") }, self.fixed_speed_2),
            3 => (const { Row::place("wf.fixed_speed_3") }, self.fixed_speed_3),
            _ => (const { Row::place("wf.fixed_speed_1") }, self.fixed_speed_1),
        }
    }
}
