//! The commands that every axis executes: enable, disable, halt, quick_stop, reset_errors, cancel; and the commands
//! that wait for their end.

use crate::axis::state::alarm::NO_NUMBERS;
use crate::axis::state::waiting::Until;
use crate::axis::state::{Aim, Axis, Context, Generator, Power};
use crate::code::Code;
use crate::command::Action;
use crate::event::{Event, Kind, Refusal, Severity};
use crate::object::Object;
use crate::position::Position;
use crate::state::{AxisState, Reference};
use crate::sync::Disengage;
use crate::vocabulary::Notice;

impl Axis {
    /// Checks whether a command for several axes can be executed on this one. All axes are checked before any of them
    /// changes.
    ///
    /// # Errors
    /// The reason why not.
    pub fn admits(&self, action: &Action) -> Result<(), Refusal> {
        let refuse = |code| Err(Refusal::new(code, self.object()));
        // A stop is never refused: without room for another waiting command it still stops.
        let stops = matches!(action, Action::Disable(_) | Action::Halt(_) | Action::QuickStop(_));
        if !stops && !self.pending.waiting().has_room() {
            return refuse(Code::TOO_MANY_WAITING);
        }
        if matches!(action, Action::Enable(_)) {
            match self.status.power() {
                Power::Off => {
                    self.check_lock()?;
                    self.check_contacts()?;
                }
                _ if self.status.state() == AxisState::ErrorStop => return refuse(Code::IN_ERROR),
                Power::SwitchingOff | Power::Closing { .. } => return refuse(Code::NOT_AT_STANDSTILL),
                _ => self.check_contacts()?,
            }
        }
        Ok(())
    }

    /// Lets a command wait. If too many wait, it ends at once with a warning that its end will not be reported.
    fn wait(&mut self, cx: &mut Context<'_>, sequence: u64, until: Until) {
        let done = Event::new(Severity::Info, Kind::Done, self.object(), Code::NONE).of_command(sequence);
        let done = Event { position: self.command.position(), ..done };
        if until == Until::Standstill && self.rests() && self.has_stopped_by_itself(cx.cycle) {
            // The axis is at rest: later commands of this cycle do not concern this one.
            cx.events.push(done);
        } else if !self.pending.waiting_mut().add(sequence, until) {
            cx.events.push(Event { severity: Severity::Warn, code: Code::TOO_MANY_WAITING, ..done });
        }
    }

    pub(in crate::axis) fn enable(&mut self, cx: &mut Context<'_>, sequence: u64) {
        // A deactivation, an error or a stop that locks has priority in its cycle: the wait then ends at once.
        let is_free = self.check_lock().is_ok() && self.locked_in(cx.cycle).is_none();
        if self.status.power() == Power::Off && self.observed.is_active() && is_free {
            // An abort has closed the brake while the axis was off.
            self.status.release_brake();
            // A disable of the same cycle has reached its end, although the axis does not stay off.
            self.pending.waiting_mut().end(
                cx.events,
                self.setup.index,
                Until::Disabled,
                Code::NONE,
                self.command.position(),
            );
            self.status.set_power(Power::SwitchingOn { since: cx.cycle });
        }
        self.wait(cx, sequence, Until::Enabled);
    }

    pub(in crate::axis) fn disable(&mut self, cx: &mut Context<'_>, sequence: u64) {
        self.begin_disable(cx);
        self.wait(cx, sequence, if self.is_virtual() { Until::Standstill } else { Until::Disabled });
    }

    /// Stops with the maximum deceleration, then switches off, without reporting the end.
    pub(in crate::axis) fn begin_disable(&mut self, cx: &mut Context<'_>) {
        self.end_all_motion(cx, Code::DISABLED);
        if self.is_virtual() {
            // A virtual axis is always on: only its motion has to end.
            self.task.leave_function();
            self.brake_to_rest(cx, &self.stop_limits());
            return;
        }
        match self.status.power() {
            Power::On | Power::Opening { .. } => {
                self.status.set_power(Power::SwitchingOff);
                self.brake_to_rest(cx, &self.stop_limits());
            }
            Power::SwitchingOff | Power::Closing { .. } => {}
            Power::DriveStops { since, .. } if !self.has_stopped_by_itself(cx.cycle) => {
                self.status.set_power(Power::DriveStops { since, then_off: true });
            }
            _ => self.switch_off(cx),
        }
    }

