//! Draws figures of a run as SVG or PNG: signals as stacked panels over one time axis, events as numbered lines.
//! plotters draws axes, ticks, meshes, curves and text; this module chooses signals, units and rows.
//!
//! Law      signals of one quantity and unit share a panel, with the legend above it. Bits, enums, words, and numbers
//!          without a unit that change seldom are lanes of a timing diagram. Each axis has a unit, with a prefix for
//!          small and large values, or 1 if there is none; encoders in m or rad are shown in the unit of the axes.
//!          Signals chosen by a pattern that never change, or that are a fraction, are not drawn but named below.
//!          Numbers of NaN or infinite values, values too large to draw, and gaps of a curve are also given below.
//! Reads    series in order of time, events in any order
//! Refuses  no series, only constant series, a size too small or too large for a figure
//!
//! A figure is a pure function of its arguments: the same arguments give the same bytes on every machine, with the
//! bundled font. The colours are those of Okabe and Ito, which colour-blind people can distinguish, each with its own
//! dashes.

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
pub use chart::{Chart, Curve, MeasureMark, Panel, draw_chart};
pub use pen::LineStyle;

use super::series::{EventMark, Series};
use crate::whole_file::WholeFile;
use std::path::Path;

/// Minimum and maximum width, in px.
pub const WIDTHS: (u32, u32) = (500, 8000);
/// Minimum and maximum height, in px.
pub const HEIGHTS: (u32, u32) = (200, 20_000);
/// Maximum number of pixels of a PNG.
pub const MOST_PIXELS: u64 = 24_000_000;

/// A signal chosen for a figure.
#[derive(Clone, Copy, Debug)]
pub struct Chosen<'a> {
    /// The signal.
    pub series: &'a Series,
    /// Whether it was chosen by its full name; it is then drawn even if it never changes.
    pub by_name: bool,
}

/// Quantity of the horizontal axis that all panels share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Across {
    /// Time, in s.
    #[default]
    Time,
    /// Position of a master, in inc, in place of the times of a series.
    Master,
}

impl Across {
    /// Returns name and unit.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Time => ("time", "s"),
            Self::Master => ("master", "inc"),
        }
    }
}

/// Description of a figure.
#[derive(Clone, Debug)]
pub struct Figure<'a> {
    /// Title line; empty for none.
    pub title: String,
    /// Signals in the order of legends and lanes.
    pub signals: Vec<Chosen<'a>>,
    /// Events; those outside of the time shown are left out.
    pub marks: &'a [EventMark],
    /// First time shown, in s; `None` for that of the first point.
    pub from: Option<f64>,
    /// Last time shown, in s; `None` for that of the last point.
    pub to: Option<f64>,
    /// Quantity of the shared axis.
    pub across: Across,
    /// Width, in px; see [`WIDTHS`].
    pub width: u32,
    /// Height, in px; see [`HEIGHTS`]. `None` for the height that the panels need.
    pub height: Option<u32>,
    /// Whether each signal has its own panel.
    pub split: bool,
}

/// Reason why no figure is drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// No signal was chosen.
    #[error("no signal is chosen")]
    NoSignal,
    /// No chosen signal has a value in the time shown.
    #[error("no chosen signal has a value{}{}", range_text(*.from, *.to), there_is(*.run))]
    NoValue {
        /// Requested start, in s.
        from: Option<f64>,
        /// Requested end, in s.
        to: Option<f64>,
        /// First and last time with a value, in s.
        run: Option<(f64, f64)>,
    },
    /// Only signals that never change were chosen, by patterns.
    #[error(
        "none of the {count} chosen signals changes from {from} s to {to} s; one that is named in full is drawn all the same"
    )]
    NoChange {
        /// Number of signals.
        count: usize,
        /// Start, in s.
        from: f64,
        /// End, in s.
        to: f64,
    },
    /// The end is before the start.
    #[error("the figure would end at {to} s, before its start at {from} s")]
    Backwards {
        /// Start, in s.
        from: f64,
        /// End, in s.
        to: f64,
    },
    /// The width is outside of its range.
    #[error("width {given} px is outside {} to {} px", WIDTHS.0, WIDTHS.1)]
    Width {
        /// Given width, in px.
        given: u32,
    },
    /// The height is outside of its range.
    #[error("height {given} px is outside {} to {} px", HEIGHTS.0, HEIGHTS.1)]
    Height {
        /// Given height, in px.
        given: u32,
    },
    /// The height is too small for all panels.
    #[error("{panels} need a height of {needed} px or more, not {given} px")]
    Low {
        /// Number of panels and lanes, as text.
        panels: String,
        /// Minimum height, in px.
        needed: u32,
        /// Given height, in px.
        given: u32,
    },
    /// The figure has too many panels and lanes.
    #[error("{panels} would need a height of {needed} px, more than {} px; choose fewer signals", HEIGHTS.1)]
    High {
        /// Number of panels and lanes, as text.
        panels: String,
        /// Required height, in px.
        needed: u32,
    },
    /// The PNG has too many pixels.
    #[error("{width} x {height} px are more than the {} million pixels of a PNG; an SVG may be as large", MOST_PIXELS / 1_000_000)]
    Pixels {
        /// Width, in px.
        width: u32,
        /// Height, in px.
        height: u32,
    },
    /// The file extension is none of the formats.
    #[error("{name} ends with neither .svg nor .png")]
    Ending {
        /// Name of the file.
        name: String,
    },
    /// The file cannot be written.
    #[error("cannot write {name}: {reason}")]
    File {
        /// Name of the file.
        name: String,
        /// Error message of the operating system.
        reason: String,
    },
    /// The drawing library failed.
    #[error("the picture cannot be made: {reason}")]
    Drawing {
        /// Error message of the drawing library.
        reason: String,
    },
}

/// Returns text such as ` from 3 s to 4 s`.
fn range_text(from: Option<f64>, to: Option<f64>) -> String {
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
/// Returns any [`Problem`] except those about files.
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
    /// Returns the format for the extension of a file name.
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

/// Draws a figure and writes it to a file, replacing an existing one. After an error, no partial file remains and an
/// existing file is unchanged.
///
/// # Errors
/// [`Problem`]
pub fn write(figure: &Figure<'_>, path: &Path) -> Result<(), Problem> {
    replace(path, &draw(figure, Target::of(path)?)?)
}

/// Writes a figure to a file, replacing an existing one. After an error, no partial file remains and an existing file
/// is unchanged.
///
/// # Errors
/// [`Problem::File`]
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), Problem> {
    let written = WholeFile::write(path, bytes, None).and_then(WholeFile::replace);
    written.map_err(|error| Problem::File { name: path.display().to_string(), reason: error.to_string() })
}
