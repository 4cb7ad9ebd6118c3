//! Texts about a row that do not depend on an axis: for the terminal and for docs/parameters.md.

use lineshaft_core::parameter::{Bare, Effect, Measure, ROWS, Range, Row, Storage, Value};
use lineshaft_core::text::{range_text, value_text};
use lineshaft_core::unit::Scale;

/// Maximum position in each direction, in inc.
const LARGEST_POSITION: i64 = (1 << 62) - 1;
/// Value from which a number is written with its exponent.
const LARGE: f64 = 1e9;

/// Returns the unit of a number without unit.
pub(crate) fn unit_text(row: &Row) -> String {
    let order = match row.measure {
        Measure::Position | Measure::Distance => "",
        Measure::Velocity => "/s",
        Measure::Acceleration => "/s^2",
        Measure::Jerk => "/s^3",
        Measure::Time => return if row.bare == Bare::Milliseconds { "ms" } else { "s" }.to_owned(),
        Measure::Integer | Measure::Number | Measure::Choice(_) => return row.unit.to_owned(),
    };
    match row.bare {
        Bare::Si | Bare::Milliseconds => format!("m{order}, rad{order}"),
        Bare::AxisUnit => format!("axis unit{order}"),
        Bare::AxisUnitPerMs => "axis unit/ms".to_owned(),
    }
}

/// Formats a value in increments.
fn value_words(row: &Row, value: Value) -> String {
    let scale = Scale::increments();
    match (value, row.measure) {
        (Value::Real(number), Measure::Number) if number.abs() >= LARGE => format!("{number:e}"),
        (Value::Real(number), _) if number.abs() >= LARGE => {
            let unit = value_text(row, Value::Real(0.0), &scale);
            format!("{number:e}{}", unit.trim_start_matches('0'))
        }
        _ => value_text(row, value, &scale),
    }
}

/// Returns the permitted values.
pub(crate) fn range_words(row: &Row) -> String {
    match (row.range, row.measure) {
        (_, Measure::Choice(names)) => names.join(", "),
        (_, _) if matches!(row.storage, Storage::Derived | Storage::Signal(_)) => String::new(),
        (Range::Int(low, LARGEST_POSITION), Measure::Position) if low == -LARGEST_POSITION => "any".to_owned(),
        _ if row.is_bound_by_cycle() => "more than 0 up to 2^31 inc per cycle".to_owned(),
        _ => range_text(row, |value| value_words(row, value)),
    }
}

/// Returns the default.
pub(crate) fn default_text(row: &Row) -> String {
    match row.default {
        _ if row.required => "required".to_owned(),
        Value::Unset if row.default_text.is_empty() => "-".to_owned(),
        value => value_words(row, value),
    }
}

/// Returns when a change takes effect, for a table.
pub(super) fn effect_text(effect: Effect) -> &'static str {
    match effect {
        Effect::AtOnce => "at once",
        Effect::NextMotion => "next motion",
        Effect::NextSynchronize => "next synchronize",
        Effect::NextSaiaCommand => "next command",
        Effect::NextHoming => "next homing",
        Effect::NextVirtualMaster => "next start of the virtual master",
        Effect::Disabled => "while disabled",
        Effect::Start => "next start",
    }
}

/// Returns where the value is stored.
pub(super) fn storage_text(storage: Storage) -> String {
    match storage {
        Storage::User => "saved".to_owned(),
        Storage::Volatile => "until the power goes".to_owned(),
        Storage::Cell => "cell, read-only".to_owned(),
        Storage::Derived => "computed, read-only".to_owned(),
        Storage::Signal(signal) => format!("signal {signal}"),
    }
}

/// Returns the name in its source.
pub(super) fn source_text(row: &Row) -> String {
    match (row.mnemonic, row.number) {
        ("", "") => row.system.name().to_owned(),
        (name, "") => format!("{} {name}", row.system.name()),
        ("", number) => format!("{} no. {number}", row.system.name()),
        (name, number) => format!("{} {name}, no. {number}", row.system.name()),
    }
}

/// Returns the keys of the other views of a native value.
pub(super) fn views_of(row: &Row) -> Vec<&'static str> {
    ROWS.iter().filter(|view| view.view_of == row.key).map(|view| view.key).collect()
}
