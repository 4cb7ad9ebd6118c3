//! Trajectories: points of several axes over time, which the machine runs as one goal.
//!
//! Law      between two points each axis moves on a spline whose degree is decided by what both carry; up to the first point
//!          that lies ahead it moves on one that begins where it is taken over; after the last one it rests on the whole
//!          increment that is nearest to it. An axis whose last knot has a velocity continues with that instead
//! Refuses  times that do not ascend, knots that are not one for each time

mod lag;
mod limits;
mod spline;
mod stretch;

pub use lag::{Lag, LagLimits};
pub use limits::{OnExcess, TrajectoryLimits};
pub use spline::{Reach, Spline};
pub use stretch::{Moment, Stretch};

use crate::modulo::{Direction, Modulo};
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// The axis.
    pub axis: u16,
    /// One for each time of the trajectory.
    pub knots: Box<[Knot]>,
    /// On the way.
    pub path: Tolerance,
    /// At the end.
    pub goal: Tolerance,
    /// How far the command may be from a first point at time 0 (inc); none: as far as it likes (GRP-TRAJ-11).
    pub start: Option<f64>,
    /// Whether the track is moved by whole turns of a modulo axis until it is nearest to the axis (GRP-TRAJ-10).
    pub wraps: bool,
}

/// Where a track has its largest values: the number of a point, or of the point at which the segment with the value ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Peaks {
    /// Of the lowest point.
    pub lowest: u32,
    /// Of the highest point.
    pub highest: u32,
    /// Of the lowest position.
    pub low: u32,
    /// Of the highest position.
    pub high: u32,
    /// Of the highest speed.
    pub speed: u32,
    /// Of the highest acceleration.
    pub acceleration: u32,
    /// Of the highest deceleration.
    pub deceleration: u32,
    /// Of the largest step of the velocity.
    pub step: u32,
}

impl Peaks {
    /// All in the segment that ends at one point.
    pub fn at(point: u32) -> Self {
        Self {
            lowest: point,
            highest: point,
            low: point,
            high: point,
            speed: point,
            acceleration: point,
            deceleration: point,
            step: point,
        }
    }

    /// Notes a segment that ends at `point` where it exceeds what was before it.
    fn note(&mut self, before: &Reach, segment: &Reach, point: u32) {
        for (is_more, peak) in [
            (segment.low < before.low, &mut self.low),
            (segment.high > before.high, &mut self.high),
            (segment.speed() > before.speed(), &mut self.speed),
            (segment.acceleration > before.acceleration, &mut self.acceleration),
            (segment.deceleration > before.deceleration, &mut self.deceleration),
        ] {
            if is_more {
                *peak = point;
            }
        }
    }
}

/// What a trajectory asks of an axis from its first point on, or from the first point that lies ahead where it began in the past.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Demand {
    /// Of its splines.
    pub way: Reach,
    /// Where `way` has its largest values.
    pub peaks: Peaks,
    /// Largest step of the velocity at a point, where straight segments meet others or end (inc/s).
    pub step: f64,
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
    limits: TrajectoryLimits,
    max_duration_ns: Option<u64>,
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
    limits: TrajectoryLimits,
    max_duration_ns: Option<u64>,
    #[allow(dead_code, reason = "part of the recorded form")]
    demands: Box<[Demand]>,
}

impl From<Read> for Trajectory {
    fn from(read: Read) -> Self {
        let Read { start_ns, times_ns, tracks, goal_time_ns, limits, max_duration_ns, .. } = read;
        let demands = Box::default();
        Self { start_ns, times_ns, tracks, goal_time_ns, limits, max_duration_ns, demands }.with_demands()
    }
}

/// Where a trajectory begins on an axis. Its positions are those of the trajectory, without the shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begin {
    /// The motion there: that of the axis, or what the points ask for where the axis is near to that.
    pub motion: Motion,
    /// When, in the trajectory's time (ns).
    pub time_ns: u64,
    /// How far the track is moved on the axis.
    pub shift: Position,
}

impl Trajectory {
    /// A trajectory of these tracks; none where its law does not hold. `start_ns` is the time from the cycle in which the
    /// command applies to time 0, negative where that has been before; `times_ns` are counted from time 0; `goal_time_ns` is
    /// how long after the last point the axes may take to come within their goal tolerances, none for ever.
    pub fn new(start_ns: i64, times_ns: Box<[u64]>, tracks: Box<[Track]>, goal_time_ns: Option<u64>) -> Option<Self> {
        let (limits, demands) = (TrajectoryLimits::default(), Box::default());
        let trajectory = Self { start_ns, times_ns, tracks, goal_time_ns, limits, max_duration_ns: None, demands };
        let trajectory = trajectory.with_demands();
        trajectory.is_sound().then_some(trajectory)
    }

    /// How long ago its time 0 was when the command applies (ns).
    fn past_ns(&self) -> u64 {
        if self.start_ns < 0 { self.start_ns.unsigned_abs() } else { 0 }
    }

