//! The one door for errors: whoever finds one hands its code over here, and one table says all that the axis does.
//!
//! Law      deed = f(class of the code, error_reaction, endswmod, does the axis close its position loop here); what is done is the
//!          deed, as far as there is something left to command the axis by, and beside an error that stops it already no more than
//!          what takes its power. docs/errors.md has the table in words, and a test compares an axis with it
//! Reads    the code, parameters of the axis, what the axis wants of its drive
//! Writes   the power, the generator, the state, the brake; all in the cycle of the error
//! Source   MACS-ERR-02, MACS-ERR-03, MACS-ERR-05, MACS-LIM-08, MACS-IO-04, MACS-PROF-13

use super::power::Power;
use super::waiting::Until;
use super::{Axis, AxisState, Context, Generator, Reference};
use crate::code::{Class, Code};
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::profile::Motion;
use crate::vocabulary::{Notice, Owner};

/// Is the brake closed in the end, by this number of error_reaction (MACS-IO-04)?
pub(super) fn closes_brake(reaction: i64) -> bool {
    matches!(reaction, 1 | 3)
}

/// Does an error of this code stop all axes (MACS-ERR-05)?
pub fn stops_all(code: Code) -> bool {
    code == Code::FOLLOWING_ERROR
}

/// Where the axis is when its error comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moment {
    /// The command of this cycle is known: a stop begins with it.
    Behind,
    /// It is not known yet: a stop begins with the last one, a cycle ago.
    Before,
    /// The axis stops at a software limit, on a way of its own.
    AtLimit,
    /// A command was refused that switches the drive off with that (SAIA-ERR-04), whatever class its code has.
    Refused,
}

/// An error, as it is handed over.
#[derive(Clone, Copy, Debug)]
pub(super) struct Failure {
    code: Code,
    /// What was found, and what is allowed.
    numbers: (Number, Number),
    moment: Moment,
    /// Its cause was there in the cycle before: beside another error it is told no more.
    lasts: bool,
    /// It takes the power, whatever its reaction is.
    takes_power: bool,
}

impl Failure {
    /// One that comes behind the motion of its cycle.
    pub(super) fn of(code: Code) -> Self {
        Self { code, numbers: (Number::None, Number::None), moment: Moment::Behind, lasts: false, takes_power: false }
    }

    /// With what was found and what is allowed.
    pub(super) fn with(self, found: Number, allowed: Number) -> Self {
        Self { numbers: (found, allowed), ..self }
    }

    /// It comes before the motion of its cycle.
    pub(super) fn before_motion(self) -> Self {
        Self { moment: Moment::Before, ..self }
    }

    /// It comes because the axis stops at a software limit.
    pub(super) fn at_limit(self) -> Self {
        Self { moment: Moment::AtLimit, ..self }
    }

    /// The refusal of a command that is to switch the drive off.
    pub(super) fn of_refusal(refusal: Refusal) -> Self {
        Self { moment: Moment::Refused, ..Self::of(refusal.code).with(refusal.asked, refusal.limit) }
    }

    /// Was its cause there in the cycle before?
    pub(super) fn lasting(self, lasts: bool) -> Self {
        Self { lasts, ..self }
    }

    /// It takes the power, whatever its reaction is.
    pub(super) fn taking_power(self) -> Self {
        Self { takes_power: true, ..self }
    }

    fn class(&self) -> Class {
        match self.moment {
            Moment::Refused => Class::Command,
            _ => self.code.class().unwrap_or(Class::Parameter),
        }
    }
}

/// What an axis does for an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Deed {
    /// It goes on; the error is told.
    Report,
    /// What it does ends, it stops with max_deceleration, and takes goals.
    End,
    /// No voltage at once.
    Off { brake: bool },
    /// No voltage; one that stands leaves its load to its own brake first.
    LetGo { brake: bool },
    /// The drive stops by itself.
    DriveStops,
    /// It stops with max_deceleration; then what this number of error_reaction says.
    Stop { then: i64 },
    /// Nothing here holds it: its drive stops it, its power goes, and the brake closes if this number of error_reaction says so.
    LeaveToDrive { then: i64 },
}

impl Deed {
    /// The table.
    fn of(class: Class, reaction: i64, endswmod: i64, closes_loop: bool) -> Self {
        let by_parameter = match reaction {
            0 => Self::Off { brake: false },
            1 => Self::Off { brake: true },
            4 => Self::DriveStops,
            5 => Self::Report,
            stops => Self::Stop { then: stops },
        };
        let ending = if by_parameter == Self::Report { Self::Stop { then: 2 } } else { by_parameter };
        match class {
            Class::NoError | Class::Parameter | Class::Skew => by_parameter,
            Class::Search if by_parameter == Self::Report => Self::End,
            Class::Search => by_parameter,
            Class::Ends => ending,
            Class::Switch if endswmod == 1 => Self::Stop { then: 2 },
            Class::Switch => ending,
            Class::SoftwareLimit => Self::Stop { then: reaction },
            Class::Feedback if closes_loop => Self::Off { brake: reaction != 0 },
            Class::Feedback => ending,
            Class::Drive => Self::Off { brake: closes_brake(reaction) },
            Class::Command => Self::LetGo { brake: closes_brake(reaction) },
            Class::Interlock => Self::Stop { then: if reaction == 3 { 3 } else { 2 } },
            Class::EmergencyStop => Self::Stop { then: 1 },
        }
    }

