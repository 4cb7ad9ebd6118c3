//! Supervision of a cycle: following error and arrival at the target.

use crate::axis::state::supervision::STILL_NS;
use crate::axis::state::{Axis, Context, Failure, Power};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Severity};
use crate::position::Position;
use crate::state::AxisState;

/// Interval of the round-robin check of following errors (ns).
const TURN_NS: u64 = 20_000_000;

/// Interval at which an error without reaction is reported again (ns).
const REPEAT_NS: u64 = 1_000_000_000;

impl Axis {
    /// Checks for errors from the inputs of this cycle. They are known before the commands of the cycle, and to the
    /// vocabularies.
    pub(in crate::axis) fn check_errors(&mut self, cx: &mut Context<'_>) {
        self.supervision.note_step(cx.cycle, self.feedback.change(), self.rest_tolerance());
        if !self.is_on() {
            self.supervision.set_following_error(0);
            return;
        }
        self.judge_jump(cx);
        if !self.is_on() {
            return;
        }
        if self.is_open_loop() || self.out_an().is_some() {
            self.supervision.set_following_error(0);
        } else if !self.is_virtual() {
            self.check_following(cx, self.following_error());
        }
    }

    /// Checks for arrival at the target, after the commands of the cycle.
    pub(in crate::axis) fn check_arrival(&mut self, cx: &mut Context<'_>) {
        self.supervision.keep(self.commanded_increment());
        if !self.is_on() {
            self.supervision.set_following_error(0);
            self.leave_rest();
        } else if self.rests() {
            self.check_rest(cx);
        } else {
            self.leave_rest();
        }
    }

    /// Clears the state of a rest when the axis moves or is off.
    fn leave_rest(&mut self) {
        self.brake.forget_settling();
        self.supervision.leave_rest();
    }

    /// Returns the command to which the actual position of this cycle responds, minus that position (inc).
    #[inline]
    pub(in crate::axis) fn following_error(&self) -> i64 {
        // A simulated encoder shows the command itself.
        if self.is_simulated() {
            0
        } else {
            self.supervision.answered_command().saturating_sub(self.feedback.position().floor())
        }
    }

    fn check_following(&mut self, cx: &mut Context<'_>, error: i64) {
        self.supervision.set_following_error(error);
        let is_within = error.unsigned_abs() <= self.parameters.max_following_error.unsigned_abs();
        let lasts = match self.parameters.supervision.following_error_check {
            1 => self.exceeds_tolerated_checks(cx.cycle, is_within),
            _ => self.exceeds_for_long(cx.cycle, is_within),
        };
        if !lasts || self.status.state() == AxisState::ErrorStop {
            return;
        }
        let (error, allowed) = (Number::Position(error), Number::Position(self.parameters.max_following_error));
        if self.alarm.is_none() || !self.only_reports(Code::FOLLOWING_ERROR) {
            // After the report error_reaction was changed to a value that stops the axis: this counts as a new error.
            if self.alarm.code() == Code::FOLLOWING_ERROR {
                self.alarm.clear();
            }
            self.raise_following_error(cx, error, allowed);
        } else {
            self.repeat(cx, error, allowed);
        }
    }

    /// Raises a following error.
    pub(super) fn raise_following_error(&mut self, cx: &mut Context<'_>, found: Number, allowed: Number) {
        self.supervision.note_report(cx.cycle);
        self.raise(cx, Failure::of(Code::FOLLOWING_ERROR).with(found, allowed));
    }

    /// Whether the axis moves away from its command, beyond the allowed following error.
    pub(in crate::axis) fn runs_away(&self) -> bool {
        let (error, most) = (self.supervision.following_error(), self.parameters.max_following_error);
        let leads_off =
            if error > 0 { self.feedback.change() < Position::ZERO } else { self.feedback.change() > Position::ZERO };
        error.unsigned_abs() > most.unsigned_abs() && leads_off
    }

