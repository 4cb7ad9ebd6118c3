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
}

/// How trajectories of a group are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrajectorySettings {
    /// What happens where they exceed limits of axes.
    pub limits: TrajectoryLimits,
    /// Whether points of modulo axes are moved by whole turns until the first one is nearest to the axis.
    pub angle_wraparound: bool,
    /// Longest time from start to end (s); 0: without limit.
    pub max_duration: f64,
}

impl TrajectorySettings {
    /// Largest `max_duration`: a day (s).
    pub const LONGEST: u32 = 86_400;
}