    /// The same once the axis has stopped.
    fn behind_stop(self) -> Self {
        let then = match self {
            Self::Stop { then } | Self::LeaveToDrive { then } => then,
            Self::Off { brake } | Self::LetGo { brake } => i64::from(brake),
            Self::DriveStops | Self::Report | Self::End => 4,
        };
        Self::Stop { then }
    }
}

impl Axis {
    fn deed(&self, class: Class) -> Deed {
        let p = &self.parameters;
        let reaction = if class == Class::Skew { p.gantry.skew_reaction } else { p.error_reaction };
        Deed::of(class, reaction, p.supervision.endswmod, self.closes_loop_here())
    }

    /// Does an error of this code stop nothing?
    pub(super) fn only_reports(&self, code: Code) -> bool {
        self.deed(Failure::of(code).class()) == Deed::Report
    }

    /// The deed as far as there is something left to command the axis by.
    fn possible(&self, deed: Deed, moment: Moment) -> Deed {
        match deed {
            Deed::Report | Deed::End => deed,
            Deed::Stop { then } if self.is_left_to_drive() => Deed::LeaveToDrive { then },
            Deed::DriveStops if self.is_left_to_drive() => Deed::LeaveToDrive { then: 4 },
            _ if moment == Moment::AtLimit => deed.behind_stop(),
            // There is no power that could go, and no drive.
            _ if self.is_virtual() => deed.behind_stop(),
            // While it is being switched off it only stops, and then is.
            Deed::DriveStops if self.is_on() && !self.is_at_work() => deed.behind_stop(),
            // One that is not on yet is not to come on.
            Deed::DriveStops if !self.is_on() => Deed::Off { brake: false },
            Deed::Stop { then } if !self.is_on() => Deed::Off { brake: closes_brake(then) },
            _ => deed,
        }
    }

    /// The door: the whole reaction to an error, in its cycle.
    #[cold]
    pub(super) fn raise(&mut self, cx: &mut Context<'_>, failure: Failure) {
        let class = failure.class();
        let deed = match self.deed(class) {
            Deed::Off { brake } => Deed::Off { brake },
            _ if failure.takes_power => Deed::Off { brake: closes_brake(self.parameters.gantry.skew_reaction) },
            Deed::Report if failure.lasts && !self.alarm.is_none() => return,
            deed => deed,
        };
        if self.state == AxisState::ErrorStop {
            return self.raise_beside(cx, failure, class, deed);
        }
        self.stops_others |= stops_all(failure.code) && self.parameters.supervision.following_error_stops_all == 1;
        let deed = self.possible(deed, failure.moment);
        self.record(cx, failure);
        if deed == Deed::Report {
            return;
        }
        self.end_all(cx, failure);
        match deed {
            Deed::Report => {}
            Deed::End => return self.brake_to_rest(cx, &self.stop_limits()),
            Deed::Off { brake } => self.take_power(failure.code, class, brake),
            Deed::LetGo { brake } => {
                self.set_state(cx, AxisState::ErrorStop);
                self.ask_for_brake(brake);
                self.let_go(cx);
            }
            Deed::DriveStops => {
                self.power = Power::DriveStops { since: cx.cycle, then_off: self.creeps() };
                self.stand_on_actual();
            }
            Deed::LeaveToDrive { then } => {
                self.leave_to_drive(cx);
                self.judge.after_stop = self.behind_abort(then);
            }
            Deed::Stop { then } => {
                if failure.moment != Moment::AtLimit || self.is_open_loop() {
                    self.brake_to_rest(cx, &self.stop_limits());
                }
                self.judge.after_stop = self.behind_abort(then);
            }
        }
        self.set_state(cx, AxisState::ErrorStop);
        if let (Moment::Before, Generator::Plan(course)) = (failure.moment, &mut self.generator) {
            course.begin_earlier();
            self.command = course.at(cx.cycle);
        }
    }

    /// What this number of error_reaction is where an abort was to close a brake: it is closed all the same.
    fn behind_abort(&self, then: i64) -> i64 {
        match then {
            2 | 5 if closes_brake(self.judge.after_stop) => 3,
            0 | 4 if closes_brake(self.judge.after_stop) => 1,
            _ => then,
        }
    }

