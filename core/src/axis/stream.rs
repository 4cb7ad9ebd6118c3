//! Streamed setpoints: the newest velocity holds until the next one, and for no longer than setpoint_timeout.
//!
//! Law      a setpoint moves an axis that is on and stands, or that a setpoint moves already; it takes no axis from a goal. An axis
//!          that has had none for longer than `setpoint_timeout` stops, and says so; one whose setpoint was asked for so
//!          long and no longer stops then, and is free for the next one on its way
//! Refuses  what it may not follow: told once by a warning with the reason, and again when that changes or the stream was silent
//!          between. A setpoint of 0 asks for nothing that anybody would miss, and is not told of. Where the newest one leads
//!          into a limit, or backwards against REVERS, the one before is asked for no more: the axis stops. With `jog_at_limit:
//!          stop` one that leads into a software limit is reported once, until the axis leaves that limit or is led away from it

use super::alarm::NO_NUMBERS;
use super::course::Aim;
use super::{Axis, AxisState, Context, Generator, Reference};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Severity};
use crate::parameter::Row;
use crate::vocabulary::Owner;
use crate::{command::Setpoint, event::Refusal};
use serde::{Deserialize, Serialize};

/// The parameter by which warnings of streams are told from those of what else moves an axis.
pub(crate) const STREAM: &str = "setpoint_timeout";

/// What an axis knows of its setpoints.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Streamed {
    /// Cycles since the last one that it followed.
    age: u64,
    /// For how long that one was asked for (ns).
    duration: Option<u64>,
    /// Cycles since the last one that came.
    silence: u64,
    /// Why one was not followed, as it was told.
    told: Code,
}

impl Default for Streamed {
    /// None has ever come.
    fn default() -> Self {
        Self { age: u64::MAX, duration: None, silence: u64::MAX, told: Code::NONE }
    }
}

impl Streamed {
    /// A cycle without a setpoint.
    pub(super) fn pass(&mut self) {
        (self.age, self.silence) = (self.age.saturating_add(1), self.silence.saturating_add(1));
    }

    /// Is nothing told that is forgotten in time?
    pub(super) fn is_settled(&self) -> bool {
        self.told.is_none()
    }
}

impl Axis {
    /// Takes a new setpoint, and stops when none has come for too long.
    pub(super) fn follow_stream(&mut self, cx: &mut Context<'_>) {
        let timeout = self.parameters.setpoint_timeout.unsigned_abs();
        self.streamed.pass();
        if self.streamed.silence.saturating_mul(self.setup.cycle_ns) > timeout {
            self.streamed.told = Code::NONE;
        }
        let new = cx.stream.and_then(|stream| *stream.axes.get(usize::from(self.setup.index))?);
        if let Some(setpoint) = new {
            self.streamed.silence = 0;
            self.take_setpoint(cx, setpoint);
        }
        let age = self.streamed.age.saturating_mul(self.setup.cycle_ns);
        // Also one that the override holds: it is not to move once that lets it go.
        let runs = matches!(&self.generator, Generator::Plan(course) if course.aim != Aim::Stop);
        if self.reference != Reference::Stream || !runs {
            return;
        }
        if age > timeout {
            self.end_overlay(cx, Code::STREAM_TIMEOUT, NO_NUMBERS);
            self.brake_to_rest(cx, &self.parameters.usual_limits());
            cx.events.push(Event::new(Severity::Warn, Kind::Warning, self.object(), Code::STREAM_TIMEOUT));
        } else if self.streamed.duration.is_some_and(|duration| age >= duration) {
            self.stream_at(cx, 0.0);
        }
    }

    fn take_setpoint(&mut self, cx: &mut Context<'_>, Setpoint { velocity, duration }: Setpoint) {
        let mut told = Code::NONE;
        let checked = self.check_setpoint(velocity);
        if self.is_held_at_limit(velocity, &checked) {
            // What stops it goes on.
            (self.streamed.age, self.streamed.duration) = (0, duration);
            return;
        }
        let velocity = match checked {
            Ok(true) => velocity,
            Ok(false) => return,
            Err(refusal) => {
                if velocity != 0.0 && self.streamed.told != refusal.code {
                    self.streamed.told = refusal.code;
                    let event = Event::new(Severity::Warn, Kind::Warning, self.object(), refusal.code);
                    let parameter = Some(const { Row::place(STREAM) });
                    cx.events.push(Event { parameter, ..event.with(refusal.asked, refusal.limit) });
                }
                self.note_refused_at_limit(velocity, &refusal);
                let is_barred = matches!(refusal.code, Code::LIMIT_VIOLATION | Code::REVERSE_FORBIDDEN);
                if !(is_barred && self.streams()) {
                    // One that is not followed is no sign of life.
                    return;
                }
                told = refusal.code;
                0.0
            }
        };
        self.streamed = Streamed { age: 0, duration, silence: 0, told };
        if velocity != 0.0 || !self.rests() {
            // What waited to engage is not to take the axis from it.
            self.end_engagement(cx, Code::REPLACED, NO_NUMBERS);
            self.stream_at(cx, velocity);
        }
    }

    /// Does a setpoint move it?
    pub(super) fn streams(&self) -> bool {
        self.state == AxisState::ContinuousMotion && self.reference == Reference::Stream
    }

    /// May the axis follow it? Not yet, where it comes to rest by itself.
    fn check_setpoint(&self, velocity: f64) -> Result<bool, Refusal> {
        let refuse = |code, limit| Err(Refusal::new(code, self.object()).with(Number::Velocity(velocity), limit));
        self.check_closed_loop()?;
        if !velocity.is_finite() {
            // Without it: an event with NaN would not equal itself.
            return Err(Refusal::new(Code::SETPOINT_NO_NUMBER, self.object()));
        }
        self.check_free()?;
        if !self.streams() && self.state != AxisState::Standstill {
            let stops = matches!(&self.generator, Generator::Plan(course) if course.aim == Aim::Stop);
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
        let usual = self.parameters.usual_limits();
        let aim = Aim::velocity(velocity);
        let mut course = self.course(cx.cycle, from, aim, usual);
        // Turning back before a limit may take more than the usual deceleration.
        if self.check_course(&course, from, usual).is_err() {
            course = self.course(cx.cycle, from, aim, self.stop_limits());
        }
        self.owner = Owner::Native;
        self.begin_motion(cx, AxisState::ContinuousMotion, Reference::Stream, Generator::Plan(course));
    }
}
