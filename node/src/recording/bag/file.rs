//! One file of a bag: MCAP in the profile `ros2`.
//!
//! Each file can be read without the others: it contains schemas, all channels, attachments and the record `lineshaft`,
//! and its first cycle is a key cycle. Chunks are collected in memory and written to the disk as a whole.

use super::super::Encoded;
use super::super::metadata::{FileInformation, qos_text};
use super::disk::{Disk, Medium};
use super::topics::Offered;
use lineshaft_ros::layer::TappedMessage;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, McapError, WriteOptions, Writer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A chunk ends beyond this size (in bytes, before compression), and at each key cycle.
const CHUNK: usize = 1 << 20;
/// A chunk ends after this time, in ns; a killed process loses no more than that.
const CHUNK_NS: u64 = 1_000_000_000;

/// Numbers of messages, and the time that they span.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    /// Number of messages of each topic of the file, in the order of the topics.
    pub messages: Vec<u64>,
    pub cycles: u64,
    /// Minimum and maximum log time, in ns.
    pub span: Option<(u64, u64)>,
}

impl Counts {
    pub(super) fn all(&self) -> u64 {
        self.messages.iter().sum()
    }

    fn add(&mut self, log_ns: u64) {
        self.cycles += 1;
        self.reach(log_ns);
    }

    /// Extends the span by a log time, in ns.
    fn reach(&mut self, log_ns: u64) {
        self.span = Some(self.span.map_or((log_ns, log_ns), |(first, last)| (first.min(log_ns), last.max(log_ns))));
    }

    pub(super) fn information(&self, path: &Path) -> FileInformation {
        // Only the path of a folder can lack a file name.
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        FileInformation { name, span: self.span, messages: self.all() }
    }
}

/// Content of a file before its first cycle.
pub(super) struct Opening<'a> {
    /// Log time of the first cycle, in ns.
    pub log_ns: u64,
    /// Name, type and content of each attachment.
    pub attachments: Vec<(&'static str, &'static str, Cow<'a, [u8]>)>,
    /// The record `lineshaft`.
    pub record: BTreeMap<String, String>,
}

/// A file that is being written.
pub(super) struct BagFile {
    pub path: PathBuf,
    writer: Writer<Disk>,
    flushed: Arc<AtomicU64>,
    channels: Vec<u16>,
    /// Index of the first channel of the topics that the node publishes.
    first_published: usize,
    counts: Counts,
    /// Counts of the data on the disk.
    safe: Counts,
    chunk_bytes: usize,
    chunk_start_ns: u64,
}

impl BagFile {
    /// Creates a file without content.
    pub(super) fn create(path: PathBuf, medium: Box<dyn Medium>) -> io::Result<Self> {
        let (disk, flushed) = Disk::new(medium);
        let options = WriteOptions::new()
            .profile("ros2")
            .library("lineshaft")
            .compression(Some(Compression::Zstd))
            // More threads could divide the stream differently, depending on the load of the machine.
            .compression_threads(0)
            .chunk_size(None)
            .disable_seeking(true);
        let mut writer = options.create(disk).map_err(io_error)?;
        writer.flush().map_err(io_error)?;
        let (counts, safe) = Default::default();
        let (channels, first_published) = (Vec::new(), 0);
        Ok(Self { path, writer, flushed, channels, first_published, counts, safe, chunk_bytes: 0, chunk_start_ns: 0 })
    }

    /// Writes the beginning of the file, before its first cycle. The last `published` of `topics` are those that the
    /// node publishes.
    pub(super) fn begin(&mut self, opening: Opening<'_>, topics: &[Offered], published: usize) -> io::Result<()> {
        let time = opening.log_ns;
        for (name, media_type, data) in opening.attachments {
            let (name, media_type) = (name.to_owned(), media_type.to_owned());
            let attachment = Attachment { log_time: time, create_time: time, name, media_type, data };
            self.writer.attach(&attachment).map_err(io_error)?;
        }
        self.record("lineshaft", opening.record)?;
        for Offered { name, schema: (schema_name, schema), qos } in topics {
            let schema = self.writer.add_schema(schema_name, "ros2msg", schema.as_bytes()).map_err(io_error)?;
            let qos = BTreeMap::from([("offered_qos_profiles".to_owned(), qos_text(*qos, 0))]);
            let channel = self.writer.add_channel(schema, &name.to_string(), "cdr", &qos).map_err(io_error)?;
            self.channels.push(channel);
        }
        self.chunk_start_ns = time;
        self.first_published = self.channels.len().saturating_sub(published);
        self.counts.messages.resize(self.channels.len(), 0);
        Ok(())
    }

