//! Running trajectories: started on all of their axes or on none, monitored together, ended once.
//!
//! Law      t(k) = (k - k of the command) T - start. Until time 0, axes on a trajectory follow it, and its goal is
//!          ended by this one; other axes are at rest, or stop first. In the first cycle with t >= 0 each axis starts
//!          with its present motion, or with the motion of its points if that is near. If an axis leaves the trajectory
//!          for any reason, the trajectory ends for all: the other axes stop as with a halt
//! Refuses  a trajectory with all points in the past; a trajectory without remaining time that ends at another position
//!          than an axis has; every request that one of its axes refuses
//! Source   ros2_controllers' joint_trajectory_controller, for times and tolerances

use super::trajectory_lag::STEPS_PER_CYCLE;
use super::{CycleInputs, Machine};
use crate::axis::{Axis, Excess, LagEstimate, Run};
use crate::code::Code;
use crate::command::Command;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::object::Object;
use crate::profile::Motion;
use crate::trajectory::{OnExcess, Stretch, Trajectory};
use std::sync::Arc;

/// Maximum number of iterations for the time stretch of a trajectory.
const MAX_STRETCHES: u32 = 8;

/// Result of a trajectory.
struct End {
    object: Object,
    code: Code,
    asked: Number,
    limit: Number,
    /// Whether all axes are at their final positions.
    reached: bool,
}

impl End {
    fn new(object: Object, code: Code) -> Self {
        Self { object, code, asked: Number::None, limit: Number::None, reached: false }
    }
}

fn time_number(ns: u64) -> Number {
    Number::Time(i64::try_from(ns).unwrap_or(i64::MAX))
}

/// Checks that a stretched run ends within its maximum duration.
fn check_duration(run: &Run) -> Result<(), Refusal> {
    let lasts = run.duration_ns();
    match run.trajectory.max_duration_ns() {
        Some(most) if lasts > most => {
            let refusal = Refusal::new(Code::TRAJECTORY_TOO_LONG, Object::Machine);
            Err(refusal.with(time_number(lasts), time_number(most)))
        }
        _ => Ok(()),
    }
}

impl Machine {
    /// Starts a trajectory on all of its axes, after they have moved in this cycle.
    pub(super) fn start_trajectory(
        &mut self,
        told: CycleInputs<'_>,
        command: &Command,
        trajectory: &Arc<Trajectory>,
    ) -> Result<(), Refusal> {
        let run = self.run_of(command.sequence, trajectory);
        self.check_run(&run)?;
        let (run, excess) = self.stretched(run)?;
        if run.stretch != Stretch::NONE {
            // From motion, the path to the first point changes with each stretch.
            self.check_run(&run)?;
        }
        for (track, of) in trajectory.tracks().iter().enumerate() {
            let Some(axis) = self.state.axes.get(usize::from(of.axis)) else { continue };
            axis.check_stop_after_end(self.start_of(axis, &run), &run, track)?;
        }
        let steps = self.has_steps(&run)?;
        let Some(slot) = self.state.runs.iter().position(Option::is_none) else {
            return Err(Refusal::new(Code::TOO_MANY_WAITING, Object::Machine));
        };
        for (track, of) in trajectory.tracks().iter().enumerate() {
            self.act_on(usize::from(of.axis), told, |axis, cx| axis.take_track(cx, &run, (slot, track)));
        }
        // Ends the trajectories whose axes this one takes.
        for slot in 0..self.state.runs.len() {
            self.end_trajectory_if_due(slot, told, Self::end_by_leaving_axis);
        }
        for of in trajectory.tracks() {
            self.act_on(usize::from(of.axis), told, |axis, cx| axis.begin_track(cx, &run));
        }
        self.accept(command, Object::Machine);
        if let Some(Refusal { object, parameter, asked, limit, place, .. }) = excess {
            let event = Event::new(Severity::Info, Kind::Warning, object, Code::TRAJECTORY_STRETCHED);
            self.events.push(Event { parameter, asked, limit, place, ..event.of_command(command.sequence) });
        }
        if let Some(place) = self.state.runs.get_mut(slot) {
            *place = Some(Run { lag: steps.then(LagEstimate::default), ..run });
        }
        Ok(())
    }

