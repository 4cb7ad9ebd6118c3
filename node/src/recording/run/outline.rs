//! Scans one file without unpacking its chunks: finds its end, attachments and metadata.

use super::error::{Cut, Damage, Reason, RunError};
use super::fields::{Fields, MessageHead};
use super::records::{Frame, HEAD, Records, op, what};
use lineshaft_ros::layer::open_file;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Maximum size of names and metadata that are kept of one file, in bytes.
const MAX_KEPT: u64 = 16 << 20;
/// Memory of a kept name in addition to its text, in bytes.
const ENTRY: u64 = 128;
/// Size of the start of an attachment that contains its names, in bytes.
const ATTACHMENT_HEAD: u64 = 4096;
/// Sizes of a footer and of the checksum at its end, in bytes.
const FOOTER: u64 = 8 + 8 + CRC;
const CRC: u64 = 4;
/// Size of the start of a message or a chunk that contains its time, in bytes.
const MESSAGE_HEAD: u64 = MessageHead::LENGTH as u64;

/// A file attached to a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Name of the attachment.
    pub name: String,
    /// Media type, such as `text/yaml`.
    pub media_type: String,
    /// Length, in bytes.
    pub bytes: u64,
    /// Record of the attachment.
    pub(super) frame: Frame,
}

/// One file of a run.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Path of the file.
    pub path: PathBuf,
    /// Name for messages.
    pub name: String,
    /// Length, in bytes.
    pub bytes: u64,
    /// Profile of the MCAP file; `ros2` for bags.
    pub profile: String,
    /// Program that wrote the file.
    pub library: String,
    /// Attachments in the order of the file.
    pub attachments: Vec<Attachment>,
    /// Metadata records in the order of the file: name, keys and values.
    pub metadata: Vec<(String, BTreeMap<String, String>)>,
    /// Time of the first message, in ns, if there is any.
    pub first_time: Option<u64>,
    /// Missing part, if any.
    pub cut: Option<Cut>,
    /// Defect after the data, with its offset in bytes; no message is lost by it.
    pub(super) flaw: Option<(u64, Damage)>,
    /// Offset after the last record that is read.
    pub(super) end: u64,
    /// Checksum of the data, if the file has one.
    pub(super) crc: Option<u32>,
}

impl Outline {
    /// Scans a file.
    pub(super) fn read(path: &Path) -> Result<Self, RunError> {
        let open = |error| RunError::Open { path: path.to_owned(), error };
        let about = fs::metadata(path).map_err(open)?;
        if !about.is_file() {
            return Err(RunError::Special { path: path.to_owned() });
        }
        check_start(path)?;
        let name = path.display().to_string();
        let records = Records::open(path, &name, about.len(), false)?;
        let outline = Self {
            path: path.to_owned(),
            name,
            bytes: about.len(),
            profile: String::new(),
            library: String::new(),
            attachments: Vec::new(),
            metadata: Vec::new(),
            first_time: None,
            cut: None,
            flaw: None,
            end: 0,
            crc: None,
        };
        Scan { records, outline, kept: 0, is_finished: false }.all()
    }
}

/// Checks that the file is an MCAP file or the start of one.
fn check_start(path: &Path) -> Result<(), RunError> {
    const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
    let mut start = Vec::new();
    let file = open_file(path).map_err(|error| RunError::Open { path: path.to_owned(), error })?;
    let read = file.take(16).read_to_end(&mut start);
    read.map_err(|error| RunError::Open { path: path.to_owned(), error })?;
    let path = path.to_owned();
    if start.starts_with(b"SQLite format 3") {
        Err(RunError::Database { path })
    } else if start.starts_with(&ZSTD) {
        Err(RunError::Compressed { path, what: "this file is compressed as a whole", hint: "`zstd -d` unpacks it" })
    } else if start.starts_with(mcap::MAGIC) || mcap::MAGIC.starts_with(&start) {
        Ok(())
    } else {
        Err(RunError::NoMcap { path })
    }
}

/// A file during the scan.
struct Scan {
    records: Records,
    outline: Outline,
    /// Memory of the outline, in bytes.
    kept: u64,
    /// Whether the file has a regular end.
    is_finished: bool,
}

