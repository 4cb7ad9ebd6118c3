//! Gains in the cell file.
//!
//! Law      a gain that stands is written in its place, one that is missing behind its neighbours, with all else of the text left as it is;
//!          one that the cell has anyway is left alone. The new text is read as a cell: where that differs from the old one in more
//!          or less than these gains, nothing is written
//! Reads    the cell, with the files beside it
//! Writes   the cell file, in one step; its permissions stay, a link leads to where it led
//! Refuses  [`ApplyError`]; what to write by hand then is [`by_hand`]
//!
//! Layer User hides what a cell says (docs/parameters.md): who has saved gains there sets them there, too.

use super::findings::Gain;
use crate::cell::Cell;
use crate::document::{Document, Fixed, Source};
use crate::whole_file::WholeFile;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::{ROWS, Range, Row, Value};
use std::fs;
use std::io;
use std::path::Path;

/// Why gains are not in the cell file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ApplyError {
    /// The cell is none as it stands.
    #[error("{name} is no cell without errors; lineshaft check says more")]
    Cell {
        /// The file.
        name: String,
    },
    /// No such axis.
    #[error("{name} has no axis {axis}")]
    NoAxis {
        /// The file.
        name: String,
        /// What was asked for.
        axis: String,
    },
    /// No such gain, or none with that value.
    #[error("{key} is {value}, which no cell takes")]
    Value {
        /// The parameter.
        key: String,
        /// Its value.
        value: String,
    },
    /// Another view of the value stands there.
    #[error("{name}, line {line}: {view} gives the same value as {key}; take it out first")]
    View {
        /// The file.
        name: String,
        /// Where, from 1.
        line: usize,
        /// What stands there.
        view: &'static str,
        /// What would stand beside it.
        key: &'static str,
    },
    /// The text cannot be changed there.
    #[error("{name}, {fixed}")]
    Fixed {
        /// The file.
        name: String,
        /// Where, and why.
        fixed: Fixed,
    },
    /// The text would say something else.
    #[error("{name} would not say these gains and the rest as before; nothing is written")]
    Differs {
        /// The file.
        name: String,
    },
    /// Somebody has written it meanwhile.
    #[error("{name} has changed since it was read; nothing is written")]
    Changed {
        /// The file.
        name: String,
    },
    /// The disk's.
    #[error("cannot write {name}: {reason}")]
    File {
        /// The file.
        name: String,
        /// What the system says.
        reason: String,
    },
}

/// Lines to be pasted below an axis.
pub fn by_hand(gains: &[Gain]) -> String {
    gains.iter().map(|gain| format!("    {}: {}\n", gain.key, gain.written())).collect()
}

/// Writes gains of an axis into the cell file, which was `read` before the trial, and tells which were others; where none is, the file is left alone.
///
/// # Errors
/// [`ApplyError`]; the file is what it was.
pub fn apply(path: &Path, read: &str, axis: &str, gains: &[Gain]) -> Result<Vec<Gain>, ApplyError> {
    let document = Document::read(path);
    if !document.problems().is_empty() {
        return Err(ApplyError::Cell { name: path.display().to_string() });
    }
    if document.text() != read {
        return Err(ApplyError::Changed { name: path.display().to_string() });
    }
    let (text, written) = edited(path, document.text(), axis, gains)?;
    if !written.is_empty() {
        replace(path, document.text(), &text)?;
    }
    Ok(written)
}

/// The text of a cell with gains of an axis, and which of them it did not have; nothing is written. Files of its tables stand beside `path`.
///
/// # Errors
/// [`ApplyError`]
pub fn edited(path: &Path, text: &str, axis: &str, gains: &[Gain]) -> Result<(String, Vec<Gain>), ApplyError> {
    let name = path.display().to_string();
    let read = |text: &str| Cell::parse_beside(path, text).ok();
    let old = read(text).ok_or_else(|| ApplyError::Cell { name: name.clone() })?;
    let mut expected = old.clone();
    let written = assign(&mut expected.machine, axis, gains, &name)?;
    let fixed = |fixed| ApplyError::Fixed { name: name.clone(), fixed };
    let source = Source::parse(text).map_err(fixed)?;
    let place = ["axes", axis];
    for gain in &written {
        for view in ROWS.iter().filter(|row| row.view_of == gain.key) {
            if let Some(line) = source.line_of(&place, view.key) {
                return Err(ApplyError::View { name, line, view: view.key, key: gain.key });
            }
        }
    }
    let values: Vec<String> = written.iter().map(Gain::written).collect();
    let entries: Vec<(&str, &str)> =
        written.iter().zip(&values).map(|(gain, value)| (gain.key, value.as_str())).collect();
    let neighbours: Vec<&str> = gains.iter().map(|gain| gain.key).collect();
    let new = source.set(&place, &entries, &neighbours).map_err(fixed)?;
    if !read(&new).is_some_and(|new| is_same(new, expected)) {
        return Err(ApplyError::Differs { name });
    }
    Ok((new, written))
}

/// Sets gains of an axis, and tells which it did not have.
fn assign(machine: &mut MachineConfig, axis: &str, gains: &[Gain], name: &str) -> Result<Vec<Gain>, ApplyError> {
    let no_axis = || ApplyError::NoAxis { name: name.to_owned(), axis: axis.to_owned() };
    let found = machine.axes.iter_mut().find(|known| known.name == axis).ok_or_else(no_axis)?;
    let mut written = Vec::new();
    for gain in gains {
        let refuse = || ApplyError::Value { key: gain.key.to_owned(), value: gain.written() };
        let (_, row) = Row::find(gain.key).filter(|(_, row)| row.is_stored()).ok_or_else(refuse)?;
        let value = match row.range {
            Range::Int(..) | Range::Among(_) if gain.new.fract() != 0.0 => return Err(refuse()),
            Range::Int(..) | Range::Among(_) => Value::Int(gain.new as i64),
            Range::Real(..) | Range::PositiveUpTo(_) => Value::Real(gain.new),
        };
        if row.value(&found.parameters) != value {
            row.assign(&mut found.parameters, value).map_err(|_| refuse())?;
            written.push(*gain);
        }
    }
    Ok(written)
}

/// Do two cells say the same, whatever their texts are?
fn is_same(one: Cell, other: Cell) -> bool {
    let said = |cell: Cell| format!("{:?}", Cell { text: String::new(), ..cell });
    said(one) == said(other)
}

/// Puts a text into the place of the one that was read.
fn replace(path: &Path, old: &str, new: &str) -> Result<(), ApplyError> {
    let name = || path.display().to_string();
    let file = |error: io::Error| ApplyError::File { name: name(), reason: error.to_string() };
    // A link leads to where it led.
    let path = &fs::canonicalize(path).map_err(file)?;
    let permissions = fs::metadata(path).map_err(file)?.permissions();
    let written = WholeFile::write(path, new.as_bytes(), Some(permissions)).map_err(file)?;
    if fs::read(path).map_err(file)? != old.as_bytes() {
        return Err(ApplyError::Changed { name: name() });
    }
    written.take_place().map_err(file)
}

#[cfg(test)]
mod tests;
