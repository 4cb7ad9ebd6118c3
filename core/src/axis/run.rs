//! A running trajectory: its times, its stretch, and the lag that is computed for its axes.

use crate::event::{Refusal, TrajectoryPlace};
use crate::profile::Motion;
use crate::trajectory::{Begin, Lag, Moment, Stretch, Trajectory};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A trajectory that runs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    /// Number of its command.
    pub sequence: u64,
    /// Freed by who gave it.
    #[serde(with = "shared")]
    pub trajectory: Arc<Trajectory>,
    /// The cycle in which it begins on its axes.
    pub begins: u64,
    /// The trajectory's time in that cycle (ns).
    pub begin_ns: u64,
    /// Length of a cycle (ns).
    pub cycle_ns: u64,
    /// How much longer than planned it takes.
    pub stretch: Stretch,
    /// Its goal has ended: it leads axes on until the trajectories begin that have replaced it.
    pub is_over: bool,
    /// How far its axes will lag, while that is computed.
    pub lag: Option<LagEstimate>,
}

/// How far the axes of a run will lag, as far as that is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LagEstimate {
    /// The track that is looked at.
    pub track: u16,
    /// The axis of that track at the last point that was looked at, and the number of the next one; none: at its begin.
    pub at: Option<(Lag, u32)>,
    /// The largest lag of a track that is done.
    pub largest: Option<LargestLag>,
    /// The longest time after the last point that an axis of such a track takes (s).
    pub late_s: f64,
}

/// The largest lag of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LargestLag {
    /// The axis.
    pub axis: u16,
    /// Its largest lag (inc).
    pub lag: f64,
    /// The same in seconds at its max_velocity, by which axes of several units are compared.
    pub seconds: f64,
    /// The point before which it is.
    pub point: u32,
}

impl Run {
    /// Real time since the cycle in which it begins (ns).
    pub(super) fn elapsed_ns(&self, cycle: u64) -> u64 {
        cycle.saturating_sub(self.begins).saturating_mul(self.cycle_ns)
    }

    /// The trajectory's time in a cycle, from the one in which it begins on.
    pub fn time(&self, cycle: u64) -> Moment {
        self.time_after(self.elapsed_ns(cycle))
    }

    /// The trajectory's time, once so much real time has passed since the cycle in which it begins (ns).
    pub(super) fn time_after(&self, elapsed_ns: u64) -> Moment {
        self.stretch.moment(self.begin_ns, elapsed_ns)
    }

    /// Real time that has passed since its last point was due (ns); none before that.
    pub fn late_ns(&self, cycle: u64) -> Option<u64> {
        self.elapsed_ns(cycle).checked_sub(self.duration_ns())
    }

    /// Real time from its start to its last point (ns).
    pub fn duration_ns(&self) -> u64 {
        self.stretch.real_ns(self.trajectory.end_ns().saturating_sub(self.begin_ns))
    }

    /// How long it runs already and how long it may (ns), where that is too long.
    pub fn overtime_ns(&self, cycle: u64) -> Option<(u64, u64)> {
        let (runs, most) = (self.elapsed_ns(cycle), self.trajectory.max_duration_ns()?);
        (runs > most).then_some((runs, most))
    }

    /// The real motion that it asks of a track, once so much real time has passed since the cycle in which it begins (ns).
    pub(super) fn sample_after(&self, track: usize, begin: &Begin, elapsed_ns: u64) -> Motion {
        self.stretch.real(self.trajectory.sample(track, begin, self.time_after(elapsed_ns)))
    }
}

/// A rate of a track beyond its limit.
#[derive(Clone, Copy, Debug)]
pub struct Excess {
    /// Factor by which the time would have to be stretched further.
    pub factor: f64,
    /// Why the track is refused where it is not stretched.
    pub refusal: Refusal,
}

/// A point of a trajectory.
pub fn place(trajectory: &Trajectory, point: u32) -> TrajectoryPlace {
    let time_ns = trajectory.times_ns().get(point as usize).copied().unwrap_or(0);
    TrajectoryPlace { point, time_ns, stretch: 1.0, max_stretch: 1.0 }
}

/// A trajectory within a state.
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