    /// The same, with what it asks of its axes; without that where its law does not hold.
    fn with_demands(self) -> Self {
        // Past points are skipped. A point at time 0 is where a trajectory that starts now begins.
        let ahead = if self.past_ns() == 0 { 0 } else { self.passed(self.past_ns()) };
        let of = |track| demand(&self.times_ns, track, ahead);
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
                && track.path.is_sound()
                && track.goal.is_sound()
                && track.start.is_none_or(|most| most > 0.0 && most.is_finite())
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
        !self.demands.is_empty() && self.limits.is_sound()
    }

    /// From the cycle in which the command applies to time 0 (ns); negative: it has begun before.
    pub fn start_ns(&self) -> i64 {
        self.start_ns
    }

    /// The same, with another time from the cycle in which the command applies to time 0 (ns). For a time in the past all points are
    /// looked at.
    #[must_use]
    pub fn starting(self, start_ns: i64) -> Self {
        let before_ns = self.past_ns();
        let started = Self { start_ns, ..self };
        if started.past_ns() == before_ns { started } else { started.with_demands() }
    }

    /// The same, with what happens where its points exceed limits of axes.
    #[must_use]
    pub fn within(self, limits: TrajectoryLimits) -> Self {
        Self { limits, ..self }
    }

    /// What happens where its points exceed limits of axes.
    pub fn limits(&self) -> TrajectoryLimits {
        self.limits
    }

    /// The same, which is ended where it takes longer (ns), counted from its start.
    #[must_use]
    pub fn ended_after(self, max_duration_ns: Option<u64>) -> Self {
        Self { max_duration_ns, ..self }
    }

