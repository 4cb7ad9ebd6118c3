//! Reads recorded runs of this program and of any other recorder that writes MCAP in the profile of rosbag2.
//!
//! Law      messages are returned file by file in the order of the file; only complete data is read: a chunk with a
//!          wrong checksum gives no message
//! Reads    one file, a folder, or the metadata.yaml of a bag
//! Refuses  other formats, folders of several runs, and sizes that would need too much memory; see [`RunError`]
//!
//! At most one chunk of a run is in memory, whatever its length. A file that was cut off, because its recorder was
//! killed or the disk was full, is read up to its last complete chunk or record; [`Run::cuts`] reports it.
//!
//! ```no_run
//! # use lineshaft::recording::run::{Run, RunError};
//! # fn main() -> Result<(), RunError> {
//! let mut run = Run::open("run.mcap".as_ref())?;
//! while let Some(message) = run.next_message()? {
//!     println!("{} {} {} bytes", message.log_time, message.topic, message.data.len());
//! }
//! for cut in run.cuts() {
//!     eprintln!("{cut}");
//! }
//! # Ok(())
//! # }
//! ```

mod error;
mod fields;
mod messages;
mod outline;
mod places;
mod records;

pub use error::{Cut, Damage, Reason, RunError};
pub use outline::{Attachment, Outline};

use fields::Fields;
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::cdr;
use messages::Messages;
use records::Records;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::path::Path;

/// A recorded message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// Topic name.
    pub topic: &'a str,
    /// ROS 2 type, such as `lineshaft_msgs/msg/Event`; empty if the file does not name it.
    pub kind: &'a str,
    /// Log time, in ns.
    pub log_time: u64,
    /// Publish time, in ns.
    pub publish_time: u64,
    /// Sequence number within its topic, given by the recorder.
    pub sequence: u32,
    /// Encoding; `cdr` from a ROS 2 recorder.
    pub encoding: &'a str,
    /// Encoded data; in CDR with its header of 4 bytes.
    pub data: &'a [u8],
    /// Index of its file in [`Run::files`].
    pub file: usize,
}

impl<'a> Message<'a> {
    /// Returns true if the message is in CDR.
    pub fn is_cdr(&self) -> bool {
        self.encoding == "cdr"
    }

    /// Returns the data of a message in CDR.
    ///
    /// # Errors
    /// Returns a message that names the encoding if it is not CDR.
    pub fn cdr(&self) -> Result<&'a [u8], String> {
        let sentence = || format!("it is encoded as `{}`; only cdr is read", excerpt(self.encoding));
        self.is_cdr().then_some(self.data).ok_or_else(sentence)
    }

    /// Decodes the message.
    ///
    /// # Errors
    /// Returns a message if the data is not CDR or does not match its type.
    pub fn decode<T: DeserializeOwned>(&self) -> Result<T, String> {
        cdr::decode_with_header(self.cdr()?).map_err(|error| error.to_string())
    }
}

/// A recorded run, with the position of the next message.
pub struct Run {
    files: Vec<Outline>,
    /// Reader of the current file.
    reader: Option<Messages>,
    /// Index of the file after it.
    next_file: usize,
    /// Number of messages read.
    messages: u64,
    progress: Option<ProgressSink>,
}

/// Callback with the number of bytes read so far and the number of bytes of all files.
type ProgressSink = Box<dyn FnMut(u64, u64) + Send>;

/// Number of messages between two calls of [`ProgressSink`].
const PROGRESS_MESSAGES: u64 = 256;

impl std::fmt::Debug for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Run").field("files", &self.files).field("next_file", &self.next_file).finish_non_exhaustive()
    }
}

