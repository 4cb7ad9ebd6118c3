//! A simulated disk that becomes full.

use super::super::Medium;
use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// Free space in bytes, shared by all files of a bag.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Space(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    left: usize,
    files: Vec<Vec<u8>>,
    /// Number of calls after the disk was first full, except truncations.
    writes_after: usize,
    is_full: bool,
}

impl Space {
    pub(in super::super) fn of(bytes: usize) -> Self {
        Self(Arc::new(Mutex::new(State { left: bytes, ..State::default() })))
    }

    fn with<T>(&self, act: impl FnOnce(&mut State) -> T) -> T {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the bytes of the only file.
    pub(in super::super) fn bytes(&self) -> Vec<u8> {
        self.with(|state| state.files.iter().flatten().copied().collect())
    }

    pub(super) fn files(&self) -> Vec<Vec<u8>> {
        self.with(|state| state.files.clone())
    }

    pub(super) fn writes_after(&self) -> usize {
        self.with(|state| state.writes_after)
    }
}

/// A file on such a disk: it accepts a part of a write, as disks do, and then nothing more.
pub(in super::super) struct Small {
    space: Space,
    number: usize,
}

impl Small {
    pub(in super::super) fn new(space: &Space) -> Self {
        let number = space.with(|state| {
            state.files.push(Vec::new());
            state.files.len() - 1
        });
        Self { space: space.clone(), number }
    }
}

impl Write for Small {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.space.with(|state| {
            state.writes_after += usize::from(state.is_full);
            let taken = bytes.len().min(state.left);
            if taken == 0 && !bytes.is_empty() {
                state.is_full = true;
                return Err(io::ErrorKind::StorageFull.into());
            }
            state.left -= taken;
            state.files[self.number].extend_from_slice(&bytes[..taken]);
            Ok(taken)
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Medium for Small {
    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.space.with(|state| state.files[self.number].truncate(length as usize));
        Ok(())
    }
}
