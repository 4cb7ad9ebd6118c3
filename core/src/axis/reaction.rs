//! What an error does to its axis: one table.
//!
//! Law      reaction = f(class of the code, error_reaction, endswmod); every code that can be the error of an axis has its line,
//!          but a refusal that saia.command_error makes an error, which switches the drive off
//! Reads    the code, parameters of the axis
//! Writes   the power, the generator, the state; all in the cycle of the error
//! Source   MACS-ERR-02, MACS-ERR-03, MACS-ERR-05, MACS-LIM-08, MACS-PROF-13

use super::power::Power;
use super::{Axis, AxisState, Context, Generator};
use crate::code::{Class, Code};
use crate::event::Number;
use crate::profile::Motion;

/// Is the brake closed in the end, by this number of error_reaction (MACS-IO-04)?
pub(super) fn closes_brake(reaction: i64) -> bool {
    matches!(reaction, 1 | 3)
}

/// Does an error of this code stop all axes (MACS-ERR-05)?
pub fn stops_all(code: Code) -> bool {
    code == Code::FOLLOWING_ERROR
}

/// What an axis does for an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Deed {
    /// It goes on; the error is told.
    Report,
    /// No voltage at once.
    Off { brake: bool },
    /// The drive stops by itself.
    DriveStops,
    /// It stops with max_deceleration; then what this number of error_reaction says.
    Stop { then: i64 },
}

impl Deed {
    fn of_parameter(reaction: i64) -> Self {
        match reaction {
            0 => Self::Off { brake: false },
            1 => Self::Off { brake: true },
            4 => Self::DriveStops,
            5 => Self::Report,
            stops => Self::Stop { then: stops },
        }
    }

    /// Nothing goes on.
    fn ending(self) -> Self {
        if self == Self::Report { Self::Stop { then: 2 } } else { self }
    }
}

impl Axis {
    fn deed(&self, code: Code) -> Deed {
        let reaction = self.parameters.error_reaction;
        let by_parameter = Deed::of_parameter(reaction);
        match code.class().unwrap_or(Class::Parameter) {
            Class::NoError | Class::Parameter | Class::Search => by_parameter,
            Class::Ends => by_parameter.ending(),
            Class::Switch if self.parameters.supervision.endswmod == 1 => Deed::Stop { then: 2 },
            Class::Switch => by_parameter.ending(),
            Class::SoftwareLimit => Deed::Stop { then: reaction },
            Class::Feedback if self.closes_loop_here() => Deed::Off { brake: reaction != 0 },
            Class::Feedback => by_parameter.ending(),
            Class::Drive | Class::Command => Deed::Off { brake: closes_brake(reaction) },
            Class::Interlock => Deed::Stop { then: if reaction == 3 { 3 } else { 2 } },
            Class::EmergencyStop => Deed::Stop { then: 1 },
        }
    }

    /// Does an error of this code stop nothing?
    pub(super) fn only_reports(&self, code: Code) -> bool {
        self.deed(code) == Deed::Report
    }

    /// The reaction to an error that leaves the drive in operation. A motion ends from the command of this cycle on.
    pub(super) fn react(&mut self, cx: &mut Context<'_>, code: Code, found: Number, allowed: Number) {
        self.stops_others |= stops_all(code) && self.parameters.supervision.following_error_stops_all == 1;
        let deed = self.deed(code);
        if deed == Deed::Report {
            return self.report(cx, code, found, allowed);
        }
        self.raise(cx, code, found, allowed);
        match deed {
            Deed::Off { brake } if !self.is_virtual() => {
                self.power = Power::Off;
                self.ask_for_brake(brake || closes_brake(self.judge.after_stop));
                self.stand_on_actual();
            }
            // While it is being switched off it only stops, and then is.
            Deed::DriveStops if !self.is_virtual() && self.is_at_work() => {
                self.power = Power::DriveStops { since: cx.cycle, then_off: false };
                self.stand_on_actual();
            }
            // One that is not on yet is not to come on.
            _ if !self.is_on() && !self.is_virtual() => {
                self.brake = matches!(deed, Deed::Stop { then: 1 | 3 });
                self.switch_off(cx);
            }
            _ => {
                self.brake_to_rest(cx, &self.stop_limits());
                let then = self.after_stop_of(code);
                // A brake that an abort was to close is closed all the same.
                self.judge.after_stop = match then {
                    2 | 5 if closes_brake(self.judge.after_stop) => 3,
                    0 | 4 if closes_brake(self.judge.after_stop) => 1,
                    _ => then,
                };
            }
        }
        self.set_state(cx, AxisState::ErrorStop);
    }

    /// As [`react`](Self::react), before the command of this cycle is known: a stop begins with the last one, a cycle ago.
    pub(super) fn react_at_once(&mut self, cx: &mut Context<'_>, code: Code, found: Number, allowed: Number) {
        self.react(cx, code, found, allowed);
        if let Generator::Plan(course) = &mut self.generator {
            course.begin_earlier();
            self.command = course.at(cx.cycle);
        }
    }

    /// Stops it because of another axis' error, in the same cycle, after its own step.
    pub fn stop_with_other(&mut self, cx: &mut Context<'_>, other: u16) {
        // Its actual position is read, its command may be that of a stop now.
        let concerned = self.is_on() || matches!(self.power, Power::SwitchingOn { .. });
        if self.is_virtual() || !concerned || self.state == AxisState::ErrorStop {
            return;
        }
        self.react(cx, Code::STOPPED_WITH_OTHER, Number::Count(other.into()), Number::None);
        self.stops_others = false;
        self.settle_step(cx);
    }

    /// Has an error of this cycle to stop the others?
    pub fn stops_others(&self) -> bool {
        self.stops_others
    }

    /// What is left to do for an error once the axis stands, as a number of error_reaction.
    pub(super) fn after_stop_of(&self, code: Code) -> i64 {
        match self.deed(code) {
            Deed::Stop { then } => then,
            Deed::Off { brake } => i64::from(brake),
            Deed::DriveStops | Deed::Report => 4,
        }
    }

    /// On, and not on its way to being off.
    fn is_at_work(&self) -> bool {
        matches!(self.power, Power::On | Power::Opening { .. })
    }

    pub(super) fn closes_loop_here(&self) -> bool {
        use crate::drive::Interface::{Torque, Velocity};
        matches!(self.setup.interface, Velocity | Torque)
    }

    pub(super) fn stand_on_actual(&mut self) {
        self.generator = Generator::Rest;
        self.command = Motion::at_rest(self.actual.position);
    }

    /// Is there something left to do for an error once the axis stands, which still moves?
    pub(super) fn is_finishing_stop(&self) -> bool {
        matches!(self.judge.after_stop, 0 | 1 | 3) && self.is_on()
    }

    /// What an error reaction leaves to do once the axis stands; its command does.
    pub(super) fn finish_stop(&mut self, cycle: u64) {
        if self.is_finishing_stop() && !self.has_come_to_rest(cycle) {
            return;
        }
        let reaction = std::mem::replace(&mut self.judge.after_stop, -1);
        let has_drive = !self.is_virtual();
        match reaction {
            0 | 1 if has_drive => {
                self.give_to_brake(cycle);
                self.ask_for_brake(reaction == 1);
            }
            3 => self.ask_for_brake(true),
            4 if has_drive && self.is_at_work() => self.power = Power::DriveStops { since: cycle, then_off: false },
            _ => {}
        }
    }
}
