//! Reactions to errors. Every error passes through [`Axis::raise`], and one table defines the reaction of the axis.
//!
//! Law      reaction = f(class of the code, error_reaction, endswmod, whether the axis closes its position loop here).
//!          The reaction is executed as far as the axis can still be commanded. While an error already stops the axis,
//!          a further error can only remove its power. docs/errors.md has the table in words, and a test compares an
//!          axis with it
//! Reads    the code, parameters of the axis, its power state
//! Writes   the power, the generator, the state, the brake; all in the cycle of the error
//! Source   MACS-ERR-02, MACS-ERR-03, MACS-ERR-05, MACS-LIM-08, MACS-IO-04, MACS-PROF-13

use crate::axis::state::failure::closes_brake;
use crate::axis::state::waiting::Until;
use crate::axis::state::{Axis, Context, Failure, Moment, Power};
use crate::code::{Class, Code};
use crate::event::{Event, Kind, Number, Severity};
use crate::state::AxisState;
use crate::vocabulary::Notice;

/// Whether an error of this code stops all axes (MACS-ERR-05).
pub fn stops_all(code: Code) -> bool {
    code == Code::FOLLOWING_ERROR
}

/// Reaction of an axis to an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reaction {
    /// Only reports the error.
    Report,
    /// Ends the goal and stops with max_deceleration; the axis then accepts goals.
    End,
    /// Removes the power at once.
    Off { brake: bool },
    /// Removes the power; an axis at rest closes its own brake first.
    OffAfterBrake { brake: bool },
    /// The drive stops by itself.
    DriveStops,
    /// Stops with max_deceleration; then executes this value of error_reaction.
    Stop { then: i64 },
    /// No loop here holds the axis: its drive stops it, its power is removed, and the brake closes if this value of
    /// error_reaction requires it.
    LeaveToDrive { then: i64 },
}

impl Reaction {
    /// Returns the reaction by the table.
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
            Class::Command => Self::OffAfterBrake { brake: closes_brake(reaction) },
            Class::Interlock => Self::Stop { then: if reaction == 3 { 3 } else { 2 } },
            Class::EmergencyStop => Self::Stop { then: 1 },
        }
    }

    /// Returns the same reaction for after a stop.
    fn after_stop(self) -> Self {
        let then = match self {
            Self::Stop { then } | Self::LeaveToDrive { then } => then,
            Self::Off { brake } | Self::OffAfterBrake { brake } => i64::from(brake),
            Self::DriveStops | Self::Report | Self::End => 4,
        };
        Self::Stop { then }
    }
}

impl Axis {
    fn reaction_to(&self, class: Class) -> Reaction {
        let p = &self.parameters;
        let reaction = if class == Class::Skew { p.gantry.skew_reaction } else { p.error_reaction };
        Reaction::of(class, reaction, p.supervision.endswmod, self.closes_loop_here())
    }

    /// Whether an error of this code stops nothing.
    pub(super) fn only_reports(&self, code: Code) -> bool {
        self.reaction_to(Failure::of(code).class()) == Reaction::Report
    }

    /// Returns the reaction as far as the axis can still be commanded.
    fn as_far_as_possible(&self, deed: Reaction, moment: Moment) -> Reaction {
        match deed {
            Reaction::Report | Reaction::End => deed,
            Reaction::Stop { then } if self.drive_stops_axis() => Reaction::LeaveToDrive { then },
            Reaction::DriveStops if self.drive_stops_axis() => Reaction::LeaveToDrive { then: 4 },
            _ if moment == Moment::AtLimit => deed.after_stop(),
            // There is neither power nor a drive.
            _ if self.is_virtual() => deed.after_stop(),
            // While it is being switched off, the axis stops and is then switched off.
            Reaction::DriveStops if self.is_on() && !self.is_operating() => deed.after_stop(),
            // An axis that is not on yet must not be switched on.
            Reaction::DriveStops if !self.is_on() => Reaction::Off { brake: false },
            Reaction::Stop { then } if !self.is_on() => Reaction::Off { brake: closes_brake(then) },
            _ => deed,
        }
    }

