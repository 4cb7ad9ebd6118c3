//! `--record`: recording of a run.

use crate::recording::bag::BagOptions;
use crate::run::recorder::{BAG_DURATIONS, is_bag_duration};
use clap::Args;
use std::path::PathBuf;

/// Where and how a run is recorded.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct RecordArgs {
    /// Record the run from its first cycle on: `NAME.mcap` is that file, anything else a new folder (a rosbag2 bag)
    #[arg(long, value_name = "PATH")]
    record: Option<PathBuf>,
    /// Begin a new file of the bag beyond this size (bytes, 0 never), at the next full second of cycles; folders only
    #[arg(long, value_name = "BYTES", default_value_t = 0, requires = "record")]
    max_bag_size: u64,
    /// Begin a new file of the bag beyond this time (s, 0 never, 1 and more), at the next full second of cycles; folders only
    #[arg(long, value_name = "SECONDS", default_value = "0", requires = "record", value_parser = bag_duration)]
    max_bag_duration: u64,
}

impl RecordArgs {
    /// Returns the options of the recording, if one was requested.
    pub(super) fn options(&self) -> Option<BagOptions> {
        let path = self.record.clone()?;
        Some(BagOptions::split(path, self.max_bag_size, self.max_bag_duration))
    }
}

/// Parses a time in s; returns it in ns.
fn bag_duration(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if is_bag_duration(seconds) => Ok((seconds * 1e9) as u64),
        _ => Err(format!("{BAG_DURATIONS} is allowed")),
    }
}
