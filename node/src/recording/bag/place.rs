//! What a path given for a bag means, and whether a bag may be made there (contract section 6).

use super::BagError;
use crate::recording::metadata;
use lineshaft_ros::layer::open_file;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read};
use std::iter;
use std::path::{Path, PathBuf};

/// How metadata.yaml tells that it describes a bag of one file, as [`Place::kind`] has it.
const ONE_FILE: &str = "lineshaft_bag: \"file\"";

/// Where a bag is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// One file, metadata.yaml beside it.
    File(PathBuf),
    /// A folder with files `<name>_0.mcap`, `<name>_1.mcap` .. and metadata.yaml.
    Folder {
        /// The folder.
        path: PathBuf,
        /// Its name.
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

    /// Takes the place, as far as it may be taken.
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

    /// Bags of one file may share a folder, and metadata.yaml there describes the newest one. That of a bag which needs it
    /// stays.
    fn may_describe(&self) -> Result<(), BagError> {
        let path = self.usual_description();
        let refused =
            |why: String| Err(BagError::Refused(format!("{} {why}; name a folder of its own", path.display())));
        match read(&path) {
            Ok(Some(text)) if !is_of_one_file(&text) => refused("describes another bag".to_owned()),
            Ok(_) => Ok(()),
            // Whatever it is, it would be replaced.
            Err(error) => refused(format!("cannot be read: {error}")),
        }
    }

    /// Where metadata.yaml of this bag is written. That of another bag of one file which is still there is kept under the
    /// name of that bag: `a.metadata.yaml`.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn description(&self) -> io::Result<PathBuf> {
        let usual = self.usual_description();
        let Self::File(own) = self else { return Ok(usual) };
        let Some(text) = read(&usual)? else { return Ok(usual) };
        if !is_of_one_file(&text) {
            // It came after this bag was begun, and its bag needs it.
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

    /// The other bag of one file in the folder that a description lists.
    fn other_bag(&self, description: &str) -> Option<PathBuf> {
        let is_other = |path: &PathBuf| {
            let name = path.file_name().filter(|name| Some(*name) != self.path().file_name());
            let line = name.and_then(OsStr::to_str).map(|name| format!("    - {}", metadata::quoted(name)));
            line.is_some_and(|line| description.lines().any(|listed| listed == line))
        };
        fs::read_dir(self.folder()).ok()?.flatten().map(|entry| entry.path()).find(is_other)
    }

    /// What metadata.yaml tells of the place: name and value.
    pub(super) fn kind(&self) -> (&'static str, &'static str) {
        ("lineshaft_bag", if self.is_folder() { "folder" } else { "file" })
    }

    /// The folder that holds the files and metadata.yaml.
    pub(super) fn folder(&self) -> &Path {
        match self {
            Self::File(path) => match path.parent() {
                Some(folder) if folder != Path::new("") => folder,
                _ => Path::new("."),
            },
            Self::Folder { path, .. } => path,
        }
    }

    /// As it was given.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::File(path) | Self::Folder { path, .. } => path,
        }
    }

    /// A bag of several files?
    pub(super) fn is_folder(&self) -> bool {
        matches!(self, Self::Folder { .. })
    }

    /// Path of a file of the bag, counted from 0.
    pub(super) fn file(&self, number: usize) -> PathBuf {
        match self {
            Self::File(path) => path.clone(),
            Self::Folder { path, name } => path.join(format!("{name}_{number}.mcap")),
        }
    }

    /// Makes a file of the bag.
    pub(super) fn open(&self, path: &Path) -> io::Result<File> {
        let mut options = OpenOptions::new();
        match self {
            // An empty one may be there.
            Self::File(_) => options.write(true).create(true).truncate(false).open(path),
            Self::Folder { .. } => options.write(true).create_new(true).open(path),
        }
    }

    /// Takes an empty folder away again.
    pub(super) fn release(&self) {
        if let Self::Folder { path, .. } = self {
            // With files in it, it stays.
            let _ = fs::remove_dir(path);
        }
    }
}

/// A description, if there is one.
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

/// Where the description of a bag of one file is kept; it replaces an older one of such a bag, and nothing else.
fn kept(bag: &Path) -> PathBuf {
    let numbers = (2..).map(|number: u64| format!("{number}.{}", metadata::FILE_NAME));
    let endings = iter::once(metadata::FILE_NAME.to_owned()).chain(numbers);
    let is_free = |path: &PathBuf| {
        path.symlink_metadata().is_err() || matches!(read(path), Ok(Some(text)) if is_of_one_file(&text))
    };
    endings.map(|ending| bag.with_extension(ending)).find(is_free).unwrap_or_default()
}

/// Keeps a description under another name. Another recorder may have done it meanwhile.
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

    /// Two bags that end at the same time see the description of the same third one.
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
