//! Sets parameters of axes in a cell file.
//!
//! Law      an existing value is replaced in its place, a missing one is inserted after its neighbours; the rest of the
//!          text stays unchanged, and so does a value that the cell has already. The new text is read as a cell; if it
//!          differs from the old one in more or fewer than these values, nothing is written
//! Reads    the cell, with the files next to it
//! Writes   the cell file, in one step; its permissions are kept, and a symbolic link stays a link
//! Refuses  [`EditError`]
//!
//! Layer User overrides the cell (docs/parameters.md): values that were saved there must be set there, too.

use crate::cell::Cell;
use crate::document::{Document, Fixed, Source};
use crate::whole_file::WholeFile;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::{ROWS, Row, Value};
use std::fs;
use std::io;
use std::path::Path;

/// New value of a parameter of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Name of the axis.
    pub axis: String,
    /// Key, as in cells, ROS and docs/parameters.md.
    pub key: &'static str,
    /// Value in units of the core.
    pub value: Value,
    /// Value in the format of the cell.
    pub written: String,
}

/// A cell with changed parameters.
#[derive(Clone, Debug)]
pub struct Edited {
    /// Text of the cell.
    pub text: String,
    /// The new cell.
    pub cell: Cell,
    /// Values that the cell did not have before.
    pub written: Vec<Setting>,
}

/// Reason why parameters cannot be set in the cell file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// The present cell has errors.
    #[error("{name} is no cell without errors; lineshaft check says more")]
    Cell {
        /// Path of the file.
        name: String,
    },
    /// There is no such axis.
    #[error("{name} has no axis {axis}")]
    NoAxis {
        /// Path of the file.
        name: String,
        /// Given name.
        axis: String,
    },
    /// There is no such parameter, or the value is not permitted.
    #[error("{key} is {value}, which no cell takes")]
    Value {
        /// Key of the parameter.
        key: String,
        /// Given value.
        value: String,
    },
    /// The cell has another view of the value.
    #[error("{name}, line {line}: {view} gives the same value as {key}; take it out first")]
    View {
        /// Path of the file.
        name: String,
        /// Line, from 1.
        line: usize,
        /// Key of the existing view.
        view: &'static str,
        /// Key that would be added.
        key: &'static str,
    },
    /// The text cannot be changed at that location.
    #[error("{name}, {fixed}")]
    Fixed {
        /// Path of the file.
        name: String,
        /// Location and reason.
        fixed: Fixed,
    },
    /// The new cell would have errors.
    #[error("with these values the cell has errors; nothing is written\n{problems}")]
    Invalid {
        /// Problems of the new text, one per line, with locations in it.
        problems: String,
    },
    /// The new text would have another meaning.
    #[error("{name} would not say these values and the rest as before; nothing is written")]
    Differs {
        /// Path of the file.
        name: String,
    },
    /// The file was changed by another program.
    #[error("{name} has changed since it was read; nothing is written")]
    Changed {
        /// Path of the file.
        name: String,
    },
    /// An error of the disk.
    #[error("cannot write {name}: {reason}")]
    File {
        /// Path of the file.
        name: String,
        /// Error message of the operating system.
        reason: String,
    },
}

/// Writes parameters into the cell file, whose text was `read` before; if no value changes, the file is not written.
///
/// # Errors
/// Returns an [`EditError`]; the file is then unchanged.
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

/// Returns the text of a cell with these parameters; nothing is written. The files of its tables are next to `path`. A
/// missing parameter is inserted after another one of the same axis in `settings`.
///
/// # Errors
/// [`EditError`]
pub fn edited(path: &Path, text: &str, settings: &[Setting]) -> Result<Edited, EditError> {
    let name = path.display().to_string();
    let old = Cell::parse_in_folder(path, text).map_err(|_| EditError::Cell { name: name.clone() })?;
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
    let cell = Cell::parse_in_folder(path, &new).map_err(problems)?;
    if !is_same(&cell, &expected) {
        return Err(EditError::Differs { name });
    }
    Ok(Edited { text: new, cell, written })
}

/// Returns the text with parameters of one axis; `asked` are its neighbours.
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

/// Sets parameters, and returns those that changed.
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

/// Whether two cells have the same content, whatever their texts are, and whether values in them have a unit.
fn is_same(one: &Cell, other: &Cell) -> bool {
    let said = |cell: &Cell| format!("{:?}", Cell { text: String::new(), bare_numbers: Vec::new(), ..cell.clone() });
    said(one) == said(other)
}

/// Replaces the text that was read by a new one.
fn replace(path: &Path, old: &str, new: &str) -> Result<(), EditError> {
    let name = || path.display().to_string();
    let file = |error: io::Error| EditError::File { name: name(), reason: error.to_string() };
    // A symbolic link stays a link.
    let path = &fs::canonicalize(path).map_err(file)?;
    let permissions = fs::metadata(path).map_err(file)?.permissions();
    let written = WholeFile::write(path, new.as_bytes(), Some(permissions)).map_err(file)?;
    if fs::read(path).map_err(file)? != old.as_bytes() {
        return Err(EditError::Changed { name: name() });
    }
    written.replace().map_err(file)
}

#[cfg(test)]
mod tests;