impl Run {
    /// Opens a run and scans its files; their messages are not read yet.
    ///
    /// # Errors
    /// Returns an error if the path is no run, or if the files have a defect that shows without unpacking their
    /// messages.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        let run = Self::open_any(path)?;
        places::check_related(path, &run.files)?;
        Ok(run)
    }

    /// Opens a run like [`Run::open`], and also a folder with files of several runs, to report their content.
    ///
    /// # Errors
    /// Same errors as [`Run::open`].
    pub fn open_any(path: &Path) -> Result<Self, RunError> {
        Ok(Self { files: places::outlines(path)?, reader: None, next_file: 0, messages: 0, progress: None })
    }

    /// Returns true if all files of the run were recorded with the same cell.
    pub fn is_of_one_cell(&self) -> bool {
        places::unrelated(&self.files).is_none()
    }

    /// Returns the files in their order; at least one.
    pub fn files(&self) -> &[Outline] {
        &self.files
    }

    /// Returns the missing parts of files that were cut off.
    pub fn cuts(&self) -> impl Iterator<Item = &Cut> {
        self.files.iter().filter_map(|file| file.cut.as_ref())
    }

    /// Returns defects after the data of files; they cost no message.
    pub fn flaws(&self) -> impl Iterator<Item = RunError> {
        self.files.iter().filter_map(|file| {
            let (at, damage) = file.flaw.clone()?;
            Some(RunError::Damaged { file: file.name.clone(), at, damage })
        })
    }

    /// Returns the next message, or `None` at the end of the run.
    ///
    /// # Errors
    /// Returns an error if the next record or chunk is damaged. Nothing more is read after that.
    pub fn next_message(&mut self) -> Result<Option<Message<'_>>, RunError> {
        self.report_progress();
        let place = loop {
            let reader = match &mut self.reader {
                Some(reader) => reader,
                None => {
                    let Some(file) = self.files.get(self.next_file) else {
                        self.progress = None;
                        return Ok(None);
                    };
                    self.next_file += 1;
                    self.reader.insert(Messages::open(file)?)
                }
            };
            match reader.advance() {
                Ok(Some(place)) => break place,
                Ok(None) => self.reader = None,
                Err(error) => {
                    (self.reader, self.next_file) = (None, self.files.len());
                    return Err(error);
                }
            }
        };
        Ok(self.reader.as_ref().and_then(|reader| {
            let (channel, data) = reader.message(&place);
            Some(Message {
                topic: &channel?.topic,
                kind: &channel?.kind,
                log_time: place.head.log_time,
                publish_time: place.head.publish_time,
                sequence: place.head.sequence,
                encoding: &channel?.encoding,
                data,
                file: self.next_file - 1,
            })
        }))
    }

    /// Calls `progress` at intervals while messages are read, with the number of bytes read so far and the number of
    /// bytes of all files, until the end of the run or [`Run::end_progress`].
    pub fn set_progress(&mut self, progress: impl FnMut(u64, u64) + Send + 'static) {
        self.progress = Some(Box::new(progress));
    }

    /// Stops the calls of [`Run::set_progress`].
    pub fn end_progress(&mut self) {
        self.progress = None;
    }

    fn report_progress(&mut self) {
        let Some(progress) = &mut self.progress else { return };
        self.messages = self.messages.wrapping_add(1);
        if !self.messages.is_multiple_of(PROGRESS_MESSAGES) {
            return;
        }
        let begun: u64 = self.files.iter().take(self.next_file).map(|file| file.bytes).sum();
        let current = self.next_file.checked_sub(1).and_then(|place| self.files.get(place));
        // Only a part of the open file was read.
        let rest = self.reader.as_ref().zip(current).map_or(0, |(reader, file)| file.bytes.saturating_sub(reader.at()));
        progress(begun.saturating_sub(rest), self.files.iter().map(|file| file.bytes).sum());
    }

    /// Returns to the first message.
    pub fn rewind(&mut self) {
        (self.reader, self.next_file) = (None, 0);
    }

    /// Returns the bytes of the first attachment of that name, in the first file that has one.
    ///
    /// # Errors
    /// Same errors as [`Run::attachment_of`].
    pub fn attachment(&self, name: &str) -> Result<Option<Vec<u8>>, RunError> {
        for file in 0..self.files.len() {
            if let Some(bytes) = self.attachment_of(file, name)? {
                return Ok(Some(bytes));
            }
        }
        Ok(None)
    }

    /// Returns the bytes of the first attachment of that name in the file with this index.
    ///
    /// # Errors
    /// Returns an error if the bytes are damaged or would need too much memory.
    pub fn attachment_of(&self, file: usize, name: &str) -> Result<Option<Vec<u8>>, RunError> {
        let Some(outline) = self.files.get(file) else { return Ok(None) };
        let Some(attachment) = outline.attachments.iter().find(|attachment| attachment.name == name) else {
            return Ok(None);
        };
        let frame = attachment.frame;
        let mut records = Records::open(&outline.path, &outline.name, outline.end, false)?;
        records.seek(frame.at + records::HEAD)?;
        let mut body = Vec::new();
        records.body(frame, &mut body)?;
        data_of(name, &body).map(|data| Some(data.to_vec())).map_err(|damage| records.damaged(frame.at, damage))
    }

    /// Returns the first metadata record of that name, in the first file that has one.
    pub fn metadata(&self, name: &str) -> Option<&BTreeMap<String, String>> {
        let mut all = self.files.iter().flat_map(|file| &file.metadata);
        all.find(|(known, _)| known == name).map(|(_, map)| map)
    }
}

/// Returns the data of an attachment.
fn data_of<'b>(name: &str, body: &'b [u8]) -> Result<&'b [u8], Damage> {
    let mut fields = Fields::new(body);
    let _times = (fields.u64()?, fields.u64()?);
    let _names = (fields.text()?, fields.text()?);
    let data = fields.bytes()?;
    let covered = body.len() - fields.rest().len();
    let written = fields.u32()?;
    let found = crc32fast::hash(body.get(..covered).unwrap_or_default());
    if written != 0 && written != found {
        return Err(Damage::AttachmentCrc { name: name.to_owned(), found, written });
    }
    Ok(data)
}

/// Formats an integer in groups of three digits: `12 345`.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let first = digits.len() % 3;
    let (first, rest) = digits.split_at(first);
    let groups = rest.as_bytes().chunks(3).filter_map(|group| std::str::from_utf8(group).ok());
    let groups: Vec<&str> = std::iter::once(first).filter(|first| !first.is_empty()).chain(groups).collect();
    groups.join(" ")
}

#[cfg(test)]
mod tests;
