//! A trajectory on one of its axes. The machine keeps the trajectory and checks all its axes together.
//!
//! Law      target(k) = the trajectory at t_k. The axis follows it as a coupled axis follows its leader: exactly if its
//!          limits allow that; otherwise it lags, and catches up within them. Splines of degree 3 and 5 were checked
//!          before, so that only the steps of velocity between straight segments cause a lag
//! Reads    the active trajectories
//! Source   PLCopen (MC_GearIn, for the catching up), joint_trajectory_controller of ros2_controllers for the splines

use crate::axis::state::planned_motion::ROUNDING;
use crate::axis::state::run::Run;
use crate::axis::state::{Aim, Axis, Context, Generator, Goal, Tracker};
use crate::code::Code;
use crate::encoder::Lead;
use crate::event::Number;
use crate::parameter::ReversingRule;
use crate::position::Position;
use crate::profile::Motion;
use crate::state::{AxisState, Reference};
use crate::sync::follower::{Bounds, Follower, Phase, Reserve};
use crate::sync::gear::{Gear, Ratio};
use crate::sync::{SyncMode, Transmission};
use crate::trajectory::{Begin, LagLimits, Reach, Tolerance};
use crate::vocabulary::Owner;

/// Share by which the differences of whole cycles may exceed the rates of a spline.
const STEP_SLACK: f64 = 1e-6;

/// Found and allowed value of a violated tolerance.
pub type Violation = (Number, Number);

impl Axis {
    pub(in crate::axis) fn tracker(&self) -> Option<Tracker> {
        self.task.goal().as_ref().and_then(|goal| goal.track)
    }

    /// Returns its own trajectory, and the one that it follows until that begins.
    pub(in crate::axis) fn trackers(&self) -> impl Iterator<Item = Tracker> {
        self.task.goal().iter().flat_map(|goal| [goal.track, goal.before]).flatten()
    }

    /// Returns the trajectory that it follows; not its own while that waits for its start.
    fn leading(&self) -> Option<Tracker> {
        self.task.goal().as_ref().and_then(|goal| goal.before.or(goal.track))
    }

