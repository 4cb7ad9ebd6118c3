//! The files of a store: the present one, the generation before it, and how one takes the place of the other.
//!
//! Law      the present name always leads to a whole file, at every moment and after a cut of power

use super::{StoreError, text};
use crate::document::MAX_BYTES;
use lineshaft_ros::layer::open_file;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Where the files of a store are, all in one folder.
#[derive(Clone, Debug)]
pub(super) struct Files {
    pub current: PathBuf,
    /// The generation before.
    pub previous: PathBuf,
    /// Held by the program that writes.
    pub lock: PathBuf,
    /// What becomes the present one.
    new: PathBuf,
    /// What becomes the generation before.
    old: PathBuf,
    folder: PathBuf,
}

/// How the present file was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Present {
    /// There is none.
    Missing,
    /// Whole.
    Good,
    /// Not whole: it must not become the generation before.
    Damaged,
}

/// What counts: a file and its text.
#[derive(Debug)]
pub(super) struct Found {
    pub text: Option<(PathBuf, String)>,
    pub present: Present,
}

/// What a look into a file shows.
enum Look {
    Missing,
    Good(String),
    Damaged(String),
}

impl Files {
    /// The files of the store `path`; where it is a link, those of the file that it leads to.
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

    /// What counts. Damage is told.
    pub(super) fn find(&self) -> Result<Found, StoreError> {
        let current = match look(&self.current)? {
            Look::Good(text) => {
                return Ok(Found { text: Some((self.current.clone(), text)), present: Present::Good });
            }
            Look::Missing => {
                if self.previous.exists() {
                    tracing::warn!(
                        "{} is not there, so nothing is saved; {} is the generation before, and goes with the next save",
                        self.current.display(),
                        self.previous.display()
                    );
                }
                return Ok(Found { text: None, present: Present::Missing });
            }
            Look::Damaged(reason) => reason,
        };
        let before = match look(&self.previous)? {
            Look::Good(text) => {
                let generation = text::generation_of(&text).unwrap_or(0);
                tracing::warn!(
                    "{}: it is damaged: {current}; the generation before, {}, is used: number {generation}",
                    self.current.display(),
                    self.previous.display()
                );
                return Ok(Found { text: Some((self.previous.clone(), text)), present: Present::Damaged });
            }
            Look::Missing => "There is no generation before".to_owned(),
            Look::Damaged(reason) => format!("The generation before, {}, too: {reason}", self.previous.display()),
        };
        Err(StoreError::Damaged { path: self.current.clone(), current, before })
    }

    /// What the present file holds now; beside its text why it is no good one.
    pub(super) fn again(&self) -> (Present, Result<String, String>) {
        match look(&self.current) {
            Ok(Look::Missing) => (Present::Missing, Err("it is not there".to_owned())),
            Ok(Look::Good(text)) => (Present::Good, Ok(text)),
            Ok(Look::Damaged(reason)) => (Present::Damaged, Err(reason)),
            Err(error) => (Present::Damaged, Err(error.to_string())),
        }
    }

    /// Puts a new text in the place of the present file, which becomes the generation before if it is whole. `may` is asked
    /// before each step.
    ///
    /// # Errors
    /// The disk's; the present file is what it was.
    pub(super) fn replace(
        &self,
        text: &str,
        present: Present,
        may: &mut dyn FnMut(&'static str) -> io::Result<()>,
    ) -> io::Result<()> {
        let replaced = self.steps(text, present, may);
        if replaced.is_err() {
            // What is left of them is replaced by the next save.
            let _ = [&self.new, &self.old].map(fs::remove_file);
        }
        replaced
    }

    /// The same without clearing up, as a program that is killed does not.
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
                // Not every file system has links.
                fs::hard_link(&self.current, &self.old).or_else(|_| copy(&self.current, &self.old))?;
                may("keep")?;
                fs::rename(&self.old, &self.previous)?;
                // Two names of one file are not renamed onto each other; then both stay.
                remove(&self.old)?;
            }
            // Who took the present one away wants no older one either.
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

fn look(path: &Path) -> Result<Look, StoreError> {
    let mut bytes = Vec::new();
    let read = open_file(path).and_then(|file| file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes));
    match read {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Look::Missing),
        // That is put right by who runs it.
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {
            return Err(StoreError::Place { path: path.to_owned(), reason: format!("it cannot be read: {error}") });
        }
        Err(error) => return Ok(Look::Damaged(format!("it cannot be read: {error}"))),
        Ok(_) => {}
    }
    if bytes.len() > MAX_BYTES {
        return Ok(Look::Damaged(format!("it is longer than {MAX_BYTES} bytes")));
    }
    Ok(text::checked(bytes).map_or_else(Look::Damaged, Look::Good))
}

/// Where a link leads behind which nothing is yet.
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
