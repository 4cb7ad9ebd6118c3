//! Groups of axes that execute trajectories together.

use lineshaft_core::trajectory::TrajectoryLimits;

/// Group of the cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name of the group.
    pub name: String,
    /// Indices of its axes in the cell, each once.
    pub axes: Vec<u16>,
    /// Settings for trajectories.
    pub trajectories: TrajectorySettings,
    /// Settings of a gripper, for a group with one axis.
    pub gripper: Option<GripperSettings>,
}

/// Settings of a gripper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GripperSettings {
    /// Whether a goal that ends because the gripper has stalled has succeeded.
    pub allow_stalling: bool,
}

/// Settings for trajectories of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectorySettings {
    /// Reaction to trajectories that exceed limits of axes.
    pub limits: TrajectoryLimits,
    /// Whether points of modulo axes are shifted by whole turns so that the first one is nearest to the axis.
    pub angle_wraparound: bool,
    /// Maximum duration, in s; 0: no limit.
    pub max_duration: f64,
    /// Rate of `~/controller_state`, in messages per second; 0: not published.
    pub state_rate: f64,
}

impl Default for TrajectorySettings {
    fn default() -> Self {
        Self { limits: TrajectoryLimits::default(), angle_wraparound: false, max_duration: 0.0, state_rate: 50.0 }
    }
}

impl TrajectorySettings {
    /// Maximum of `max_duration`: one day, in s.
    pub const LONGEST: u32 = 86_400;

    /// Allowed range of the rate of `~/controller_state`, in 1/s.
    pub const STATE_RATES: (f64, f64) = (0.0, 1000.0);

    /// Returns `max_duration` in ns; `None`: no limit.
    pub fn max_duration_ns(&self) -> Option<u64> {
        (self.max_duration > 0.0).then(|| (self.max_duration * 1e9).round() as u64)
    }
}
