//! State of the position loop.

use crate::regulator::Pid;
use serde::{Deserialize, Serialize};

/// State of the position loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct PositionLoop {
    pub(in crate::axis) pid: Pid,
    /// Output, -1 to 1.
    pub(in crate::axis) output: f64,
    /// Output as a velocity (inc/s).
    pub(in crate::axis) velocity: f64,
    /// Reference at output 1: max_velocity and max_acceleration when the axis last came to rest. A change acts from the
    /// next motion on.
    pub(in crate::axis) full: Option<(f64, f64)>,
    /// Whether a closed brake holds the axis, so that no loop advances.
    pub(in crate::axis) is_held: bool,
}

impl PositionLoop {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        let is_full = |(velocity, acceleration): (f64, f64)| velocity > 0.0 && acceleration > 0.0;
        self.pid.is_sound() && self.output.abs() <= 1.0 && self.velocity.is_finite() && self.full.is_none_or(is_full)
    }
}
