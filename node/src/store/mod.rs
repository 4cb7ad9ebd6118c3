//! Store: keeps layer User of the parameters in a file across restarts of the program (MACS-STO-04, MACS-STO-06).
//!
//! Law      a confirmed set is on the disk, complete; after any interruption of a write, the file has the previous set
//!          or the new one. Reading gives the written parameters bit by bit
//! Writes   only if the file differs, because its medium endures only some ten thousand writes (MACS-STO-06)
//! Refuses  a store that another program uses; a damaged one without a valid previous generation; one that does not fit
//!          the cell
//!
//! The file has the values that differ from the cell, so that an edit of the cell applies to all values that were never
//! saved.

mod file;
mod read;
mod text;

use crate::document::Problems;
use file::{Files, Present, StoredFiles};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::parameter::{AxisParameters, MachineParameters};
use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

pub use read::{Stored, read_store};
pub use text::store_text;

/// Reason why a store cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The path is invalid for a store.
    #[error("{}: {reason}", .path.display())]
    Place {
        /// Path as given.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// Another program uses it.
    #[error("{}: another program keeps its parameters there; end it, or name another file with --store", .0.display())]
    InUse(PathBuf),
    /// Neither of the two generations can be read.
    #[error(
        "{}: it is damaged: {current}. {before}. Put a good copy in its place, or delete it to begin with the values of \
         the cell", .path.display()
    )]
    Damaged {
        /// Path of the store.
        path: PathBuf,
        /// Defect of the current file.
        current: String,
        /// Defect of the previous generation.
        before: String,
    },
    /// The store does not fit the cell.
    #[error(
        "{problems}{}: the machine does not start with it; mend the cell, name another file with --store, or delete this \
         one: what was saved is lost then", .path.display()
    )]
    Unfit {
        /// Path of the file.
        path: PathBuf,
        /// All values that do not fit.
        problems: Problems,
    },
    /// The store is read-only.
    #[error("{}: parameters are not kept there: {reason}", .path.display())]
    ReadOnly {
        /// Path of the store.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// An error of the operating system.
    #[error("{}: parameters cannot be written: {error}; what was saved before stands", .path.display())]
    Write {
        /// Path of the store.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The text would not give the same parameters when read.
    #[error("{}: these parameters cannot be written without a loss; what was saved before stands", .0.display())]
    Inexact(PathBuf),
}

/// File that keeps layer User of one machine.
#[derive(Debug)]
pub struct Store {
    files: Files,
    /// Lock, held during the lifetime of this object and released when the process ends in any way; or the reason why
    /// the store is read-only.
    lock: Result<File, String>,
    /// Valid text, and its file.
    found: Option<(PathBuf, String)>,
    present: Present,
    /// Saved values in the valid file.
    body: String,
    generation: u64,
}

impl Store {
    /// Opens a store for this program only. The file need not exist; its folder must exist.
    ///
    /// # Errors
    /// Returns an error if another program uses it, if both generations are damaged, or if it is no file or cannot be
    /// read.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let files = Files::of(path)?;
        let lock = match lock(&files.lock) {
            Ok(lock) => Ok(lock),
            Err(TryLockError::WouldBlock) => return Err(StoreError::InUse(files.current)),
            Err(TryLockError::Error(error)) => Err(format!("{}: {error}", files.lock.display())),
        };
        Self::read(files, lock)
    }

    /// Does the same; if another program uses the store, it is opened read-only.
    ///
    /// # Errors
    /// Returns the same errors, except for use by another program.
    pub fn open_read_only_if_used(path: &Path) -> Result<Self, StoreError> {
        match Self::open(path) {
            Err(StoreError::InUse(_)) => {
                Self::read(Files::of(path)?, Err("another program keeps its own there".into()))
            }
            opened => opened,
        }
    }

    fn read(files: Files, lock: Result<File, String>) -> Result<Self, StoreError> {
        let StoredFiles { text, present } = files.find()?;
        let (body, generation) = text.as_ref().map_or((text::body(&[]), 0), |(_, text)| {
            (text::body_of(text).to_owned(), text::generation_of(text).unwrap_or(0))
        });
        let store = Self { files, lock, found: text, present, body, generation };
        if let Err(reason) = &store.lock {
            tracing::warn!("{}: it is read, but nothing will be saved there: {reason}", store.path().display());
        }
        Ok(store)
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.files.current
    }

    /// Returns the number of the set in the file; 0 before the first one.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Applies the saved values to `config`, as layer User at its start.
    ///
    /// # Errors
    /// Returns an error if the saved values do not fit that cell; nothing is changed then.
    pub fn load(&self, config: &mut MachineConfig) -> Result<(), StoreError> {
        let Some((path, text)) = &self.found else { return Ok(()) };
        let label = path.display().to_string();
        let stored =
            read_store(&label, text, config).map_err(|problems| StoreError::Unfit { path: path.clone(), problems })?;
        for line in text::differences(config, &stored.sets) {
            tracing::debug!("{label}: {line}");
        }
        if stored.values > 0 {
            let axes: Vec<_> = std::iter::zip(&config.axes, &stored.sets)
                .filter_map(|(axis, set)| set.as_ref().map(|_| axis.name.as_str()))
                .chain(stored.machine.map(|_| "the machine"))
                .collect();
            let (values, take) =
                if stored.values == 1 { ("1 value", "takes") } else { (&*format!("{} values", stored.values), "take") };
            tracing::info!(
                "{label}: {values} of {} {take} the place of what the cell says; generation {}",
                axes.join(", "),
                stored.generation
            );
        }
        stored.put_into(config);
        Ok(())
    }

    /// Writes layer User; returns false if the file has that set already.
    ///
    /// # Errors
    /// Returns an error if the set cannot be written; the file is unchanged.
    #[cfg(test)]
    pub fn keep(&mut self, config: &MachineConfig, user: &[AxisParameters]) -> Result<bool, StoreError> {
        self.keep_all(config, user, &config.global.power_on())
    }

    /// Writes layer User of the axes and of the machine; returns false if the file has that set already.
    ///
    /// # Errors
    /// Returns an error if the set cannot be written; the file is unchanged.
    pub fn keep_all(
        &mut self,
        config: &MachineConfig,
        user: &[AxisParameters],
        machine: &MachineParameters,
    ) -> Result<bool, StoreError> {
        self.keep_while(config, (user, machine), &mut |_| Ok(()))
    }

    /// Reads the file again, because another program may have changed, damaged or deleted it.
    fn look_again(&mut self) {
        let (present, found) = self.files.reread();
        let path = self.path().display();
        let known = self.found.as_ref().filter(|(path, _)| path == self.path()).map(|(_, text)| text);
        match (present, found) {
            (Present::Good, Ok(text)) if known == Some(&text) => {}
            (_, Ok(text)) => {
                tracing::warn!("{path}: somebody has put another set there; what is saved now takes its place");
                self.generation = self.generation.max(text::generation_of(&text).unwrap_or(0));
                self.body = text::body_of(&text).to_owned();
                self.found = Some((self.path().to_owned(), text));
            }
            (Present::Missing, Err(_)) => {
                if self.present != Present::Missing {
                    tracing::warn!("{path}: somebody has taken it away; what is saved now is all that it holds");
                }
                (self.body, self.found) = (text::body(&[]), None);
            }
            (_, Err(reason)) => {
                if self.present != Present::Damaged {
                    tracing::warn!("{path}: somebody has damaged it: {reason}; what is saved now takes its place");
                }
                self.found = None;
            }
        }
        self.present = present;
    }

    /// Writes a set; `may` is called before each step on the disk.
    fn keep_while(
        &mut self,
        config: &MachineConfig,
        (user, machine): (&[AxisParameters], &MachineParameters),
        may: &mut dyn FnMut(&'static str) -> io::Result<()>,
    ) -> Result<bool, StoreError> {
        self.look_again();
        let sets: Vec<_> = std::iter::zip(&config.axes, user).collect();
        let body = text::body_with(&sets, (&config.global.parameters, machine));
        if body == self.body && self.present != Present::Damaged {
            return Ok(false);
        }
        let path = self.path().to_owned();
        if let Err(reason) = &self.lock {
            return Err(StoreError::ReadOnly { path, reason: reason.clone() });
        }
        let generation = self.generation.saturating_add(1);
        let text = text::whole(generation, &body);
        if !gives(&text, config, user, machine) {
            return Err(StoreError::Inexact(path));
        }
        self.files.replace(&text, self.present, may).map_err(|error| StoreError::Write { path, error })?;
        (self.body, self.generation, self.present) = (body, generation, Present::Good);
        self.found = Some((self.path().to_owned(), text));
        tracing::debug!("{}: generation {generation} is on the disk", self.path().display());
        Ok(true)
    }
}

/// Whether the text gives these parameters, bit by bit.
fn gives(text: &str, config: &MachineConfig, user: &[AxisParameters], machine: &MachineParameters) -> bool {
    let Ok(stored) = read_store("store", text, config) else { return false };
    if stored.machine.unwrap_or(config.global.parameters) != *machine {
        return false;
    }
    std::iter::zip(&config.axes, stored.sets).map(|(axis, set)| set.unwrap_or(axis.parameters)).eq(user.iter().copied())
}

/// A process that is being started has a copy of the lock for a moment, so that closing it would not be sufficient.
impl Drop for Store {
    fn drop(&mut self) {
        if let Ok(lock) = &self.lock {
            // Closing also releases it, as soon as there is no copy.
            let _ = lock.unlock();
        }
    }
}

fn lock(path: &Path) -> Result<File, TryLockError> {
    // Opening a pipe would block until its other end is opened.
    if path.exists() && !path.is_file() {
        return Err(TryLockError::Error(io::Error::other("it is no file")));
    }
    let file = File::options().create(true).truncate(false).write(true).open(path).map_err(TryLockError::Error)?;
    file.try_lock()?;
    Ok(file)
}

#[cfg(test)]
mod tests;
