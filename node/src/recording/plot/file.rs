//! Figures as files.

use super::{Figure, Problem, draw};
use std::ffi::OsString;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The format of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Scalable Vector Graphics.
    Svg,
    /// Portable Network Graphics.
    Png,
}

impl Target {
    /// The format that the ending of a file's name asks for.
    ///
    /// # Errors
    /// [`Problem::Ending`]
    pub fn of(path: &Path) -> Result<Self, Problem> {
        match path.extension().map(|ending| ending.to_ascii_lowercase()) {
            Some(ending) if ending == "svg" => Ok(Self::Svg),
            Some(ending) if ending == "png" => Ok(Self::Png),
            _ => Err(Problem::Ending { name: path.display().to_string() }),
        }
    }
}

/// Draws a figure and writes it; a file that exists is replaced. Where that fails, nothing is left and an old file stays.
///
/// # Errors
/// [`Problem`]
pub fn write(figure: &Figure<'_>, path: &Path) -> Result<(), Problem> {
    replace(path, &draw(figure, Target::of(path)?)?)
}

/// Writes a figure; a file that exists is replaced. Where that fails, nothing is left and an old file stays.
///
/// # Errors
/// [`Problem::File`]
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), Problem> {
    let beside = beside(path);
    let written = fs::File::create(&beside)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&beside, path));
    written.map_err(|error| {
        // It may never have existed.
        let _ = fs::remove_file(&beside);
        Problem::File { name: path.display().to_string(), reason: error.to_string() }
    })
}

/// A name in the same folder, so that the file can take the place of the old one in one step.
fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}
