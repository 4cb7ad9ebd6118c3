//! Streamed setpoints: the newest velocity holds until the next one, and for no longer than setpoint_timeout.

use super::course::Aim;
use super::power::Power;
use super::{Axis, AxisState, Context, Generator, Reference};
use crate::code::Code;
use crate::event::{Event, Kind, Severity};
use crate::vocabulary::Owner;

impl Axis {
    /// Takes the newest streamed velocity, and stops when none has come for too long.
    pub(super) fn follow_stream(&mut self, cx: &mut Context<'_>) {
        if self.is_open_loop() {
            return self.refuse_stream(cx);
        }
        let streams = self.state == AxisState::ContinuousMotion && self.reference == Reference::Stream;
        let free = self.state == AxisState::Standstill || streams;
        let newest = cx.stream.filter(|stream| stream.generation != self.stream_generation);
        let wanted = newest.and_then(|stream| *stream.velocity.get(usize::from(self.setup.index))?);
        self.stream_age = self.stream_age.saturating_add(1);
        if let Some(stream) = newest {
            self.stream_generation = stream.generation;
        }
        // NaN fails the comparison: a bad setpoint is no sign of life.
        if let Some(velocity) = wanted
            && free
            && self.power == Power::On
            && velocity.abs() <= self.velocity_for_base()
            && self.check_forward(velocity).is_ok()
        {
            self.stream_age = 0;
            if velocity != 0.0 || !self.rests() {
                self.stream_at(cx, velocity);
            }
        }
        let timeout = self.parameters.setpoint_timeout.unsigned_abs();
        let silent = self.stream_age.saturating_mul(self.setup.cycle_ns) > timeout;
        // Also one that the override holds: it is not to move once that lets it go.
        let runs = matches!(&self.generator, Generator::Plan(course) if course.aim != Aim::Stop);
        if self.reference == Reference::Stream && runs && silent {
            self.end_overlay(cx, Code::STREAM_TIMEOUT);
            self.brake_to_rest(cx, &self.parameters.usual_limits());
            cx.events.push(Event::new(Severity::Warn, Kind::Warning, self.object(), Code::STREAM_TIMEOUT));
        }
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
        self.generator = Generator::Plan(course);
        self.reference = Reference::Stream;
        self.owner = Owner::Native;
        self.set_state(cx, AxisState::ContinuousMotion);
    }
}