    /// Returns the run of a trajectory. It starts in this cycle, or in the first one with a time of 0 or later.
    fn run_of(&self, sequence: u64, trajectory: &Arc<Trajectory>) -> Run {
        let cycle_ns = self.config.cycle_ns;
        let ahead = u64::try_from(trajectory.start_ns()).unwrap_or(0);
        let cycles = ahead.div_ceil(cycle_ns);
        let begin_ns = match u64::try_from(trajectory.start_ns()) {
            Ok(ahead) => cycles.saturating_mul(cycle_ns).saturating_sub(ahead),
            Err(_) => trajectory.start_ns().unsigned_abs(),
        };
        let begins = self.state.cycle.saturating_add(cycles);
        let (trajectory, stretch) = (Arc::clone(trajectory), Stretch::NONE);
        Run { sequence, trajectory, begins, begin_ns, cycle_ns, stretch, is_over: false, lag: None }
    }

    fn check_run(&self, run: &Run) -> Result<(), Refusal> {
        let last = run.trajectory.end_ns();
        // In the cycle in which the run starts, its axes may already be at the last point.
        if last <= run.begin_ns && run.trajectory.start_ns() < 0 {
            let refusal = Refusal::new(Code::TRAJECTORY_IN_THE_PAST, Object::Machine);
            return Err(refusal.with(time_number(last), time_number(run.begin_ns)));
        }
        for (track, of) in run.trajectory.tracks().iter().enumerate() {
            let axis = self.state.axes.get(usize::from(of.axis));
            let axis = axis.ok_or_else(|| Refusal::new(Code::BAD_REQUEST, Object::Machine))?;
            axis.check_track(self.start_of(axis, run), run, track)?;
        }
        Ok(())
    }

    /// Returns the motion of an axis in the cycle in which a run starts.
    fn start_of(&self, axis: &Axis, run: &Run) -> Motion {
        axis.motion_at(self.state.cycle, run.begins, &self.state.runs)
    }

    /// Returns the run, stretched until it is within the limits of its axes, with the excess that caused the largest
    /// stretch.
    fn stretched(&self, mut run: Run) -> Result<(Run, Option<Refusal>), Refusal> {
        let (mut first, mut largest): (Option<Refusal>, Option<Refusal>) = (None, None);
        let mut factor = 1.0;
        // From rest one stretch is enough. From motion, the path to the first point changes with each stretch.
        for _ in 0..MAX_STRETCHES {
            let mut more: Option<Excess> = None;
            for (track, of) in run.trajectory.tracks().iter().enumerate() {
                let Some(axis) = self.state.axes.get(usize::from(of.axis)) else { continue };
                for excess in axis.track_excesses(self.start_of(axis, &run), &run, track) {
                    first = first.or(Some(excess.refusal));
                    more = more.filter(|more| more.factor >= excess.factor).or(Some(excess));
                }
            }
            let Some(excess) = more else {
                check_duration(&run)?;
                return Ok((run, largest.map(|largest| largest.with_stretch(factor))));
            };
            largest = largest.or(Some(excess.refusal));
            factor = excess.factor * run.stretch.factor();
            if factor > run.trajectory.limits().most() {
                return Err(first.unwrap_or(excess.refusal).with_stretch(factor));
            }
            run.stretch = Stretch::at_least(factor);
        }
        // An axis already exceeds its velocity limit where the trajectory starts.
        let refusal = first.unwrap_or_else(|| Refusal::new(Code::BAD_REQUEST, Object::Machine));
        Err(refusal.with_stretch(f64::INFINITY))
    }

