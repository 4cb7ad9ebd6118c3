//! Formats the output of `lineshaft functions`.

use super::{default, facts, name, range, when};
use crate::parameters::wrap;
use lineshaft_core::function::{Description, Field, TYPES};
use std::fmt::Write;

/// Indentation of the description of a field.
const INDENT: usize = 6;
/// Width of the label before a fact.
const LABEL: usize = 12;
/// Minimum width, even if the terminal is narrower.
const NARROWEST: usize = 30;

/// Returns a line for each type.
pub fn listing(width: usize) -> String {
    let longest = TYPES.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    TYPES.iter().for_each(|row| entry(&mut text, (row.name, longest + 2), row.help, width));
    text
}

/// Returns the full description of a type.
pub fn details(row: &Description, width: usize) -> String {
    let mut text = format!("{}: {}\n\n", row.name, row.help);
    for (word, what) in facts(row) {
        entry(&mut text, (&format!("  {word}"), LABEL), &what.replace('`', ""), width);
    }
    text += "\n";
    row.fields.iter().for_each(|one| field(&mut text, one, width));
    text
}

fn field(text: &mut String, field: &Field, width: usize) {
    let unit = if field.unit.is_empty() { String::new() } else { format!(" ({})", field.unit) };
    let default = match default(field) {
        number if number.ends_with(|digit: char| digit.is_ascii_digit()) => format!("left out: {number}"),
        words => words,
    };
    let (name, range, when) = (name(field), range(field), when(field));
    // Writing to a string cannot fail.
    let _ = writeln!(text, "  {name}  {range}{unit}, {default}, {when}");
    entry(text, ("", INDENT), &format!("{} [{}]", field.help, field.source), width);
}

/// Appends a label in its column, with its description next to it.
fn entry(text: &mut String, (word, column): (&str, usize), what: &str, width: usize) {
    for (place, line) in wrap(what, width.saturating_sub(column).max(NARROWEST)).iter().enumerate() {
        let word = if place == 0 { word } else { "" };
        let _ = writeln!(text, "{word:column$}{line}");
    }
}