    /// An error beside one that stops the axis already: that stands, and is answered.
    fn raise_beside(&mut self, cx: &mut Context<'_>, failure: Failure, class: Class, deed: Deed) {
        match (class, deed) {
            // What was to stop it cannot any more.
            (Class::Drive | Class::Feedback | Class::Skew, Deed::Off { brake }) => {
                self.end_all(cx, failure);
                self.tell_beside(cx, failure);
                self.take_power(failure.code, class, brake);
            }
            (Class::Command, Deed::LetGo { brake }) => {
                self.end_all(cx, failure);
                self.ask_for_brake(brake);
                self.let_go(cx);
            }
            (Class::EmergencyStop, _) => {
                if !failure.lasts {
                    self.tell_beside(cx, failure);
                }
                // What stops it may leave it under power, and so may a drive that has stopped by itself.
                self.judge.after_stop = 1;
                if matches!(self.power, Power::DriveStops { .. }) && self.has_stopped_by_itself(cx.cycle) {
                    self.power = Power::Off;
                    self.brake = true;
                }
            }
            (Class::Switch, _) => self.tell_beside(cx, failure),
            (Class::Skew, _) if !failure.lasts => self.tell_beside(cx, failure),
            _ => {}
        }
    }

    /// Keeps the first error and tells it; behind one that stopped nothing it is told beside that.
    fn record(&mut self, cx: &mut Context<'_>, failure: Failure) {
        let Failure { code, numbers: (found, allowed), .. } = failure;
        if !self.alarm.is_none() {
            return self.tell_beside(cx, failure);
        }
        self.alarm.set((found, allowed), self.fault_of(cx.cycle, code));
        // A reset that waits was meant for what was there before.
        self.waiting.fail_with(cx.events, self.setup.index, code, Until::Healthy, (found, allowed));
        self.tell_error(cx, failure);
    }

    /// The first error stands; another one that stops the axis, which the first did not, or takes its power, is told beside it.
    fn tell_beside(&self, cx: &mut Context<'_>, failure: Failure) {
        if self.alarm.code() != failure.code || failure.takes_power {
            self.tell_error(cx, failure);
        }
    }

    /// Tells it.
    pub(super) fn tell_error(&self, cx: &mut Context<'_>, Failure { code, numbers: (found, allowed), .. }: Failure) {
        let event = Event::new(Severity::Error, Kind::Error, self.object(), code).with(found, allowed);
        cx.events.push(Event { position: self.actual.position, ..event });
    }

    /// Ends what runs.
    fn end_all(&mut self, cx: &mut Context<'_>, failure: Failure) {
        self.reference = Reference::Stop;
        if self.owner != Owner::Native {
            self.lost = Some((cx.cycle, self.owner));
        }
        self.abandon_with(cx, failure.code, failure.numbers);
    }

    /// No voltage from this cycle on.
    fn take_power(&mut self, code: Code, class: Class, brake: bool) {
        if class == Class::Drive && code.is_alarm() && self.alarm.code() == code {
            self.vocabularies.notice(Notice::Alarm((code.0 % 100) as u8));
        }
        // Nothing stops it any more: a brake that was to close once it stands closes now (MACS-IO-04).
        self.ask_for_brake(brake || closes_brake(self.judge.after_stop));
        self.power = Power::Off;
        self.stand_on_actual();
    }

    /// Stops it because of another axis' error, in the same cycle, after its own step.
    pub fn stop_with_other(&mut self, cx: &mut Context<'_>, other: u16) {
        // Its actual position is read, its command may be that of a stop now.
        let concerned = self.is_on() || matches!(self.power, Power::SwitchingOn { .. });
        if self.is_virtual() || !concerned || self.state == AxisState::ErrorStop {
            return;
        }
        self.raise(cx, Failure::of(Code::STOPPED_WITH_OTHER).with(Number::Count(other.into()), Number::None));
        self.stops_others = false;
        self.settle_step(cx);
    }

    /// Has an error of this cycle to stop the others?
    pub fn stops_others(&self) -> bool {
        self.stops_others
    }

    /// On, and not on its way to being off.
    fn is_at_work(&self) -> bool {
        matches!(self.power, Power::On | Power::Opening { .. })
    }

    /// Would it not stay where its drive has stopped it? No voltage is 0 V.
    pub(super) fn creeps(&self) -> bool {
        self.setup.analog.is_some()
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
            // A virtual axis has none but the one that o_brake names (MACS-IO-04).
            1 => self.ask_for_brake(self.parameters.outputs.brake != 0),
            3 => self.ask_for_brake(true),
            4 if has_drive && self.is_at_work() => {
                self.power = Power::DriveStops { since: cycle, then_off: self.creeps() };
            }
            _ => {}
        }
    }
}
