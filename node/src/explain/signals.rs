//! Explains signals by name, such as `x.actual.position`, or by the part after the object; names of their states;
//! system variables of MACS.
//!
//! The names of signals depend on the cell. The objects of objects.yaml, one of each kind, represent those of any cell.

use super::section;
use crate::cell::Cell;
use lineshaft_core::function::TYPES;
use lineshaft_core::signal::sysvar::{Address, SYSTEM_VARIABLES, Shown, SystemVariable};
use lineshaft_core::signal::{Measure, Type};
use std::sync::LazyLock;

/// Objects of objects.yaml: name in the file, name in a pattern, and description.
const OBJECTS: [(&str, &str, &str); 6] = [
    ("axis", "AXIS", "an axis"),
    ("gantry", "AXIS", "an axis with two drives"),
    ("encoder", "ENCODER", "an entry of encoders"),
    ("master", "MASTER", "an entry of masters"),
    ("function", "FUNCTION", "a function slot"),
    ("machine", "machine", "the machine"),
];

/// A signal of a kind of objects.
struct SignalRow {
    object: &'static str,
    /// Description of its object.
    of: String,
    /// Name after the object.
    end: String,
    kind: Type,
    measure: Measure,
    drivable: bool,
    help: &'static str,
}

/// All rows, created once.
static ROWS: LazyLock<Vec<SignalRow>> = LazyLock::new(rows);

pub(super) fn sections(name: &str, width: usize) -> Vec<String> {
    // `actual.position` is the end of a name, not the signal `position` of an object with the name `actual`.
    let is_end = ROWS.iter().any(|row| row.end.eq_ignore_ascii_case(name));
    let is_called = |row: &&SignalRow| if is_end { row.end.eq_ignore_ascii_case(name) } else { is_of(row, name) };
    let called = ROWS.iter().filter(is_called).map(|row| text(row, width));
    let states = ROWS.iter().filter_map(|row| state(row, name, width));
    let variables = SYSTEM_VARIABLES.iter().filter(|variable| is_variable(variable, name));
    called.chain(states).chain(variables.map(|variable| variable_text(variable, width))).collect()
}

pub(super) fn names() -> Vec<String> {
    let variables = SYSTEM_VARIABLES.iter().map(|variable| variable.name.to_owned()).filter(|name| !name.is_empty());
    ROWS.iter().map(|row| row.end.clone()).chain(variables).collect()
}

/// Whether it is the signal `x.actual.position` of any object; `machine` is one object.
fn is_of(row: &SignalRow, name: &str) -> bool {
    let is_machine = |object: &str| object.eq_ignore_ascii_case("machine");
    name.split_once('.')
        .is_some_and(|(object, end)| end.eq_ignore_ascii_case(&row.end) && is_machine(object) == is_machine(row.object))
}

/// Returns the signals of objects. Inputs, outputs and memory cells are single signals with names chosen by the user.
fn rows() -> Vec<SignalRow> {
    let cell =
        Cell::parse("objects.yaml", include_str!("objects.yaml")).expect("the text is fixed, and a test reads it");
    let directory = cell.machine.directory();
    let mut rows: Vec<SignalRow> = Vec::new();
    for (_, entry) in directory.iter() {
        let Some((name, end)) = entry.name.split_once('.') else { continue };
        let Some(&(_, object, of)) = OBJECTS.iter().find(|(known, ..)| *known == name) else { continue };
        // An axis with two drives has the signals of every axis as well.
        if rows.iter().any(|row| row.object == object && row.end == end) {
            continue;
        }
        let (kind, measure, drivable, help) = (entry.kind, entry.measure, entry.drivable, entry.help);
        rows.push(SignalRow { object, of: of.to_owned(), end: end.to_owned(), kind, measure, drivable, help });
    }
    rows.extend(shown());
    rows
}

/// Returns the signals of function slots in addition to those that all of them have.
fn shown() -> Vec<SignalRow> {
    let mut rows: Vec<SignalRow> = Vec::new();
    for row in TYPES {
        for shown in row.shows {
            match rows.iter_mut().find(|known| known.end == shown.name && known.help == shown.help) {
                Some(known) => known.of += &format!(", {}", row.name),
                None => rows.push(SignalRow {
                    object: "FUNCTION",
                    of: format!("a function slot of type {}", row.name),
                    end: shown.name.to_owned(),
                    kind: shown.kind,
                    measure: shown.measure,
                    drivable: false,
                    help: shown.help,
                }),
            }
        }
    }
    rows
}

fn text(row: &SignalRow, width: usize) -> String {
    let kind = match row.kind {
        Type::Int => "whole number",
        Type::Real => "number",
        Type::Bit => "bit, 0 or 1",
        Type::Enum(_) => "one of the values",
        Type::Word => "bits",
    };
    let values: Vec<String> = match row.kind {
        Type::Enum(names) => names.iter().enumerate().map(|(number, name)| format!("{number} {name}")).collect(),
        _ => Vec::new(),
    };
    let values = values.join(", ");
    let drive = if row.drivable { "section `drive` of a scenario may replace it" } else { "" };
    let facts: [(&str, &str); 6] = [
        ("what", row.help),
        ("type", kind),
        ("unit", row.measure.unit()),
        ("values", values.as_str()),
        ("scenarios", drive),
        ("documented", "docs/contract.md, section 4; `lineshaft signals CELL` lists those of a cell"),
    ];
    section(&format!("{}.{}: a signal of {}", row.object, row.end, row.of), &facts, width)
}

/// Explains a value of a signal by its name, such as `STANDSTILL`.
fn state(row: &SignalRow, name: &str, width: usize) -> Option<String> {
    let Type::Enum(names) = row.kind else { return None };
    let number = names.iter().position(|known| known.eq_ignore_ascii_case(name))?;
    let what = format!("value {number} of {}.{}, {}", row.object, row.end, row.help);
    Some(section(&format!("{}: a value of a signal", names[number]), &[("what", what.as_str())], width))
}

/// Whether it is the name or the number of a variable: `SYSVAR 4096`.
fn is_variable(variable: &SystemVariable, name: &str) -> bool {
    let small = name.to_lowercase();
    let number = small.strip_prefix("sysvar").and_then(|number| number.trim().parse::<u16>().ok());
    let is_numbered = matches!(variable.address, Address::Number(known) if Some(known) == number);
    is_numbered || !name.is_empty() && variable.name.eq_ignore_ascii_case(name)
}

fn variable_text(variable: &SystemVariable, width: usize) -> String {
    let number = match variable.address {
        Address::Number(number) => format!("SYSVAR {number}"),
        Address::Object(index, subindex) => format!("object {index:04X}h:{subindex}"),
        Address::Name => String::new(),
    };
    let shown = match variable.shown {
        Shown::Signal(end) => format!("signal AXIS.{end}"),
        Shown::Encoder(end) => format!("signal ENCODER.{end}"),
        Shown::Missing(what) => format!("no signal: {what}"),
    };
    let name = if variable.name.is_empty() { number.as_str() } else { variable.name };
    let facts: [(&str, &str); 4] = [
        ("what", variable.meaning),
        ("number", number.as_str()),
        ("here", shown.as_str()),
        ("documented", "docs/motion.md"),
    ];
    section(&format!("{name}: a system variable of MACS"), &facts, width)
}