    /// Executes the whole reaction to an error in its cycle. Every error passes through this function.
    #[cold]
    pub(in crate::axis) fn raise(&mut self, cx: &mut Context<'_>, failure: Failure) {
        let class = failure.class();
        let deed = match self.reaction_to(class) {
            Reaction::Off { brake } => Reaction::Off { brake },
            _ if failure.takes_power => Reaction::Off { brake: closes_brake(self.parameters.gantry.skew_reaction) },
            Reaction::Report if failure.lasts && !self.alarm.is_none() => return,
            deed => deed,
        };
        if self.status.state() == AxisState::ErrorStop {
            return self.raise_further(cx, failure, class, deed);
        }
        self.alarm.stop_others(stops_all(failure.code) && self.parameters.supervision.following_error_stops_all == 1);
        let deed = self.as_far_as_possible(deed, failure.moment);
        self.record(cx, failure);
        if deed == Reaction::Report {
            return;
        }
        self.end_all(cx, failure);
        match deed {
            Reaction::Report => {}
            Reaction::End => return self.brake_to_rest(cx, &self.stop_limits()),
            Reaction::Off { brake } => self.take_power(failure.code, class, brake),
            Reaction::OffAfterBrake { brake } => {
                self.set_state(cx, AxisState::ErrorStop);
                self.request_brake(brake);
                self.switch_off_with_brake(cx);
            }
            Reaction::DriveStops => {
                self.status.set_power(Power::DriveStops { since: cx.cycle, then_off: self.creeps() });
                self.command_actual_position();
            }
            Reaction::LeaveToDrive { then } => {
                self.let_drive_stop(cx);
                self.supervision.react_after_stop(self.with_brake_of_abort(then));
            }
            Reaction::Stop { then } => {
                if failure.moment != Moment::AtLimit || self.is_open_loop() {
                    self.brake_to_rest(cx, &self.stop_limits());
                }
                self.supervision.react_after_stop(self.with_brake_of_abort(then));
            }
        }
        self.set_state(cx, AxisState::ErrorStop);
        if failure.moment == Moment::Before
            && let Some(motion) = self.motion.begin_earlier(cx.cycle)
        {
            self.command.execute(motion);
        }
    }

    /// Returns this value of error_reaction, combined with a brake that an abort was to close.
    fn with_brake_of_abort(&self, then: i64) -> i64 {
        match then {
            2 | 5 if closes_brake(self.supervision.after_stop()) => 3,
            0 | 4 if closes_brake(self.supervision.after_stop()) => 1,
            _ => then,
        }
    }

    /// Handles an error while another one already stops the axis: the first error remains active.
    fn raise_further(&mut self, cx: &mut Context<'_>, failure: Failure, class: Class, deed: Reaction) {
        match (class, deed) {
            // The axis can no longer be stopped as planned.
            (Class::Drive | Class::Feedback | Class::Skew, Reaction::Off { brake }) => {
                self.end_all(cx, failure);
                self.report_further(cx, failure);
                self.take_power(failure.code, class, brake);
            }
            (Class::Command, Reaction::OffAfterBrake { brake }) => {
                self.end_all(cx, failure);
                self.request_brake(brake);
                self.switch_off_with_brake(cx);
            }
            (Class::EmergencyStop, _) => {
                if !failure.lasts {
                    self.report_further(cx, failure);
                }
                // The present stop, or a drive that has stopped by itself, may leave the axis under power.
                self.supervision.react_after_stop(1);
                if matches!(self.status.power(), Power::DriveStops { .. }) && self.has_stopped_by_itself(cx.cycle) {
                    self.status.set_power(Power::Off);
                    self.status.request_brake(true);
                }
            }
            (Class::Switch, _) => self.report_further(cx, failure),
            (Class::Skew, _) if !failure.lasts => self.report_further(cx, failure),
            _ => {}
        }
    }

    /// Sets and reports the first error; a later one is only reported.
    fn record(&mut self, cx: &mut Context<'_>, failure: Failure) {
        let Failure { code, numbers: (found, allowed), .. } = failure;
        if !self.alarm.is_none() {
            return self.report_further(cx, failure);
        }
        self.alarm.set((found, allowed), self.fault_of(cx.cycle, code));
        // A waiting reset was meant for the state before.
        self.pending.waiting_mut().fail_with(cx.events, self.setup.index, code, Until::Healthy, (found, allowed));
        self.report_error(cx, failure);
    }

