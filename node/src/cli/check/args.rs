//! Arguments of `lineshaft check`.

use crate::cell::Preset;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct CheckArgs {
    /// The cell
    pub(super) cell: PathBuf,
    /// A scenario for it
    #[arg(long, value_name = "FILE")]
    pub(super) scenario: Option<PathBuf>,
    /// Draw its function slots, and who reads what of whom: FILE.svg; one that exists is replaced
    #[arg(long, value_name = "FILE")]
    pub(super) graph: Option<PathBuf>,
    /// Hold it to the bounds of a source that are narrower
    #[arg(long, value_enum)]
    pub(super) preset: Option<PresetArg>,
    /// Print one JSON object (docs/json.md) instead of the lines
    #[arg(long)]
    pub(super) json: bool,
}

/// A source to whose bounds a cell is held.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum PresetArg {
    /// Fast functions of AMKASYN: 16 slots, 8 axes; docs/functions.md has all
    Amkasyn,
}

impl From<PresetArg> for Preset {
    fn from(preset: PresetArg) -> Self {
        match preset {
            PresetArg::Amkasyn => Self::Amkasyn,
        }
    }
}
