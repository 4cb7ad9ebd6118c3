//! Finds the cell of a scenario.
//!
//! Law      key `cell` of the scenario, relative to its folder; without the key, NAME.yaml next to NAME.scenario.yaml.
//!          A cell given on the command line overrides the key, with a note if it is another file
//! Reads    only that key; other errors of the scenario are found when it is read with the cell
//! Refuses  a scenario without a cell, and a key that names no file

use crate::document::{Document, Place, Problems, Value};
use std::fs;
use std::path::{Path, PathBuf};

/// File name suffix of a scenario whose cell may be next to it.
pub const SUFFIX: &str = ".scenario.yaml";

/// Value of key `cell`, and its location.
struct Key {
    place: Place,
    path: PathBuf,
}

/// Returns the path of the cell of a scenario.
///
/// # Errors
/// Returns an error if the scenario cannot be read, names no cell, or names one that does not exist.
pub fn cell_of(scenario: &Path) -> Result<PathBuf, Problems> {
    let refuse = |place: Place, sentence: String| {
        let problems = Problems::new(&scenario.display().to_string());
        problems.push(place, sentence, None);
        Err(problems)
    };
    match key(scenario)? {
        Some(Key { path, .. }) if path.is_file() => Ok(path),
        Some(Key { path, place }) => refuse(place, format!("cell: there is no file {}", path.display())),
        None => match cell_next_to(scenario).filter(|path| path.is_file()) {
            Some(path) => Ok(path),
            None => {
                let sentence = "the scenario has no cell; name it by the key `cell: FILE`, or put NAME.yaml next to \
                                NAME.scenario.yaml";
                refuse(Place::START, sentence.to_owned())
            }
        },
    }
}

/// Returns NAME.yaml next to NAME.scenario.yaml, whether it exists or not; `None` for another name.
pub fn cell_next_to(scenario: &Path) -> Option<PathBuf> {
    let name = scenario.file_name()?.to_str()?;
    let stem = name.strip_suffix(SUFFIX).filter(|stem| !stem.is_empty())?;
    Some(scenario.with_file_name(format!("{stem}.yaml")))
}

/// Returns a note if the scenario names another cell than the used one; `None` as used cell is the built-in demo.
pub fn other_cell(scenario: &Path, used: Option<&Path>) -> Option<String> {
    let Key { place: Place { line, col }, path } = key(scenario).ok().flatten()?;
    if used.is_some_and(|used| is_same(used, &path)) {
        return None;
    }
    let used = used.map_or_else(|| "the built-in demo".to_owned(), |used| used.display().to_string());
    let (file, path) = (scenario.display(), path.display());
    Some(format!("{file}:{line}:{col}: the scenario names the cell {path}; {used} is used"))
}

fn is_same(one: &Path, other: &Path) -> bool {
    match (fs::canonicalize(one), fs::canonicalize(other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}

fn key(scenario: &Path) -> Result<Option<Key>, Problems> {
    let folder = scenario.parent().unwrap_or(Path::new(""));
    let document = Document::read(scenario);
    let entries = document.root("the scenario").and_then(|root| root.entries()).unwrap_or_default();
    let value = entries.into_iter().find(|(key, _)| key.peek() == Some("cell")).map(|(_, value)| value.called("cell"));
    let key = value.and_then(|value| Some(Key { place: value.place(), path: read(&value, folder)? }));
    if document.problems().is_empty() { Ok(key) } else { Err(document.into_problems()) }
}

/// Reads key `cell`.
pub(super) fn read(value: &Value<'_>, folder: &Path) -> Option<PathBuf> {
    let text = value.text()?;
    if text.trim().is_empty() {
        value.refuse("cell is empty; the file of a cell is expected", None);
        return None;
    }
    Some(folder.join(text))
}