    /// Reports a further error; the first one remains active. A repeated code is reported only if it removes the power.
    fn report_further(&self, cx: &mut Context<'_>, failure: Failure) {
        if self.alarm.code() != failure.code || failure.takes_power {
            self.report_error(cx, failure);
        }
    }

    /// Reports the error.
    pub(super) fn report_error(&self, cx: &mut Context<'_>, Failure { code, numbers: (found, allowed), .. }: Failure) {
        let event = Event::new(Severity::Error, Kind::Error, self.object(), code).with(found, allowed);
        cx.events.push(Event { position: self.feedback.position(), ..event });
    }

    /// Ends all active motions.
    fn end_all(&mut self, cx: &mut Context<'_>, failure: Failure) {
        self.status.end_reference();
        self.alarm.note_lost(cx.cycle, self.status.owner());
        self.end_all_motion_with(cx, failure.code, failure.numbers);
    }

    /// Removes the power from this cycle on.
    fn take_power(&mut self, code: Code, class: Class, brake: bool) {
        if class == Class::Drive && code.is_alarm() && self.alarm.code() == code {
            self.vocabularies.notice(Notice::Alarm((code.0 % 100) as u8));
        }
        // Nothing stops the axis any more: a brake that was to close at rest closes now (MACS-IO-04).
        self.request_brake(brake || closes_brake(self.supervision.after_stop()));
        self.status.set_power(Power::Off);
        self.command_actual_position();
    }

    /// Stops the axis because of the error of another axis, in the same cycle, after its own step.
    pub fn stop_with_other(&mut self, cx: &mut Context<'_>, other: u16) {
        // Its actual position is known, its command may already be that of a stop.
        let concerned = self.is_on() || matches!(self.status.power(), Power::SwitchingOn { .. });
        if self.is_virtual() || !concerned || self.status.state() == AxisState::ErrorStop {
            return;
        }
        self.raise(cx, Failure::of(Code::STOPPED_WITH_OTHER).with(Number::Count(other.into()), Number::None));
        self.alarm.let_others_continue();
        self.settle_step(cx);
    }

    /// Whether an error of this cycle stops the other axes.
    pub fn stops_others(&self) -> bool {
        self.alarm.stops_others()
    }

    /// Whether the axis is on and is not being switched off.
    fn is_operating(&self) -> bool {
        matches!(self.status.power(), Power::On | Power::Opening { .. })
    }

    /// Whether the axis may not stay where its drive has stopped it: 0 V is not standstill.
    pub(in crate::axis) fn creeps(&self) -> bool {
        self.setup.analog.is_some()
    }

    pub(in crate::axis) fn command_actual_position(&mut self) {
        self.motion.rest();
        self.command.rest_at(self.feedback.position());
    }

    /// Whether an error reaction waits for the axis, which still moves, to come to rest.
    pub(in crate::axis) fn is_finishing_stop(&self) -> bool {
        matches!(self.supervision.after_stop(), 0 | 1 | 3) && self.is_on()
    }

    /// Executes the rest of an error reaction once the command is at rest.
    pub(super) fn finish_stop(&mut self, cycle: u64) {
        if self.is_finishing_stop() && !self.has_settled_or_timed_out(cycle) {
            return;
        }
        let reaction = self.supervision.take_after_stop();
        let has_drive = !self.is_virtual();
        match reaction {
            0 | 1 if has_drive => {
                self.switch_off_after_brake(cycle);
                self.request_brake(reaction == 1);
            }
            // A virtual axis has no brake but that of o_brake (MACS-IO-04).
            1 => self.request_brake(self.parameters.outputs.brake != 0),
            3 => self.request_brake(true),
            4 if has_drive && self.is_operating() => {
                self.status.set_power(Power::DriveStops { since: cycle, then_off: self.creeps() });
            }
            _ => {}
        }
    }
}
