//! The track of a trajectory that an axis follows.

use super::run::Run;
use crate::position::Position;
use crate::profile::Motion;
use crate::trajectory::Begin;
use serde::{Deserialize, Serialize};

/// The track of a trajectory that an axis follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Tracker {
    /// Index of the trajectory among the active ones.
    pub(in crate::axis) slot: u16,
    /// Index of the track in the trajectory.
    pub(in crate::axis) track: u16,
    /// Motion at the begin, in the time of the trajectory.
    pub(in crate::axis) begin: Motion,
    /// Whether the trajectory has not begun yet.
    pub(in crate::axis) waits: bool,
    /// Change of the command in the last cycle (inc/s).
    pub(in crate::axis) moved: f64,
    /// Whether the command is the spline itself, with its velocity: that of its step within half of the change per
    /// cycle.
    pub(in crate::axis) exact: bool,
    /// Whether it has no step of velocity that would make the axis lag.
    pub(in crate::axis) smooth: bool,
    /// Lowest and highest position of the whole track.
    pub(in crate::axis) low: Position,
    pub(in crate::axis) high: Position,
    /// Shift of the track: whole turns.
    pub(in crate::axis) shift: Position,
}

impl Tracker {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.begin.is_sound() && self.moved.is_finite()
    }

    pub(in crate::axis) fn begin(&self, run: &Run) -> Begin {
        Begin { motion: self.begin, time_ns: run.begin_ns, shift: self.shift }
    }

    /// Returns its trajectory.
    pub(in crate::axis) fn run<'a>(&self, runs: &'a [Option<Run>]) -> Option<&'a Run> {
        runs.get(usize::from(self.slot))?.as_ref()
    }

    /// Returns the motion of the track after that real time since the cycle in which the trajectory begins (ns).
    pub(in crate::axis) fn motion_after(&self, run: &Run, elapsed_ns: u64) -> Motion {
        let sample = run.sample_after(usize::from(self.track), &self.begin(run), elapsed_ns);
        Motion { position: sample.position + self.shift, ..sample }
    }

    /// Returns the motion of the track in a cycle.
    pub(in crate::axis) fn asked(&self, run: &Run, cycle: u64) -> Motion {
        self.motion_after(run, run.elapsed_ns(cycle))
    }
}
