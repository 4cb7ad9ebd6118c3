//! The active parameters of an axis, and values derived from them that every cycle needs.
//!
//! Law      `derived` is always [`Derived::of`] the values: [`InForce::write`] is the only function that writes them
//! Reads    the values, as an [`AxisParameters`]; methods with the same name as those of its values return the stored
//!          result
//! Writes   its values, and whether the axis itself has changed some in this cycle

use super::master_view::Grid;
use super::supervision::slack_of;
use crate::encoder::source::{Feedback, Master};
use crate::parameter::{AxisParameters, CountDirection, ROWS, Reversing, Value, ValuesByAxis};
use crate::position::Position;
use crate::profile::Limits;
use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// Values derived from the parameters alone and read in every cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::axis) struct Derived {
    pub sense: CountDirection,
    pub reversing: Reversing,
    pub master: Option<Master>,
    /// Whether ENCODERTYPE selects an absolute encoder.
    pub is_absolute: bool,
    /// Distance by which an encoder at rest may jitter or creep.
    pub slack: Position,
    /// The software limits, or the ends of the position range.
    pub low: i64,
    pub high: i64,
    /// Resolution of the displayed master position.
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
            slack: slack_of(values),
            low: values.min_position.unwrap_or(1 - Position::LIMIT),
            high: values.max_position.unwrap_or(Position::LIMIT - 1),
            grid: Grid::of(values),
            largest: values.max_limits(),
        }
    }
}

/// The active parameters. A state image contains the values alone.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(from = "AxisParameters", into = "AxisParameters")]
#[repr(C)]
pub struct InForce {
    pub(in crate::axis) derived: Derived,
    values: AxisParameters,
    /// Whether they were written since the last call of `take_written`.
    is_new: bool,
    /// As [`AxisParameters::needs_full_cycles`].
    needs_full_cycles: bool,
    /// Own parameters of the axis before it changed them in this cycle.
    own_before: Option<ValuesByAxis>,
}

impl InForce {
    /// Writes all values; the only function that does so.
    fn write(&mut self, values: AxisParameters) {
        (self.values, self.derived, self.is_new) = (values, Derived::of(&values), true);
        self.needs_full_cycles = values.needs_full_cycles();
    }

    /// Applies the parameters of a command.
    pub(in crate::axis) fn set(&mut self, values: AxisParameters) {
        self.write(values);
    }

    /// Applies a change by the axis itself.
    pub(in crate::axis) fn change(&mut self, change: impl FnOnce(&mut AxisParameters)) {
        self.own_before.get_or_insert_with(|| self.values.values_by_axis());
        let mut values = self.values;
        change(&mut values);
        self.write(values);
    }

    /// Writes valid values to rows, given by their indices, for the axis itself. Only `Axis::write_own` calls this: it
    /// reports the values.
    pub(in crate::axis) fn assign(&mut self, values: impl Iterator<Item = (u16, Value)>) {
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

    /// Returns true if the axis itself has changed parameters since the last call. Values that were changed back do not
    /// count.
    #[inline]
    pub(in crate::axis) fn take_own_change(&mut self) -> bool {
        // The whole set is copied and compared only after a write.
        self.own_before.is_some() && self.own_before.take() != Some(self.values.values_by_axis())
    }

    /// Returns true if they were written since the last call.
    pub(in crate::axis) fn take_written(&mut self) -> bool {
        std::mem::take(&mut self.is_new)
    }

    /// As [`AxisParameters::sense`].
    #[inline]
    pub(in crate::axis) fn sense(&self) -> CountDirection {
        self.derived.sense
    }

    /// As [`AxisParameters::reversing`].
    #[inline]
    pub(in crate::axis) fn reversing(&self) -> Reversing {
        self.derived.reversing
    }

    /// As [`AxisParameters::max_limits`].
    pub(in crate::axis) fn largest_limits(&self) -> Limits {
        self.derived.largest
    }

    /// As [`AxisParameters::needs_full_cycles`].
    #[inline]
    pub(in crate::axis) fn needs_full_cycles(&self) -> bool {
        self.needs_full_cycles
    }

    /// Whether the derived values match the values.
    #[cfg(test)]
    pub(crate) fn is_consistent(&self) -> bool {
        self.derived == Derived::of(&self.values) && self.needs_full_cycles == self.values.needs_full_cycles()
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
