//! Figures of a run: signals as stacked panels over one time axis, events as numbered lines, as SVG or PNG. plotters draws axes,
//! ticks, meshes, curves and text; this module chooses signals, units and rows.
//!
//! Law      Signals of one quantity and unit share a panel, whose legend is above it. Bits, enums, words and numbers without a
//!          unit that seldom change are lanes of a timing diagram. Each axis has a unit, with a prefix for small and large
//!          values, and 1 for none; encoders in m or rad are shown in the unit of the axes. Signals chosen by a pattern that
//!          never change, or are a fraction, are named below, not drawn; so is how often a curve has no number, a value too
//!          large to draw, or a gap.
//! Reads    series in order of time, events in any order
//! Refuses  no series, none that changes, a size that holds no figure
//!
//! A figure is a pure function of its arguments: the same arguments make the same bytes on every machine, with the bundled font.
//! Colours are those of Okabe and Ito, which colour-blind people tell apart, each with its own dashes.

mod axis;
mod chart;
mod curve;
mod events;
mod lane;
mod pen;
mod pixels;
mod quantity;
mod signals;
#[cfg(test)]
mod tests;
mod text;

pub use axis::{Axis, Spacing};
pub use chart::{Chart, Curve, Panel, Pin, draw_chart};
pub use pen::Look;

use super::series::{Mark, Series};
use crate::whole_file::WholeFile;
use std::path::Path;

/// Smallest and largest width (px).
pub const WIDTHS: (u32, u32) = (500, 8000);
/// Smallest and largest height (px).
pub const HEIGHTS: (u32, u32) = (200, 20_000);
/// Most pixels of a PNG.
pub const MOST_PIXELS: u64 = 24_000_000;

/// A signal that is wanted in a figure.
#[derive(Clone, Copy, Debug)]
pub struct Chosen<'a> {
    /// The signal.
    pub series: &'a Series,
    /// Chosen by its full name: it is drawn even if it never changes.
    pub by_name: bool,
}

/// What lies along the axis that all panels share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Across {
    /// Time (s).
    #[default]
    Time,
    /// The place of a master (inc), where a series has times.
    Master,
}

impl Across {
    /// Its name, and its unit.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Time => ("time", "s"),
            Self::Master => ("master", "inc"),
        }
    }
}

/// What is to be drawn.
#[derive(Clone, Debug)]
pub struct Figure<'a> {
    /// One line on top; empty for none.
    pub title: String,
    /// In this order in legends and lanes.
    pub signals: Vec<Chosen<'a>>,
    /// Events; those outside of the time shown are left out.
    pub marks: &'a [Mark],
    /// First time shown (s); left out: that of the first point.
    pub from: Option<f64>,
    /// Last time shown (s); left out: that of the last point.
    pub to: Option<f64>,
    /// Along the shared axis.
    pub across: Across,
    /// Width (px), see [`WIDTHS`].
    pub width: u32,
    /// Height (px), see [`HEIGHTS`]; left out: what the panels need.
    pub height: Option<u32>,
    /// Each signal has a panel of its own.
    pub split: bool,
}

/// Why there is no figure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// Nothing was chosen.
    #[error("no signal is chosen")]
    NoSignal,
    /// No chosen signal has a value in the time shown.
    #[error("no chosen signal has a value{}{}", asked(*.from, *.to), there_is(*.run))]
    NoValue {
        /// As it was asked for (s).
        from: Option<f64>,
        /// As it was asked for (s).
        to: Option<f64>,
        /// From when to when (s) they have values.
        run: Option<(f64, f64)>,
    },
    /// Only signals that never change were chosen, by patterns.
    #[error(
        "none of the {count} chosen signals changes from {from} s to {to} s; one that is named in full is drawn all the same"
    )]
    NoChange {
        /// How many.
        count: usize,
        /// (s)
        from: f64,
        /// (s)
        to: f64,
    },
    /// The end lies before the start.
    #[error("the figure would end at {to} s, before its start at {from} s")]
    Backwards {
        /// (s)
        from: f64,
        /// (s)
        to: f64,
    },
    /// The width lies outside of its range.
    #[error("width {given} px is outside {} to {} px", WIDTHS.0, WIDTHS.1)]
    Width {
        /// (px)
        given: u32,
    },
    /// The height lies outside of its range.
    #[error("height {given} px is outside {} to {} px", HEIGHTS.0, HEIGHTS.1)]
    Height {
        /// (px)
        given: u32,
    },
    /// The height holds not all panels.
    #[error("{panels} need a height of {needed} px or more, not {given} px")]
    Low {
        /// What is to be drawn, in words.
        panels: String,
        /// (px)
        needed: u32,
        /// (px)
        given: u32,
    },
    /// More panels and lanes than a figure holds.
    #[error("{panels} would need a height of {needed} px, more than {} px; choose fewer signals", HEIGHTS.1)]
    High {
        /// What is to be drawn, in words.
        panels: String,
        /// (px)
        needed: u32,
    },
    /// More pixels than a PNG may have.
    #[error("{width} x {height} px are more than the {} million pixels of a PNG; an SVG may be as large", MOST_PIXELS / 1_000_000)]
    Pixels {
        /// (px)
        width: u32,
        /// (px)
        height: u32,
    },
    /// The name of the file ends with neither of the formats.
    #[error("{name} ends with neither .svg nor .png")]
    Ending {
        /// The file.
        name: String,
    },
    /// The file cannot be written.
    #[error("cannot write {name}: {reason}")]
    File {
        /// The file.
        name: String,
        /// What the system says.
        reason: String,
    },
    /// The picture could not be made.
    #[error("the picture cannot be made: {reason}")]
    Drawing {
        /// What the drawing library says.
        reason: String,
    },
}

/// ` from 3 s to 4 s`
fn asked(from: Option<f64>, to: Option<f64>) -> String {
    match (from, to) {
        (Some(from), Some(to)) => format!(" from {from} s to {to} s"),
        (Some(from), None) => format!(" from {from} s on"),
        (None, Some(to)) => format!(" up to {to} s"),
        (None, None) => String::new(),
    }
}

fn there_is(run: Option<(f64, f64)>) -> String {
    run.map_or(String::new(), |(from, to)| format!("; they have values from {from} s to {to} s"))
}

/// Draws a figure and returns the content of its file.
///
/// # Errors
/// [`Problem`], all but its variants about files.
pub fn draw(figure: &Figure<'_>, target: Target) -> Result<Vec<u8>, Problem> {
    signals::draw(figure, target)
}

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
