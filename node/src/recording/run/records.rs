//! Reads the records of one file, one after the other.
//!
//! Law      a record is its kind (one byte), the length of its body (u64) and its body
//! Refuses  lengths beyond the end of the file, and lengths beyond the memory limit

use super::error::{Damage, RunError};
use lineshaft_ros::layer::open_file;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

pub(super) use mcap::records::op;

/// Maximum length of a record that is read into memory, in bytes.
pub(super) const MAX_RECORD: u64 = 256 << 20;
/// Number of bytes before the body of a record.
pub(super) const HEAD: u64 = 1 + 8;

/// Location of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Frame {
    pub kind: u8,
    /// Offset of its first byte.
    pub at: u64,
    /// Length of its body, in bytes.
    pub length: u64,
}

impl Frame {
    /// Returns the offset after the record.
    pub(super) fn end(&self) -> u64 {
        self.at + HEAD + self.length
    }
}

/// Returns the name of a kind of record, with its article.
pub(super) fn what(kind: u8) -> &'static str {
    match kind {
        op::HEADER => "the header",
        op::SCHEMA => "a schema",
        op::CHANNEL => "a channel",
        op::MESSAGE => "a message",
        op::CHUNK => "a chunk",
        op::MESSAGE_INDEX => "an index of messages",
        op::ATTACHMENT => "an attachment",
        op::METADATA => "a record of metadata",
        op::DATA_END => "the end of the data",
        _ => "a record",
    }
}

/// Reads a file record by record; parts of a body that are not requested are skipped.
#[derive(Debug)]
pub(super) struct Records {
    file: BufReader<File>,
    name: String,
    at: u64,
    /// Offset at which reading ends.
    end: u64,
    /// CRC over all bytes so far, if requested, and over those before the last record.
    crc: Option<crc32fast::Hasher>,
    crc_before: Option<crc32fast::Hasher>,
}

impl Records {
    /// Opens a file at its first byte; reading ends at `end`.
    pub(super) fn open(path: &Path, name: &str, end: u64, with_crc: bool) -> Result<Self, RunError> {
        let file = open_file(path).map_err(|error| RunError::Open { path: path.to_owned(), error })?;
        let crc = with_crc.then(crc32fast::Hasher::new);
        let file = BufReader::with_capacity(1 << 16, file);
        Ok(Self { file, name: name.to_owned(), at: 0, end, crc, crc_before: None })
    }

    /// Returns the offset of the next byte.
    pub(super) fn at(&self) -> u64 {
        self.at
    }

    /// Returns the number of remaining bytes.
    pub(super) fn left(&self) -> u64 {
        self.end.saturating_sub(self.at)
    }

    /// Returns the checksum of all bytes before the last record, if requested.
    pub(super) fn crc_before(&self) -> Option<u32> {
        self.crc_before.clone().map(crc32fast::Hasher::finalize)
    }

    /// Reads the next bytes.
    pub(super) fn take(&mut self, buffer: &mut [u8]) -> Result<(), RunError> {
        self.file.read_exact(buffer).map_err(|error| self.failed(error))?;
        if let Some(crc) = &mut self.crc {
            crc.update(buffer);
        }
        self.at += buffer.len() as u64;
        Ok(())
    }

    /// Reads kind and length of the next record, whose head must be in the file.
    pub(super) fn head(&mut self) -> Result<Frame, RunError> {
        let at = self.at;
        self.crc_before.clone_from(&self.crc);
        let (mut kind, mut length) = ([0], [0; 8]);
        self.take(&mut kind)?;
        self.take(&mut length)?;
        Ok(Frame { kind: kind[0], at, length: u64::from_le_bytes(length) })
    }

    /// Returns the next record, or `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Frame>, RunError> {
        if self.left() == 0 {
            return Ok(None);
        }
        let frame = self.head()?;
        // The file was scanned before; if this does not hold, it has changed since.
        if frame.length > self.left() {
            return Err(self.damaged(frame.at, Damage::Length { claimed: frame.length, left: self.left() }));
        }
        Ok(Some(frame))
    }

    /// Reads the body of the record whose head was read; replaces the content of `buffer`.
    pub(super) fn body(&mut self, frame: Frame, buffer: &mut Vec<u8>) -> Result<(), RunError> {
        if frame.length > MAX_RECORD {
            let damage = Damage::TooLong { what: what(frame.kind), bytes: frame.length, most: MAX_RECORD };
            return Err(self.damaged(frame.at, damage));
        }
        buffer.clear();
        buffer.resize(frame.length as usize, 0);
        self.take(buffer)
    }

    /// Skips all bytes before `to`.
    pub(super) fn skip_to(&mut self, to: u64) -> Result<(), RunError> {
        if self.crc.is_none() {
            // A file has at most i64::MAX bytes.
            let far = i64::try_from(to.saturating_sub(self.at)).unwrap_or(i64::MAX);
            self.file.seek_relative(far).map_err(|error| self.failed(error))?;
            self.at = to;
            return Ok(());
        }
        let mut piece = [0; 4096];
        while self.at < to {
            let length = piece.len().min((to - self.at) as usize);
            self.take(&mut piece[..length])?;
        }
        Ok(())
    }

    /// Moves to a byte offset, forwards or backwards.
    pub(super) fn seek(&mut self, to: u64) -> Result<(), RunError> {
        self.file.seek(SeekFrom::Start(to)).map_err(|error| self.failed(error))?;
        self.at = to;
        Ok(())
    }

    /// Returns the error of a record at byte `at`.
    pub(super) fn damaged(&self, at: u64, damage: Damage) -> RunError {
        RunError::Damaged { file: self.name.clone(), at, damage }
    }

    fn failed(&self, error: std::io::Error) -> RunError {
        RunError::Read { file: self.name.clone(), at: self.at, error }
    }
}