impl Scan {
    fn all(mut self) -> Result<Outline, RunError> {
        let magic = mcap::MAGIC.len() as u64;
        if self.outline.bytes < magic {
            self.cut(0, Reason::Start);
            return Ok(self.outline);
        }
        let mut last = [0; mcap::MAGIC.len()];
        self.records.seek(self.outline.bytes - magic)?;
        self.records.take(&mut last)?;
        self.is_finished = last == *mcap::MAGIC && self.outline.bytes > magic;
        self.records.seek(magic)?;
        let mut is_first = true;
        while let Some(frame) = self.next()? {
            if is_first && frame.kind != op::HEADER {
                return Err(self.records.damaged(frame.at, Damage::NoHeader));
            }
            is_first = false;
            self.keep(frame)?;
            self.records.skip_to(frame.end())?;
            if frame.kind == op::DATA_END {
                self.outline.end = frame.end();
                match self.index(frame.end())? {
                    Some((_, damage)) if !self.is_finished && !matches!(damage, Damage::TrailingBytes { .. }) => {
                        self.cut(frame.end(), Reason::Index);
                    }
                    flaw => self.outline.flaw = flaw,
                }
                break;
            }
        }
        Ok(self.outline)
    }

    /// Returns the next complete record; `None` if the file was cut off.
    fn next(&mut self) -> Result<Option<Frame>, RunError> {
        let (at, left) = (self.records.at(), self.records.left());
        if left == 0 {
            self.cut(at, if at == mcap::MAGIC.len() as u64 { Reason::Start } else { Reason::NoEnd });
            return Ok(None);
        }
        if left < HEAD {
            if self.is_finished {
                return Err(self.records.damaged(at, Damage::Length { claimed: HEAD, left }));
            }
            let mut kind = [0];
            self.records.take(&mut kind)?;
            let reason = if kind == [0] { Reason::Zeros } else { Reason::Within(what(kind[0])) };
            self.cut(at, reason);
            return Ok(None);
        }
        let frame = self.records.head()?;
        if frame.kind == 0 && !self.is_finished && self.are_all_zero()? {
            self.cut(at, Reason::Zeros);
            return Ok(None);
        }
        self.check_kind(frame)?;
        let left = self.records.left();
        if frame.length > left {
            if self.is_finished {
                return Err(self.records.damaged(at, Damage::Length { claimed: frame.length, left }));
            }
            self.cut(at, Reason::Within(what(frame.kind)));
            return Ok(None);
        }
        Ok(Some(frame))
    }

    /// Returns the defect of the index, which begins at `start`, of the footer, or of the bytes after them, if any.
    /// Their content is not used otherwise.
    fn index(&mut self, start: u64) -> Result<Option<(u64, Damage)>, RunError> {
        let footer = loop {
            let (at, left) = (self.records.at(), self.records.left());
            if left < HEAD {
                return Ok(Some((at, Damage::Length { claimed: HEAD, left })));
            }
            let frame = self.records.head()?;
            let left = self.records.left();
            if frame.length > left {
                return Ok(Some((at, Damage::Length { claimed: frame.length, left })));
            }
            let damage = match frame.kind {
                op::FOOTER if frame.length == FOOTER => break frame,
                op::FOOTER => Damage::Record,
                op::SCHEMA
                | op::CHANNEL
                | op::CHUNK_INDEX
                | op::ATTACHMENT_INDEX
                | op::STATISTICS
                | op::METADATA_INDEX
                | op::SUMMARY_OFFSET
                | 0x80.. => {
                    self.records.skip_to(frame.end())?;
                    continue;
                }
                kind @ op::HEADER..=op::DATA_END => Damage::InIndex(what(kind)),
                kind => Damage::Opcode(kind),
            };
            return Ok(Some((at, damage)));
        };
        let mut body = Vec::new();
        self.records.body(footer, &mut body)?;
        let (covered, crc) = body.split_at(body.len() - CRC as usize);
        let Ok(written) = Fields::new(crc).u32() else { return Ok(Some((footer.at, Damage::Record))) };
        let found = self.crc_of(start, footer.end() - covered.len() as u64 - CRC, covered)?;
        if written != 0 && written != found {
            return Ok(Some((start, Damage::IndexCrc { found, written })));
        }
        let mut mark = [0; mcap::MAGIC.len()];
        if self.records.left() < mark.len() as u64 {
            return Ok(Some((footer.end(), Damage::NoMark)));
        }
        self.records.take(&mut mark)?;
        if mark != *mcap::MAGIC {
            return Ok(Some((footer.end(), Damage::NoMark)));
        }
        let (at, bytes) = (self.records.at(), self.records.left());
        Ok((bytes > 0).then_some((at, Damage::TrailingBytes { bytes })))
    }

