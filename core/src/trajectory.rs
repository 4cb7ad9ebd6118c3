//! Trajectories: points of several axes over time, which the machine executes as one goal.
//!
//! Law      between two points each axis moves on a spline whose degree depends on the values that both points have. To
//!          the first future point it moves on a spline from the motion at which it is taken over. After the last one
//!          it rests at the nearest whole increment. An axis whose last knot has a velocity continues with that instead
//! Refuses  times that do not ascend, tracks without one knot for each time

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

/// Largest number of points of a trajectory.
pub const MAX_POINTS: usize = 100_000;
/// Largest number of points of all axes together: a recording has to hold them.
pub const MAX_KNOTS: usize = 100_000;

/// Tolerances of an axis; none: no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Position tolerance (inc).
    pub position: Option<f64>,
    /// Velocity tolerance (inc/s).
    pub velocity: Option<f64>,
    /// Acceleration tolerance (inc/s^2).
    pub acceleration: Option<f64>,
}

impl Tolerance {
    /// Whether it has no limit.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    fn is_sound(&self) -> bool {
        let limits = [self.position, self.velocity, self.acceleration];
        limits.into_iter().flatten().all(|limit| limit >= 0.0 && limit.is_finite())
    }
}

/// A point of one axis. Missing values are none; the values of both ends of a segment decide the degree of its spline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Knot {
    /// Position.
    pub position: Position,
    /// Velocity (inc/s).
    pub velocity: Option<f64>,
    /// Acceleration (inc/s^2).
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
    /// Index of the axis.
    pub axis: u16,
    /// Knots, one for each time of the trajectory.
    pub knots: Box<[Knot]>,
    /// Tolerance before the end.
    pub path: Tolerance,
    /// Tolerance at the end.
    pub goal: Tolerance,
    /// Largest distance of the command from a first point at time 0 (inc); none: no limit (GRP-TRAJ-11).
    pub start: Option<f64>,
    /// Whether the track is shifted by whole turns of a modulo axis until it is nearest to the axis (GRP-TRAJ-10).
    pub wraps: bool,
}

/// Points of the largest values of a track: the index of the point, or of the end of the segment with the value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Peaks {
    /// Point of the lowest knot.
    pub lowest: u32,
    /// Point of the highest knot.
    pub highest: u32,
    /// Point of the lowest position.
    pub low: u32,
    /// Point of the highest position.
    pub high: u32,
    /// Point of the highest speed.
    pub speed: u32,
    /// Point of the highest acceleration.
    pub acceleration: u32,
    /// Point of the highest deceleration.
    pub deceleration: u32,
    /// Point of the largest step of velocity.
    pub step: u32,
}

impl Peaks {
    /// Returns peaks that are all in the segment that ends at one point.
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

    /// Notes a segment that ends at `point` if it exceeds the segments before.
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

/// Demands of a trajectory on an axis from its first point on, or from the first future point if it began in the past.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Demand {
    /// Range and rates of its splines.
    pub way: Reach,
    /// Points of the largest values of `way`.
    pub peaks: Peaks,
    /// Largest step of velocity at a point, where straight segments meet others or end (inc/s).
    pub step: f64,
    /// Lowest knot.
    pub lowest: Position,
    /// Highest knot.
    pub highest: Position,
    /// Index of the knot from which on it rests at its end: the last one, or an earlier one if all knots after it only
    /// hold.
    pub stands: u32,
}

/// A trajectory. It begins at the positions of its axes, and reaches its first point at the first of its times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Read")]
pub struct Trajectory {
    start_ns: i64,
    times_ns: Box<[u64]>,
    tracks: Box<[Track]>,
    goal_time_ns: Option<u64>,
    limits: TrajectoryLimits,
    max_duration_ns: Option<u64>,
    /// Demand of each track, so that no cycle has to read all knots.
    demands: Box<[Demand]>,
}

/// A trajectory that was read from outside: its demands are calculated again.
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

/// Start of a trajectory on an axis. Its positions are those of the trajectory, without the shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begin {
    /// Motion at the start: that of the axis, or that of the points if the axis is near them.
    pub motion: Motion,
    /// Time of the start, in the time of the trajectory (ns).
    pub time_ns: u64,
    /// Shift of the track on the axis.
    pub shift: Position,
}

impl Trajectory {
    /// Returns a trajectory of these tracks; none if they violate its law. `start_ns` is the time from the cycle in
    /// which the command acts to time 0, negative if that is in the past; `times_ns` are counted from time 0;
    /// `goal_time_ns` is the time after the last point within which the axes must reach their goal tolerances, none: no
    /// limit.
    pub fn new(start_ns: i64, times_ns: Box<[u64]>, tracks: Box<[Track]>, goal_time_ns: Option<u64>) -> Option<Self> {
        let (limits, demands) = (TrajectoryLimits::default(), Box::default());
        let trajectory = Self { start_ns, times_ns, tracks, goal_time_ns, limits, max_duration_ns: None, demands };
        let trajectory = trajectory.with_demands();
        trajectory.is_sound().then_some(trajectory)
    }

