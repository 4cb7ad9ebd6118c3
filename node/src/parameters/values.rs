//! Lists the parameters of the axes of a cell, and the changes of a file.

use super::catalogue::Filter;
use super::read::Import;
use super::words::{default_text, storage_text};
use lineshaft_core::config::{AxisConfig, MachineConfig};
use lineshaft_core::parameter::{AxisParameters, Change, MachineParameters, Measure, ROWS, Row, Storage, Value};
use lineshaft_core::text::value_text;
use lineshaft_core::unit::Scale;
use std::fmt::Write;

/// Returns a line for each parameter of the machine and of each axis, with `*` if it is not at its default; with
/// `changed` only those, each with the name by which it was set.
pub fn values(config: &MachineConfig, parameters: &[AxisParameters], filter: &Filter, changed: bool) -> String {
    let defaults = AxisParameters::new(0.0, 0.0);
    let mut lines = Vec::new();
    let of_machine = config.global.power_on();
    for row in machine_rows().filter(|row| filter.takes_of("machine", row)) {
        let differs = row.machine_value(&of_machine) != row.default;
        if differs || !changed {
            let mark = if differs { "*" } else { "" };
            let name = format!("machine.{}", row.key);
            lines.push([name, mark.to_owned(), machine_value(row, &of_machine), remark(row, differs)]);
        }
    }
    for (axis, parameters) in config.axes.iter().zip(parameters) {
        for row in ROWS.iter().filter(|row| row.applies.to(axis) && filter.takes_of(&axis.name, row)) {
            let is_given = row.required || row.value(parameters) != row.value(&defaults);
            let differs = is_given && parameters.is_given_by(row);
            if changed && !differs {
                continue;
            }
            let mark = if differs { "*" } else { "" };
            lines.push([
                format!("{}.{}", axis.name, row.key),
                mark.to_owned(),
                value(row, parameters, axis),
                remark(row, differs),
            ]);
        }
    }
    let width = |column: usize| lines.iter().map(|line: &[String; 4]| line[column].chars().count()).max().unwrap_or(0);
    let (name_width, value_width) = (width(0), width(2));
    let mut text = String::new();
    for [name, mark, value, remark] in &lines {
        let line = format!("{name:name_width$} {mark:1} {value:value_width$}  {remark}");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Returns the changes of a file, one line `x.max_velocity: 1200 mm/s -> 800 mm/s` for each.
pub fn differences(config: &MachineConfig, import: &Import) -> String {
    let mut text = String::new();
    let before = config.global.power_on();
    for row in machine_rows().filter(|row| row.machine_value(&before) != row.machine_value(&import.machine)) {
        let (old, new) = (machine_value(row, &before), machine_value(row, &import.machine));
        let _ = writeln!(text, "machine.{}: {old} -> {new}", row.key);
    }
    for (index, (axis, after)) in config.axes.iter().zip(&import.parameters).enumerate() {
        let before = axis.power_on();
        let is_named = |row: &Row| {
            let of_row = |change: &&Change| {
                usize::from(change.axis) == index && change.row().is_some_and(|named| named.key == row.key)
            };
            import.changes.iter().any(|change| of_row(&change))
        };
        for row in ROWS.iter().filter(|row| row.applies.to(axis) && (row.is_stored() || is_named(row))) {
            if row.value(&before) != row.value(after) {
                let (old, new) = (value(row, &before, axis), value(row, after, axis));
                let _ = writeln!(text, "{}.{}: {old} -> {new}", axis.name, row.key);
            }
        }
    }
    text
}

fn machine_rows() -> impl Iterator<Item = &'static Row> {
    ROWS.iter().filter(|row| row.is_kept_by_machine())
}

fn machine_value(row: &Row, parameters: &MachineParameters) -> String {
    with_unit(row, row.machine_value(parameters), &Scale::increments())
}

/// Formats a value in the axis unit or in the unit of the row.
fn value(row: &Row, parameters: &AxisParameters, axis: &AxisConfig) -> String {
    with_unit(row, row.value(parameters), &axis.scale)
}

fn with_unit(row: &Row, value: Value, scale: &Scale) -> String {
    let text = value_text(row, value, scale);
    let is_plain = matches!(row.measure, Measure::Integer | Measure::Number) && !row.unit.is_empty();
    if is_plain && value != Value::Unset { format!("{text} {}", row.unit) } else { text }
}

/// Returns a remark about a value for people.
fn remark(row: &Row, differs: bool) -> String {
    match row.storage {
        _ if row.is_view() => format!("view of {}", row.view_of),
        _ if !row.missing.is_empty() => format!("not yet: {}", row.missing),
        Storage::User | Storage::Volatile if row.required => "required".to_owned(),
        Storage::User | Storage::Volatile if differs => format!("default {}", default_text(row)),
        Storage::User | Storage::Volatile => "default".to_owned(),
        storage => storage_text(storage),
    }
}