    pub(in crate::axis) fn halt(&mut self, cx: &mut Context<'_>, sequence: u64) {
        let limits = self.active_limits();
        self.end_all_motion(cx, Code::HALTED);
        if self.is_moving_freely() {
            self.brake_to_rest(cx, &limits);
        }
        self.wait(cx, sequence, Until::Standstill);
    }

    pub(in crate::axis) fn quick_stop(&mut self, cx: &mut Context<'_>, sequence: u64) {
        // From now on a quick stop locks the axis.
        self.brake.set_interrupted(false);
        self.brake.set_aborted(false);
        self.stop_and_lock(cx, Code::QUICK_STOP);
        self.wait(cx, sequence, Until::Standstill);
    }

    /// Ends all motions. An axis under power stops, and nothing moves it until it is reset, not even after power off
    /// and on; an error keeps its own lock. I_BREAK leaves an axis without power unchanged, all other stops lock it as
    /// well. [`apply_stop_priority`](Self::apply_stop_priority) does the rest once all commands of the cycle are known.
    pub(in crate::axis) fn stop_and_lock(&mut self, cx: &mut Context<'_>, code: Code) {
        self.end_all_motion(cx, code);
        self.brake.lock(cx.cycle, code);
        if self.status.state() == AxisState::ErrorStop {
            return;
        }
        let is_on = self.is_on();
        if is_on {
            self.brake_to_rest(cx, &self.stop_limits());
        }
        if is_on || code != Code::INTERRUPTED {
            self.set_state(cx, AxisState::Stopping);
        }
    }

    /// Returns the code of the stop that locks in that cycle.
    pub(in crate::axis) fn locked_in(&self, cycle: u64) -> Option<Code> {
        self.brake.locked_in(cycle)
    }

    /// Cancels commands of this cycle that would let the axis continue: they were meant for the state before the stop,
    /// also if they come after it, because commands are executed in the order of their queues. An axis that is being
    /// switched on is switched off again.
    pub(in crate::axis) fn apply_stop_priority(&mut self, cx: &mut Context<'_>) {
        let Some(code) = self.locked_in(cx.cycle) else { return };
        self.pending.waiting_mut().fail(cx.events, self.setup.index, code, Until::Enabled);
        if matches!(self.status.power(), Power::SwitchingOn { .. }) {
            self.switch_off(cx);
        }
        // Without power and lock a reset lets no motion continue. Whether the power was removed in this cycle makes no
        // difference.
        if self.is_on() || self.brake.had_power() || self.status.state() == AxisState::Stopping {
            self.pending.waiting_mut().fail(cx.events, self.setup.index, code, Until::Healthy);
            self.brake.end_waits();
            if matches!(self.status.power(), Power::Resetting { .. }) {
                self.status.set_power(Power::Off);
            }
        }
    }

    /// Stops and locks the axis. A brake closes at rest, or at once if nothing holds the axis (MACS-ERR-09, A-49).
    pub(in crate::axis) fn abort(&mut self, cx: &mut Context<'_>, sequence: u64) {
        self.brake.set_interrupted(false);
        let was_on = self.is_on();
        self.stop_and_lock(cx, Code::ABORTED);
        let has_brake = self.own_brake().is_some() || self.parameters.outputs.brake != 0;
        self.brake.set_aborted(self.status.state() == AxisState::Stopping);
        if !was_on {
            self.status.request_brake(has_brake);
        } else if has_brake {
            // The rest of an error reaction is executed as well.
            let removes_power = matches!(self.supervision.after_stop(), 0 | 1 | 4);
            self.supervision.react_after_stop(if removes_power { 1 } else { 3 });
        }
        self.wait(cx, sequence, Until::Standstill);
    }

    /// Waits for rest; then [`settle_waiting`](Self::settle_waiting) clears the errors that can be cleared.
    pub(in crate::axis) fn reset(&mut self, cx: &mut Context<'_>, sequence: u64) {
        self.wait(cx, sequence, Until::Healthy);
    }

    /// Clears error and lock of an axis at rest; a drive in fault first has to leave it.
    fn begin_reset(&mut self, cx: &mut Context<'_>) {
        if self.drive_fails(cx) {
            self.status.set_power(Power::Resetting { since: cx.cycle });
        } else {
            self.clear_error(cx);
        }
    }

