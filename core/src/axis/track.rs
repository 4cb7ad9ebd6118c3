//! A trajectory on one of its axes. The machine keeps it, and judges all of its axes together.
//!
//! Law      target(k) = the trajectory at t_k. The axis follows it as a coupled axis follows its leader: exactly, where its
//!          limits allow that; else it lags, and catches up within them. Splines of degree 3 and 5 were checked before, so
//!          that only the steps of velocity between straight segments make it lag
//! Reads    the trajectories that run
//! Source   PLCopen (MC_GearIn, for the way to the target), ros2_controllers' joint_trajectory_controller for the splines

use super::course::{Aim, ROUNDING};
use super::goal::Goal;
use super::run::Run;
use super::{Axis, AxisState, Context, Generator, Reference};
use crate::code::Code;
use crate::encoder::Lead;
use crate::event::Number;
use crate::parameter::Rule;
use crate::position::Position;
use crate::profile::Motion;
use crate::sync::follower::{Bounds, Follower, Phase, Reserve};
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{SyncMode, Transmission};
use crate::trajectory::{Begin, LagLimits, Reach, Tolerance};
use crate::vocabulary::Owner;
use serde::{Deserialize, Serialize};

/// What the differences of whole cycles may be more than the rates of a spline, as a share.
const STEP_SLACK: f64 = 1e-6;

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

    /// Its run.
    pub(super) fn run<'a>(&self, runs: &'a [Option<Run>]) -> Option<&'a Run> {
        runs.get(usize::from(self.slot))?.as_ref()
    }

    /// The motion that its run asks of the axis, once so much real time has passed since the cycle in which that begins (ns).
    pub(super) fn asked_after(&self, run: &Run, elapsed_ns: u64) -> Motion {
        let sample = run.sample_after(usize::from(self.track), &self.begin(run), elapsed_ns);
        Motion { position: sample.position + self.shift, ..sample }
    }

    /// The same in a cycle.
    fn asked(&self, run: &Run, cycle: u64) -> Motion {
        self.asked_after(run, run.elapsed_ns(cycle))
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
        Some((tracker, tracker.run(runs)?))
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

    /// Its motion in the cycle in which a track begins: a trajectory that it follows leads it until then, else it stops from now on.
    pub fn motion_at(&self, cycle: u64, begins: u64, runs: &[Option<Run>]) -> Motion {
        let present = self.present();
        if begins <= cycle {
            return present;
        }
        if let Some((tracker, run)) = self.led_until(begins, runs) {
            return tracker.asked(run, begins);
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
        let Some(run) = tracker.run(cx.runs) else { return };
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
        let sample = tracker.asked(run, cx.cycle);
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
        let (velocity, acceleration) = (self.parameters.max_velocity, self.most_step().1);
        let limits = LagLimits { velocity, acceleration, cycle_s: self.cycle_s() };
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

    /// Age of the command that its actual values answer (cycles).
    fn age(&self) -> u64 {
        if self.is_virtual() { 0 } else { self.delay().saturating_add(1) }
    }

    /// Motion that its trajectory asked for in the cycle that its actual values answer, with the error of its acceleration; none before its
    /// start.
    fn answered(&self, cycle: u64, (run, tracker): (&Run, &Tracker)) -> Option<Motion> {
        let answered = cycle.checked_sub(self.age()).filter(|answered| *answered >= run.begins)?;
        // No drive measures its acceleration: the commanded one is what there is.
        let acceleration = tracker.asked(run, cycle).acceleration - self.command.acceleration;
        Some(Motion { acceleration, ..tracker.asked(run, answered) })
    }

    /// Is it too far from where its trajectory has ended, at rest?
    pub fn goal_violation(&self, run: &Run) -> Option<Violation> {
        let tracker = self.tracker()?;
        let track = usize::from(tracker.track);
        let goal = run.trajectory.tracks().get(track)?.goal;
        let end = Motion::at_rest(run.trajectory.end(track, tracker.shift)?);
        self.violation(&goal, Motion { acceleration: -self.command.acceleration, ..end })
    }

    /// Is its command, or are its actual values, too far from its trajectory where that ends in motion?
    pub fn end_violation(&self, cycle: u64, run: &Run) -> Option<Violation> {
        let tracker = self.tracker()?;
        let goal = run.trajectory.tracks().get(usize::from(tracker.track))?.goal;
        let (lag, most) = (self.track_error_position()?.to_f64().abs(), self.nearness());
        let whole = |value: f64| Number::Position(value as i64);
        let lags = (lag > most).then(|| (whole(lag.ceil()), whole(most)));
        lags.or_else(|| self.violation(&goal, self.answered(cycle, (run, &tracker))?))
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
