//! Streamed setpoints: the newest velocity is valid until the next one, at most for setpoint_timeout.
//!
//! Law      a setpoint moves an axis that is on and at rest, or that already follows setpoints; it does not end a goal.
//!          An axis without a setpoint for longer than `setpoint_timeout` stops with a warning. A setpoint with a
//!          duration ends after that time, and the next one may take over during the stop
//! Refuses  setpoints that the axis must not follow: one warning with the reason, and another one when the reason
//!          changes or after a pause of the stream. A refused setpoint of 0 is not reported. If the newest setpoint
//!          leads into a limit, or backward against REVERS, the one before is no longer valid: the axis stops. With
//!          `jog_at_limit: stop` a stream into a software limit is reported once, until the axis leaves that limit or a
//!          setpoint leads away from it

use crate::axis::state::alarm::NO_NUMBERS;
use crate::axis::state::{Aim, Axis, Context, Generator, Streamed};
use crate::code::Code;
use crate::command::Setpoint;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::Row;
use crate::state::{AxisState, Reference};
use crate::vocabulary::Owner;

/// Parameter in warnings of streams, which distinguishes them from warnings of other motions.
pub(crate) const STREAM: &str = "setpoint_timeout";

impl Axis {
    /// Executes a new setpoint, and stops after the timeout.
    pub(in crate::axis) fn follow_stream(&mut self, cx: &mut Context<'_>) {
        let timeout = self.parameters.setpoint_timeout.unsigned_abs();
        self.command.streamed_mut().pass();
        if self.command.streamed().silence.saturating_mul(self.setup.cycle_ns) > timeout {
            self.command.streamed_mut().told = Code::NONE;
        }
        let new = cx.stream.and_then(|stream| *stream.axes.get(usize::from(self.setup.index))?);
        if let Some(setpoint) = new {
            self.command.streamed_mut().silence = 0;
            self.take_setpoint(cx, setpoint);
        }
        let age = self.command.streamed().age.saturating_mul(self.setup.cycle_ns);
        // Also a setpoint at override 0: it must not move the axis when the override changes.
        let runs = matches!(self.motion.generator(), Generator::Plan(course) if course.aim != Aim::Stop);
        if self.status.reference() != Reference::Stream || !runs {
            return;
        }
        if age > timeout {
            self.end_overlay(cx, Code::STREAM_TIMEOUT, NO_NUMBERS);
            self.brake_to_rest(cx, &self.parameters.default_goal_limits());
            cx.events.push(Event::new(Severity::Warn, Kind::Warning, self.object(), Code::STREAM_TIMEOUT));
        } else if self.command.streamed().duration.is_some_and(|duration| age >= duration) {
            self.stream_at(cx, 0.0);
        }
    }

    fn take_setpoint(&mut self, cx: &mut Context<'_>, Setpoint { velocity, duration }: Setpoint) {
        let mut told = Code::NONE;
        let checked = self.check_setpoint(velocity);
        if self.is_held_at_limit(velocity, &checked) {
            // The stop continues.
            let streamed = self.command.streamed_mut();
            (streamed.age, streamed.duration) = (0, duration);
            return;
        }
        let velocity = match checked {
            Ok(true) => velocity,
            Ok(false) => return,
            Err(refusal) => {
                if velocity != 0.0 && self.command.streamed().told != refusal.code {
                    self.command.streamed_mut().told = refusal.code;
                    let event = Event::new(Severity::Warn, Kind::Warning, self.object(), refusal.code);
                    let parameter = Some(const { Row::place(STREAM) });
                    cx.events.push(Event { parameter, ..event.with(refusal.asked, refusal.limit) });
                }
                self.note_refused_at_limit(velocity, &refusal);
                let is_barred = matches!(refusal.code, Code::LIMIT_VIOLATION | Code::REVERSE_FORBIDDEN);
                if !(is_barred && self.streams()) {
                    // A setpoint that is not followed does not restart the timeout.
                    return;
                }
                told = refusal.code;
                0.0
            }
        };
        *self.command.streamed_mut() = Streamed { age: 0, duration, silence: 0, told };
        if velocity != 0.0 || !self.rests() {
            // A waiting coupling must not take the axis from the stream.
            self.end_engagement(cx, Code::REPLACED, NO_NUMBERS);
            self.stream_at(cx, velocity);
        }
    }

    /// Whether a setpoint moves the axis.
    pub(in crate::axis) fn streams(&self) -> bool {
        self.status.state() == AxisState::ContinuousMotion && self.status.reference() == Reference::Stream
    }

    /// Checks whether the axis may follow it. False: not yet, while the axis comes to rest by itself.
    fn check_setpoint(&self, velocity: f64) -> Result<bool, Refusal> {
        let refuse = |code, limit| Err(Refusal::new(code, self.object()).with(Number::Velocity(velocity), limit));
        self.check_closed_loop()?;
        if !velocity.is_finite() {
            // Without the value: an event with NaN would not be equal to itself.
            return Err(Refusal::new(Code::SETPOINT_NO_NUMBER, self.object()));
        }
        self.check_free()?;
        if !self.streams() && self.status.state() != AxisState::Standstill {
            let stops = matches!(self.motion.generator(), Generator::Plan(course) if course.aim == Aim::Stop);
            return if stops { Ok(false) } else { refuse(Code::STREAM_BUSY, Number::None) };
        }
        let most = self.velocity_for_base();
        if velocity.abs() > most {
            return refuse(Code::VELOCITY_TOO_HIGH, Number::Velocity(most));
        }
        self.check_velocity(velocity).map(|()| true)
    }

    fn stream_at(&mut self, cx: &mut Context<'_>, velocity: f64) {
        let from = self.base();
        let usual = self.parameters.default_goal_limits();
        let aim = Aim::velocity(velocity);
        let mut course = self.course(cx.cycle, from, aim, usual);
        // A reversal before a limit may need more than the default deceleration.
        if self.check_course(&course, from, usual).is_err() {
            course = self.course(cx.cycle, from, aim, self.stop_limits());
        }
        self.status.set_owner(Owner::Native);
        self.begin_motion(cx, AxisState::ContinuousMotion, Reference::Stream, Generator::Plan(course));
    }
}