    pub(in crate::axis) fn drive_fails(&self, cx: &Context<'_>) -> bool {
        cx.input.is_some_and(|input| !input.online || self.drive_data.shown().is_in_fault())
    }

    /// Leaves ERROR_STOP and STOPPING.
    pub(in crate::axis) fn clear_error(&mut self, cx: &mut Context<'_>) {
        if !self.alarm.is_none() {
            let (found, allowed) = self.alarm.numbers();
            let event = Event::new(Severity::Info, Kind::Reset, self.object(), self.alarm.code()).with(found, allowed);
            cx.events.push(Event { position: Position::whole(self.fault().actual), ..event });
        }
        self.brake.set_aborted(false);
        let before = self.alarm.clear();
        self.vocabularies.notice(Notice::Reset);
        let was_braked = self.status.release_brake();
        let mut lasting = self.lasting_following_error(cx.cycle).filter(|_| before == Code::FOLLOWING_ERROR);
        if matches!(self.status.power(), Power::DriveStops { .. }) {
            self.status.set_power(Power::Off);
        } else if was_braked && matches!(self.status.power(), Power::On | Power::Opening { .. }) {
            if lasting.is_some() && self.own_brake().is_some() {
                // The brake holds it away from its command: the command starts at the actual position, as with enable.
                self.note_stop_given_up();
                self.command_actual_position();
                self.supervision.fill(self.commanded_increment());
                lasting = None;
            }
            // Its own brake opens again from the next cycle on, within its opening time.
            let power = self.power_is_on(cx.cycle.saturating_add(1));
            self.status.set_power(power);
        }
        self.supervision.forget(lasting.is_some());
        if matches!(self.status.state(), AxisState::ErrorStop | AxisState::Stopping) {
            let state = if self.status.power() == Power::On { AxisState::Standstill } else { AxisState::Disabled };
            self.set_state(cx, state);
        }
        self.return_error(cx, before, lasting);
    }

    /// Ends a goal of this axis with a controlled stop; the active goal ends once the axis is at rest. Returns false if
    /// the goal belongs to another axis. `is_told`: another axis of the same goal has answered.
    pub fn cancel(&mut self, cx: &mut Context<'_>, sequence: u64, goal: u64, is_told: bool) -> bool {
        let is_active = self.task.goal().is_some_and(|active| active.sequence == goal);
        let is_overlay = self.coupling.overlay().is_some_and(|overlay| overlay.sequence == goal);
        let (is_phase, is_engaging) = (self.is_phase(goal), goal != 0 && self.engaging() == goal);
        let answer = |kind| Event::new(Severity::Info, kind, self.object(), Code::NONE).of_command(sequence);
        let (accepted, done) = (answer(Kind::Accepted), answer(Kind::Done));
        if !is_active && !is_overlay && !is_phase && !is_engaging {
            if !self.pending.buffer().holds(goal) {
                return false;
            }
            cx.events.push(accepted);
            self.cancel_waiting(cx, goal);
        } else if is_told {
            self.cancel_active(cx);
            return true;
        } else {
            cx.events.push(accepted);
            if is_overlay {
                self.cancel_overlay(cx);
            } else if is_phase {
                self.cancel_phase();
            } else if is_engaging {
                self.end_engagement(cx, Code::CANCELLED, NO_NUMBERS);
            } else {
                self.cancel_active(cx);
            }
        }
        cx.events.push(done);
        true
    }

    fn cancel_active(&mut self, cx: &mut Context<'_>) {
        self.homing.stop();
        self.end_overlay(cx, Code::CANCELLED, NO_NUMBERS);
        self.end_phase(cx, Code::CANCELLED, NO_NUMBERS);
        self.end_engagement(cx, Code::NOT_REACHED, NO_NUMBERS);
        self.end_leaving(cx, Code::NOT_REACHED, NO_NUMBERS);
        self.end_waiting_goals(cx, self.command.position());
        let disengage = self.coupling().map_or(Disengage::Stop, |coupling| coupling.disengage);
        self.uncouple(cx, disengage, Code::CANCELLED);
    }