    /// Returns whether axes will lag at velocity steps.
    ///
    /// # Errors
    /// An axis would lag, and `on_excess` is refuse or the trajectory ends in motion. The refusal names the step with
    /// the largest lag.
    fn has_steps(&self, run: &Run) -> Result<bool, Refusal> {
        let tracks = run.trajectory.tracks().iter().enumerate();
        let steps = tracks.filter_map(|(track, of)| {
            let axis = self.state.axes.get(usize::from(of.axis))?;
            axis.track_step(self.start_of(axis, run), run, track)
        });
        let largest = steps.max_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, refusal)| refusal);
        let must_not_lag = run.trajectory.limits().on_excess == OnExcess::Refuse || run.trajectory.ends_in_motion();
        match largest {
            Some(refusal) if must_not_lag => Err(refusal),
            largest => Ok(largest.is_some()),
        }
    }

    /// Monitors the running trajectories, after all axes have moved in this cycle.
    pub(super) fn monitor_trajectories(&mut self, told: CycleInputs<'_>) {
        let mut steps = STEPS_PER_CYCLE;
        for slot in 0..self.state.runs.len() {
            match &self.state.runs[slot] {
                None => {}
                Some(run) if run.is_over => self.forget_run(slot),
                Some(_) => {
                    self.estimate_lag(slot, &mut steps);
                    self.end_trajectory_if_due(slot, told, Self::end_of);
                }
            }
        }
    }

    /// Ends the trajectory of a place if its end condition is fulfilled.
    fn end_trajectory_if_due(&mut self, slot: usize, told: CycleInputs<'_>, ends: fn(&mut Self, &Run) -> Option<End>) {
        let Some(run) = self.state.runs.get_mut(slot).and_then(Option::take) else { return };
        match ends(self, &run) {
            Some(end) => {
                self.end_trajectory(&run, &end, told);
                self.state.runs[slot] = Some(Run { is_over: true, ..run });
                self.forget_run(slot);
            }
            None => self.state.runs[slot] = Some(run),
        }
    }

    /// Frees the place of an ended run, unless an axis follows it until the next one starts.
    fn forget_run(&mut self, slot: usize) {
        let is_led = |axis: &Axis| axis.follows_before().is_some_and(|(of, _)| of == slot);
        if !self.state.axes.iter().any(is_led) {
            self.state.runs[slot] = None;
        }
    }

    /// Returns the end caused by the first axis that has left the run.
    fn end_by_leaving_axis(&mut self, run: &Run) -> Option<End> {
        let tracks = run.trajectory.tracks();
        let mut left = None;
        for index in tracks.iter().map(|track| usize::from(track.axis)) {
            let why = self.state.axes.get_mut(index).and_then(|axis| axis.take_left(run.sequence));
            let end = |(code, asked, limit)| End { asked, limit, ..End::new(Object::Axis(index as u16), code) };
            left = left.or(why.map(end));
        }
        left
    }

    fn end_of(&mut self, run: &Run) -> Option<End> {
        if let Some(left) = self.end_by_leaving_axis(run) {
            return Some(left);
        }
        let tracks = run.trajectory.tracks();
        let cycle = self.state.cycle;
        let axes = || tracks.iter().filter_map(|track| self.state.axes.get(usize::from(track.axis)));
        if axes().any(|axis| axis.is_cancelled()) {
            return axes().all(|axis| axis.is_command_at_rest()).then(|| End::new(Object::Machine, Code::CANCELLED));
        }
        if cycle < run.begins {
            return None;
        }
        let violated = |code, object, (asked, limit)| End { asked, limit, ..End::new(object, code) };
        let off = axes().find_map(|axis| Some((axis.object(), axis.path_violation(cycle, run)?)));
        if let Some((object, violation)) = off {
            return Some(violated(Code::TRAJECTORY_PATH_TOLERANCE, object, violation));
        }
        let late = run.late_ns(cycle);
        let in_motion = late.is_some() && run.trajectory.ends_in_motion();
        let violation = |axis: &Axis| if in_motion { axis.end_violation(cycle, run) } else { axis.goal_violation(run) };
        let off = late.and_then(|_| axes().find_map(|axis| Some((axis.object(), violation(axis)?))));
        let reached = End { reached: true, ..End::new(Object::Machine, Code::NONE) };
        if in_motion {
            // Waiting for the tolerances would let the axes move on.
            let missed = |(object, violation)| violated(Code::TRAJECTORY_GOAL_TOLERANCE, object, violation);
            return Some(off.map_or(reached, missed));
        }
        if late.is_some() && off.is_none() && axes().all(|axis| axis.is_at_end()) {
            return Some(reached);
        }
        if let Some((lasts, most)) = run.overtime_ns(cycle) {
            let end = End::new(Object::Machine, Code::TRAJECTORY_TOO_LONG);
            return Some(End { asked: time_number(lasts), limit: time_number(most), ..end });
        }
        let (late, (object, violation)) = late.zip(off)?;
        let is_over = run.trajectory.goal_time_ns().is_some_and(|most| late > most);
        is_over.then(|| violated(Code::TRAJECTORY_GOAL_TOLERANCE, object, violation))
    }

    fn end_trajectory(&mut self, run: &Run, end: &End, told: CycleInputs<'_>) {
        let position = match end.object {
            Object::Axis(index) => self.state.axes.get(usize::from(index)).map(|axis| axis.command().position),
            _ => None,
        };
        let done = Event::done(end.object, run.sequence, end.code, position.unwrap_or_default());
        self.events.push(done.with(end.asked, end.limit));
        for track in run.trajectory.tracks() {
            let index = usize::from(track.axis);
            let is_member = |axis: &Axis| axis.tracked().is_some_and(|(of, ..)| of == run.sequence);
            if !self.state.axes.get(index).is_some_and(is_member) {
                continue;
            }
            // An axis that is still in motion stops from now on.
            let reached = end.reached && self.state.axes[index].is_at_end();
            self.act_on(index, told, |axis, cx| if reached { axis.finish_track(cx) } else { axis.release_track(cx) });
            self.state.axes[index].publish(&mut self.state.board, &self.state.leads);
        }
    }
}
