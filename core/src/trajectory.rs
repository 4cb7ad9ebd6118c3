//! Trajectories: points of several axes over time, which the machine runs as one goal.
//!
//! Law      between two points each axis moves on a spline whose degree is decided by what both carry; up to the first point
//!          that lies ahead it moves on one that begins where it is taken over; behind the last one it rests on the whole
//!          increment that is nearest to it
//! Refuses  times that do not ascend, knots that are not one for each time, an end with a velocity

mod spline;

pub use spline::{Reach, Spline};

use crate::position::Position;
use crate::profile::Motion;
use serde::{Deserialize, Serialize};

/// Most points of a trajectory.
pub const MAX_POINTS: usize = 100_000;
/// Most points of all of its axes together: a recording has to hold them.
pub const MAX_KNOTS: usize = 100_000;

/// How far an axis may be off; none: without limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// (inc)
    pub position: Option<f64>,
    /// (inc/s)
    pub velocity: Option<f64>,
    /// (inc/s^2)
    pub acceleration: Option<f64>,
}

impl Tolerance {
    /// Without any limit?
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    fn is_sound(&self) -> bool {
        let limits = [self.position, self.velocity, self.acceleration];
        limits.into_iter().flatten().all(|limit| limit >= 0.0 && limit.is_finite())
    }
}

/// What a point asks of one axis. What it does not carry is none; which of them a segment has decides the order of its spline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Knot {
    /// Where to be.
    pub position: Position,
    /// (inc/s)
    pub velocity: Option<f64>,
    /// (inc/s^2)
    pub acceleration: Option<f64>,
}

impl Knot {
    fn is_sound(&self) -> bool {
        let rates = [self.velocity, self.acceleration];
        self.position.is_legal() && rates.into_iter().flatten().all(f64::is_finite)
    }
}

impl From<Motion> for Knot {
    fn from(motion: Motion) -> Self {
        let Motion { position, velocity, acceleration, .. } = motion;
        Self { position, velocity: Some(velocity), acceleration: Some(acceleration) }
    }
}

/// One axis of a trajectory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// The axis.
    pub axis: u16,
    /// One for each time of the trajectory.
    pub knots: Box<[Knot]>,
    /// On the way.
    pub path: Tolerance,
    /// At the end.
    pub goal: Tolerance,
}

/// What a trajectory asks of an axis from its first point on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Demand {
    /// Of its splines.
    pub way: Reach,
    /// Lowest knot.
    pub lowest: Position,
    /// Highest knot.
    pub highest: Position,
    /// The knot from which on it stands at its end: the last one, or one before it where all behind only hold.
    pub stands: u32,
}

/// A trajectory. It begins where its axes are, and comes to its first point at the first of its times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Read")]
pub struct Trajectory {
    start_ns: i64,
    times_ns: Box<[u64]>,
    tracks: Box<[Track]>,
    goal_time_ns: Option<u64>,
    /// Of each track, so that nobody looks at all knots in a cycle.
    demands: Box<[Demand]>,
}

/// A trajectory that was read: what it asks for is computed again.
#[derive(Deserialize)]
struct Read {
    start_ns: i64,
    times_ns: Box<[u64]>,
    tracks: Box<[Track]>,
    goal_time_ns: Option<u64>,
    #[allow(dead_code, reason = "part of the recorded form")]
    demands: Box<[Demand]>,
}

impl From<Read> for Trajectory {
    fn from(read: Read) -> Self {
        let Read { start_ns, times_ns, tracks, goal_time_ns, .. } = read;
        Self { start_ns, times_ns, tracks, goal_time_ns, demands: Box::default() }.with_demands()
    }
}

/// Where a trajectory begins on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begin {
    /// The motion there: that of the axis, or what the points ask for where the axis is near to that.
    pub motion: Motion,
    /// When, in the trajectory's time (ns).
    pub time_ns: u64,
}

impl Trajectory {
    /// A trajectory of these tracks; none where its law does not hold. `start_ns` is the time from the cycle in which the
    /// command applies to time 0, negative where that has been before; `times_ns` are counted from time 0; `goal_time_ns` is
    /// how long after the last point the axes may take to come within their goal tolerances, none for ever.
    pub fn new(start_ns: i64, times_ns: Box<[u64]>, tracks: Box<[Track]>, goal_time_ns: Option<u64>) -> Option<Self> {
        let trajectory = Self { start_ns, times_ns, tracks, goal_time_ns, demands: Box::default() }.with_demands();
        trajectory.is_sound().then_some(trajectory)
    }

    /// The same, with what it asks of its axes; without that where its law does not hold.
    fn with_demands(self) -> Self {
        let of = |track| demand(&self.times_ns, track);
        let demands = if self.has_shape() { self.tracks.iter().map(of).collect() } else { Box::default() };
        Self { demands, ..self }
    }

    fn has_shape(&self) -> bool {
        let Self { times_ns, tracks, .. } = self;
        let ascends = times_ns.windows(2).all(|pair| pair[0] < pair[1]);
        let twice = |index: usize, track: &Track| tracks[..index].iter().any(|other| other.axis == track.axis);
        let fits = |(index, track): (usize, &Track)| {
            track.knots.len() == times_ns.len()
                && track.knots.iter().all(Knot::is_sound)
                && track.knots.last().is_some_and(|last| last.velocity.is_none_or(|velocity| velocity == 0.0))
                && track.path.is_sound()
                && track.goal.is_sound()
                && !twice(index, track)
        };
        (1..=MAX_POINTS).contains(&times_ns.len())
            && times_ns.len().saturating_mul(tracks.len()) <= MAX_KNOTS
            && times_ns.last().copied().into_iter().chain(self.goal_time_ns).all(|time| i64::try_from(time).is_ok())
            && ascends
            && !tracks.is_empty()
            && tracks.iter().enumerate().all(fits)
    }

