//! Path of a bag: its meaning, and whether a bag may be created there (contract section 6).

use super::BagError;
use crate::recording::metadata;
use lineshaft_ros::layer::open_file;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read};
use std::iter;
use std::path::{Path, PathBuf};

/// Line by which metadata.yaml shows that it describes a bag of one file, from [`Place::kind`].
const ONE_FILE: &str = "lineshaft_bag: \"file\"";

/// Location of a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// One file, with metadata.yaml next to it.
    File(PathBuf),
    /// A folder with files `<name>_0.mcap`, `<name>_1.mcap`, ... and metadata.yaml.
    Folder {
        /// Path of the folder.
        path: PathBuf,
        /// Name of the folder.
        name: String,
    },
}

impl Place {
    pub(super) fn of(path: &Path) -> Result<Self, BagError> {
        let refused = |reason: &str| BagError::Refused(format!("{}: {reason}", path.display()));
        let name = path.file_name().ok_or_else(|| refused("a bag needs a name of its own"))?;
        let name = name.to_str().ok_or_else(|| refused("the name of a bag must be UTF-8 text"))?;
        if path.extension() == Some(OsStr::new("mcap")) {
            return Ok(Self::File(path.to_owned()));
        }
        Ok(Self::Folder { path: path.to_owned(), name: name.to_owned() })
    }

    /// Reserves the path, if it is free.
    pub(super) fn claim(&self) -> Result<(), BagError> {
        match self {
            Self::File(path) => match fs::metadata(path) {
                Ok(found) if found.is_dir() => Err(exists(path, "is a folder")),
                Ok(found) if found.len() > 0 || !found.is_file() => Err(exists(path, "exists and is not empty")),
                _ => self.may_describe(),
            },
            Self::Folder { path, .. } => fs::create_dir(path).map_err(|error| match error.kind() {
                io::ErrorKind::AlreadyExists => exists(path, "exists"),
                _ => BagError::Write { path: path.clone(), error },
            }),
        }
    }

    /// Returns an error if metadata.yaml in the folder must not be replaced. Bags of one file may share a folder;
    /// metadata.yaml there describes the newest one. That of a bag which needs it is kept.
    fn may_describe(&self) -> Result<(), BagError> {
        let path = self.usual_description();
        let refused =
            |why: String| Err(BagError::Refused(format!("{} {why}; name a folder of its own", path.display())));
        match read(&path) {
            Ok(Some(text)) if !is_of_one_file(&text) => refused("describes another bag".to_owned()),
            Ok(_) => Ok(()),
            // An unreadable file would be replaced, whatever its content is.
            Err(error) => refused(format!("cannot be read: {error}")),
        }
    }

    /// Returns the path of metadata.yaml of this bag. An existing one of another bag of one file is kept under the name
    /// of that bag: `a.metadata.yaml`.
    ///
    /// # Errors
    /// Returns the error of the operating system.
    pub(super) fn description(&self) -> io::Result<PathBuf> {
        let usual = self.usual_description();
        let Self::File(own) = self else { return Ok(usual) };
        let Some(text) = read(&usual)? else { return Ok(usual) };
        if !is_of_one_file(&text) {
            // It was written after this bag was begun, and its bag needs it.
            return Ok(kept(own));
        }
        if let Some(other) = self.other_bag(&text) {
            keep(&usual, &kept(&other))?;
        }
        Ok(usual)
    }

    fn usual_description(&self) -> PathBuf {
        self.folder().join(metadata::FILE_NAME)
    }

    /// Returns the path of the other bag of one file in the folder that a description lists.
    fn other_bag(&self, description: &str) -> Option<PathBuf> {
        let is_other = |path: &PathBuf| {
            let name = path.file_name().filter(|name| Some(*name) != self.path().file_name());
            let line = name.and_then(OsStr::to_str).map(|name| format!("    - {}", metadata::quoted(name)));
            line.is_some_and(|line| description.lines().any(|listed| listed == line))
        };
        fs::read_dir(self.folder()).ok()?.flatten().map(|entry| entry.path()).find(is_other)
    }

    /// Returns the kind of bag for metadata.yaml, as name and value.
    pub(super) fn kind(&self) -> (&'static str, &'static str) {
        ("lineshaft_bag", if self.is_folder() { "folder" } else { "file" })
    }

    /// Returns the folder with the files and metadata.yaml.
    pub(super) fn folder(&self) -> &Path {
        match self {
            Self::File(path) => match path.parent() {
                Some(folder) if folder != Path::new("") => folder,
                _ => Path::new("."),
            },
            Self::Folder { path, .. } => path,
        }
    }

    /// Returns the path as given.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::File(path) | Self::Folder { path, .. } => path,
        }
    }

    /// Returns true for a bag of several files.
    pub(super) fn is_folder(&self) -> bool {
        matches!(self, Self::Folder { .. })
    }

    /// Returns the path of a file of the bag; numbers start at 0.
    pub(super) fn file(&self, number: usize) -> PathBuf {
        match self {
            Self::File(path) => path.clone(),
            Self::Folder { path, name } => path.join(format!("{name}_{number}.mcap")),
        }
    }

    /// Creates a file of the bag.
    pub(super) fn open(&self, path: &Path) -> io::Result<File> {
        let mut options = OpenOptions::new();
        match self {
            // An empty file may exist.
            Self::File(_) => options.write(true).create(true).truncate(false).open(path),
            Self::Folder { .. } => options.write(true).create_new(true).open(path),
        }
    }

    /// Removes the folder if it is empty.
    pub(super) fn release(&self) {
        if let Self::Folder { path, .. } = self {
            // A folder with files stays.
            let _ = fs::remove_dir(path);
        }
    }
}

/// Reads a description; returns `None` if there is none.
fn read(path: &Path) -> io::Result<Option<String>> {
    let mut text = String::new();
    match open_file(path).and_then(|mut file| file.read_to_string(&mut text)) {
        Ok(_) => Ok(Some(text)),
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether a description is that of a bag of one file of this program.
fn is_of_one_file(description: &str) -> bool {
    description.lines().any(|line| line.trim() == ONE_FILE)
}

/// Returns the path where the description of a bag of one file is kept. It may replace an older description of such a
/// bag, but no other file.
fn kept(bag: &Path) -> PathBuf {
    let numbers = (2..).map(|number: u64| format!("{number}.{}", metadata::FILE_NAME));
    let endings = iter::once(metadata::FILE_NAME.to_owned()).chain(numbers);
    let is_free = |path: &PathBuf| {
        path.symlink_metadata().is_err() || matches!(read(path), Ok(Some(text)) if is_of_one_file(&text))
    };
    endings.map(|ending| bag.with_extension(ending)).find(is_free).unwrap_or_default()
}

/// Renames a description to keep it. Another recorder may have done it already.
fn keep(description: &Path, path: &Path) -> io::Result<()> {
    match fs::rename(description, path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        done => done,
    }
}

fn exists(path: &Path, how: &str) -> BagError {
    BagError::Refused(format!("{} {how} already; a bag never replaces anything", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bags that end at the same time find the description of the same third bag.
    #[test]
    fn description_that_another_recorder_has_kept_meanwhile_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        let (usual, other) = (folder.path().join(metadata::FILE_NAME), folder.path().join("c.metadata.yaml"));
        fs::write(&usual, ONE_FILE).unwrap();
        keep(&usual, &other).unwrap();
        keep(&usual, &other).unwrap();
        assert_eq!(fs::read_to_string(&other).unwrap(), ONE_FILE);
        keep(&other, folder.path()).unwrap_err();
    }
}