    /// Returns the following error if it still lasts longer than tolerated.
    pub(in crate::axis) fn lasting_following_error(&self, cycle: u64) -> Option<(Number, Number)> {
        let lasts = match self.parameters.supervision.following_error_check {
            1 => self.supervision.exceeded_times() > self.tolerated_times(),
            _ => self.supervision.exceeded_since().is_some_and(|since| self.is_too_long(cycle, since)),
        };
        let error = Number::Position(self.supervision.following_error());
        (lasts && self.is_on()).then_some((error, Number::Position(self.parameters.max_following_error)))
    }

    /// Returns the distance by which an encoder at rest may jitter or creep in [`STILL_NS`]: two counts, or a
    /// thousandth of the highest speed.
    pub(in crate::axis) fn rest_tolerance(&self) -> Position {
        self.parameters.derived.slack
    }

    /// Whether the encoder moves, as far as it is known. A lost drive shows nothing; a drive without new data in this
    /// cycle counts as moving.
    pub(in crate::axis) fn turns(&self, cycle: u64) -> bool {
        let age = |drifted| cycle.saturating_sub(drifted).saturating_mul(self.setup.cycle_ns);
        self.drive_data.shown().is_awaited(self.setup.missed_cycles)
            || self.supervision.drifted().is_some_and(|drifted| age(drifted) < STILL_NS)
    }

    /// Whether the encoder moved in this cycle, faster than an encoder at rest may creep. One cycle is enough here,
    /// while a reset waits: an axis that its drive stops does not coast.
    pub(in crate::axis) fn moves(&self) -> bool {
        let change = self.feedback.change().to_f64().abs().max(self.brake.second_change().saturating_abs() as f64);
        let moved = change * STILL_NS as f64;
        self.drive_data.shown().is_awaited(self.setup.missed_cycles)
            || moved > self.rest_tolerance().to_f64() * self.setup.cycle_ns as f64
    }

    /// Whether the following error is exceeded for too long, checked in each cycle.
    fn exceeds_for_long(&mut self, cycle: u64, is_within: bool) -> bool {
        if is_within {
            self.supervision.keep_within();
            return false;
        }
        let since = self.supervision.note_exceeded(cycle);
        self.is_too_long(cycle, since)
    }

    fn is_too_long(&self, cycle: u64, since: u64) -> bool {
        let time = cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        let tolerated = self.parameters.following_error_time.unsigned_abs();
        tolerated == 0 || time > tolerated
    }

    /// Returns the tolerated number of successive exceeded checks in round robin.
    fn tolerated_times(&self) -> u64 {
        let count = u64::from(self.setup.round.1.max(1));
        self.parameters.following_error_time.unsigned_abs() / count.saturating_mul(TURN_NS)
    }

    /// Whether more successive checks than tolerated were exceeded. The check is made when it is the turn of this axis
    /// (MACS-ERR-07).
    fn exceeds_tolerated_checks(&mut self, cycle: u64, is_within: bool) -> bool {
        let (place, count) = (u64::from(self.setup.round.0), u64::from(self.setup.round.1.max(1)));
        let turn = |cycle: u64| cycle.saturating_mul(self.setup.cycle_ns) / TURN_NS;
        let is_new = cycle == 0 || turn(cycle) != turn(cycle - 1);
        if !is_new || turn(cycle) % count != place {
            return false;
        }
        self.supervision.count_check(is_within);
        self.supervision.exceeded_times() > self.tolerated_times()
    }

    /// Reports a following error without reaction again as long as it lasts (MACS-ERR-03), also in addition to another
    /// error.
    fn repeat(&mut self, cx: &mut Context<'_>, found: Number, allowed: Number) {
        let age = self
            .supervision
            .reported_at()
            .map(|told| cx.cycle.saturating_sub(told).saturating_mul(self.setup.cycle_ns));
        if age.is_none_or(|age| age >= REPEAT_NS) {
            self.supervision.note_report(cx.cycle);
            self.report_error(cx, Failure::of(Code::FOLLOWING_ERROR).with(found, allowed));
        }
    }

