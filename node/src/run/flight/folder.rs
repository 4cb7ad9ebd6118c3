//! Folder for bags of the flight recorder: it keeps a limited number and removes the oldest ones.

use super::super::decoder::Decoder;
use super::Segments;
use crate::recording::bag::{Bag, BagError, BagOptions, Subject, Summary};
use crate::recording::date_and_time;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fmt, io};

/// Prefix of the name of every bag.
const PREFIX: &str = "flight_";

/// Maximum number of nodes with the same name that get their own folder.
const MOST_NODES: u32 = 100;

/// A folder of saved bags, for one node only.
#[derive(Clone, Debug)]
pub struct FlightFolder {
    folder: PathBuf,
    keep: usize,
    /// Held while the node runs; the operating system releases it when the process ends in any way.
    _lock: Arc<File>,
}

impl fmt::Display for FlightFolder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.folder.display().fmt(f)
    }
}

impl FlightFolder {
    /// Creates a folder, if necessary, that keeps at most `keep` bags, at least 1.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be created or written, or if another node uses it.
    pub fn create(folder: PathBuf, keep: usize) -> Result<Self, BagError> {
        let failed = |path: &Path, error| BagError::Write { path: path.to_owned(), error };
        fs::create_dir_all(&folder).map_err(|error| failed(&folder, error))?;
        // Permissions and limits of the file system are only known after a write.
        let trial = folder.join(format!(".trial_{}", std::process::id()));
        let made = fs::create_dir(&trial).and_then(|()| fs::remove_dir(&trial));
        made.map_err(|error| failed(&trial, error))?;
        // The lock of the folder itself; the store of parameters in it has its own lock.
        let lock = File::open(&folder).map_err(|error| failed(&folder, error))?;
        match lock.try_lock() {
            Ok(()) => Ok(Self { folder, keep: keep.max(1), _lock: Arc::new(lock) }),
            Err(TryLockError::WouldBlock) => {
                Err(BagError::Refused(format!("{}: another node keeps its flight recorder there", folder.display())))
            }
            Err(TryLockError::Error(error)) => Err(failed(&folder, error)),
        }
    }

    /// Does the same, with `_2`, `_3`, ... appended to the name if other nodes use it.
    ///
    /// # Errors
    /// Returns an error if no such folder can be created.
    pub fn create_unique(folder: &Path, keep: usize) -> Result<Self, BagError> {
        let mut created = Self::create(folder.to_owned(), keep);
        for number in 2..MOST_NODES {
            if !matches!(created, Err(BagError::Refused(_))) {
                break;
            }
            let mut name = folder.as_os_str().to_owned();
            name.push(format!("_{number}"));
            created = Self::create(name.into(), keep);
        }
        created
    }

    /// Saves cycles as a bag, then removes the oldest bags beyond the maximum number.
    ///
    /// # Errors
    /// Returns an error if the folder or the bag cannot be written, or if there is nothing to save.
    pub fn save(&self, kept: &Segments, decoder: &mut Decoder, subject: &Subject) -> Result<Summary, BagError> {
        let Some((cycle, stamp_ns)) = kept.newest() else {
            let sentence = "the flight recorder has kept no cycle yet that a bag can begin with";
            return Err(BagError::Refused(sentence.to_owned()));
        };
        // The folder may have been deleted.
        let folder = &self.folder;
        fs::create_dir_all(folder).map_err(|error| BagError::Write { path: folder.clone(), error })?;
        let name = format!("{PREFIX}{}_{:012}", date_and_time(stamp_ns), cycle);
        let options = BagOptions { path: folder.join(name), ..BagOptions::default() };
        let mut bag = Bag::create(&options, Subject::clone(subject))?;
        kept.decode(decoder, |cycle| bag.write(cycle))?;
        let summary = bag.finish()?;
        if let Err(error) = self.remove_oldest(&summary.path) {
            tracing::warn!("{self}: old bags of the flight recorder cannot be removed: {error}");
        }
        Ok(summary)
    }

    /// Removes the oldest bags; `newest` is kept whatever its time is.
    fn remove_oldest(&self, newest: &Path) -> io::Result<()> {
        let mut bags: Vec<PathBuf> = Vec::new();
        for entry in fs::read_dir(&self.folder)? {
            let entry = entry?;
            let is_ours = entry.file_type()?.is_dir() && entry.file_name().to_str().is_some_and(is_bag);
            if is_ours && entry.path() != newest {
                bags.push(entry.path());
            }
        }
        // The order of names is that of the times.
        bags.sort_unstable();
        let surplus = (bags.len() + 1).saturating_sub(self.keep);
        bags.iter().take(surplus).try_for_each(fs::remove_dir_all)
    }
}

/// Whether it is the name of a bag of the flight recorder, such as `flight_20261121_152804_000000048211`. No other file
/// is ever removed.
fn is_bag(name: &str) -> bool {
    let Some(rest) = name.strip_prefix(PREFIX) else { return false };
    let lengths: Vec<usize> = rest.split('_').map(str::len).collect();
    matches!(lengths[..], [8, 6, digits] if digits >= 12)
        && rest.bytes().all(|byte| byte.is_ascii_digit() || byte == b'_')
}
