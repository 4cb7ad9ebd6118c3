//! Parameters of axes set in a cell file.
//!
//! Law      a value that stands is written in its place, one that is missing behind its neighbours, with all else of the text left as it is;
//!          one that the cell has anyway is left alone. The new text is read as a cell: where that differs from the old one in more
//!          or less than these values, nothing is written
//! Reads    the cell, with the files beside it
//! Writes   the cell file, in one step; its permissions stay, a link leads to where it led
//! Refuses  [`EditError`]
//!
//! Layer User hides what a cell says (docs/parameters.md): who has saved values there sets them there, too.

use crate::cell::Cell;
use crate::document::{Document, Fixed, Source};
use crate::whole_file::WholeFile;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::{ROWS, Row, Value};
use std::fs;
use std::io;
use std::path::Path;

/// A parameter of an axis, as it is to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The axis.
    pub axis: String,
    /// As cells, ROS and docs/parameters.md have it.
    pub key: &'static str,
    /// In the core's units.
    pub value: Value,
    /// As the cell says it.
    pub written: String,
}

/// A cell with other parameters.
#[derive(Clone, Debug)]
pub struct Edited {
    /// Its text.
    pub text: String,
    /// What it is.
    pub cell: Cell,
    /// What it did not have before.
    pub written: Vec<Setting>,
}

/// Why parameters are not in the cell file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
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
    /// No such parameter, or none with that value.
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
    /// The new text would be no cell.
    #[error("with these values the cell has errors; nothing is written\n{problems}")]
    Invalid {
        /// What is wrong with it, a line each, at the places of the new text.
        problems: String,
    },
    /// The text would say something else.
    #[error("{name} would not say these values and the rest as before; nothing is written")]
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

/// Writes parameters into the cell file, which was `read` before; where none is another one, the file is left alone.
///
/// # Errors
/// [`EditError`]; the file is what it was.
pub fn apply(path: &Path, read: &str, settings: &[Setting]) -> Result<Edited, EditError> {
    let document = Document::read(path);
    if !document.problems().is_empty() {
        return Err(EditError::Cell { name: path.display().to_string() });
    }
    if document.text() != read {
        return Err(EditError::Changed { name: path.display().to_string() });
    }
    let edited = edited(path, document.text(), settings)?;
    if !edited.written.is_empty() {
        replace(path, document.text(), &edited.text)?;
    }
    Ok(edited)
}

/// The text of a cell with these parameters; nothing is written. Files of its tables stand beside `path`. A parameter that is missing goes
/// behind another one of the same axis in `settings`.
///
/// # Errors
/// [`EditError`]
pub fn edited(path: &Path, text: &str, settings: &[Setting]) -> Result<Edited, EditError> {
    let name = path.display().to_string();
    let old = Cell::parse_beside(path, text).map_err(|_| EditError::Cell { name: name.clone() })?;
    let mut expected = old;
    let written = assign(&mut expected.machine, settings, &name)?;
    let mut new = text.to_owned();
    let mut axes: Vec<&str> = written.iter().map(|setting| setting.axis.as_str()).collect();
    axes.dedup();
    for axis in axes {
        let of_axis = |of: &[Setting]| of.iter().filter(|of| of.axis == axis).cloned().collect::<Vec<_>>();
        new = set(&name, &new, axis, &of_axis(&written), &of_axis(settings))?;
    }
    let problems = |problems: crate::document::Problems| EditError::Invalid { problems: problems.to_string() };
    let cell = Cell::parse_beside(path, &new).map_err(problems)?;
    if !is_same(&cell, &expected) {
        return Err(EditError::Differs { name });
    }
    Ok(Edited { text: new, cell, written })
}

/// The text with parameters of one axis; `asked` are its neighbours.
fn set(name: &str, text: &str, axis: &str, written: &[Setting], asked: &[Setting]) -> Result<String, EditError> {
    let fixed = |fixed| EditError::Fixed { name: name.to_owned(), fixed };
    let source = Source::parse(text).map_err(fixed)?;
    let place = ["axes", axis];
    for setting in written {
        for view in ROWS.iter().filter(|row| row.view_of == setting.key) {
            if let Some(line) = source.line_of(&place, view.key) {
                return Err(EditError::View { name: name.to_owned(), line, view: view.key, key: setting.key });
            }
        }
    }
    let entries: Vec<_> = written.iter().map(|setting| (setting.key, setting.written.as_str())).collect();
    let neighbours: Vec<_> = asked.iter().map(|setting| setting.key).collect();
    source.set(&place, &entries, &neighbours).map_err(fixed)
}

/// Sets parameters, and tells which were others.
fn assign(machine: &mut MachineConfig, settings: &[Setting], name: &str) -> Result<Vec<Setting>, EditError> {
    let mut written = Vec::new();
    for setting in settings {
        let Setting { axis, key, value, .. } = setting;
        let no_axis = || EditError::NoAxis { name: name.to_owned(), axis: axis.clone() };
        let found = machine.axes.iter_mut().find(|known| known.name == *axis).ok_or_else(no_axis)?;
        let refuse = || EditError::Value { key: (*key).to_owned(), value: setting.written.clone() };
        let (_, row) = Row::find(key).filter(|(_, row)| row.is_stored()).ok_or_else(refuse)?;
        if row.value(&found.parameters) != *value {
            row.assign(&mut found.parameters, *value).map_err(|_| refuse())?;
            written.push(setting.clone());
        }
    }
    Ok(written)
}

/// Do two cells say the same, whatever their texts are?
fn is_same(one: &Cell, other: &Cell) -> bool {
    let said = |cell: &Cell| format!("{:?}", Cell { text: String::new(), ..cell.clone() });
    said(one) == said(other)
}

/// Puts a text into the place of the one that was read.
fn replace(path: &Path, old: &str, new: &str) -> Result<(), EditError> {
    let name = || path.display().to_string();
    let file = |error: io::Error| EditError::File { name: name(), reason: error.to_string() };
    // A link leads to where it led.
    let path = &fs::canonicalize(path).map_err(file)?;
    let permissions = fs::metadata(path).map_err(file)?.permissions();
    let written = WholeFile::write(path, new.as_bytes(), Some(permissions)).map_err(file)?;
    if fs::read(path).map_err(file)? != old.as_bytes() {
        return Err(EditError::Changed { name: name() });
    }
    written.take_place().map_err(file)
}

#[cfg(test)]
mod tests;
