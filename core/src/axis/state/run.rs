//! An active trajectory: its times, its stretching, and the lag that is calculated for its axes.

use crate::event::{Refusal, TrajectoryPlace};
use crate::profile::Motion;
use crate::trajectory::{Begin, Lag, Moment, Stretch, Trajectory};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// An active trajectory.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    /// Number of its command.
    pub sequence: u64,
    /// Freed by its sender, not in the cycle.
    #[serde(with = "shared")]
    pub trajectory: Arc<Trajectory>,
    /// Cycle in which it begins on its axes.
    pub begins: u64,
    /// Time of the trajectory in that cycle (ns).
    pub begin_ns: u64,
    /// Length of a cycle (ns).
    pub cycle_ns: u64,
    /// Factor by which it takes longer than planned.
    pub stretch: Stretch,
    /// Whether its goal has ended. It then leads axes until the trajectories begin that have replaced it.
    pub is_over: bool,
    /// Lag of its axes, while it is being calculated.
    pub lag: Option<LagEstimate>,
}

/// Progress of the calculation of the lag of a trajectory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LagEstimate {
    /// Index of the present track.
    pub track: u16,
    /// Simulated axis of that track at the last point, and index of the next point. None: at its start.
    pub at: Option<(Lag, u32)>,
    /// Largest lag of the tracks calculated so far.
    pub largest: Option<LargestLag>,
    /// Longest time after the last point that an axis of these tracks needs (s).
    pub late_s: f64,
}

/// The largest lag of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LargestLag {
    /// The axis.
    pub axis: u16,
    /// Its largest lag (inc).
    pub lag: f64,
    /// Its largest lag in seconds at its max_velocity, to compare axes with different units.
    pub seconds: f64,
    /// Index of the next point at that lag.
    pub point: u32,
}

impl Run {
    /// Returns the real time since the cycle in which it begins (ns).
    pub(in crate::axis) fn elapsed_ns(&self, cycle: u64) -> u64 {
        cycle.saturating_sub(self.begins).saturating_mul(self.cycle_ns)
    }

    /// Returns the time of the trajectory in a cycle, from the one in which it begins on.
    pub fn time(&self, cycle: u64) -> Moment {
        self.time_after(self.elapsed_ns(cycle))
    }

    /// Returns the time of the trajectory after that real time since the cycle in which it begins (ns).
    pub(in crate::axis) fn time_after(&self, elapsed_ns: u64) -> Moment {
        self.stretch.time_after(self.begin_ns, elapsed_ns)
    }

    /// Returns the real time since its last point was due (ns); none before that.
    pub fn late_ns(&self, cycle: u64) -> Option<u64> {
        self.elapsed_ns(cycle).checked_sub(self.duration_ns())
    }

    /// Returns the real time from its start to its last point (ns).
    pub fn duration_ns(&self) -> u64 {
        self.stretch.real_ns(self.trajectory.end_ns().saturating_sub(self.begin_ns))
    }

    /// Returns its elapsed time and the longest allowed one (ns) if it exceeds that.
    pub fn overtime_ns(&self, cycle: u64) -> Option<(u64, u64)> {
        let (runs, most) = (self.elapsed_ns(cycle), self.trajectory.max_duration_ns()?);
        (runs > most).then_some((runs, most))
    }

    /// Returns the real motion of a track after that real time since the cycle in which it begins (ns).
    pub(in crate::axis) fn sample_after(&self, track: usize, begin: &Begin, elapsed_ns: u64) -> Motion {
        self.stretch.real(self.trajectory.sample(track, begin, self.time_after(elapsed_ns)))
    }
}

/// A rate of a track that exceeds its limit.
#[derive(Clone, Copy, Debug)]
pub struct Excess {
    /// Factor by which the time would have to be stretched further.
    pub factor: f64,
    /// Refusal of the track if it is not stretched.
    pub refusal: Refusal,
}

/// Returns a point of a trajectory for messages.
pub fn place(trajectory: &Trajectory, point: u32) -> TrajectoryPlace {
    let time_ns = trajectory.times_ns().get(point as usize).copied().unwrap_or(0);
    TrajectoryPlace { point, time_ns, stretch: 1.0, max_stretch: 1.0 }
}

/// Serialization of a trajectory within a state.
mod shared {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::sync::Arc;

    pub(super) fn serialize<T: Serialize, S: Serializer>(shared: &Arc<T>, serializer: S) -> Result<S::Ok, S::Error> {
        shared.as_ref().serialize(serializer)
    }

    pub(super) fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Arc<T>, D::Error> {
        T::deserialize(deserializer).map(Arc::new)
    }
}
