//! A trajectory on one of its axes. The machine keeps it, and judges all of its axes together.
//!
//! Law      target(k) = the trajectory at t_k. The axis follows it as a coupled axis follows its leader: exactly, where its
//!          limits allow that; else it lags, and catches up within them. Splines of degree 3 and 5 were checked before, so
//!          that only the steps of velocity between straight segments make it lag
//! Reads    the trajectories that run
//! Refuses  knots, ways, velocities, accelerations beyond the limits of the axis, as moves do
//! Source   PLCopen (MC_GearIn, for the way to the target), ros2_controllers' joint_trajectory_controller for the splines

use super::course::{Aim, ROUNDING};
use super::goal::Goal;
use super::{Axis, AxisState, Context, Generator, Reference};
use crate::code::Code;
use crate::encoder::Lead;
use crate::event::{Number, Refusal, TrajectoryPlace};
use crate::parameter::{Row, Rule};
use crate::position::Position;
use crate::profile::{self, Motion};
use crate::sync::follower::{Bounds, Follower, Phase, Reserve};
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{SyncMode, Transmission};
use crate::trajectory::{Begin, Lag, LagLimits, Moment, Peaks, Reach, Stretch, Tolerance, Trajectory};
use crate::vocabulary::Owner;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What rounding may put a rate beyond its limit, as a share of it.
const SLACK: f64 = 1e-9;
/// What the differences of whole cycles may be more than the rates of a spline, as a share.
const STEP_SLACK: f64 = 1e-6;

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
    fn elapsed_ns(&self, cycle: u64) -> u64 {
        cycle.saturating_sub(self.begins).saturating_mul(self.cycle_ns)
    }

    /// The trajectory's time in a cycle, from the one in which it begins on.
    pub fn time(&self, cycle: u64) -> Moment {
        self.stretch.moment(self.begin_ns, self.elapsed_ns(cycle))
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

    /// The real motion that it asks of a track in a cycle.
    fn sample(&self, track: usize, begin: &Begin, cycle: u64) -> Motion {
        self.stretch.real(self.trajectory.sample(track, begin, self.time(cycle)))
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

/// An axis' place in a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Tracker {
    /// Its place among those that run.
    slot: u16,
    /// Its place among the trajectory's.
    track: u16,
    /// The motion with which it begins, by the trajectory's time.
    begin: Motion,
    /// It has not begun yet.
    waits: bool,
    /// Change of the command in the last cycle (inc/s).
    moved: f64,
    /// The command is the spline itself, and shows its velocity: within half of what a cycle may change, that of its step.
    exact: bool,
    /// It has no step of velocity that would make the axis lag.
    smooth: bool,
    /// Lowest and highest position of all of it.
    low: Position,
    high: Position,
    /// How far the track is moved: whole turns.
    shift: Position,
}

impl Tracker {
    pub(super) fn is_sound(&self) -> bool {
        self.begin.is_sound() && self.moved.is_finite()
    }

    fn begin(&self, run: &Run) -> Begin {
        Begin { motion: self.begin, time_ns: run.begin_ns, shift: self.shift }
    }
}

/// A tolerance that does not hold: what was found, what is allowed.
pub type Violation = (Number, Number);

impl Axis {
    pub(super) fn tracker(&self) -> Option<Tracker> {
        self.goal.as_ref().and_then(|goal| goal.track)
    }

    /// Its own trajectory, and the one that it follows until that begins.
    pub(super) fn trackers(&self) -> impl Iterator<Item = Tracker> {
        self.goal.into_iter().flat_map(|goal| [goal.track, goal.before]).flatten()
    }

    /// The trajectory that leads it, which its own does not while it waits for its start.
    fn leading(&self) -> Option<Tracker> {
        self.goal.as_ref().and_then(|goal| goal.before.or(goal.track))
    }

    /// The trajectory by which it moves in this cycle.
    fn led_by<'a>(&self, runs: &'a [Option<Run>]) -> Option<(Tracker, &'a Run)> {
        let tracker =
            self.leading().filter(|tracker| !tracker.waits && matches!(self.generator, Generator::Track(_)))?;
        Some((tracker, runs.get(usize::from(tracker.slot))?.as_ref()?))
    }

    /// The trajectory by which it moves until the cycle in which another one begins: not one that ends in motion in an earlier cycle.
    fn led_until<'a>(&self, begins: u64, runs: &'a [Option<Run>]) -> Option<(Tracker, &'a Run)> {
        let lasts = |run: &Run| run.late_ns(begins).is_none_or(|late| late < run.cycle_ns);
        self.led_by(runs).filter(|(_, run)| !run.trajectory.ends_in_motion() || lasts(run))
    }

    /// Places of the trajectory that it follows until its own begins: among those that run, among the tracks of that.
    pub fn follows_before(&self) -> Option<(usize, usize)> {
        let before = self.goal?.before?;
        Some((usize::from(before.slot), usize::from(before.track)))
    }

    /// Lowest and highest position of its trajectories.
    pub(super) fn track_extent(&self) -> Option<(Position, Position)> {
        let extents = self.trackers().map(|tracker| (tracker.low, tracker.high));
        extents.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
    }

    /// Is its command its trajectory itself?
    pub(super) fn is_on_track(&self) -> bool {
        self.leading().is_some_and(|tracker| tracker.exact)
    }

    /// Whether it stays within its software limits because its trajectory does. False while the axis lags, or may lag later, and where a
    /// part of the trajectory is beyond a limit, as one may be that begins there.
    pub(super) fn stays_within_limits(&self) -> bool {
        let rounding = Position::from_f64(ROUNDING);
        let (low, high) = (Position::whole(self.limit(false)) - rounding, Position::whole(self.limit(true)) + rounding);
        self.leading()
            .is_some_and(|tracker| tracker.exact && tracker.smooth && tracker.low >= low && tracker.high <= high)
    }

    /// Is it one of a trajectory?
    pub(super) fn has_track(&self) -> bool {
        self.goal.as_ref().is_some_and(|goal| goal.track.is_some())
    }

    /// Is it the axis of that track of that run, between two cycles?
    pub fn tracks(&self, sequence: u64, slot: usize, track: usize) -> bool {
        let place = |tracker: Tracker| (usize::from(tracker.slot), usize::from(tracker.track));
        self.goal.is_some_and(|goal| goal.sequence == sequence && goal.track.map(place) == Some((slot, track)))
    }

    /// The trajectory that it is of: number, place among those that run, place among its tracks.
    pub fn tracked(&self) -> Option<(u64, usize, usize)> {
        let goal = self.goal?;
        goal.track.map(|tracker| (goal.sequence, usize::from(tracker.slot), usize::from(tracker.track)))
    }

    /// Why it has left the trajectory of that command, if it has, with what was found and what is allowed; asked once.
    pub fn take_left(&mut self, sequence: u64) -> Option<(Code, Number, Number)> {
        let (_, code, (found, allowed)) = self.left.filter(|(of, ..)| *of == sequence)?;
        self.left = None;
        Some((code, found, allowed))
    }

    /// Has its trajectory been cancelled?
    pub fn is_cancelled(&self) -> bool {
        self.goal.as_ref().is_some_and(|goal| goal.ending.is_some())
    }

    /// Nothing moves its command.
    pub fn stands(&self) -> bool {
        self.rests()
    }

    /// Checks that it may take that track of a run, from its motion in the cycle in which that begins, but for its rates.
    ///
    /// # Errors
    /// What its state or its limits forbid.
    pub fn check_track(&self, from: Motion, run: &Run, track: usize) -> Result<(), Refusal> {
        self.check_closed_loop()?;
        self.check_free()?;
        self.check_is_there(from, run, track)?;
        let trajectory = &run.trajectory;
        let refuse = || Refusal::new(Code::BAD_REQUEST, self.object());
        let demand = trajectory.demand(track).ok_or_else(refuse)?;
        let shift = self.shift(from, run, track);
        self.check_start(from.position - shift, run, track)?;
        for (knot, point) in [(demand.lowest, demand.peaks.lowest), (demand.highest, demand.peaks.highest)] {
            let at_point = |refusal| Refusal { place: Some(place(trajectory, point)), ..refusal };
            self.check_target(knot + shift, &self.parameters).map_err(at_point)?;
        }
        let begin = self.takes_over(from, run, track).position + shift;
        for (reach, peaks) in self.reaches(from, run, track).into_iter().flatten() {
            self.check_track_way(trajectory, (&reach, &peaks), begin)?;
        }
        Ok(())
    }

    /// The rates of that track that exceed their limits by more than the margin.
    pub fn track_excesses(&self, from: Motion, run: &Run, track: usize) -> impl Iterator<Item = Excess> {
        let reaches = self.reaches(from, run, track).into_iter().flatten();
        reaches.flat_map(|(reach, peaks)| self.excesses(run, &run.stretch.real_reach(reach), &peaks)).flatten()
    }

    /// The largest step of velocity of that track, where it is more than the axis can do in a cycle: the way by which the axis will lag at
    /// least (inc), and the refusal of a trajectory that must not lag.
    pub fn track_step(&self, from: Motion, run: &Run, track: usize) -> Option<(f64, Refusal)> {
        let trajectory = &run.trajectory;
        // Where the largest step is past, the largest one ahead is not known: finding it would take a pass over all points.
        let is_ahead = |step: &(f64, u32)| step.1 >= trajectory.point_ahead(run.begin_ns);
        let steps = self.steps(from, run, track)?.into_iter().filter(is_ahead);
        let (step, point) = steps.max_by(|one, other| one.0.total_cmp(&other.0))?;
        let (most, rate) = self.most_step();
        // What rounding makes of velocities is none.
        if step.is_nan() || step <= most {
            return None;
        }
        let refusal = Refusal::new(Code::TRAJECTORY_STEP, self.object());
        let refusal = refusal.with(Number::Velocity(step), Number::Velocity(most));
        Some((step * step / (2.0 * rate), Refusal { place: Some(place(trajectory, point)), ..refusal }))
    }

    /// Whether no step of that track, nor one that is past, is more than the axis can do in a cycle.
    fn is_smooth(&self, from: Motion, run: &Run, track: usize) -> bool {
        let most = self.most_step().0;
        self.steps(from, run, track).is_some_and(|steps| steps.iter().all(|(step, _)| *step <= most))
    }

    /// How much the velocity may change in a cycle (inc/s), and in a second.
    fn most_step(&self) -> (f64, f64) {
        let rate = self.parameters.max_acceleration.min(self.parameters.deceleration_limit());
        (rate * self.cycle_s(), rate)
    }

    /// The steps of velocity where that track begins, at the first point ahead, and the largest one of its points (inc/s), with their points.
    fn steps(&self, from: Motion, run: &Run, track: usize) -> Option<[(f64, u32); 3]> {
        let trajectory = &run.trajectory;
        let demand = trajectory.demand(track)?;
        let motion = self.takes_over(from, run, track);
        let begin = Begin { motion, time_ns: run.begin_ns, shift: Position::ZERO };
        let first = trajectory
            .first_spline(track, &begin)
            .map_or((motion.velocity, motion.velocity), |spline| spline.end_velocities());
        let point = trajectory.point_ahead(run.begin_ns);
        let time_ns = trajectory.times_ns().get(point as usize).copied().unwrap_or(0);
        // After the last point it rests, or continues with the velocity of that.
        let next = trajectory.given(track, time_ns).map_or(trajectory.end_velocity(track), |motion| motion.velocity);
        let (before, after) = ((first.0 - motion.velocity).abs(), (next - first.1).abs());
        let steps = [(before, point), (after, point), (demand.step, demand.peaks.step)];
        Some(steps.map(|(step, point)| (step / run.stretch.factor(), point)))
    }

    /// What that track asks for, by the trajectory's time: from its first point on, and from the axis to the first point ahead.
    fn reaches(&self, from: Motion, run: &Run, track: usize) -> [Option<(Reach, Peaks)>; 2] {
        let shift = self.shift(from, run, track);
        let begin = Begin { motion: self.takes_over(from, run, track), time_ns: run.begin_ns, shift };
        let first = run.trajectory.first_spline(track, &begin).map(|spline| {
            let point = run.trajectory.point_ahead(run.begin_ns);
            (spline.reach().moved(shift), Peaks::at(point))
        });
        [run.trajectory.demand(track).map(|demand| (demand.way.moved(shift), demand.peaks)), first]
    }

    /// How far that track is moved: by the whole turns that bring its first point ahead nearest to the axis (GRP-TRAJ-10).
    fn shift(&self, from: Motion, run: &Run, track: usize) -> Position {
        run.trajectory.shift(track, run.begin_ns, from.position, self.setup.modulo)
    }

    /// A track whose first point is at time 0 begins near to the command (GRP-TRAJ-11).
    fn check_start(&self, from: Position, run: &Run, track: usize) -> Result<(), Refusal> {
        let trajectory = &run.trajectory;
        let Some(of) = trajectory.tracks().get(track).filter(|_| trajectory.times_ns().first() == Some(&0)) else {
            return Ok(());
        };
        let Some((most, knot)) = of.start.zip(of.knots.first()) else { return Ok(()) };
        let off = (knot.position - from).to_f64().abs();
        if off <= most {
            return Ok(());
        }
        let number = |value: f64| Number::Position(value as i64);
        Err(Refusal::new(Code::TRAJECTORY_START, self.object()).with(number(off.ceil()), number(most.floor())))
    }

    /// Where that track takes it over, by the trajectory's time and without its shift: at what its points ask for, if the axis is near to that. The
    /// difference, such as the rounding of a measured position, is worked off during the motion. Otherwise the spline from the axis
    /// to the first point that lies ahead would be judged, which is not part of the plan.
    fn takes_over(&self, from: Motion, run: &Run, track: usize) -> Motion {
        self.takes_over_at(Motion { position: from.position - self.shift(from, run, track), ..from }, run, track)
    }

    /// The same, from a motion without the shift.
    fn takes_over_at(&self, motion: Motion, run: &Run, track: usize) -> Motion {
        let is_near = |given: &Motion| {
            let change = self.parameters.max_acceleration.min(self.parameters.deceleration_limit()) * self.cycle_s();
            (given.position - motion.position).to_f64().abs() <= self.nearness()
                && (run.stretch.real(*given).velocity - motion.velocity).abs() <= change
        };
        run.trajectory.given(track, run.begin_ns).filter(is_near).unwrap_or_else(|| run.stretch.planned(motion))
    }

    /// How far off a point is that counts as the same place (inc).
    fn nearness(&self) -> f64 {
        self.parameters.in_position_window.max(1) as f64
    }

    /// A trajectory that has no time left may end only where the axis is.
    fn check_is_there(&self, from: Motion, run: &Run, track: usize) -> Result<(), Refusal> {
        let shift = self.shift(from, run, track);
        let Some(end) = run.trajectory.end(track, shift).filter(|_| run.trajectory.end_ns() <= run.begin_ns) else {
            return Ok(());
        };
        if !self.rests() {
            return Err(self.not_at_standstill());
        }
        if run.trajectory.end_velocity(track) != 0.0 {
            let number = |ns: u64| Number::Time(i64::try_from(ns).unwrap_or(i64::MAX));
            let refusal = Refusal::new(Code::TRAJECTORY_IN_THE_PAST, self.object());
            return Err(refusal.with(number(run.trajectory.end_ns()), number(run.begin_ns)));
        }
        let goal = run.trajectory.tracks().get(track).and_then(|track| track.goal.position);
        let most = goal.unwrap_or(self.nearness());
        let off = |from: Position| (end - from).to_f64().abs();
        // A client that asks for where the axis is may mean either.
        let off = off(self.command.position).min(off(self.actual.position));
        if off > most {
            let number = |value: f64| Number::Position(value as i64);
            let refusal = Refusal::new(Code::TRAJECTORY_WITHOUT_TIME, self.object());
            return Err(refusal.with(number(off.ceil()), number(most.floor())));
        }
        Ok(())
    }

    /// Checks where a track goes, and that it does not go backwards where that is forbidden.
    fn check_track_way(
        &self,
        trajectory: &Trajectory,
        (reach, peaks): (&Reach, &Peaks),
        from: Position,
    ) -> Result<(), Refusal> {
        let rounding = Position::from_f64(ROUNDING);
        let (low, high) = (Position::whole(self.limit(false)), Position::whole(self.limit(true)));
        let refuse = |code, asked, limit, point| {
            let refusal = Refusal::new(code, self.object()).with(Number::Position(asked), Number::Position(limit));
            Err(Refusal { place: Some(place(trajectory, point)), ..refusal })
        };
        if reach.high > high.max(from) + rounding {
            return refuse(Code::TRAJECTORY_ABOVE_MAX_POSITION, reach.high.ceil(), high.floor(), peaks.high);
        }
        if reach.low < low.min(from) - rounding {
            return refuse(Code::TRAJECTORY_BELOW_MIN_POSITION, reach.low.floor(), low.floor(), peaks.low);
        }
        if reach.slowest < -SLACK * self.parameters.max_velocity {
            self.check_forward(reach.slowest)?;
        }
        Ok(())
    }

    /// Where an axis whose track ends with a velocity comes to rest; none where the track ends at rest.
    fn rest_after_end(&self, run: &Run, track: usize, shift: Position) -> Option<Position> {
        let trajectory = &run.trajectory;
        let (ends_with, slope) = (trajectory.end_velocity(track), trajectory.last_slope(track));
        let velocity = if slope.abs() > ends_with.abs() { slope } else { ends_with } / run.stretch.factor();
        let last = trajectory.tracks().get(track)?.knots.last()?.position + shift;
        // The stop begins in the first cycle that is not before the end.
        let cycle_ns = run.cycle_ns.max(1);
        let passed = velocity * ((cycle_ns - run.duration_ns() % cycle_ns) % cycle_ns) as f64 / 1e9;
        let stop = profile::stopping_way(Motion { velocity, ..Motion::default() }, &self.parameters.usual_limits());
        (ends_with != 0.0).then(|| last + Position::from_f64(passed + stop))
    }

    /// Checks that an axis whose track ends with a velocity can stop within its limits.
    ///
    /// # Errors
    /// It would stop beyond one.
    pub fn check_stop_after_end(&self, from: Motion, run: &Run, track: usize) -> Result<(), Refusal> {
        let Some(rest) = self.rest_after_end(run, track, self.shift(from, run, track)) else { return Ok(()) };
        let rounding = Position::from_f64(ROUNDING);
        let (low, high) = (self.limit(false), self.limit(true));
        let beyond = if rest > Position::whole(high) + rounding {
            Some((rest.ceil(), high))
        } else if rest < Position::whole(low) - rounding {
            Some((rest.floor(), low))
        } else {
            None
        };
        let refusal = Refusal::new(Code::TRAJECTORY_STOP_BEYOND_LIMIT, self.object());
        beyond.map_or(Ok(()), |(rest, limit)| Err(refusal.with(Number::Position(rest), Number::Position(limit))))
    }

    /// Velocity, acceleration and deceleration, where they exceed their limits by more than the margin.
    fn excesses(&self, run: &Run, reach: &Reach, peaks: &Peaks) -> [Option<Excess>; 3] {
        const VELOCITY: u16 = Row::place("max_velocity");
        const ACCELERATION: u16 = Row::place("max_acceleration");
        const DECELERATION: u16 = Row::place("max_deceleration");
        let p = &self.parameters;
        let limits = run.trajectory.limits();
        let (speed, up, down) = (reach.speed(), reach.acceleration, reach.deceleration);
        let rates = [
            (Code::VELOCITY_TOO_HIGH, VELOCITY, (speed, p.max_velocity), peaks.speed),
            (Code::ACCELERATION_TOO_HIGH, ACCELERATION, (up, p.max_acceleration), peaks.acceleration),
            (Code::DECELERATION_TOO_HIGH, DECELERATION, (down, p.deceleration_limit()), peaks.deceleration),
        ];
        let excess = |(code, row, (asked, most), point): (Code, u16, (f64, f64), u32)| {
            if asked <= most * (1.0 + limits.margin.max(SLACK)) {
                return None;
            }
            let is_velocity = code == Code::VELOCITY_TOO_HIGH;
            let number = if is_velocity { Number::Velocity } else { Number::Acceleration };
            let factor = if is_velocity { asked / most } else { libm::sqrt(asked / most) };
            // What is no number exceeds everything.
            let factor = if factor.is_nan() { f64::INFINITY } else { factor };
            let place = TrajectoryPlace {
                stretch: factor * run.stretch.factor(),
                max_stretch: limits.most(),
                ..place(&run.trajectory, point)
            };
            let refusal = Refusal::new(code, self.object()).with(number(asked), number(most));
            Some(Excess { factor, refusal: Refusal { parameter: Some(row), place: Some(place), ..refusal } })
        };
        rates.map(excess)
    }

    /// Its motion in the cycle in which a track begins: a trajectory that it follows leads it until then, else it stops from now on.
    pub fn motion_at(&self, cycle: u64, begins: u64, runs: &[Option<Run>]) -> Motion {
        let present = self.present();
        if begins <= cycle {
            return present;
        }
        if let Some((tracker, run)) = self.led_until(begins, runs) {
            let sample = run.sample(usize::from(tracker.track), &tracker.begin(run), begins);
            return Motion { position: sample.position + tracker.shift, ..sample };
        }
        let course = self.course(cycle, present, Aim::Stop, self.parameters.usual_limits());
        if course.has_ended(begins) { self.resting(course.at(begins).position) } else { course.at(begins) }
    }

    /// Takes that track of a run: it leaves what moves it. What moved it before is replaced, but for a trajectory that leads it until this one
    /// begins.
    pub fn take_track(&mut self, cx: &mut Context<'_>, run: &Run, (slot, track): (usize, usize)) {
        let runs = cx.runs;
        let waits = run.begins > cx.cycle;
        let before = self.led_until(run.begins, runs).map(|(tracker, _)| tracker).filter(|_| waits);
        let from = self.motion_at(cx.cycle, run.begins, runs);
        self.abandon(cx, Code::REPLACED);
        let (begin, shift) = (self.takes_over(from, run, track), self.shift(from, run, track));
        let at = Begin { motion: begin, time_ns: run.begin_ns, shift };
        let first = run.trajectory.first_spline(track, &at).map(|spline| spline.reach());
        let way = run.trajectory.demand(track).map(|demand| demand.way);
        let reach = [first, way].into_iter().flatten().reduce(Reach::union).unwrap_or(Reach::at(begin.position));
        let reach = reach.moved(shift);
        let reach = self.rest_after_end(run, track, shift).map_or(reach, |rest| reach.union(Reach::at(rest)));
        let tracker = Tracker {
            slot: slot as u16,
            track: track as u16,
            begin,
            waits,
            moved: from.velocity,
            exact: begin.position + shift == from.position,
            smooth: self.is_smooth(from, run, track),
            low: reach.low,
            high: reach.high,
            shift,
        };
        let (sequence, target) = (run.sequence, run.trajectory.end(track, shift));
        self.goal = Some(Goal { sequence, ending: None, target, search: None, track: Some(tracker), before });
    }

    /// Begins the track that it has taken, or waits for its start.
    pub fn begin_track(&mut self, cx: &mut Context<'_>, run: &Run) {
        let Some(goal) = self.goal else { return };
        let Some(tracker) = goal.track else { return };
        let generator = if !tracker.waits {
            self.track_from(self.present(), tracker.begin.position + tracker.shift, run.trajectory.limits().margin)
        } else {
            if goal.before.is_none() {
                self.brake_to_rest(cx, &self.parameters.usual_limits());
            }
            self.generator
        };
        self.judge.rested_at = None;
        self.owner = Owner::Native;
        self.begin_motion(cx, AxisState::DiscreteMotion, Reference::Trajectory, generator);
    }

    /// The follower of an axis that moves so, which a track takes over there.
    fn track_from(&self, motion: Motion, from: Position, margin: f64) -> Generator {
        let p = &self.parameters;
        let down = p.deceleration_limit();
        let slack = 1.0 + margin.max(STEP_SLACK);
        let bounds = Bounds {
            velocity: p.max_velocity,
            acceleration: p.max_acceleration.min(down),
            max_velocity: p.max_velocity * slack,
            max_acceleration: p.max_acceleration * slack,
            max_deceleration: down * slack,
        };
        let transmission = Transmission::Gear(Gear::new(Ratio::ONE));
        let follower = Follower::new(0.0, transmission, SyncMode::Position, motion, from - motion.position, bounds);
        Generator::Track(if from == motion.position { follower.at_once() } else { follower })
    }

    /// A track that waited begins, once the cycle has come in which it does.
    pub(super) fn start_waiting_track(&mut self, cx: &mut Context<'_>) {
        if !self.has_track() {
            return;
        }
        let Some(mut tracker) = self.tracker().filter(|tracker| tracker.waits && !self.is_cancelled()) else { return };
        let Some(run) = cx.runs.get(usize::from(tracker.slot)).and_then(Option::as_ref) else { return };
        if cx.cycle <= run.begins {
            return;
        }
        if let Err(refusal) = self.check_zero() {
            return self.end_goal(cx, refusal.code);
        }
        let present = self.present();
        let planned = Motion { position: present.position - tracker.shift, ..present };
        let expected = tracker.begin;
        tracker.begin = self.takes_over_at(planned, run, usize::from(tracker.track));
        (tracker.moved, tracker.waits) = (self.command.velocity, false);
        // It was checked with the motion that was expected here, which is another one where the axis lags behind the trajectory before.
        tracker.smooth &= tracker.begin == expected;
        let from = tracker.begin.position + tracker.shift;
        tracker.exact = from == present.position;
        self.generator = self.track_from(present, from, run.trajectory.limits().margin);
        if let Some(goal) = &mut self.goal {
            (goal.track, goal.before) = (Some(tracker), None);
        }
    }

    /// The motion of this cycle by the trajectory; none where there is none, and the axis stops already.
    pub(super) fn follow_track(&mut self, cx: &mut Context<'_>) -> Option<Motion> {
        let Generator::Track(mut follower) = self.generator else { return None };
        let Some((mut tracker, run)) = self.led_by(cx.runs) else {
            self.brake_to_rest(cx, &self.stop_limits());
            return None;
        };
        let (track, begin) = (usize::from(tracker.track), tracker.begin(run));
        let sample = run.sample(track, &begin, cx.cycle);
        let sample = Motion { position: sample.position + tracker.shift, ..sample };
        let change = sample.position - follower.target();
        let halt = run.trajectory.straight_end(track, &begin, run.time(cx.cycle).ns);
        follower.halt_at(halt.map(|halt| halt + tracker.shift));
        let lead = Lead { position: sample.position, change, velocity: sample.velocity, uneven: 0.0, valid: true };
        // What rounding has put beyond a limit was not commanded; it is not to stay behind for that.
        let held = (follower.target() - self.command.position).to_f64().abs() <= ROUNDING && tracker.exact;
        let position = if held { follower.target() } else { self.command.position };
        let slave = Motion { position, velocity: tracker.moved, ..self.command };
        let rule = if self.reverses_alone() { Rule::Always } else { Rule::Never };
        let next = follower.step(slave, (lead, &[]), self.cycle_s(), Reserve::default(), rule);
        tracker.moved = next.velocity;
        // Not where two straight segments meet, nor where it arrives: there the step of this cycle is what stops begin with.
        let most = self.parameters.max_acceleration.max(self.parameters.deceleration_limit());
        let half = 0.5 * most * self.cycle_s() * (1.0 + run.trajectory.limits().margin.max(STEP_SLACK));
        let is_smooth = (sample.velocity - next.velocity).abs() <= half;
        tracker.exact = follower.phase() == Phase::Synchronized && is_smooth;
        self.is_led = !tracker.exact;
        if let Some(goal) = &mut self.goal {
            *if goal.before.is_some() { &mut goal.before } else { &mut goal.track } = Some(tracker);
        }
        self.generator = Generator::Track(follower);
        // Where it is on the spline, its velocity is that of the spline now, not its mean since the last cycle.
        let position = self.unrounded(next.position);
        Some(if tracker.exact { Motion { position, ..sample } } else { Motion { position, ..next } })
    }

    /// Where a run begins on it, and what limits it while it lags, both by the trajectory's time; none once it has left the run.
    pub fn lag_of(&self, run: &Run) -> Option<(Begin, LagLimits)> {
        let is_member = !self.is_cancelled() && self.tracked().is_some_and(|(of, ..)| of == run.sequence);
        let tracker = self.tracker().filter(|_| is_member)?;
        let p = &self.parameters;
        let acceleration = p.max_acceleration.min(p.deceleration_limit());
        let limits = LagLimits { velocity: p.max_velocity, acceleration, cycle_s: self.cycle_s() };
        Some((tracker.begin(run), limits.stretched(run.stretch.factor())))
    }

    /// Without what rounding puts it beyond a limit.
    fn unrounded(&self, position: Position) -> Position {
        let (low, high) = (Position::whole(self.limit(false)), Position::whole(self.limit(true)));
        let (now, rounding) = (self.command.position, Position::from_f64(ROUNDING));
        match () {
            () if now <= high && position > high && position <= high + rounding => high,
            () if now >= low && position < low && position >= low - rounding => low,
            () => position,
        }
    }

    /// Trajectory minus command (inc); none without one.
    pub(super) fn track_error_position(&self) -> Option<Position> {
        match &self.generator {
            Generator::Track(follower) => Some(follower.error(self.command.position)),
            _ => None,
        }
    }

    /// Is it too far from where its trajectory wanted it? Its command is compared as its following error is: with the cycle
    /// that the actual values answer.
    pub fn path_violation(&self, cycle: u64, run: &Run) -> Option<Violation> {
        let tracker = self.tracker().filter(|tracker| !tracker.waits)?;
        let track = usize::from(tracker.track);
        let path = run.trajectory.tracks().get(track)?.path;
        if path.is_none() {
            return None;
        }
        if run.late_ns(cycle.checked_sub(self.age())?).is_some() {
            return None;
        }
        self.violation(&path, self.answered(cycle, (run, &tracker))?)
    }

    /// How many cycles before this one the command was that its actual values answer.
    fn age(&self) -> u64 {
        if self.is_virtual() { 0 } else { self.delay().saturating_add(1) }
    }

    /// What its trajectory asked for in the cycle that its actual values answer, with the error of its acceleration; none before its start.
    fn answered(&self, cycle: u64, (run, tracker): (&Run, &Tracker)) -> Option<Motion> {
        let answered = cycle.checked_sub(self.age()).filter(|answered| *answered >= run.begins)?;
        let (track, begin) = (usize::from(tracker.track), tracker.begin(run));
        let wanted = run.sample(track, &begin, answered);
        // No drive measures its acceleration: the commanded one is what there is.
        let acceleration = run.sample(track, &begin, cycle).acceleration - self.command.acceleration;
        Some(Motion { position: wanted.position + tracker.shift, acceleration, ..wanted })
    }

    /// Is it too far from where its trajectory has ended, or from its trajectory where that ends in motion?
    pub fn goal_violation(&self, cycle: u64, run: &Run) -> Option<Violation> {
        let tracker = self.tracker()?;
        let track = usize::from(tracker.track);
        let goal = run.trajectory.tracks().get(track)?.goal;
        if run.trajectory.ends_in_motion() {
            let (lag, most) = (self.track_error_position()?.to_f64().abs(), self.nearness());
            let whole = |value: f64| Number::Position(value as i64);
            return (lag > most)
                .then(|| (whole(lag.ceil()), whole(most)))
                .or_else(|| self.violation(&goal, self.answered(cycle, (run, &tracker))?));
        }
        let end = Motion::at_rest(run.trajectory.end(track, tracker.shift)?);
        self.violation(&goal, Motion { acceleration: -self.command.acceleration, ..end })
    }

    /// The first tolerance that does not hold. The acceleration of `wanted` is the error itself.
    fn violation(&self, tolerance: &Tolerance, wanted: Motion) -> Option<Violation> {
        let position = (wanted.position - self.actual.position).to_f64();
        let velocity = wanted.velocity - self.actual.velocity;
        let whole = |value: f64| Number::Position(value as i64);
        let beyond = |error: f64, limit: Option<f64>| limit.filter(|limit| error.abs() > *limit);
        // The error away from 0, the tolerance towards it: what is told is beyond what is allowed as well.
        beyond(position, tolerance.position)
            .map(|limit| (whole(position.abs().ceil().copysign(position)), whole(limit.floor())))
            .or_else(|| {
                let limit = beyond(velocity, tolerance.velocity)?;
                Some((Number::Velocity(velocity), Number::Velocity(limit)))
            })
            .or_else(|| {
                let limit = beyond(wanted.acceleration, tolerance.acceleration)?;
                Some((Number::Acceleration(wanted.acceleration), Number::Acceleration(limit)))
            })
    }

    /// Does its command stand where its trajectory ends? One that may not go backwards stays where rounding led it.
    pub fn is_at_end(&self) -> bool {
        let end = self.goal.and_then(|goal| goal.target);
        self.tracker().is_some_and(|tracker| !tracker.waits)
            && matches!(self.generator, Generator::Track(_))
            && end.is_some_and(|end| (end - self.command.position).to_f64().abs() <= ROUNDING)
            && self.command.velocity == 0.0
    }

    /// The trajectory has ended well: the axis stands at its end.
    pub fn finish_track(&mut self, cx: &mut Context<'_>) {
        let end = self.goal.take().and_then(|goal| goal.target);
        self.generator = Generator::Rest;
        self.command = self.resting(end.unwrap_or(self.command.position));
        self.set_state(cx, AxisState::Standstill);
    }

    /// The trajectory has ended otherwise: the axis stops, if it does not already.
    pub fn release_track(&mut self, cx: &mut Context<'_>) {
        self.goal = None;
        if self.is_on() && matches!(self.generator, Generator::Track(_)) {
            self.brake_to_rest(cx, &self.parameters.usual_limits());
        }
        self.reference = Reference::Stop;
        if self.rests() && self.state == AxisState::DiscreteMotion {
            self.set_state(cx, AxisState::Standstill);
        }
    }
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