    /// Ends the active goal with `code`: at once if the axis continues alone at the velocity of its coupling, otherwise
    /// at rest.
    pub(in crate::axis) fn uncouple(&mut self, cx: &mut Context<'_>, disengage: Disengage, code: Code) {
        let limits = self.active_limits();
        if disengage == Disengage::KeepVelocity {
            self.end_goal(cx, code);
            let steady = self.steady_velocity();
            // Without its master it may not move in the direction in which the master led it.
            let velocity = if self.reverses_alone() { steady } else { steady.max(0.0) };
            let most = self.parameters.max_velocity;
            let aim = Aim::velocity(velocity.clamp(-most, most));
            let course = self.course(cx.cycle, self.present_motion(), aim, limits);
            self.begin_motion(cx, AxisState::ContinuousMotion, Reference::Speed, Generator::Plan(course));
        } else {
            if let Some(goal) = self.task.goal_mut() {
                goal.ending = Some(code);
            }
            self.brake_to_rest(cx, &limits);
        }
    }

    /// Whether a halt may take over the motion: not while an error or a quick stop ends it.
    fn is_moving_freely(&self) -> bool {
        use AxisState::{ContinuousMotion, DiscreteMotion, Homing, SynchronizedMotion};
        self.status.power() == Power::On
            && matches!(self.status.state(), DiscreteMotion | ContinuousMotion | Homing | SynchronizedMotion)
    }

    /// Ends waiting commands whose condition is met or can no longer be met.
    pub(in crate::axis) fn settle_waiting(&mut self, cx: &mut Context<'_>) {
        if self.pending.waiting().is_empty() && !self.brake.clears() && !self.brake.resumes() {
            self.brake.forget_coasting();
            return;
        }
        let stands = self.rests();
        let locked = matches!(self.status.state(), AxisState::Stopping | AxisState::ErrorStop)
            || !self.alarm.is_none()
            || self.drive_fails(cx);
        // An axis whose drive still stops, or whose brake still closes, must not be reset.
        let is_going = match self.status.power() {
            Power::Resetting { .. } | Power::Closing { .. } => true,
            Power::DriveStops { .. } => !self.drive_fails(cx) && !self.has_stopped_by_itself(cx.cycle),
            _ => self.is_finishing_stop(),
        };
        let clears = self.brake.clears() || self.pending.waiting().waits_for(Until::Healthy);
        let resumes = self.brake.resumes() && self.alarm.is_none();
        let is_due = stands && locked && !is_going && (clears || resumes);
        if self.may_reset(cx.cycle, is_due) {
            self.brake.end_waits();
            if clears {
                self.begin_reset(cx);
            } else {
                self.clear_error(cx);
            }
        }
        self.brake.keep_clearing(locked);
        let has_stopped = self.has_stopped_by_itself(cx.cycle);
        let position = self.command.position();
        let failed = Some(self.alarm.code()).filter(|code| !code.is_none());
        let (axis, opens) = (self.setup.index, self.is_opening());
        let (found, allowed) = self.alarm.numbers();
        let mut end = |until, code| {
            let done = Event::done(Object::Axis(axis), 0, code, position);
            let done = if Some(code) == failed { done.with(found, allowed) } else { done };
            self.pending.waiting_mut().end_with(cx.events, until, done);
        };
        match self.status.power() {
            Power::On => {
                // An error that stopped it while its brake opened.
                let stopped = failed.filter(|_| self.status.state() == AxisState::ErrorStop);
                end(Until::Enabled, stopped.unwrap_or(Code::NONE));
            }
            Power::DriveStops { .. } => end(Until::Enabled, failed.unwrap_or(Code::DISABLED)),
            Power::Off => {
                end(Until::Disabled, Code::NONE);
                end(Until::Enabled, failed.unwrap_or(Code::DISABLED));
            }
            _ => {}
        }
        if stands && has_stopped {
            end(Until::Standstill, Code::NONE);
        } else if self.task.goal().is_some_and(|goal| goal.ending.is_none()) {
            end(Until::Standstill, Code::REPLACED);
        }
        let resets = matches!(self.status.power(), Power::Resetting { .. });
        // Until its brake is open it accepts no goal.
        if failed.is_none() && !resets && !opens && self.status.state() != AxisState::Stopping {
            end(Until::Healthy, Code::NONE);
        }
    }
}