    /// Returns the time since its time 0 in the cycle in which the command acts (ns).
    fn past_ns(&self) -> u64 {
        if self.start_ns < 0 { self.start_ns.unsigned_abs() } else { 0 }
    }

    /// Returns the trajectory with its demands; without demands if it violates its law.
    fn with_demands(self) -> Self {
        // Past points are skipped. A point at time 0 is the start of a trajectory that starts now.
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

    /// Whether it obeys its law; a trajectory from outside may contain any values.
    pub fn is_sound(&self) -> bool {
        // There is at least one track.
        !self.demands.is_empty() && self.limits.is_sound()
    }

    /// Returns the time from the cycle in which the command acts to time 0 (ns); negative: it has already begun.
    pub fn start_ns(&self) -> i64 {
        self.start_ns
    }

    /// Returns the trajectory with another time from the cycle in which the command acts to time 0 (ns). A time in the
    /// past requires a new reading of all points.
    #[must_use]
    pub fn starting(self, start_ns: i64) -> Self {
        let before_ns = self.past_ns();
        let started = Self { start_ns, ..self };
        if started.past_ns() == before_ns { started } else { started.with_demands() }
    }

    /// Returns the trajectory with other settings for points that exceed limits of axes.
    #[must_use]
    pub fn within(self, limits: TrajectoryLimits) -> Self {
        Self { limits, ..self }
    }

    /// Returns the settings for points that exceed limits of axes.
    pub fn limits(&self) -> TrajectoryLimits {
        self.limits
    }

    /// Returns the trajectory with a longest duration (ns) from its start, after which it is ended.
    #[must_use]
    pub fn ended_after(self, max_duration_ns: Option<u64>) -> Self {
        Self { max_duration_ns, ..self }
    }

    /// Returns the longest duration from its start to its end (ns); none: no limit.
    pub fn max_duration_ns(&self) -> Option<u64> {
        self.max_duration_ns
    }

    /// Returns the times of the points from time 0, ascending (ns); at least one.
    pub fn times_ns(&self) -> &[u64] {
        &self.times_ns
    }

    /// Returns its tracks: at least one, one for each axis.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Returns the time after the last point within which the axes must reach their goal tolerances (ns); none: no
    /// limit.
    pub fn goal_time_ns(&self) -> Option<u64> {
        self.goal_time_ns
    }

    /// Returns the time of the last point from time 0 (ns).
    pub fn end_ns(&self) -> u64 {
        self.times_ns.last().copied().unwrap_or(0)
    }

    /// Returns its demand on the axis of a track.
    pub fn demand(&self, track: usize) -> Option<&Demand> {
        self.demands.get(track)
    }

    /// Returns the velocity with which a track ends (inc/s); 0: it ends at rest.
    pub fn end_velocity(&self, track: usize) -> f64 {
        let last = self.tracks.get(track).and_then(|track| track.knots.last());
        last.and_then(|last| last.velocity).unwrap_or(0.0)
    }

    /// Returns the velocity of the last segment of a track at the last point (inc/s), which differs from that of the
    /// point if the segment is straight.
    pub fn last_slope(&self, track: usize) -> f64 {
        let knots = self.tracks.get(track).map(|track| &track.knots[..]);
        let Some(([.., from, to], [.., since, until])) = knots.zip(Some(&self.times_ns[..])) else { return 0.0 };
        Spline::new(from, to, until.saturating_sub(*since)).end_velocities().1
    }

    /// Whether a track ends with a velocity.
    pub fn ends_in_motion(&self) -> bool {
        (0..self.tracks.len()).any(|track| self.end_velocity(track) != 0.0)
    }

    /// Returns the final rest position of a track that is shifted by `shift`: the whole increment nearest to its last
    /// point, as for the target of every goal.
    pub fn end(&self, track: usize, shift: Position) -> Option<Position> {
        let last = self.tracks.get(track)?.knots.last()?.position + shift;
        Some(Position::whole(last.nearest()))
    }

    /// Returns the same position without the shift.
    fn planned_end(&self, track: usize, shift: Position) -> Option<Position> {
        self.end(track, shift).map(|end| end - shift)
    }

    /// Returns the motion of a track at a time from its points alone; none before the first point and after the last
    /// one.
    pub fn given(&self, track: usize, time_ns: u64) -> Option<Motion> {
        let next = self.passed(time_ns);
        let before = next.checked_sub(1)?;
        let knots = &self.tracks.get(track)?.knots;
        let (since, until) = (*self.times_ns.get(before)?, *self.times_ns.get(next)?);
        let spline = Spline::new(knots.get(before)?, knots.get(next)?, until.saturating_sub(since));
        Some(spline.at(time_ns.saturating_sub(since) as f64))
    }

    /// Returns the spline from the start of a track to the first future point; none if there is none.
    pub fn first_spline(&self, track: usize, begin: &Begin) -> Option<Spline> {
        let first = self.passed(begin.time_ns);
        let knot = self.tracks.get(track)?.knots.get(first)?;
        Some(Spline::new(&begin.motion.into(), knot, self.times_ns.get(first)?.saturating_sub(begin.time_ns)))
    }

    /// Returns the shift of a track that brings it nearest to the position of its axis at the start: with its first
    /// point, or with the position of its points at a later time.
    pub fn shift(&self, track: usize, time_ns: u64, from: Position, turn: Option<Modulo>) -> Position {
        let knots = self.tracks.get(track).filter(|track| track.wraps).map(|track| &track.knots);
        let ahead = knots.and_then(|knots| knots.get(self.times_ns.partition_point(|&time| time < time_ns)));
        let place = ahead.map(|knot| self.given(track, time_ns).map_or(knot.position, |due| due.position));
        let Some((turn, place)) = turn.zip(place) else { return Position::ZERO };
        turn.target(place, from, from, Direction::Shortest, 0.0) - place
    }

    /// Returns the index of the first point after a time; of the last point if there is none.
    pub fn point_ahead(&self, time_ns: u64) -> u32 {
        self.passed(time_ns).min(self.times_ns.len().saturating_sub(1)) as u32
    }

    /// Returns the end of a track that is on a straight line to it at that time: nothing slows it down before.
    pub fn straight_end(&self, track: usize, begin: &Begin, time_ns: u64) -> Option<Position> {
        let next = self.passed(time_ns);
        let end = self.planned_end(track, begin.shift)?;
        if next < self.demand(track)?.stands as usize || self.end_velocity(track) != 0.0 {
            return None;
        }
        match self.under_way(track, begin, time_ns) {
            Some((spline, _)) => spline.is_straight().then_some(end),
            // A lagging axis is still on that line.
            None => Some(end),
        }
    }

    /// Returns the motion of a track at a time, not before its start.
    pub fn sample(&self, track: usize, begin: &Begin, time: Moment) -> Motion {
        match self.under_way(track, begin, time.ns) {
            Some((spline, since)) => spline.at(time.since(since)),
            None if self.end_velocity(track) != 0.0 => self.beyond_end(track, time),
            None => Motion::at_rest(self.planned_end(track, begin.shift).unwrap_or(begin.motion.position)),
        }
    }

    /// Returns the motion of a track that ends with a velocity, after its last point.
    fn beyond_end(&self, track: usize, time: Moment) -> Motion {
        let velocity = self.end_velocity(track);
        let last =
            self.tracks.get(track).and_then(|track| track.knots.last()).map_or(Position::ZERO, |last| last.position);
        let position = last + Position::from_f64(velocity * time.since(self.end_ns()) / 1e9);
        Motion { position, velocity, acceleration: 0.0, jerk: 0.0 }
    }

    /// Returns the segment of a track at a time, and the start of the segment (ns); none after the last one.
    fn under_way(&self, track: usize, begin: &Begin, time_ns: u64) -> Option<(Spline, u64)> {
        self.segment(track, begin, self.passed(time_ns))
    }

    /// Returns the segment of a track that ends at a point, and its start (ns).
    fn segment(&self, track: usize, begin: &Begin, point: usize) -> Option<(Spline, u64)> {
        let knots = &self.tracks.get(track)?.knots;
        let (knot, time) = knots.get(point).zip(self.times_ns.get(point))?;
        // A point at or before the start is skipped.
        let before = point.checked_sub(1).and_then(|before| knots.get(before).zip(self.times_ns.get(before)));
        let (from, since) = match before {
            Some((knot, &since)) if since > begin.time_ns => (*knot, since),
            _ => (begin.motion.into(), begin.time_ns),
        };
        Some((Spline::new(&from, knot, time.saturating_sub(since)), since))
    }

    /// Returns the number of points reached by that time.
    fn passed(&self, time_ns: u64) -> usize {
        self.times_ns.partition_point(|&time| time <= time_ns)
    }
}

/// Returns the demand of a track from a point on; from the last one if that is not in the future.
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
    // A track ends at rest, or with its own velocity.
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
