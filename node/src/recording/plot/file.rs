//! Figures as files.

use super::{Figure, Problem, draw};
use crate::whole_file::WholeFile;
use std::path::Path;

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
    let written = WholeFile::write(path, bytes, None).and_then(WholeFile::take_place);
    written.map_err(|error| Problem::File { name: path.display().to_string(), reason: error.to_string() })
}
