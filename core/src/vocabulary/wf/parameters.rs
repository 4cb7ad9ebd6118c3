//! Outputs of an axis, and what its machine data say of a motion.

use crate::parameter::wf::Parameters;
use crate::profile::Limits;
use serde::{Deserialize, Serialize};

/// Outputs that an open-loop axis switches, by their places in section `io`; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring {
    /// Direction forwards (F).
    pub forward: Option<u16>,
    /// Direction backwards (B).
    pub backward: Option<u16>,
    /// Axis output (Q).
    pub output: Option<u16>,
    /// Speed as a voltage (V).
    pub dac: Option<u16>,
}

impl Parameters {
    /// Limits of a motion at `velocity` (inc/s), given the largest of the axis.
    pub(super) fn limits(&self, velocity: f64, largest: Limits) -> Limits {
        Limits {
            velocity: velocity.min(largest.velocity),
            acceleration: self.md1.map_or(largest.acceleration, |rate| rate.min(largest.acceleration)),
            deceleration: self.md2.map_or(largest.deceleration, |rate| rate.min(largest.deceleration)),
            ..largest
        }
    }

    /// Setup speed that the fixed-speed bits choose: its key, and its speed value.
    pub(super) fn fixed_speed(&self, choice: u8) -> (&'static str, f64) {
        match choice {
            2 => ("wf.fixed_speed_2", self.fixed_speed_2),
            3 => ("wf.fixed_speed_3", self.fixed_speed_3),
            _ => ("wf.fixed_speed_1", self.fixed_speed_1),
        }
    }
}
