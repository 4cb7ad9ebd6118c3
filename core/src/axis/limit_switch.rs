//! Limit switches: they stop an axis, and leave it the way back.
//!
//! Law      an edge stops the axis unless it moves away; the level blocks every motion towards the switch, but for the way in
//!          which it brakes on the switch that its homing had sought until something ended that
//! Reads    the switches of this cycle and of the one before, the command of this cycle
//! Writes   the error; the reaction begins in the cycle of the edge
//! Refuses  with code 98 what would begin towards an actuated switch
//! Source   MACS-LIM-05, MACS-LIM-07, MACS-LIM-08, MACS-LIM-09, A-16, A-17, A-56

use super::course::{Aim, Course, ROUNDING};
use super::reaction::Failure;
use super::{Axis, AxisState, Context, Generator};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::position::Position;
use crate::profile::Motion;

impl Axis {
    /// Do switches stop it? Not while it looks for its zero: that uses them.
    pub(super) fn limits_apply(&self) -> bool {
        !self.homing.is_running()
    }

    /// The switch ahead in a direction of the user: its level, and its edge in this cycle. The positive one stands at the end
    /// of rising counts, whatever the sense of the user's units.
    fn switch(&self, up: bool) -> (bool, bool) {
        let rising = up == (self.turn_counts(1) > 0);
        let (now, before) = (self.switches, self.switches_before);
        let (now, before) = if rising { (now.positive, before.positive) } else { (now.negative, before.negative) };
        (now, now && !before)
    }

    /// The code of the switch in a direction.
    fn switch_code(&self, up: bool) -> Code {
        let rising = up == (self.turn_counts(1) > 0);
        if rising { Code::HARDWARE_LIMIT_POSITIVE } else { Code::HARDWARE_LIMIT_NEGATIVE }
    }

    /// May a motion begin that leads up and down as told?
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

    /// A velocity does not lead into an actuated switch.
    pub(super) fn check_velocity_switches(&self, velocity: f64) -> Result<(), Refusal> {
        self.check_switches(velocity > 0.0, velocity < 0.0)
    }

    /// A course does not lead into an actuated switch.
    pub(super) fn check_course_switches(&self, course: &Course, from: Motion) -> Result<(), Refusal> {
        let (low, high) = course.extent_from(from.position);
        let rounding = Position::from_f64(ROUNDING);
        self.check_switches(high > from.position + rounding, low < from.position - rounding)
    }

    /// Stops the axis at a switch instead of the motion `next`; true where it does.
    pub(super) fn stop_at_switch(&mut self, cx: &mut Context<'_>, next: Motion) -> bool {
        if !self.limits_apply() || self.state == AxisState::ErrorStop {
            return false;
        }
        if !(self.switches.positive || self.switches.negative || self.homing.is_ending()) {
            return false;
        }
        let change = next.position - self.command.position;
        let way = if change == Position::ZERO { next.velocity } else { change.to_f64() };
        let slows = way != 0.0 && next.velocity.abs() <= self.command.velocity.abs();
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

    /// Is the way of this cycle that of a stop, and of nothing else?
    fn only_stops(&self) -> bool {
        let stops = match &self.generator {
            Generator::Plan(course) => course.aim == Aim::Stop,
            // A stop that ends in this cycle.
            generator => matches!(generator, Generator::Rest),
        };
        stops && self.overlay.is_none()
    }

    /// What a switch has to tell while an error stops the axis already: it stands beside that.
    pub(super) fn tell_switches(&mut self, cx: &mut Context<'_>) {
        if self.state != AxisState::ErrorStop {
            return;
        }
        let ((upper, upper_edge), (lower, lower_edge)) = (self.switch(true), self.switch(false));
        if !(upper_edge || lower_edge) {
            return;
        }
        let code = if upper && lower { Code::BOTH_LIMIT_SWITCHES } else { self.switch_code(upper) };
        self.raise(cx, Failure::of(code).before_motion());
    }

    /// The error that the switches make of a motion in this direction (0 at rest).
    fn switch_error(&self, cx: &mut Context<'_>, way: f64) -> Option<Code> {
        if !self.switches.positive && !self.switches.negative {
            // No level, no edge.
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
                // It moves away, as from the switch on which it stood: that is its way back.
                let event = Event::new(Severity::Warn, Kind::Limit, self.object(), self.switch_code(up));
                cx.events.push(Event { position: self.actual.position, ..event });
            }
        }
        None
    }
}
