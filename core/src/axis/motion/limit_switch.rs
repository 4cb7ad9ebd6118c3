//! Limit switches: stop an axis, and allow motion away from the switch.
//!
//! Law      an edge stops the axis unless it moves away. The level blocks every motion towards the switch, except the
//!          stop after a homing that was ended while it searched for this switch
//! Reads    the switches of this cycle and of the one before, the command of this cycle
//! Writes   the error; the reaction begins in the cycle of the edge
//! Refuses  with code 98 every motion that would begin towards an active switch
//! Source   MACS-LIM-05, MACS-LIM-07, MACS-LIM-08, MACS-LIM-09, A-16, A-17, A-56

use crate::axis::state::planned_motion::ROUNDING;
use crate::axis::state::{Aim, Axis, Context, Failure, Generator, PlannedMotion};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::position::Position;
use crate::profile::Motion;
use crate::state::AxisState;

impl Axis {
    /// Whether switches stop the axis. They do not during homing, which uses them.
    fn limits_apply(&self) -> bool {
        !self.homing.is_running()
    }

    /// Returns level, and edge in this cycle, of the switch ahead in a direction of the axis. The positive switch is at
    /// the end of rising counts, whatever the direction of the axis.
    fn switch(&self, up: bool) -> (bool, bool) {
        let rising = up == (self.turn_counts(1) > 0);
        let (now, before) = (self.observed.switches(), self.observed.switches_before());
        let (now, before) = if rising { (now.positive, before.positive) } else { (now.negative, before.negative) };
        (now, now && !before)
    }

    /// Returns the code of the switch in a direction.
    fn switch_code(&self, up: bool) -> Code {
        let rising = up == (self.turn_counts(1) > 0);
        if rising { Code::HARDWARE_LIMIT_POSITIVE } else { Code::HARDWARE_LIMIT_NEGATIVE }
    }

    /// Checks whether a motion that leads up, or down, may begin.
    fn check_switches(&self, up: bool, down: bool) -> Result<(), Refusal> {
        let barred = [(up, true), (down, false)].into_iter().find(|(moves, way)| *moves && self.switch(*way).0);
        match barred.filter(|_| self.limits_apply()) {
            Some((_, way)) => {
                let code = if self.switch(!way).0 { Code::BOTH_LIMIT_SWITCHES } else { self.switch_code(way) };
                let switch = Number::Count(i64::from(code.0));
                Err(self.refuse(Code::LIMIT_VIOLATION).with(switch, Number::None))
            }
            None => Ok(()),
        }
    }

    /// Checks that a velocity does not lead into an active switch.
    pub(in crate::axis) fn check_velocity_switches(&self, velocity: f64) -> Result<(), Refusal> {
        self.check_switches(velocity > 0.0, velocity < 0.0)
    }

    /// Checks that a course does not lead into an active switch.
    pub(in crate::axis) fn check_course_switches(&self, course: &PlannedMotion, from: Motion) -> Result<(), Refusal> {
        let (low, high) = course.extent_from(from.position);
        let rounding = Position::from_f64(ROUNDING);
        self.check_switches(high > from.position + rounding, low < from.position - rounding)
    }

    /// Stops the axis at a switch instead of the motion `next`. Returns true if it does.
    pub(super) fn stop_at_switch(&mut self, cx: &mut Context<'_>, next: Motion) -> bool {
        if !self.limits_apply() || self.status.state() == AxisState::ErrorStop {
            return false;
        }
        if !(self.observed.switches().positive || self.observed.switches().negative || self.homing.is_ending()) {
            return false;
        }
        let change = next.position - self.command.position();
        let way = if change == Position::ZERO { next.velocity } else { change.to_f64() };
        let slows = way != 0.0 && next.velocity.abs() <= self.command.velocity().abs();
        let Some(code) = self.switch_error(cx, way) else {
            if !slows {
                self.homing.forget_end();
            }
            return false;
        };
        if code == Code::LIMIT_VIOLATION && slows && self.homing.is_ending() && self.only_stops() {
            return false;
        }
        self.raise(cx, Failure::of(code).before_motion());
        true
    }

    /// Whether the motion of this cycle is only that of a stop.
    fn only_stops(&self) -> bool {
        let stops = match self.motion.generator() {
            Generator::Plan(course) => course.aim == Aim::Stop,
            // A stop that ends in this cycle.
            generator => matches!(generator, Generator::Rest),
        };
        stops && self.coupling.overlay().is_none()
    }

    /// Reports switches while an error already stops the axis, in addition to that error.
    pub(in crate::axis) fn report_switches(&mut self, cx: &mut Context<'_>) {
        if self.status.state() != AxisState::ErrorStop {
            return;
        }
        let ((upper, upper_edge), (lower, lower_edge)) = (self.switch(true), self.switch(false));
        if !(upper_edge || lower_edge) {
            return;
        }
        let code = if upper && lower { Code::BOTH_LIMIT_SWITCHES } else { self.switch_code(upper) };
        self.raise(cx, Failure::of(code).before_motion());
    }

    /// Returns the error of the switches for a motion in this direction (0 at rest).
    fn switch_error(&self, cx: &mut Context<'_>, way: f64) -> Option<Code> {
        if !self.observed.switches().positive && !self.observed.switches().negative {
            // Neither level nor edge.
            return None;
        }
        let ((upper, upper_edge), (lower, lower_edge)) = (self.switch(true), self.switch(false));
        if upper && lower && (upper_edge || lower_edge) {
            return Some(Code::BOTH_LIMIT_SWITCHES);
        }
        for (up, level, edge) in [(true, upper, upper_edge), (false, lower, lower_edge)] {
            let ahead = if up { way > 0.0 } else { way < 0.0 };
            if level && ahead {
                return Some(if edge { self.switch_code(up) } else { Code::LIMIT_VIOLATION });
            }
            if edge && way == 0.0 {
                return Some(self.switch_code(up));
            }
            if edge {
                // The axis moves away, as from a switch on which it rested: this is allowed.
                let event = Event::new(Severity::Warn, Kind::Limit, self.object(), self.switch_code(up));
                cx.events.push(Event { position: self.feedback.position(), ..event });
            }
        }
        None
    }
}
