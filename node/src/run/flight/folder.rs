//! Where the bags of the flight recorder go: a folder that holds a few of them, the oldest making room for the newest.

use super::super::decoder::Decoder;
use super::Kept;
use crate::recording::bag::{Bag, BagError, BagOptions, Subject, Summary};
use crate::recording::date_and_time;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fmt, io};

/// How the name of every bag begins.
const PREFIX: &str = "flight_";

/// Most nodes of one name that find a folder of their own.
const MOST_NODES: u32 = 100;

/// A folder of saved bags, for one node alone.
#[derive(Clone, Debug)]
pub struct FlightFolder {
    folder: PathBuf,
    keep: usize,
    /// Held while the node runs; the system lets go of it when the process ends, however it ends.
    _lock: Arc<File>,
}

impl fmt::Display for FlightFolder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.folder.display().fmt(f)
    }
}

impl FlightFolder {
    /// A folder that holds at most `keep` bags, at least 1. It is made where it does not exist.
    ///
    /// # Errors
    /// The folder cannot be made, nothing can be made in it, or another node uses it.
    pub fn create(folder: PathBuf, keep: usize) -> Result<Self, BagError> {
        let failed = |path: &Path, error| BagError::Write { path: path.to_owned(), error };
        fs::create_dir_all(&folder).map_err(|error| failed(&folder, error))?;
        // What the rights and the file system allow shows only when something is made.
        let trial = folder.join(format!(".trial_{}", std::process::id()));
        let made = fs::create_dir(&trial).and_then(|()| fs::remove_dir(&trial));
        made.map_err(|error| failed(&trial, error))?;
        // The lock of the folder itself; the store of parameters beside the bags has a lock of its own.
        let lock = File::open(&folder).map_err(|error| failed(&folder, error))?;
        match lock.try_lock() {
            Ok(()) => Ok(Self { folder, keep: keep.max(1), _lock: Arc::new(lock) }),
            Err(TryLockError::WouldBlock) => {
                Err(BagError::Refused(format!("{}: another node keeps its flight recorder there", folder.display())))
            }
            Err(TryLockError::Error(error)) => Err(failed(&folder, error)),
        }
    }

    /// The same, with `_2`, `_3` .. behind the name where other nodes have it.
    ///
    /// # Errors
    /// No such folder can be made.
    pub fn create_beside(folder: &Path, keep: usize) -> Result<Self, BagError> {
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

    /// Saves cycles as a bag; then the oldest bags go, beyond as many as are kept.
    ///
    /// # Errors
    /// The folder or the bag cannot be written, or there is nothing to save.
    pub fn save(&self, kept: &Kept, decoder: &mut Decoder, subject: &Subject) -> Result<Summary, BagError> {
        let Some((cycle, stamp_ns)) = kept.newest() else {
            let sentence = "the flight recorder has kept no cycle yet that a bag can begin with";
            return Err(BagError::Refused(sentence.to_owned()));
        };
        // Somebody may have taken it away meanwhile.
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

    /// Removes the oldest bags; `newest` stays, whatever its time.
    fn remove_oldest(&self, newest: &Path) -> io::Result<()> {
        let mut bags: Vec<PathBuf> = Vec::new();
        for entry in fs::read_dir(&self.folder)? {
            let entry = entry?;
            let is_ours = entry.file_type()?.is_dir() && entry.file_name().to_str().is_some_and(is_bag);
            if is_ours && entry.path() != newest {
                bags.push(entry.path());
            }
        }
        // Names sort by time.
        bags.sort_unstable();
        let surplus = (bags.len() + 1).saturating_sub(self.keep);
        bags.iter().take(surplus).try_for_each(fs::remove_dir_all)
    }
}

/// Is it the name of a bag of the flight recorder, such as `flight_20261121_152804_000000048211`? Nothing else is ever removed.
fn is_bag(name: &str) -> bool {
    let Some(rest) = name.strip_prefix(PREFIX) else { return false };
    let lengths: Vec<usize> = rest.split('_').map(str::len).collect();
    matches!(lengths[..], [8, 6, digits] if digits >= 12)
        && rest.bytes().all(|byte| byte.is_ascii_digit() || byte == b'_')
}
