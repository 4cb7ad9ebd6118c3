//! Files of a store: the current one, the previous generation, and the replacement of one by the other.
//!
//! Law      the current name always refers to a complete file, at every moment and after a power failure

use super::{StoreError, text};
use crate::document::MAX_BYTES;
use lineshaft_ros::layer::open_file;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Paths of the files of a store, all in one folder.
#[derive(Clone, Debug)]
pub(super) struct Files {
    pub current: PathBuf,
    /// Previous generation.
    pub previous: PathBuf,
    /// Lock file, locked by the program that writes.
    pub lock: PathBuf,
    /// File that becomes the current one.
    new: PathBuf,
    /// File that becomes the previous generation.
    old: PathBuf,
    folder: PathBuf,
}

/// State of the current file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Present {
    /// The file does not exist.
    Missing,
    /// The file is complete.
    Good,
    /// The file is damaged; it must not become the previous generation.
    Damaged,
}

/// The valid file, and its text.
#[derive(Debug)]
pub(super) struct StoredFiles {
    pub text: Option<(PathBuf, String)>,
    pub present: Present,
}

/// Result of reading a file.
enum ReadResult {
    Missing,
    Good(String),
    Damaged(String),
}

impl Files {
    /// Returns the files of the store `path`; for a symbolic link, those of its target.
    pub(super) fn of(path: &Path) -> Result<Self, StoreError> {
        let refuse = |reason: String| StoreError::Place { path: path.to_owned(), reason };
        let path = &fs::canonicalize(path).unwrap_or_else(|_| behind_link(path));
        let name = path.file_name().ok_or_else(|| refuse("it is no name of a file".to_owned()))?.to_owned();
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        if !folder.is_dir() {
            return Err(refuse(format!("there is no folder {}", folder.display())));
        }
        if path.exists() && !path.is_file() {
            return Err(refuse("it is no file".to_owned()));
        }
        let beside = |before: &str, after: &str| {
            let mut beside = OsString::from(before);
            beside.push(&name);
            beside.push(after);
            folder.join(beside)
        };
        Ok(Self {
            current: path.clone(),
            previous: beside("", ".previous"),
            lock: beside(".", ".lock"),
            new: beside(".", ".new"),
            old: beside(".", ".old"),
            folder,
        })
    }

    /// Returns the valid file. Reports damage.
    pub(super) fn find(&self) -> Result<StoredFiles, StoreError> {
        let current = match look(&self.current)? {
            ReadResult::Good(text) => {
                return Ok(StoredFiles { text: Some((self.current.clone(), text)), present: Present::Good });
            }
            ReadResult::Missing => {
                if self.previous.exists() {
                    tracing::warn!(
                        "{} is not there, so nothing is saved; {} is the generation before, and goes with the next save",
                        self.current.display(),
                        self.previous.display()
                    );
                }
                return Ok(StoredFiles { text: None, present: Present::Missing });
            }
            ReadResult::Damaged(reason) => reason,
        };
        let before = match look(&self.previous)? {
            ReadResult::Good(text) => {
                let generation = text::generation_of(&text).unwrap_or(0);
                tracing::warn!(
                    "{}: it is damaged: {current}; the generation before, {}, is used: number {generation}",
                    self.current.display(),
                    self.previous.display()
                );
                return Ok(StoredFiles { text: Some((self.previous.clone(), text)), present: Present::Damaged });
            }
            ReadResult::Missing => "There is no generation before".to_owned(),
            ReadResult::Damaged(reason) => format!("The generation before, {}, too: {reason}", self.previous.display()),
        };
        Err(StoreError::Damaged { path: self.current.clone(), current, before })
    }

    /// Returns the present state of the current file, with its text or the reason why it is invalid.
    pub(super) fn reread(&self) -> (Present, Result<String, String>) {
        match look(&self.current) {
            Ok(ReadResult::Missing) => (Present::Missing, Err("it is not there".to_owned())),
            Ok(ReadResult::Good(text)) => (Present::Good, Ok(text)),
            Ok(ReadResult::Damaged(reason)) => (Present::Damaged, Err(reason)),
            Err(error) => (Present::Damaged, Err(error.to_string())),
        }
    }

    /// Replaces the current file by a new text; the current file becomes the previous generation if it is complete.
    /// `may` is called before each step.
    ///
    /// # Errors
    /// Returns the error of the disk; the current file is then unchanged.
    pub(super) fn replace(
        &self,
        text: &str,
        present: Present,
        may: &mut dyn FnMut(&'static str) -> io::Result<()>,
    ) -> io::Result<()> {
        let replaced = self.steps(text, present, may);
        if replaced.is_err() {
            // Remaining files are replaced by the next save.
            let _ = [&self.new, &self.old].map(fs::remove_file);
        }
        replaced
    }

    /// Does the same without cleanup, like a program that is killed.
    pub(super) fn steps(
        &self,
        text: &str,
        present: Present,
        may: &mut dyn FnMut(&'static str) -> io::Result<()>,
    ) -> io::Result<()> {
        may("clear")?;
        [&self.new, &self.old].into_iter().try_for_each(|left| remove(left))?;
        may("create")?;
        let mut new = File::create_new(&self.new)?;
        if let Ok(known) = fs::metadata(&self.current) {
            new.set_permissions(known.permissions())?;
        }
        may("write")?;
        new.write_all(text.as_bytes())?;
        may("sync")?;
        new.sync_all()?;
        match present {
            Present::Good => {
                may("link")?;
                // Not every file system has hard links.
                fs::hard_link(&self.current, &self.old).or_else(|_| copy(&self.current, &self.old))?;
                may("keep")?;
                fs::rename(&self.old, &self.previous)?;
                // Renaming has no effect if both names refer to one file; then both remain.
                remove(&self.old)?;
            }
            // A user who deleted the current file does not want the older one either.
            Present::Missing => {
                may("forget")?;
                remove(&self.previous)?;
            }
            Present::Damaged => {}
        }
        may("rename")?;
        fs::rename(&self.new, &self.current)?;
        may("sync folder")?;
        File::open(&self.folder)?.sync_all()
    }
}

fn look(path: &Path) -> Result<ReadResult, StoreError> {
    let mut bytes = Vec::new();
    let read = open_file(path).and_then(|file| file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes));
    match read {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(ReadResult::Missing),
        // The user must fix the permissions.
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            return Err(StoreError::Place { path: path.to_owned(), reason: format!("it cannot be read: {error}") });
        }
        Err(error) => return Ok(ReadResult::Damaged(format!("it cannot be read: {error}"))),
        Ok(_) => {}
    }
    if bytes.len() > MAX_BYTES {
        return Ok(ReadResult::Damaged(format!("it is longer than {MAX_BYTES} bytes")));
    }
    Ok(text::checked(bytes).map_or_else(ReadResult::Damaged, ReadResult::Good))
}

/// Returns the target of a symbolic link whose target does not exist.
fn behind_link(path: &Path) -> PathBuf {
    let target = fs::read_link(path).ok();
    target.map_or_else(|| path.to_owned(), |target| path.parent().map_or(target.clone(), |folder| folder.join(&target)))
}

fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::copy(from, to)?;
    File::open(to)?.sync_all()
}
