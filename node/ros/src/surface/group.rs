//! Groups of axes that take trajectories together.

use lineshaft_core::trajectory::TrajectoryLimits;

/// A group of the cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// Places of its axes in the cell, each once.
    pub axes: Vec<u16>,
    /// How its trajectories are taken.
    pub trajectories: TrajectorySettings,
    /// Where it is a gripper, of one axis.
    pub gripper: Option<GripperSettings>,
}

/// How goals of a gripper end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GripperSettings {
    /// A goal that ends because the gripper has stalled has succeeded.
    pub allow_stalling: bool,
}

/// How trajectories of a group are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectorySettings {
    /// What happens where they exceed limits of axes.
    pub limits: TrajectoryLimits,
    /// Whether points of modulo axes are moved by whole turns until the first one is nearest to the axis.
    pub angle_wraparound: bool,
    /// Longest time from start to end (s); 0: without limit.
    pub max_duration: f64,
    /// Messages of `~/controller_state` per second; 0: none.
    pub state_rate: f64,
}

impl Default for TrajectorySettings {
    fn default() -> Self {
        Self { limits: TrajectoryLimits::default(), angle_wraparound: false, max_duration: 0.0, state_rate: 50.0 }
    }
}

impl TrajectorySettings {
    /// Largest `max_duration`: a day (s).
    pub const LONGEST: u32 = 86_400;

    /// Allowed rates of `~/controller_state` (1/s).
    pub const STATE_RATES: (f64, f64) = (0.0, 1000.0);

    /// `max_duration` (ns); none: without limit.
    pub fn max_duration_ns(&self) -> Option<u64> {
        (self.max_duration > 0.0).then(|| (self.max_duration * 1e9).round() as u64)
    }
}
