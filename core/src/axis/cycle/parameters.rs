//! Parameters of an axis: applied by commands, and written by the axis itself.

use crate::axis::feedback::direction::{may_output_sign, may_turn_loop};
use crate::axis::loops::position::may_close_loop;
use crate::axis::state::source::may_read;
use crate::axis::state::{Axis, Context};
use crate::code::Code;
use crate::event::{Event, Kind, Number, Refusal, Severity};
use crate::parameter::{AxisParameters, Change, Value};
use crate::vocabulary::Notice;

impl Axis {
    /// Sets the parameters before its first cycle.
    pub fn begin_with(&mut self, parameters: AxisParameters) {
        self.parameters.set(parameters);
        self.observed.set_override_seen(parameters.velocity_override);
    }

    /// Returns true if it has changed parameters by itself since the last call.
    pub fn take_own_change(&mut self) -> bool {
        self.parameters.take_own_change()
    }

    /// Applies new parameters. Returns true if they mirror the axis: other copies of its position must then be
    /// mirrored, too.
    pub fn take_parameters(&mut self, parameters: AxisParameters) -> bool {
        let before = self.direction().units;
        let had_fixed_zero = self.has_fixed_zero();
        if self.parameters.invalidates_zero(&parameters) {
            self.homing.forget();
        }
        self.parameters.set(parameters);
        if had_fixed_zero && !self.is_referenced() {
            self.homing.forget_reference_of_encoder();
        }
        let turns = before != self.direction().units;
        if turns {
            self.mirror();
        }
        turns
    }

    /// Mirrors all stored positions of the axis, which is off and stays where it is.
    pub(in crate::axis) fn mirror(&mut self) {
        self.command.rest_at(-self.command.position());
        self.feedback.mirror();
        self.travel.mirror();
        self.observed.mirror();
        self.homing.turn_over();
        self.pending.touch_probes_mut().note_new_coordinate();
        self.supervision.fill(self.command.position().floor());
        self.vocabularies.notice(Notice::Turned);
    }

    /// Checks whether the axis may have these parameters.
    ///
    /// # Errors
    /// The loop of its drive cannot be inverted here, or the loop that is closed here cannot run.
    pub fn check_sense(&self, candidate: &AxisParameters) -> Result<(), Refusal> {
        self.admits_analog(candidate)?;
        let interface = self.setup.drive.map(|_| self.setup.interface);
        let wired = may_read(self.setup.wired, self.setup.encoders, interface, candidate);
        let timed = may_close_loop(interface, self.setup.law, candidate, self.setup.cycle_ns);
        let (key, code) = if let Err(refused) = wired.and(timed).and(self.may_find_velocity_with(candidate)) {
            refused
        } else if !may_turn_loop(interface, candidate) {
            ("posdrct", Code::LOOP_IN_DRIVE)
        } else if !may_output_sign(interface, candidate) {
            ("revers", Code::REVERSING_BY_POSITION)
        } else {
            return Ok(());
        };
        let (parameter, row) = crate::parameter::Row::find(key).unzip();
        let asked = match row.map(|row| row.value(candidate)) {
            Some(crate::parameter::Value::Int(value)) => Number::Count(value),
            _ => Number::None,
        };
        Err(Refusal { parameter, ..Refusal::new(code, self.object()).with(asked, Number::None) })
    }

    /// Sets parameters for the axis, or a vocabulary on it, and reports them, as results of the command if there is
    /// one. No other function does this.
    pub(in crate::axis) fn write_own(
        &mut self,
        cx: &mut Context<'_>,
        sequence: Option<u64>,
        values: impl Iterator<Item = (u16, Value)> + Clone,
    ) {
        if values.clone().next().is_none() {
            return;
        }
        self.parameters.assign(values.clone());
        for (row, value) in values {
            self.report_own_change(cx, sequence, row, value);
        }
    }

    /// Reports a parameter that the axis has set by itself.
    pub(in crate::axis) fn report_own_change(
        &self,
        cx: &mut Context<'_>,
        sequence: Option<u64>,
        row: u16,
        value: Value,
    ) {
        let event = Event::new(Severity::Info, Kind::Parameter, self.object(), Code::NONE);
        let event = sequence.map_or(event, |sequence| event.of_command(sequence));
        let number = Change { axis: self.setup.index, row, value }.number();
        cx.events.push(Event { parameter: Some(row), ..event.with(number, Number::None) });
    }
}