    /// Longest time from its start to its end (ns); none: without limit.
    pub fn max_duration_ns(&self) -> Option<u64> {
        self.max_duration_ns
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

    /// The velocity with which a track ends (inc/s); 0: it ends at rest.
    pub fn end_velocity(&self, track: usize) -> f64 {
        let last = self.tracks.get(track).and_then(|track| track.knots.last());
        last.and_then(|last| last.velocity).unwrap_or(0.0)
    }

    /// The velocity with which the last segment of a track comes to the last point (inc/s), which is another one than that where the segment
    /// is straight.
    pub fn last_slope(&self, track: usize) -> f64 {
        let knots = self.tracks.get(track).map(|track| &track.knots[..]);
        let Some(([.., from, to], [.., since, until])) = knots.zip(Some(&self.times_ns[..])) else { return 0.0 };
        Spline::new(from, to, until.saturating_sub(*since)).end_velocities().1
    }

    /// Whether a track ends with a velocity.
    pub fn ends_in_motion(&self) -> bool {
        (0..self.tracks.len()).any(|track| self.end_velocity(track) != 0.0)
    }

    /// Where a track that is moved by `shift` rests at last: the whole increment that is nearest to its last point, as the target of every
    /// goal is.
    pub fn end(&self, track: usize, shift: Position) -> Option<Position> {
        let last = self.tracks.get(track)?.knots.last()?.position + shift;
        Some(Position::whole(last.nearest()))
    }

    /// The same without the shift.
    fn planned_end(&self, track: usize, shift: Position) -> Option<Position> {
        self.end(track, shift).map(|end| end - shift)
    }

    /// The motion that its points alone ask of a track at a time; none before the first of them and after the last one.
    pub fn given(&self, track: usize, time_ns: u64) -> Option<Motion> {
        let next = self.passed(time_ns);
        let before = next.checked_sub(1)?;
        let knots = &self.tracks.get(track)?.knots;
        let (since, until) = (*self.times_ns.get(before)?, *self.times_ns.get(next)?);
        let spline = Spline::new(knots.get(before)?, knots.get(next)?, until.saturating_sub(since));
        Some(spline.at(time_ns.saturating_sub(since) as f64))
    }

    /// From where a track begins to the first point that lies ahead; none where none does.
    pub fn first_spline(&self, track: usize, begin: &Begin) -> Option<Spline> {
        let first = self.passed(begin.time_ns);
        let knot = self.tracks.get(track)?.knots.get(first)?;
        Some(Spline::new(&begin.motion.into(), knot, self.times_ns.get(first)?.saturating_sub(begin.time_ns)))
    }

    /// How far a track is moved, so that it is nearest to a position of its axis where it begins: at its first point, or where its points
    /// ask for at a time after that.
    pub fn shift(&self, track: usize, time_ns: u64, from: Position, turn: Option<Modulo>) -> Position {
        let knots = self.tracks.get(track).filter(|track| track.wraps).map(|track| &track.knots);
        let ahead = knots.and_then(|knots| knots.get(self.times_ns.partition_point(|&time| time < time_ns)));
        let place = ahead.map(|knot| self.given(track, time_ns).map_or(knot.position, |due| due.position));
        let Some((turn, place)) = turn.zip(place) else { return Position::ZERO };
        turn.target(place, from, from, Direction::Shortest, 0.0) - place
    }

    /// The first point that lies ahead of a time; the last point where none does.
    pub fn point_ahead(&self, time_ns: u64) -> u32 {
        self.passed(time_ns).min(self.times_ns.len().saturating_sub(1)) as u32
    }

    /// Where a track ends, if it is on a straight line there at a time: nothing slows it down before.
    pub fn straight_end(&self, track: usize, begin: &Begin, time_ns: u64) -> Option<Position> {
        let next = self.passed(time_ns);
        let end = self.planned_end(track, begin.shift)?;
        if next < self.demand(track)?.stands as usize || self.end_velocity(track) != 0.0 {
            return None;
        }
        match self.under_way(track, begin, time_ns) {
            Some((spline, _)) => spline.is_straight().then_some(end),
            // Who lags is still on that line.
            None => Some(end),
        }
    }

    /// The motion of a track at a time, not before its begin.
    pub fn sample(&self, track: usize, begin: &Begin, time: Moment) -> Motion {
        match self.under_way(track, begin, time.ns) {
            Some((spline, since)) => spline.at(time.since(since)),
            None if self.end_velocity(track) != 0.0 => self.beyond_end(track, time),
            None => Motion::at_rest(self.planned_end(track, begin.shift).unwrap_or(begin.motion.position)),
        }
    }

    /// The motion of a track that ends with a velocity, after its last point.
    fn beyond_end(&self, track: usize, time: Moment) -> Motion {
        let velocity = self.end_velocity(track);
        let last =
            self.tracks.get(track).and_then(|track| track.knots.last()).map_or(Position::ZERO, |last| last.position);
        let position = last + Position::from_f64(velocity * time.since(self.end_ns()) / 1e9);
        Motion { position, velocity, acceleration: 0.0, jerk: 0.0 }
    }

    /// The segment that a track is on at a time, and when it began (ns); none behind the last one.
    fn under_way(&self, track: usize, begin: &Begin, time_ns: u64) -> Option<(Spline, u64)> {
        self.segment(track, begin, self.passed(time_ns))
    }

    /// The segment of a track that ends at a point, and when it begins (ns).
    fn segment(&self, track: usize, begin: &Begin, point: usize) -> Option<(Spline, u64)> {
        let knots = &self.tracks.get(track)?.knots;
        let (knot, time) = knots.get(point).zip(self.times_ns.get(point))?;
        // A point at or before the begin is passed over.
        let before = point.checked_sub(1).and_then(|before| knots.get(before).zip(self.times_ns.get(before)));
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

/// What a track asks for from a point on: from the last one where none lies ahead.
fn demand(times_ns: &[u64], track: &Track, ahead: usize) -> Demand {
    let first = ahead.min(track.knots.len().saturating_sub(1));
    let places = || track.knots.iter().map(|knot| knot.position).enumerate().skip(first);
    let (lowest_point, lowest) = places().min_by_key(|(_, place)| *place).unwrap_or_default();
    let (highest_point, highest) = places().max_by_key(|(_, place)| *place).unwrap_or_default();
    let stands = track.knots.get(first).map_or(Position::ZERO, |first| first.position);
    let mut way = Reach::at(stands);
    let mut peaks = Peaks { lowest: lowest_point as u32, highest: highest_point as u32, ..Peaks::at(first as u32) };
    let (mut step, mut velocity): (f64, Option<f64>) = (0.0, None);
    let segments = std::iter::zip(track.knots.windows(2), times_ns.windows(2)).enumerate();
    for (before, (knots, times)) in segments.skip(first) {
        let spline = Spline::new(&knots[0], &knots[1], times[1].saturating_sub(times[0]));
        let segment = spline.reach();
        peaks.note(&way, &segment, before as u32 + 1);
        way = way.union(segment);
        let (begin, end) = spline.end_velocities();
        let change = (begin - velocity.unwrap_or(begin)).abs();
        if change > step {
            (step, peaks.step) = (change, before as u32);
        }
        velocity = Some(end);
    }
    // A track ends at rest, or with a velocity of its own.
    let ends_with = track.knots.last().and_then(|last| last.velocity).unwrap_or(0.0);
    (way.slowest, way.fastest) = (way.slowest.min(ends_with), way.fastest.max(ends_with));
    if let Some(last) = velocity.map(|velocity| (velocity - ends_with).abs()).filter(|last| *last > step) {
        (step, peaks.step) = (last, track.knots.len().saturating_sub(1) as u32);
    }
    let end = track.knots.last().map(|last| last.position);
    let is_zero = |rate: Option<f64>| rate.is_none_or(|rate| rate == 0.0);
    let holds = |knot: &Knot| Some(knot.position) == end && is_zero(knot.velocity) && is_zero(knot.acceleration);
    let moves = track.knots.iter().rposition(|knot| !holds(knot));
    let last = track.knots.len().saturating_sub(1);
    let stands = moves.map_or(0, |moves| (moves + 1).min(last)) as u32;
    Demand { way, peaks, step, lowest, highest, stands }
}

#[cfg(test)]
mod tests;
