//! The parameters of an axis in force, with what every cycle would else compute of them anew.
//!
//! Law      `derived` is [`Derived::of`] the values, whoever has written them: there is one way to write, [`InForce::write`]
//! Reads    the values, as an [`AxisParameters`]; methods of the same name as those of its values answer from what is kept
//! Writes   its values, and whether the axis itself has changed some in this cycle

use super::master::Grid;
use super::{Axis, Context, judge};
use crate::code::Code;
use crate::encoder::source::{Feedback, Master};
use crate::event::{Event, Kind, Number, Severity};
use crate::parameter::{AxisParameters, Change, ROWS, Reversing, Sense, Value, ValuesByAxis};
use crate::position::Position;
use crate::profile::Limits;
use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// What follows from parameters alone and is asked for in every cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Derived {
    pub sense: Sense,
    pub reversing: Reversing,
    pub master: Option<Master>,
    /// ENCODERTYPE is that of an absolute encoder.
    pub is_absolute: bool,
    /// How far an encoder that stands may tremble or creep.
    pub slack: Position,
    /// The software limits, or the ends of all positions.
    pub low: i64,
    pub high: i64,
    /// How finely it shows its master.
    pub grid: Grid,
    pub largest: Limits,
}

impl Derived {
    fn of(values: &AxisParameters) -> Self {
        let chosen = Feedback::decode(values.encoder.encodertype);
        Self {
            sense: values.sense(),
            reversing: values.reversing(),
            master: Master::decode(values.encoder.mencodertype),
            is_absolute: matches!(chosen, Some(Feedback::Absolute { .. })),
            slack: judge::slack_of(values),
            low: values.min_position.unwrap_or(1 - Position::LIMIT),
            high: values.max_position.unwrap_or(Position::LIMIT - 1),
            grid: Grid::of(values),
            largest: values.largest_limits(),
        }
    }
}

/// The parameters in force. A state image holds the values alone.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(from = "AxisParameters", into = "AxisParameters")]
#[repr(C)]
pub struct InForce {
    pub(super) derived: Derived,
    values: AxisParameters,
    /// They were written since this was asked last.
    is_new: bool,
    /// As [`AxisParameters::needs_full_cycles`].
    needs_full_cycles: bool,
    /// What the axis changes by itself, before it did so in this cycle.
    own_before: Option<ValuesByAxis>,
}

impl InForce {
    /// The one way to change them.
    fn write(&mut self, values: AxisParameters) {
        (self.values, self.derived, self.is_new) = (values, Derived::of(&values), true);
        self.needs_full_cycles = values.needs_full_cycles();
    }

    /// A command puts others in force.
    pub(super) fn set(&mut self, values: AxisParameters) {
        self.write(values);
    }

    /// The axis itself changes some.
    pub(super) fn change(&mut self, change: impl FnOnce(&mut AxisParameters)) {
        self.own_before.get_or_insert_with(|| self.values.values_by_axis());
        let mut values = self.values;
        change(&mut values);
        self.write(values);
    }

    /// The axis itself gives some rows, by their places, values that they take.
    fn assign(&mut self, values: impl Iterator<Item = (u16, Value)>) {
        self.change(|parameters| {
            for (row, value) in values {
                if let Some(row) = ROWS.get(usize::from(row)) {
                    debug_assert!(row.by_axis, "{} is changed by the axis, and its row lacks by_axis", row.key);
                    // A value that its row refuses changes nothing.
                    let _ = row.assign(parameters, value);
                }
            }
        });
    }

    /// Has the axis itself changed any, since this was asked last? What was changed back counts for nothing.
    #[inline]
    pub(super) fn take_own_change(&mut self) -> bool {
        // A whole set is taken and compared only where something was written.
        self.own_before.is_some() && self.own_before.take() != Some(self.values.values_by_axis())
    }

    /// Were they written since this was asked last?
    pub(super) fn take_new(&mut self) -> bool {
        std::mem::take(&mut self.is_new)
    }

    /// As [`AxisParameters::sense`].
    #[inline]
    pub(super) fn sense(&self) -> Sense {
        self.derived.sense
    }

    /// As [`AxisParameters::reversing`].
    #[inline]
    pub(super) fn reversing(&self) -> Reversing {
        self.derived.reversing
    }

    /// As [`AxisParameters::largest_limits`].
    pub(super) fn largest_limits(&self) -> Limits {
        self.derived.largest
    }

    /// As [`AxisParameters::needs_full_cycles`].
    #[inline]
    pub(super) fn needs_full_cycles(&self) -> bool {
        self.needs_full_cycles
    }

    /// Does what is kept follow from the values?
    #[cfg(test)]
    pub(crate) fn agrees(&self) -> bool {
        self.derived == Derived::of(&self.values) && self.needs_full_cycles == self.values.needs_full_cycles()
    }
}

impl Axis {
    /// The one way in which an axis, or a vocabulary on it, sets parameters by itself: they are in force from now on, and told,
    /// as those of the command where one asked for them.
    pub(super) fn write_own(
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
            self.tell_own(cx, sequence, row, value);
        }
    }

    /// Tells a parameter that the axis has set by itself.
    pub(super) fn tell_own(&self, cx: &mut Context<'_>, sequence: Option<u64>, row: u16, value: Value) {
        let event = Event::new(Severity::Info, Kind::Parameter, self.object(), Code::NONE);
        let event = sequence.map_or(event, |sequence| event.of_command(sequence));
        let number = Change { axis: self.setup.index, row, value }.number();
        cx.events.push(Event { parameter: Some(row), ..event.with(number, Number::None) });
    }
}

impl From<AxisParameters> for InForce {
    fn from(values: AxisParameters) -> Self {
        let (derived, needs_full_cycles) = (Derived::of(&values), values.needs_full_cycles());
        Self { values, derived, is_new: true, needs_full_cycles, own_before: None }
    }
}

impl From<InForce> for AxisParameters {
    fn from(parameters: InForce) -> Self {
        parameters.values
    }
}

impl Deref for InForce {
    type Target = AxisParameters;

    fn deref(&self) -> &AxisParameters {
        &self.values
    }
}