    /// Does its law hold? One that was read from outside may hold anything.
    pub fn is_sound(&self) -> bool {
        // There is one track at least.
        !self.demands.is_empty()
    }

    /// From the cycle in which the command applies to time 0 (ns); negative: it has begun before.
    pub fn start_ns(&self) -> i64 {
        self.start_ns
    }

    /// The same, with another time from the cycle in which the command applies to time 0 (ns).
    #[must_use]
    pub fn starting(self, start_ns: i64) -> Self {
        Self { start_ns, ..self }
    }

    /// When the points are reached, from time 0, ascending (ns); at least one.
    pub fn times_ns(&self) -> &[u64] {
        &self.times_ns
    }

    /// Its axes, at least one, each once.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// How long after the last point the axes may take to come within their goal tolerances (ns); none: for ever.
    pub fn goal_time_ns(&self) -> Option<u64> {
        self.goal_time_ns
    }

    /// When the last point is reached, from time 0 (ns).
    pub fn end_ns(&self) -> u64 {
        self.times_ns.last().copied().unwrap_or(0)
    }

    /// What it asks of the axis of a track.
    pub fn demand(&self, track: usize) -> Option<&Demand> {
        self.demands.get(track)
    }

    /// Where a track rests at last: the whole increment that is nearest to its last point, as the target of every goal is.
    pub fn end(&self, track: usize) -> Option<Position> {
        Some(Position::whole(self.tracks.get(track)?.knots.last()?.position.nearest()))
    }

    /// The motion that its points alone ask of a track at a time; none before the first of them and behind the last one.
    pub fn given(&self, track: usize, time_ns: u64) -> Option<Motion> {
        let next = self.passed(time_ns);
        let before = next.checked_sub(1)?;
        let knots = &self.tracks.get(track)?.knots;
        let (since, until) = (*self.times_ns.get(before)?, *self.times_ns.get(next)?);
        let spline = Spline::new(knots.get(before)?, knots.get(next)?, until.saturating_sub(since));
        Some(spline.at(time_ns.saturating_sub(since)))
    }

    /// From where a track begins to the first point that lies ahead; none where none does.
    pub fn first_spline(&self, track: usize, begin: &Begin) -> Option<Spline> {
        let first = self.passed(begin.time_ns);
        let knot = self.tracks.get(track)?.knots.get(first)?;
        Some(Spline::new(&begin.motion.into(), knot, self.times_ns.get(first)?.saturating_sub(begin.time_ns)))
    }

    /// Where a track ends, if it is on a straight line there at a time: nothing slows it down before.
    pub fn straight_end(&self, track: usize, begin: &Begin, time_ns: u64) -> Option<Position> {
        let next = self.passed(time_ns);
        let end = self.end(track)?;
        if next < self.demand(track)?.stands as usize {
            return None;
        }
        match self.under_way(track, begin, time_ns) {
            Some((spline, _)) => spline.is_straight().then_some(end),
            // Who lags is still on that line.
            None => Some(end),
        }
    }

    /// The motion of a track at a time, not before its begin.
    pub fn sample(&self, track: usize, begin: &Begin, time_ns: u64) -> Motion {
        match self.under_way(track, begin, time_ns) {
            Some((spline, since)) => spline.at(time_ns.saturating_sub(since)),
            None => Motion::at_rest(self.end(track).unwrap_or(begin.motion.position)),
        }
    }

    /// The segment that a track is on at a time, and when it began (ns); none behind the last one.
    fn under_way(&self, track: usize, begin: &Begin, time_ns: u64) -> Option<(Spline, u64)> {
        let next = self.passed(time_ns);
        let knots = &self.tracks.get(track)?.knots;
        let (knot, time) = knots.get(next).zip(self.times_ns.get(next))?;
        // A point at or before the begin is passed over.
        let before = next.checked_sub(1).and_then(|before| knots.get(before).zip(self.times_ns.get(before)));
        let (from, since) = match before {
            Some((knot, &since)) if since > begin.time_ns => (*knot, since),
            _ => (begin.motion.into(), begin.time_ns),
        };
        Some((Spline::new(&from, knot, time.saturating_sub(since)), since))
    }

    /// How many points are reached by then.
    fn passed(&self, time_ns: u64) -> usize {
        self.times_ns.partition_point(|&time| time <= time_ns)
    }
}

fn demand(times_ns: &[u64], track: &Track) -> Demand {
    let places = || track.knots.iter().map(|knot| knot.position);
    let lowest = places().min().unwrap_or_default();
    let highest = places().max().unwrap_or_default();
    let stands = track.knots.first().map_or(Position::ZERO, |first| first.position);
    let segments = std::iter::zip(track.knots.windows(2), times_ns.windows(2));
    let way = segments.fold(Reach::at(stands), |way, (knots, times)| {
        way.union(Spline::new(&knots[0], &knots[1], times[1].saturating_sub(times[0])).reach())
    });
    let end = track.knots.last().map(|last| last.position);
    let is_zero = |rate: Option<f64>| rate.is_none_or(|rate| rate == 0.0);
    let holds = |knot: &Knot| Some(knot.position) == end && is_zero(knot.velocity) && is_zero(knot.acceleration);
    let moves = track.knots.iter().rposition(|knot| !holds(knot));
    let last = track.knots.len().saturating_sub(1);
    let stands = moves.map_or(0, |moves| (moves + 1).min(last)) as u32;
    Demand { way, lowest, highest, stands }
}

#[cfg(test)]
mod tests;
