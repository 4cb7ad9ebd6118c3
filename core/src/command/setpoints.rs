//! Streamed setpoints.

use super::Source;

/// A streamed setpoint of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// Velocity (inc/s).
    pub velocity: f64,
    /// Duration (ns), after which the axis stops as commanded. `None`: until the next setpoint. The time is limited to
    /// `setpoint_timeout` in both cases.
    pub duration: Option<u64>,
}

/// Setpoints that are new in a cycle, only the newest of each axis. Setpoints of earlier cycles are not included: each
/// axis counts the time since its last setpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Setpoints {
    /// Origin of the newest setpoint.
    pub source: Source,
    /// One entry per axis, in file order.
    pub axes: Vec<Option<Setpoint>>,
}

impl Setpoints {
    /// Creates an empty set for that number of axes.
    pub fn none(axes: usize) -> Self {
        Self { source: Source::Machine, axes: vec![None; axes] }
    }

    /// Merges newer setpoints, which replace older ones.
    pub fn merge(&mut self, newer: &Self) {
        if !newer.is_empty() {
            self.source = newer.source;
        }
        for (mine, newer) in self.axes.iter_mut().zip(&newer.axes) {
            *mine = newer.or(*mine);
        }
    }

    /// Removes all setpoints.
    pub fn clear(&mut self) {
        self.axes.fill(None);
    }

    /// Returns true if there is no new setpoint.
    pub fn is_empty(&self) -> bool {
        self.axes.iter().all(Option::is_none)
    }
}