    /// Handles the end of the generator: the goal is reached, or the reaction that ended it is complete.
    fn check_rest(&mut self, cx: &mut Context<'_>) {
        self.finish_stop(cx.cycle);
        let in_position = self.is_in_window(cx) && self.is_compensated();
        self.supervision.set_in_position(in_position);
        if self.homing.is_running() {
            return self.settle_homing(cx);
        }
        use AxisState::{ContinuousMotion, DiscreteMotion, Homing};
        let is_moving_state = matches!(self.status.state(), DiscreteMotion | ContinuousMotion | Homing);
        // A trajectory ends for all its axes at once.
        if !is_moving_state || self.status.power() != Power::On || self.has_track() {
            return;
        }
        let missed = self.searches();
        let ending = if missed { Some(Code::PROBE_MISSED) } else { self.task.goal().and_then(|goal| goal.ending) };
        let reached = self.supervision.is_in_position() || self.task.goal().is_none() || (ending.is_some() && !missed);
        if !reached {
            self.report_long_wait(cx);
        }
        if reached {
            if ending.is_none() {
                self.supervision.rest_at(self.task.goal().and_then(|goal| goal.target));
            }
            self.end_goal(cx, ending.unwrap_or(Code::NONE));
            if missed {
                self.end_waiting_goals(cx, self.command.position());
            }
            if self.pending.buffer().is_empty() {
                self.set_state(cx, AxisState::Standstill);
            } else {
                let before = self.supervision.rested_at();
                self.begin_next(cx, self.command.motion(), 0.0, before);
            }
        }
    }

    /// Reports once that a goal waits too long for its target window (MACS-TGT-06).
    pub(in crate::axis) fn report_long_wait(&mut self, cx: &mut Context<'_>) {
        let patience = self.parameters.supervision.in_position_timeout.unsigned_abs();
        let Some(since) = self.supervision.waits_since(cx.cycle) else { return };
        let waited = cx.cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        if patience == 0 || waited < patience {
            return;
        }
        self.supervision.note_long_wait();
        let distance = self.commanded_increment().saturating_sub(self.feedback.position().floor());
        let event = Event::new(Severity::Warn, Kind::Warning, self.object(), Code::IN_POSITION_TIMEOUT);
        let window = Number::Position(self.parameters.in_position_window);
        let event = event.with(Number::Position(distance), window);
        cx.events.push(Event { position: self.feedback.position(), ..event });
    }

    /// MACS-TGT-01: without a window the command is enough. MACS-TGT-03: with a time and testval, two readings close to
    /// each other. MACS-TGT-04: with a time alone, longer than that within the window.
    fn is_in_window(&mut self, cx: &Context<'_>) -> bool {
        let window = self.parameters.in_position_window;
        if window > 0 && !self.is_virtual() {
            let distance = self.commanded_increment().saturating_sub(self.feedback.position().floor());
            if distance.unsigned_abs() > window.unsigned_abs() {
                self.supervision.leave_window();
                return false;
            }
        }
        let most = self.parameters.supervision.testval;
        if window > 0 && most > 0 && self.parameters.in_position_time > 0 && !self.is_virtual() {
            return self.reads_the_same_twice(cx.cycle, most);
        }
        let since = self.supervision.inside_since(cx.cycle);
        let time = self.parameters.in_position_time.unsigned_abs();
        window == 0 || time == 0 || cx.cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns) > time
    }

    /// Whether two readings in the window, in_position_time apart, differ by less than `most`. Once they do, the result
    /// stays true.
    fn reads_the_same_twice(&mut self, cycle: u64, most: i64) -> bool {
        let here = self.feedback.position().floor();
        let (since, before) = self.supervision.reading(cycle, here);
        if self.supervision.is_in_position() {
            return true;
        }
        let waited = cycle.saturating_sub(since).saturating_mul(self.setup.cycle_ns);
        if waited < self.parameters.in_position_time.unsigned_abs() {
            return false;
        }
        self.supervision.read_again(cycle, here);
        here.abs_diff(before) < most.unsigned_abs()
    }
}
