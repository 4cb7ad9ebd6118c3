//! Bytes of one read from a stream.

use super::TransportError;
use super::way::{Loss, TransportState};
use std::io::Read;

/// Maximum number of bytes of one read.
const ROOM: usize = 512;

/// Piece of a stream.
#[derive(Debug)]
pub(super) struct Piece {
    bytes: [u8; ROOM],
    /// The bytes from `at` to `end` are still to be taken.
    at: usize,
    end: usize,
}

impl Piece {
    pub(super) fn new() -> Self {
        Self { bytes: [0; ROOM], at: 0, end: 0 }
    }

    /// Returns the next byte; `None` at the end of the piece.
    pub(super) fn next(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at..self.end)?.first()?;
        self.at += 1;
        Some(byte)
    }

    /// Reads the next piece. Returns false if no byte has arrived.
    ///
    /// # Errors
    /// The stream has ended or failed.
    pub(super) fn read(&mut self, stream: &mut impl Read, way: &mut TransportState) -> Result<bool, TransportError> {
        (self.at, self.end) = (0, 0);
        match way.unless_would_block(stream.read(&mut self.bytes))? {
            Some(0) => Err(way.mark_lost(Loss::Ended)),
            Some(count) => {
                self.end = count;
                Ok(true)
            }
            None => Ok(false),
        }
    }
}
