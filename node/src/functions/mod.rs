//! Describes types of function slots: in a terminal, and in docs/functions.md.
//!
//! The texts are made from the type table of the core and the fields of its parameter sets.

mod markdown;
mod terminal;

pub use markdown::{markdown, renewed};
pub use terminal::{details, listing};

use lineshaft_core::function::{Description, Field, Quantity, Requirement, Shown};

/// Returns the facts about a type other than its fields: a label, and the rest of the sentence.
fn facts(row: &Description) -> Vec<(&'static str, String)> {
    let source = match row.source {
        Requirement::Must => "one",
        Requirement::May => "one or none",
        Requirement::Never => "none",
    };
    let mut facts = vec![("source", source.to_owned()), ("sink", sink(row))];
    if row.chooses_quantity {
        facts.push(("quantity", "`position`, or `speed` (0.0001 rpm) where the cell says so".to_owned()));
    }
    facts.push(("inputs", lines('E', row.inputs)));
    facts.push(("outputs", outputs(row)));
    facts.push(("tables", tables(row)));
    for word in row.words {
        facts.push(("word", format!("`{word}` names the signal that is read in each call as well as the source")));
    }
    let value_new = if row.renews { "takes the live fields" } else { "is refused" };
    facts.push(("VALUE_NEW", value_new.to_owned()));
    if row.takes_goals {
        facts.push(("goals", "orders that end, by `~/run_function`".to_owned()));
    }
    if !row.shows.is_empty() {
        facts.push(("shows", shown(row.shows)));
    }
    facts
}

/// Returns the signals of a type; names with the same meaning are shown as a range.
fn shown(shows: &[Shown]) -> String {
    let told = shows.chunk_by(|shown, other| shown.help == other.help).filter_map(|chunk| {
        let (first, last) = (chunk.first()?, chunk.last()?);
        let names = match chunk.len() {
            1 => format!("`{}`", first.name),
            _ => format!("`{}` to `{}`", first.name, last.name),
        };
        let unit = first.measure.unit();
        let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
        Some(format!("{names}, {}{unit}", first.help))
    });
    told.collect::<Vec<_>>().join("; ")
}

fn sink(row: &Description) -> String {
    let what = match row.quantity {
        _ if row.sink == Requirement::Never => return "none".to_owned(),
        Quantity::Position => "",
        Quantity::Speed => "a speed (0.0001 rpm): ",
    };
    let axis = if row.moves_axes { "an axis, " } else { "" };
    let end = if row.sink == Requirement::Must { "; it must be given" } else { "" };
    format!("{what}{axis}a memory cell of numbers, an ao or none{end}")
}

fn outputs(row: &Description) -> String {
    let rests: Vec<_> = (0..row.outputs).filter(|bit| row.rests >> bit & 1 == 1).collect();
    let names: Vec<_> = rests.iter().map(|bit| format!("A{}", bit + 1)).collect();
    let end = if rests.is_empty() { String::new() } else { format!("; RESET makes {} 1", names.join(", ")) };
    lines('A', row.outputs) + &end
}

fn tables(row: &Description) -> String {
    match (row.tables, row.edits_tables) {
        (0, _) => "none".to_owned(),
        (1, true) => "1, which may get new numbers while the function runs".to_owned(),
        (1, false) => "1, which keeps its numbers while the function runs".to_owned(),
        (most, true) => format!("up to {most}, which may get new numbers while the function runs"),
        (most, false) => format!("up to {most}, which keep their numbers while the function runs"),
    }
}

fn lines(letter: char, count: usize) -> String {
    match count {
        0 => "none".to_owned(),
        1 => format!("{letter}1"),
        2 => format!("{letter}1, {letter}2"),
        last => format!("{letter}1 to {letter}{last}"),
    }
}

/// Returns the name of a field, with the indices of a list.
fn name(field: &Field) -> String {
    if field.count == 1 { field.name.to_owned() } else { format!("{}[0..{}]", field.name, field.count - 1) }
}

pub(crate) fn range(field: &Field) -> String {
    format!("{} to {}", field.min, field.max)
}

/// Returns the default of a field.
pub(crate) fn default(field: &Field) -> String {
    if (field.min..=field.max).contains(&field.default) {
        field.default.to_string()
    } else {
        "must be given".to_owned()
    }
}

/// Returns when a new value takes effect.
pub(crate) fn when(field: &Field) -> &'static str {
    if field.live { "live" } else { "from START on" }
}

#[cfg(test)]
mod tests;
