//! Recorded runs, of this program and of any other recorder that writes MCAP in the profile of rosbag2.
//!
//! Law      the messages of all files, file after file, in the order in which they stand; only what is whole is read: a chunk
//!          whose checksum is wrong gives no message
//! Reads    one file, a folder, or the metadata.yaml of a bag
//! Refuses  other formats, folders of several runs, and everything that no memory would be taken for; see [`RunError`]
//!
//! Of a run of any length no more than one chunk is in memory. A file that was cut off anywhere, because its recorder was
//! killed or the disk was full, is read up to its last whole chunk or record; [`Run::cuts`] tells of it.
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
    /// Name of its topic.
    pub topic: &'a str,
    /// Its type in ROS 2, as `lineshaft_msgs/msg/Event`; empty where the file does not tell.
    pub kind: &'a str,
    /// When it was recorded (ns).
    pub log_time: u64,
    /// When it was published (ns).
    pub publish_time: u64,
    /// Its number among those of its topic, as the recorder gave it.
    pub sequence: u32,
    /// How it is encoded: `cdr` where a recorder of ROS 2 wrote it.
    pub encoding: &'a str,
    /// As it stands; in CDR with its header of 4 bytes.
    pub data: &'a [u8],
    /// Place of its file in [`Run::files`].
    pub file: usize,
}

impl<'a> Message<'a> {
    /// Is it in CDR?
    pub fn is_cdr(&self) -> bool {
        self.encoding == "cdr"
    }

    /// Its bytes, where they are in CDR.
    ///
    /// # Errors
    /// A sentence that tells its encoding.
    pub fn cdr(&self) -> Result<&'a [u8], String> {
        let sentence = || format!("it is encoded as `{}`; only cdr is read", excerpt(self.encoding));
        self.is_cdr().then_some(self.data).ok_or_else(sentence)
    }

    /// Its content.
    ///
    /// # Errors
    /// A sentence: it is not in CDR, or not what its type says.
    pub fn decode<T: DeserializeOwned>(&self) -> Result<T, String> {
        cdr::decode_with_header(self.cdr()?).map_err(|error| error.to_string())
    }
}

/// A recorded run, at the message that comes next.
pub struct Run {
    files: Vec<Outline>,
    /// The file that is being read.
    reader: Option<Messages>,
    /// The one that comes after it.
    next_file: usize,
    /// Messages that were read.
    messages: u64,
    progress: Option<ProgressSink>,
}

/// Is called with the bytes that were read so far, and with those of all files.
type ProgressSink = Box<dyn FnMut(u64, u64) + Send>;

/// Messages from one call of [`ProgressSink`] to the next.
const PROGRESS_MESSAGES: u64 = 256;

impl std::fmt::Debug for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Run").field("files", &self.files).field("next_file", &self.next_file).finish_non_exhaustive()
    }
}

impl Run {
    /// Opens a run and looks through its files; their messages are not read yet.
    ///
    /// # Errors
    /// What is no run, and what is wrong with it as far as that shows without unpacking its messages.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        let run = Self::open_any(path)?;
        places::check_related(path, &run.files)?;
        Ok(run)
    }

    /// As [`Run::open`], also a folder whose files are of several runs: to tell what they hold.
    ///
    /// # Errors
    /// As [`Run::open`].
    pub fn open_any(path: &Path) -> Result<Self, RunError> {
        Ok(Self { files: places::outlines(path)?, reader: None, next_file: 0, messages: 0, progress: None })
    }

    /// Do the files of the run tell of one cell?
    pub fn is_of_one_cell(&self) -> bool {
        places::unrelated(&self.files).is_none()
    }

    /// The files in their order; at least one.
    pub fn files(&self) -> &[Outline] {
        &self.files
    }

    /// What is missing of the files that were cut off.
    pub fn cuts(&self) -> impl Iterator<Item = &Cut> {
        self.files.iter().filter_map(|file| file.cut.as_ref())
    }

    /// What is wrong behind the data of its files, of which no message is lost.
    pub fn flaws(&self) -> impl Iterator<Item = RunError> {
        self.files.iter().filter_map(|file| {
            let (at, damage) = file.flaw.clone()?;
            Some(RunError::Damaged { file: file.name.clone(), at, damage })
        })
    }

    /// The next message; none at the end of the run.
    ///
    /// # Errors
    /// What is wrong with the record or the chunk that comes next. Then nothing more is read.
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

    /// Calls `progress` now and then while messages are read, with the bytes that were read so far and with those of all files, until
    /// the end of the run or [`Run::end_progress`].
    pub fn set_progress(&mut self, progress: impl FnMut(u64, u64) + Send + 'static) {
        self.progress = Some(Box::new(progress));
    }

    /// Ends the calls of [`Run::set_progress`].
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
        // Of the file that is open only a part was read.
        let rest = self.reader.as_ref().zip(current).map_or(0, |(reader, file)| file.bytes.saturating_sub(reader.at()));
        progress(begun.saturating_sub(rest), self.files.iter().map(|file| file.bytes).sum());
    }

    /// Goes back to the first message.
    pub fn rewind(&mut self) {
        (self.reader, self.next_file) = (None, 0);
    }

    /// The bytes of the first attachment of that name, in the first file that has one.
    ///
    /// # Errors
    /// As [`Run::attachment_of`].
    pub fn attachment(&self, name: &str) -> Result<Option<Vec<u8>>, RunError> {
        for file in 0..self.files.len() {
            if let Some(bytes) = self.attachment_of(file, name)? {
                return Ok(Some(bytes));
            }
        }
        Ok(None)
    }

    /// The bytes of the first attachment of that name in a file, by its place.
    ///
    /// # Errors
    /// Bytes that are not those that were written, and what no memory is taken for.
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

    /// The first record of metadata of that name, in the first file that has one.
    pub fn metadata(&self, name: &str) -> Option<&BTreeMap<String, String>> {
        let mut all = self.files.iter().flat_map(|file| &file.metadata);
        all.find(|(known, _)| known == name).map(|(_, map)| map)
    }
}

/// The data of an attachment.
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

/// A whole number in groups of three digits: `12 345`.
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
