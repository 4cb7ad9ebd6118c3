//! Values by name: parameters, memory cells, outputs and sets of functions; numbers of a table.

use super::axis;
use super::numbers::rate;
use lineshaft_core::config::{IoKind, MachineConfig, MemoryKind};
use lineshaft_core::parameter::{Change, MACHINE, Measure, Value};
use lineshaft_core::request::NAMELESS;
use lineshaft_core::table::{Form, Table};
use serde::{Serialize, Serializer};

/// Names and values in the order of the command.
#[derive(Default)]
pub(in crate::recording::verb) struct Entries(pub(in crate::recording::verb) Vec<(String, Scalar)>);

impl Entries {
    pub(in crate::recording::verb) fn of<const N: usize>(entries: [(&str, Scalar); N]) -> Self {
        Self::some(entries.map(|(name, value)| (name, Some(value))))
    }

    /// Returns those entries that have a value.
    pub(in crate::recording::verb) fn some<const N: usize>(entries: [(&str, Option<Scalar>); N]) -> Self {
        Self(entries.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))).collect())
    }

    pub(in crate::recording::verb) fn unless_empty(self) -> Option<Scalar> {
        (!self.0.is_empty()).then_some(Scalar::Entries(self))
    }
}

impl Serialize for Entries {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

#[derive(Serialize)]
#[serde(untagged)]
pub(in crate::recording::verb) enum Scalar {
    Nothing,
    Truth(bool),
    Text(String),
    Whole(i128),
    Real(f64),
    List(Vec<Scalar>),
    Entries(Entries),
}

impl From<&str> for Scalar {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

/// Numbers of a table as in its cell.
pub(super) struct Numbers<'a>(pub(super) &'a Table);

impl Serialize for Numbers<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.form() {
            Form::Xy => serializer.collect_seq(self.0.x().iter().zip(self.0.y()).map(|(x, y)| [x, y])),
            Form::Y | Form::Words => serializer.collect_seq(self.0.y()),
        }
    }
}

/// Returns the values of a set, with the names of their fields.
pub(super) fn set_values(slot: u16, values: &[(u16, i64)], config: &MachineConfig) -> Entries {
    let kind = config.slots.get(usize::from(slot)).map(|slot| slot.kind);
    let name = |place: u16| match kind.and_then(|kind| kind.description().field_of(place.into())) {
        Some((_, field, _)) if field.count == 1 => field.name.to_owned(),
        Some((_, field, nth)) => format!("{}[{nth}]", field.name),
        None => NAMELESS.to_owned(),
    };
    Entries(values.iter().map(|&(place, value)| (name(place), Scalar::Whole(value.into()))).collect())
}

pub(super) fn parameter(change: &Change, config: &MachineConfig) -> (String, Scalar) {
    let row = change.row();
    let object = if change.axis == MACHINE { "machine" } else { axis(change.axis, config) };
    let name = format!("{object}.{}", row.map_or(NAMELESS, |row| row.key));
    let order = match row.map(|row| row.measure) {
        Some(Measure::Acceleration) => 2,
        Some(Measure::Jerk) => 3,
        _ => 1,
    };
    let value = match (change.value, row.map(|row| row.measure)) {
        (Value::Unset, _) => Scalar::Nothing,
        (Value::Real(value), Some(Measure::Number)) => Scalar::Real(value),
        (Value::Real(value), _) => Scalar::Text(rate(value, order)),
        (Value::Int(value), Some(Measure::Position | Measure::Distance)) => Scalar::Text(format!("{value} inc")),
        (Value::Int(value), Some(Measure::Time)) => Scalar::Text(format!("{value} ns")),
        (Value::Int(value), Some(Measure::Choice(names))) => {
            let name = usize::try_from(value).ok().and_then(|place| names.get(place));
            name.map_or(Scalar::Whole(value.into()), |name| Scalar::Text((*name).to_owned()))
        }
        (Value::Int(value), _) => Scalar::Whole(value.into()),
    };
    (name, value)
}

pub(super) fn cell(index: u16, value: f64, config: &MachineConfig) -> (String, Scalar) {
    let Some(memory) = config.memory.get(usize::from(index)) else { return (NAMELESS.to_owned(), Scalar::Real(value)) };
    // The cast saturates; values that it changes are outside of the range of an integer memory cell.
    let whole = value as i128;
    let is_whole = memory.kind != MemoryKind::F64 && (whole as f64).to_bits() == value.to_bits();
    (memory.name.clone(), if is_whole { Scalar::Whole(whole) } else { Scalar::Real(value) })
}

pub(super) fn output(index: u16, value: f64, config: &MachineConfig) -> (String, Scalar) {
    let Some(io) = config.io.get(usize::from(index)) else { return (NAMELESS.to_owned(), Scalar::Real(value)) };
    let is_bit = io.kind != IoKind::AnalogOutput && (value.to_bits() == 0 || value == 1.0);
    (io.name.clone(), if is_bit { Scalar::Whole(value as i128) } else { Scalar::Real(value) })
}