    fn record(&mut self, name: &str, metadata: BTreeMap<String, String>) -> io::Result<()> {
        self.writer.write_metadata(&Metadata { name: name.to_owned(), metadata }).map_err(io_error)
    }

    /// Writes a cycle with its log time. The first one is flushed immediately, so that no file is without a cycle.
    pub(super) fn write(&mut self, encoded: &Encoded, time: u64) -> io::Result<()> {
        let is_old = time >= self.chunk_start_ns.saturating_add(CHUNK_NS);
        if self.chunk_bytes >= CHUNK || is_old {
            self.flush()?;
        }
        if self.chunk_bytes == 0 {
            self.chunk_start_ns = time;
        }
        // Frames of buses that this bag does not record have no channel.
        let first_published = self.first_published;
        for (place, message) in encoded.places().filter(|(place, _)| *place < first_published) {
            self.put(place, message, time)?;
        }
        for (topic, message) in encoded.published() {
            self.put_published(topic, message, time)?;
        }
        self.counts.add(time);
        if self.safe.cycles == 0 { self.flush() } else { Ok(()) }
    }

    /// Writes a message that the node published, also before the first cycle.
    pub(super) fn put_published(&mut self, topic: usize, message: &[u8], time: u64) -> io::Result<()> {
        self.put(self.first_published.saturating_add(topic), message, time)
    }

    /// Writes messages that the node published after the last cycle, with the log time of that cycle; in a file without
    /// a cycle, with the system time of each message.
    pub(super) fn put_late(&mut self, messages: &[TappedMessage]) -> io::Result<()> {
        let last_ns = self.counts.span.map(|(_, last)| last);
        for message in messages {
            let log_ns = last_ns.unwrap_or(message.published_ns);
            self.put_published(message.topic, &message.data, log_ns)?;
            self.counts.reach(log_ns);
        }
        Ok(())
    }

    /// Writes a message; does nothing if there is no channel at that index.
    fn put(&mut self, place: usize, message: &[u8], time: u64) -> io::Result<()> {
        let (Some(&channel_id), Some(count)) = (self.channels.get(place), self.counts.messages.get_mut(place)) else {
            return Ok(());
        };
        let header = MessageHeader { channel_id, sequence: *count as u32, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, message).map_err(io_error)?;
        *count += 1;
        self.chunk_bytes += message.len();
        Ok(())
    }

    /// Ends the chunk and flushes it to the disk. Schemas and channels alone make no chunk: a chunk without a message
    /// has no message index, and rosbag2 treats a file whose first chunk has none as a file without any.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        if self.chunk_bytes == 0 {
            return Ok(());
        }
        self.writer.flush().map_err(io_error)?;
        self.safe = self.counts.clone();
        self.chunk_bytes = 0;
        Ok(())
    }

    /// Ends the file.
    pub(super) fn finish(&mut self, record: BTreeMap<String, String>) -> io::Result<()> {
        self.flush()?;
        self.record("lineshaft_end", record)?;
        // This flushes: the record and the summary reach the disk together.
        self.writer.finish().map(drop).map_err(io_error)
    }

    /// Returns the counts of the data on the disk.
    pub(super) fn safe(&self) -> &Counts {
        &self.safe
    }

    /// Returns the counts of all data written so far, flushed or not.
    pub(super) fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Returns the size on the disk, in bytes.
    pub(super) fn size(&self) -> u64 {
        self.flushed.load(Ordering::Relaxed)
    }
}

fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