    /// Returns the checksum of the bytes from `start` to `end`, followed by `behind`.
    fn crc_of(&mut self, start: u64, end: u64, behind: &[u8]) -> Result<u32, RunError> {
        let back = self.records.at();
        self.records.seek(start)?;
        let mut crc = crc32fast::Hasher::new();
        let mut piece = [0; 4096];
        while self.records.at() < end {
            let length = piece.len().min((end - self.records.at()) as usize);
            self.records.take(&mut piece[..length])?;
            crc.update(&piece[..length]);
        }
        crc.update(behind);
        self.records.seek(back)?;
        Ok(crc.finalize())
    }

    fn cut(&mut self, read: u64, reason: Reason) {
        let Outline { name, bytes, .. } = &self.outline;
        self.outline.cut = Some(Cut { file: name.clone(), read_bytes: read, file_bytes: *bytes, reason });
        self.outline.end = read;
    }

    /// Whether all bytes from the head of the last record on are zero.
    fn are_all_zero(&mut self) -> Result<bool, RunError> {
        let start = self.records.at() - HEAD;
        let back = self.records.at();
        self.records.seek(start)?;
        let mut piece = [0; 4096];
        let mut all_zero = true;
        while all_zero && self.records.left() > 0 {
            let length = piece.len().min(self.records.left() as usize);
            self.records.take(&mut piece[..length])?;
            all_zero = piece[..length].iter().all(|byte| *byte == 0);
        }
        self.records.seek(back)?;
        Ok(all_zero)
    }

    /// Returns an error for a record of the index before the end of the data, and for an unknown record.
    fn check_kind(&self, frame: Frame) -> Result<(), RunError> {
        let damage = match frame.kind {
            op::FOOTER
            | op::CHUNK_INDEX
            | op::ATTACHMENT_INDEX
            | op::STATISTICS
            | op::METADATA_INDEX
            | op::SUMMARY_OFFSET => Damage::NoDataEnd,
            op::HEADER..=op::DATA_END | 0x80.. => return Ok(()),
            kind => Damage::Opcode(kind),
        };
        Err(self.records.damaged(frame.at, damage))
    }

    /// Keeps the information of a record for the outline.
    fn keep(&mut self, frame: Frame) -> Result<(), RunError> {
        let is_first = self.outline.first_time.is_none();
        let length = match frame.kind {
            op::HEADER | op::METADATA | op::DATA_END => frame.length,
            op::ATTACHMENT => frame.length.min(ATTACHMENT_HEAD),
            op::CHUNK | op::MESSAGE if is_first => frame.length.min(MESSAGE_HEAD),
            _ => return Ok(()),
        };
        let damaged = |look: &Self, damage| look.records.damaged(frame.at, damage);
        if length > MAX_KEPT {
            let damage = Damage::TooLong { what: what(frame.kind), bytes: length, most: MAX_KEPT };
            return Err(damaged(self, damage));
        }
        let mut body = vec![0; length as usize];
        self.records.take(&mut body)?;
        let kept = self.keep_body(frame, &body).map_err(|damage| damaged(self, damage))?;
        self.kept += kept;
        if self.kept > MAX_KEPT {
            let what = "what stands beside the messages";
            return Err(damaged(self, Damage::TooLong { what, bytes: self.kept, most: MAX_KEPT }));
        }
        Ok(())
    }

    /// Keeps the body of a record; returns its memory in bytes.
    fn keep_body(&mut self, frame: Frame, body: &[u8]) -> Result<u64, Damage> {
        let mut fields = Fields::new(body);
        match frame.kind {
            op::HEADER => {
                self.outline.profile = fields.text()?.to_owned();
                self.outline.library = fields.text()?.to_owned();
            }
            op::METADATA => {
                let (name, map) = (fields.text()?.to_owned(), fields.map()?);
                let entries = 1 + map.len() as u64;
                self.outline.metadata.push((name, map));
                return Ok(body.len() as u64 + entries * ENTRY);
            }
            op::ATTACHMENT => {
                let _times = (fields.u64()?, fields.u64()?);
                let (name, media_type) = (fields.text()?.to_owned(), fields.text()?.to_owned());
                let bytes = fields.u64()?;
                let kept = (name.len() + media_type.len()) as u64 + ENTRY;
                self.outline.attachments.push(Attachment { name, media_type, bytes, frame });
                return Ok(kept);
            }
            op::DATA_END => self.outline.crc = Some(fields.u32()?).filter(|crc| *crc != 0),
            op::CHUNK => self.outline.first_time = Some(fields.u64()?),
            _ => self.outline.first_time = Some(MessageHead::read(body)?.log_time),
        }
        Ok(0)
    }
}