    /// Returns the trajectory that moves it in this cycle.
    fn led_by<'a>(&self, runs: &'a [Option<Run>]) -> Option<(Tracker, &'a Run)> {
        let tracker = self
            .leading()
            .filter(|tracker| !tracker.waits && matches!(*self.motion.generator(), Generator::Track(_)))?;
        Some((tracker, tracker.run(runs)?))
    }

    /// Returns the trajectory that moves it until the cycle in which another one begins; not one that ends in motion in
    /// an earlier cycle.
    fn tracker_until<'a>(&self, begins: u64, runs: &'a [Option<Run>]) -> Option<(Tracker, &'a Run)> {
        let lasts = |run: &Run| run.late_ns(begins).is_none_or(|late| late < run.cycle_ns);
        self.led_by(runs).filter(|(_, run)| !run.trajectory.ends_in_motion() || lasts(run))
    }

    /// Returns the indices of the trajectory that it follows until its own begins: among the active ones, and of its
    /// track.
    pub fn follows_before(&self) -> Option<(usize, usize)> {
        let before = self.task.goal().as_ref()?.before?;
        Some((usize::from(before.slot), usize::from(before.track)))
    }

    /// Returns lowest and highest position of its trajectories.
    pub(in crate::axis) fn track_extent(&self) -> Option<(Position, Position)> {
        let extents = self.trackers().map(|tracker| (tracker.low, tracker.high));
        extents.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
    }

    /// Whether its command is exactly its trajectory.
    pub(in crate::axis) fn is_on_track(&self) -> bool {
        self.leading().is_some_and(|tracker| tracker.exact)
    }

    /// Whether it stays within its software limits because its trajectory does. False while the axis lags, or may lag
    /// later, and if a part of the trajectory is beyond a limit, which is possible for one that begins there.
    pub(in crate::axis) fn stays_within_limits(&self) -> bool {
        let rounding = Position::from_f64(ROUNDING);
        let (low, high) = (Position::whole(self.limit(false)) - rounding, Position::whole(self.limit(true)) + rounding);
        self.leading()
            .is_some_and(|tracker| tracker.exact && tracker.smooth && tracker.low >= low && tracker.high <= high)
    }

    /// Whether it belongs to a trajectory.
    pub(in crate::axis) fn has_track(&self) -> bool {
        self.task.goal().as_ref().is_some_and(|goal| goal.track.is_some())
    }

    /// Whether it is the axis of that track of that trajectory, between two cycles.
    pub fn tracks(&self, sequence: u64, slot: usize, track: usize) -> bool {
        let place = |tracker: Tracker| (usize::from(tracker.slot), usize::from(tracker.track));
        self.task.goal().is_some_and(|goal| goal.sequence == sequence && goal.track.map(place) == Some((slot, track)))
    }

    /// Returns its trajectory: number, index among the active ones, index of its track.
    pub fn tracked(&self) -> Option<(u64, usize, usize)> {
        let goal = (*self.task.goal())?;
        goal.track.map(|tracker| (goal.sequence, usize::from(tracker.slot), usize::from(tracker.track)))
    }

    /// Returns the reason why it has left the trajectory of that command, with found and allowed value, and clears it.
    pub fn take_left(&mut self, sequence: u64) -> Option<(Code, Number, Number)> {
        let (_, code, (found, allowed)) = self.task.left().filter(|(of, ..)| *of == sequence)?;
        self.task.forget_left();
        Some((code, found, allowed))
    }

    /// Whether its trajectory has been cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.task.goal().as_ref().is_some_and(|goal| goal.ending.is_some())
    }

    /// Whether nothing moves its command.
    pub fn is_command_at_rest(&self) -> bool {
        self.rests()
    }

    /// Returns its motion in the cycle in which a track begins: it follows its trajectory until then, or stops from now
    /// on.
    pub fn motion_at(&self, cycle: u64, begins: u64, runs: &[Option<Run>]) -> Motion {
        let present = self.present_motion();
        if begins <= cycle {
            return present;
        }
        if let Some((tracker, run)) = self.tracker_until(begins, runs) {
            return tracker.asked(run, begins);
        }
        let course = self.course(cycle, present, Aim::Stop, self.parameters.default_goal_limits());
        if course.has_ended(begins) { self.resting(course.at(begins).position) } else { course.at(begins) }
    }

    /// Starts that track of a trajectory. It replaces the present motion, except for a trajectory that the axis follows
    /// until this one begins.
    pub fn take_track(&mut self, cx: &mut Context<'_>, run: &Run, (slot, track): (usize, usize)) {
        let runs = cx.runs;
        let waits = run.begins > cx.cycle;
        let before = self.tracker_until(run.begins, runs).map(|(tracker, _)| tracker).filter(|_| waits);
        let from = self.motion_at(cx.cycle, run.begins, runs);
        self.end_all_motion(cx, Code::REPLACED);
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
        self.task.begin(Goal { sequence, ending: None, target, search: None, track: Some(tracker), before });
    }

    /// Begins the started track, or waits for its start.
    pub fn begin_track(&mut self, cx: &mut Context<'_>, run: &Run) {
        let Some(goal) = *self.task.goal() else { return };
        let Some(tracker) = goal.track else { return };
        let generator = if !tracker.waits {
            let from = tracker.begin.position + tracker.shift;
            Generator::Track(self.track_from(self.present_motion(), from, run.trajectory.limits().margin))
        } else {
            if goal.before.is_none() {
                self.brake_to_rest(cx, &self.parameters.default_goal_limits());
            }
            *self.motion.generator()
        };
        self.supervision.forget_rest();
        self.status.set_owner(Owner::Native);
        self.begin_motion(cx, AxisState::DiscreteMotion, Reference::Trajectory, generator);
    }

    /// Returns the follower of an axis with that motion, from which the track takes over at `from`.
    fn track_from(&self, motion: Motion, from: Position, margin: f64) -> Follower {
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
        if from == motion.position { follower.at_once() } else { follower }
    }

    /// Begins a waiting track when its cycle has come.
    pub(in crate::axis) fn start_waiting_track(&mut self, cx: &mut Context<'_>) {
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
        let present = self.present_motion();
        let planned = Motion { position: present.position - tracker.shift, ..present };
        let expected = tracker.begin;
        tracker.begin = self.takes_over_at(planned, run, usize::from(tracker.track));
        (tracker.moved, tracker.waits) = (self.command.velocity(), false);
        // It was checked with the expected motion, which differs if the axis lags behind the trajectory before.
        tracker.smooth &= tracker.begin == expected;
        let from = tracker.begin.position + tracker.shift;
        tracker.exact = from == present.position;
        self.motion.track(self.track_from(present, from, run.trajectory.limits().margin));
        if let Some(goal) = self.task.goal_mut() {
            (goal.track, goal.before) = (Some(tracker), None);
        }
    }

    /// Returns the motion of this cycle by the trajectory. None: no trajectory, and the axis already stops.
    pub(in crate::axis) fn follow_track(&mut self, cx: &mut Context<'_>) -> Option<Motion> {
        let Generator::Track(mut follower) = *self.motion.generator() else { return None };
        let Some((mut tracker, run)) = self.led_by(cx.runs) else {
            self.brake_to_rest(cx, &self.stop_limits());
            return None;
        };
        let (track, begin) = (usize::from(tracker.track), tracker.begin(run));
        let sample = tracker.asked(run, cx.cycle);
        let change = sample.position - follower.target();
        let halt = run.trajectory.straight_end(track, &begin, run.time(cx.cycle).ns);
        follower.set_halt(halt.map(|halt| halt + tracker.shift));
        let lead = Lead { position: sample.position, change, velocity: sample.velocity, uneven: 0.0, valid: true };
        // A position beyond a limit that comes only from rounding was not commanded, and must not cause a lag.
        let held = (follower.target() - self.command.position()).to_f64().abs() <= ROUNDING && tracker.exact;
        let position = if held { follower.target() } else { self.command.position() };
        let slave = Motion { position, velocity: tracker.moved, ..self.command.motion() };
        let rule = if self.reverses_alone() { ReversingRule::Always } else { ReversingRule::Never };
        let next = follower.step(slave, (lead, &[]), self.cycle_s(), Reserve::default(), rule);
        tracker.moved = next.velocity;
        // Not where two straight segments meet, nor at the end: there a stop begins with the step of this cycle.
        let most = self.parameters.max_acceleration.max(self.parameters.deceleration_limit());
        let half = 0.5 * most * self.cycle_s() * (1.0 + run.trajectory.limits().margin.max(STEP_SLACK));
        let is_smooth = (sample.velocity - next.velocity).abs() <= half;
        tracker.exact = follower.phase() == Phase::Synchronized && is_smooth;
        self.status.set_led(!tracker.exact);
        if let Some(goal) = self.task.goal_mut() {
            *if goal.before.is_some() { &mut goal.before } else { &mut goal.track } = Some(tracker);
        }
        self.motion.track(follower);
        // On the spline its velocity is the present one of the spline, not the mean since the last cycle.
        let position = self.unrounded(next.position);
        Some(if tracker.exact { Motion { position, ..sample } } else { Motion { position, ..next } })
    }

    /// Returns the start of a trajectory on it, and its limits while it lags, both in the time of the trajectory; none
    /// once it has left the trajectory.
    pub fn lag_of(&self, run: &Run) -> Option<(Begin, LagLimits)> {
        let is_member = !self.is_cancelled() && self.tracked().is_some_and(|(of, ..)| of == run.sequence);
        let tracker = self.tracker().filter(|_| is_member)?;
        let (velocity, acceleration) = (self.parameters.max_velocity, self.most_step().1);
        let limits = LagLimits { velocity, acceleration, cycle_s: self.cycle_s() };
        Some((tracker.begin(run), limits.stretched(run.stretch.factor())))
    }

    /// Removes the part of a position that is beyond a limit only by rounding.
    fn unrounded(&self, position: Position) -> Position {
        let (low, high) = (Position::whole(self.limit(false)), Position::whole(self.limit(true)));
        let (now, rounding) = (self.command.position(), Position::from_f64(ROUNDING));
        match () {
            () if now <= high && position > high && position <= high + rounding => high,
            () if now >= low && position < low && position >= low - rounding => low,
            () => position,
        }
    }

    /// Returns trajectory minus command (inc); none without one.
    pub(in crate::axis) fn track_error_position(&self) -> Option<Position> {
        match self.motion.generator() {
            Generator::Track(follower) => Some(follower.error(self.command.position())),
            _ => None,
        }
    }

    /// Returns the violation if it is too far from its trajectory. Its actual values are compared with the cycle to
    /// which they respond, as for the following error.
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

    /// Returns the age of the command to which its actual values respond (cycles).
    pub(in crate::axis) fn age(&self) -> u64 {
        if self.is_virtual() { 0 } else { self.delay().saturating_add(1) }
    }

    /// Returns the motion of its trajectory in the cycle to which its actual values respond, with the error of its
    /// acceleration; none before its start.
    fn answered(&self, cycle: u64, (run, tracker): (&Run, &Tracker)) -> Option<Motion> {
        let answered = cycle.checked_sub(self.age()).filter(|answered| *answered >= run.begins)?;
        // No drive measures its acceleration, so the commanded one is used.
        let acceleration = tracker.asked(run, cycle).acceleration - self.command.acceleration();
        Some(Motion { acceleration, ..tracker.asked(run, answered) })
    }

    /// Returns the violation if it is too far from the end of its trajectory, at rest.
    pub fn goal_violation(&self, run: &Run) -> Option<Violation> {
        let tracker = self.tracker()?;
        let track = usize::from(tracker.track);
        let goal = run.trajectory.tracks().get(track)?.goal;
        let end = Motion::at_rest(run.trajectory.end(track, tracker.shift)?);
        self.violation(&goal, Motion { acceleration: -self.command.acceleration(), ..end })
    }

    /// Returns the violation if its command or its actual values are too far from a trajectory that ends in motion.
    pub fn end_violation(&self, cycle: u64, run: &Run) -> Option<Violation> {
        let tracker = self.tracker()?;
        let goal = run.trajectory.tracks().get(usize::from(tracker.track))?.goal;
        let (lag, most) = (self.track_error_position()?.to_f64().abs(), self.position_tolerance());
        let whole = |value: f64| Number::Position(value as i64);
        let lags = (lag > most).then(|| (whole(lag.ceil()), whole(most)));
        lags.or_else(|| self.violation(&goal, self.answered(cycle, (run, &tracker))?))
    }

    /// Returns the first violated tolerance. The acceleration of `wanted` is the error itself.
    fn violation(&self, tolerance: &Tolerance, wanted: Motion) -> Option<Violation> {
        let position = (wanted.position - self.feedback.position()).to_f64();
        let velocity = wanted.velocity - self.feedback.velocity();
        let whole = |value: f64| Number::Position(value as i64);
        let beyond = |error: f64, limit: Option<f64>| limit.filter(|limit| error.abs() > *limit);
        // The error is rounded away from 0, the tolerance towards 0, so that the reported error exceeds the reported
        // tolerance.
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

    /// Whether its command rests at the end of its trajectory. An axis that may not move backward stays where rounding
    /// has led it.
    pub fn is_at_end(&self) -> bool {
        let end = self.task.goal().and_then(|goal| goal.target);
        self.tracker().is_some_and(|tracker| !tracker.waits)
            && matches!(*self.motion.generator(), Generator::Track(_))
            && end.is_some_and(|end| (end - self.command.position()).to_f64().abs() <= ROUNDING)
            && self.command.velocity() == 0.0
    }

    /// Ends the trajectory successfully: the axis is at rest at its end.
    pub fn finish_track(&mut self, cx: &mut Context<'_>) {
        let end = self.task.take_goal().and_then(|goal| goal.target);
        self.motion.rest();
        self.command.execute(self.resting(end.unwrap_or(self.command.position())));
        self.set_state(cx, AxisState::Standstill);
    }

    /// Ends the trajectory in any other way: the axis stops, if it has not stopped yet.
    pub fn release_track(&mut self, cx: &mut Context<'_>) {
        self.task.take_goal();
        if self.is_on() && matches!(*self.motion.generator(), Generator::Track(_)) {
            self.brake_to_rest(cx, &self.parameters.default_goal_limits());
        }
        self.status.end_reference();
        if self.rests() && self.status.state() == AxisState::DiscreteMotion {
            self.set_state(cx, AxisState::Standstill);
        }
    }
}
