//! Starters: the files that `lineshaft new` writes, a commented cell and a scenario that passes with it.
//!
//! Law      all files of a kind are written next to each other, or none; an existing file is replaced only on request
//! Refuses  a file that does not end in .yaml, a name that would have to be quoted in YAML, an existing file, a folder
//!          that cannot be written

mod kinds;

pub(crate) use kinds::{KINDS, StarterKind};

use crate::whole_file::WholeFile;
use kinds::{CELL, SCENARIO};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Files of a starter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Starter {
    /// Paths in the order of the kind: the cell, the scenario, the files that they name.
    pub(crate) paths: Vec<PathBuf>,
    texts: Vec<String>,
}

impl Starter {
    /// Creates the files of a kind for the cell at `file`.
    ///
    /// # Errors
    /// Returns an error message for a name that no cell of a starter may have.
    pub(crate) fn new(kind: &StarterKind, file: &Path) -> Result<Self, String> {
        let name = cell_name(file)?;
        let path = |(end, _): &(&str, &str)| file.with_file_name(format!("{name}{end}"));
        let paths = kind.files.iter().map(path).collect();
        let texts = kind.files.iter().map(|(_, text)| kind.text_for(text, name)).collect();
        Ok(Self { paths, texts })
    }

    /// Writes the files; with `replace` also over existing ones.
    ///
    /// # Errors
    /// Returns an error message about a file that exists or cannot be written; then nothing is written.
    pub(crate) fn write(&self, replace: bool) -> Result<(), String> {
        if replace { self.replace() } else { self.create() }
    }

    fn create(&self) -> Result<(), String> {
        let exists = |path: &&PathBuf| path.symlink_metadata().is_ok();
        if let Some(path) = self.paths.iter().find(exists) {
            return Err(existing(path));
        }
        for (place, (path, text)) in self.paths.iter().zip(&self.texts).enumerate() {
            // `create_new` never opens a file that appeared since then.
            let written = File::create_new(path).and_then(|mut file| {
                let written = file.write_all(text.as_bytes()).and_then(|()| file.sync_all());
                written.inspect_err(|_| remove(path))
            });
            if let Err(error) = written {
                self.paths.iter().take(place).for_each(|path| remove(path));
                return Err(refused(path, &error));
            }
        }
        Ok(())
    }

    /// All new files are complete before the first one replaces an old one.
    fn replace(&self) -> Result<(), String> {
        let mut files = Vec::new();
        for (path, text) in self.paths.iter().zip(&self.texts) {
            if path.is_dir() {
                return Err(format!("{}: is a folder; nothing was written", path.display()));
            }
            files.push(WholeFile::write(path, text.as_bytes(), None).map_err(|error| refused(path, &error))?);
        }
        for (file, path) in files.into_iter().zip(&self.paths) {
            file.replace().map_err(|error| format!("{}: cannot be replaced: {error}", path.display()))?;
        }
        Ok(())
    }
}

/// Returns cell or scenario of the built-in demo, as they are printed.
pub(crate) fn demo(scenario: bool) -> &'static str {
    let end = if scenario { SCENARIO } else { CELL };
    let mut files = KINDS.iter().filter(|kind| kind.name == "demo").flat_map(|kind| kind.files);
    files.find(|(known, _)| *known == end).map_or("", |(_, text)| text)
}

/// Removes an incomplete file of a starter; an error is ignored, because nothing else can be done.
fn remove(path: &Path) {
    let _ = fs::remove_file(path);
}

/// Returns the name of a cell: its file without .yaml. It is written into other files, so only some characters are
/// permitted.
fn cell_name(file: &Path) -> Result<&str, String> {
    let shown = file.display();
    let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let Some(stem) = name.strip_suffix(CELL).filter(|stem| !stem.is_empty()) else {
        return Err(format!("{shown}: the file of a cell must end in .yaml, such as machine.yaml"));
    };
    if let Some(cell) = name.strip_suffix(SCENARIO) {
        return Err(format!("{shown}: is the name of a scenario; give that of the cell, {cell}.yaml"));
    }
    let is_allowed = |sign: char| sign.is_alphanumeric() || "_-.".contains(sign);
    if !stem.starts_with(char::is_alphanumeric) || !stem.chars().all(is_allowed) {
        return Err(format!("{shown}: the name must be a letter or digit, then letters, digits, `_`, `-` and `.`"));
    }
    Ok(stem)
}

fn existing(path: &Path) -> String {
    format!("{}: exists already; nothing was written. --force replaces it", path.display())
}

fn refused(path: &Path, error: &io::Error) -> String {
    let shown = path.display();
    match error.kind() {
        io::ErrorKind::AlreadyExists => existing(path),
        io::ErrorKind::NotFound => format!("{shown}: its folder does not exist; nothing was written"),
        _ => format!("{shown}: cannot be written: {error}; nothing was written"),
    }
}

#[cfg(test)]
mod tests;
