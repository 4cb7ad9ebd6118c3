//! Writes a bag: MCAP files in rosbag2's profile, and metadata.yaml (contract section 6).
//!
//! Law      the same cycles give the same bytes; each file begins at a key cycle and can be read without the other
//!          files
//! Refuses  a path that is in use; after a disk error, every call: data flushed before it stays readable
//!
//! Log times of a bag begin with the system time of its first cycle and then follow the monotonic clock, in all of its files.
//!
//! A bag in a folder continues in a new file once the current one is too large or too long. The new file begins at a
//! key cycle with a stored machine state. Missing cycles are counted, either by their cycle numbers or as reported by
//! the caller.

mod disk;
mod file;
mod place;
mod retained;
mod topics;

use super::metadata::{self, FileInformation, Metadata, TopicInformation};
use super::{CycleTime, Encoded};
use crate::cell::Cell;
use crate::parameters::parameters_text;
use crate::store::store_text;
use disk::Medium;
use file::{BagFile, Counts, Opening};
use lineshaft_ros::layer::{NodeName, TappedMessage, TappedTopic};
use place::Place;
pub(crate) use retained::Retained;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use topics::Offered;
pub(crate) use topics::repeats_events;

/// Location of a bag, and the limits after which it continues in a new file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BagOptions {
    /// `NAME.mcap`: a single file with that name. Any other path: a new folder.
    pub path: PathBuf,
    /// Maximum size of a file, in bytes; a new file begins once it is reached. Folders only.
    pub max_size: Option<u64>,
    /// Maximum duration of a file, in ns; a new file begins once it is reached. Folders only.
    pub max_duration_ns: Option<u64>,
}

impl BagOptions {
    /// Returns the options of a bag that continues in new files; 0 means no limit.
    pub fn split(path: PathBuf, max_size: u64, max_duration_ns: u64) -> Self {
        let limit = |most: u64| Some(most).filter(|&most| most > 0);
        Self { path, max_size: limit(max_size), max_duration_ns: limit(max_duration_ns) }
    }
}

/// Content of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// Text of the cell file.
    pub cell: String,
    /// Parameters in force before cycle 0, from [`parameters_text`]; a later file has those of its first cycle.
    pub parameters: String,
    /// CSV files of the tables and modules of the programs, from [`Cell::files_text`]; `None` if the cell has none.
    pub files: Option<String>,
    /// Names of the programs, with the SHA-256 of each module.
    pub programs: Vec<(String, String)>,
    /// Values that were stored when the machine started, from [`store_text`]; `None` if there were none.
    pub store: Option<String>,
    /// Name of the node that owns the topics.
    pub node: NodeName,
    /// Cycle time, in ns.
    pub cycle_ns: u64,
    /// Version of this program.
    pub version: String,
    /// Name of the scenario that is played, for the titles of figures; `None` if none is played.
    pub scenario: Option<String>,
    /// Buses whose frames are recorded.
    pub buses: Vec<String>,
    /// Topics that the node publishes in addition to those of the cycles.
    pub published: Vec<TappedTopic>,
}

/// Reason why a bag cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum BagError {
    /// The path is in use, or the options do not fit it: an error message.
    #[error("{0}")]
    Refused(String),
    /// An I/O error of the operating system.
    #[error("cannot write {}: {error}", .path.display())]
    Write {
        /// File that could not be written.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// An earlier error has ended the bag.
    #[error("{}: nothing more is written after the error before", .0.display())]
    Ended(PathBuf),
}

/// Summary of a bag.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Path as given in the options.
    pub path: PathBuf,
    /// Files in the order of their cycles.
    pub files: Vec<PathBuf>,
    /// Number of cycles in the bag.
    pub cycles: u64,
    /// Size on the disk without metadata.yaml, in bytes.
    pub size: u64,
    /// Number of cycles missing between the first and the last one.
    pub lost: u64,
    /// Whether the bag begins with a state for replay and no cycle is missing.
    pub replayable: bool,
}

/// A finished file.
struct Ended {
    path: PathBuf,
    counts: Counts,
    size: u64,
}

/// Opens a file of a bag.
type Open = Box<dyn Fn(&Place, &Path) -> io::Result<Box<dyn Medium>> + Send>;

/// A bag that is being written. If it is dropped without [`Bag::finish`], it has no metadata.yaml, and its last file
/// has no record `lineshaft_end`, as after a kill of the program.
pub struct Bag {
    options: BagOptions,
    place: Place,
    subject: Subject,
    cell_sha256: String,
    topics: Vec<Offered>,
    /// Latched messages so far; each new file begins with them.
    retained: Retained,
    /// Messages that the node published after the last cycle.
    late: Vec<TappedMessage>,
    open: Open,
    ended: Vec<Ended>,
    file: Option<BagFile>,
    /// Expected number of the next cycle, once a file has begun.
    next: Option<u64>,
    /// Offset added to log times, in ns, so that those of the bag begin with the system time; `None` before its first
    /// cycle.
    shift_ns: Option<i64>,
    /// Whether the current file can be replayed from its beginning.
    is_start_known: bool,
    /// Lost cycles of the current file.
    lost: Lost,
    /// Number of lost cycles in the files before.
    lost_before: u64,
    /// Whether all files before can be replayed.
    replayable_before: bool,
    is_broken: bool,
}

/// Missing cycles of a file: by their numbers, and as reported.
#[derive(Clone, Copy, Debug, Default)]
struct Lost {
    gaps: u64,
    noted: u64,
}

impl Lost {
    fn count(self) -> u64 {
        self.gaps.max(self.noted)
    }
}

/// Attachment with the CSV files of tables and the modules of programs.
pub(crate) const TABLES: &str = "tables.json";

/// Key of the record `lineshaft`: time by which stamps are ahead of log times in the first cycle of the file, in ns.
/// Without it they are equal.
pub(crate) const STAMPS_AHEAD: &str = "stamps_ahead_ns";

/// Key of the record `lineshaft`: name of the scenario that is played; absent without one.
pub(crate) const SCENARIO: &str = "scenario";

impl Subject {
    /// Returns the subject for a machine of that cell before its cycle 0, recorded as `node`.
    pub fn new(cell: &Cell, node: &NodeName) -> Self {
        let parameters: Vec<_> = cell.machine.axes.iter().map(|axis| axis.power_on()).collect();
        Self {
            cell: cell.text.clone(),
            parameters: parameters_text(&cell.machine, &cell.machine.global.power_on(), &parameters),
            files: cell.files_text(),
            programs: cell.programs(),
            store: store_text(&cell.machine),
            node: node.clone(),
            cycle_ns: cell.machine.cycle_ns,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scenario: None,
            buses: Vec::new(),
            published: Vec::new(),
        }
    }
}

impl BagError {
    /// Returns the error number of the operating system, or 0 if there is none.
    pub fn system_error(&self) -> i32 {
        match self {
            Self::Write { error, .. } => error.raw_os_error().unwrap_or(0),
            Self::Refused(_) | Self::Ended(_) => 0,
        }
    }
}

impl Bag {
    /// Begins a bag. The folder `options.path` must not exist; a file of that name must be empty.
    ///
    /// # Errors
    /// Returns an error if the path is in use or cannot be created, or if a bag of one file has a limit.
    pub fn create(options: &BagOptions, subject: Subject) -> Result<Self, BagError> {
        Self::create_on(options, subject, Box::new(|place, path| Ok(Box::new(place.open(path)?))))
    }

    fn create_on(options: &BagOptions, subject: Subject, open: Open) -> Result<Self, BagError> {
        let place = Place::of(&options.path)?;
        if !place.is_folder() && (options.max_size.is_some() || options.max_duration_ns.is_some()) {
            let path = place.path().display();
            return Err(BagError::Refused(format!(
                "{path} is one file and is never split; leave the largest size and duration out, or name a folder"
            )));
        }
        let topics = Offered::all(&subject).map_err(|error| BagError::Refused(error.to_string()))?;
        place.claim()?;
        let cell_sha256 = super::sha256(&subject.cell);
        let retained = Retained::new(&subject.published);
        let mut bag = Self {
            options: options.clone(),
            place,
            subject,
            cell_sha256,
            topics,
            retained,
            late: Vec::new(),
            open,
            ended: Vec::new(),
            file: None,
            next: None,
            shift_ns: None,
            is_start_known: false,
            lost: Lost::default(),
            lost_before: 0,
            replayable_before: true,
            is_broken: false,
        };
        bag.open_file()?;
        Ok(bag)
    }

    /// Writes a cycle. Cycles before the first key cycle are left out.
    ///
    /// # Errors
    /// Returns the disk error. After it nothing is written; data flushed before it can be read.
    pub fn write(&mut self, encoded: &Encoded) -> Result<(), BagError> {
        if self.is_broken {
            return Err(BagError::Ended(self.options.path.clone()));
        }
        if self.next.is_none() && !encoded.is_key {
            return Ok(());
        }
        if let Some(next) = self.next {
            self.lost.gaps = self.lost.gaps.saturating_add(encoded.cycle.saturating_sub(next));
        }
        if encoded.is_key && self.next.is_some() {
            self.on_file(BagFile::flush)?;
            if self.must_split(encoded) {
                self.end_file(true)?;
                self.open_file()?;
            }
        }
        if self.next.is_none() {
            self.begin_file(Some(encoded))?;
        }
        self.next = Some(encoded.cycle.saturating_add(1));
        let log_ns = self.time(encoded).log_ns;
        for (topic, message) in encoded.published() {
            self.retained.take(topic, message);
        }
        self.on_file(|file| file.write(encoded, log_ns))
    }

    /// Returns the time of a cycle in this bag.
    fn time(&self, encoded: &Encoded) -> CycleTime {
        let shift_ns = self.shift_ns.unwrap_or(encoded.time.ahead_ns());
        CycleTime { log_ns: encoded.time.log_ns.saturating_add_signed(shift_ns), ..encoded.time }
    }

    /// Adds cycles that were lost before they reached the bag.
    pub fn note_lost(&mut self, cycles: u64) {
        self.lost.noted = self.lost.noted.saturating_add(cycles);
    }

    /// Adds messages that the node published after the last cycle; the bag ends with them.
    pub fn add_late(&mut self, messages: Vec<TappedMessage>) {
        self.late.extend(messages);
    }

    /// Ends the bag.
    ///
    /// # Errors
    /// Returns the disk error, or an earlier one; data flushed before it can be read.
    pub fn finish(mut self) -> Result<Summary, BagError> {
        if self.is_broken {
            return Err(BagError::Ended(self.options.path.clone()));
        }
        if self.next.is_none() {
            self.begin_file(None)?;
        }
        let late = std::mem::take(&mut self.late);
        self.on_file(|file| file.put_late(&late))?;
        self.end_file(false)?;
        self.write_metadata(self.is_replayable())?;
        Ok(self.summary())
    }

    /// Returns the path as given in the options.
    pub fn path(&self) -> &Path {
        &self.options.path
    }

    /// Returns the size on the disk so far, without metadata.yaml, in bytes.
    pub fn size(&self) -> u64 {
        self.ended.iter().map(|file| file.size).sum::<u64>() + self.file.as_ref().map_or(0, BagFile::size)
    }

    /// Returns a summary of the data on the disk.
    pub fn summary(&self) -> Summary {
        let file = self.file.as_ref();
        let ended = self.ended.iter().map(|file| file.path.clone());
        Summary {
            path: self.options.path.clone(),
            files: ended.chain(file.map(|file| file.path.clone())).collect(),
            cycles: self.ended.iter().map(|file| file.counts.cycles).sum::<u64>()
                + file.map_or(0, |file| file.safe().cycles),
            size: self.size(),
            lost: self.lost_before + self.lost.count(),
            replayable: !self.is_broken && self.is_replayable(),
        }
    }

    fn is_replayable(&self) -> bool {
        self.replayable_before && (self.file.is_none() || self.is_file_replayable())
    }

    fn is_file_replayable(&self) -> bool {
        self.is_start_known && self.lost.count() == 0
    }

    fn must_split(&self, encoded: &Encoded) -> bool {
        let Some(file) = self.file.as_ref().filter(|_| self.place.is_folder() && encoded.state.is_some()) else {
            return false;
        };
        let log_ns = self.time(encoded).log_ns;
        let start = file.counts().span.map_or(log_ns, |(first, _)| first);
        let duration = log_ns.saturating_sub(start);
        self.options.max_size.is_some_and(|most| file.size() >= most)
            || self.options.max_duration_ns.is_some_and(|most| duration >= most)
    }

    fn open_file(&mut self) -> Result<(), BagError> {
        let path = self.place.file(self.ended.len());
        let medium = match (self.open)(&self.place, &path) {
            Ok(medium) => medium,
            Err(error) => return Err(self.fail(path, error)),
        };
        match BagFile::create(path.clone(), medium) {
            Ok(file) => self.file = Some(file),
            Err(error) => {
                let _ = std::fs::remove_file(&path);
                return Err(self.fail(path, error));
            }
        }
        Ok(())
    }

    /// Writes the part of a file before the first cycle. Without a cycle, the bag has only [late
    /// messages](Self::add_late).
    fn begin_file(&mut self, first: Option<&Encoded>) -> Result<(), BagError> {
        if let Some(first) = first {
            self.shift_ns.get_or_insert(first.time.ahead_ns());
        }
        let time = first.map_or(CycleTime::default(), |first| self.time(first));
        let state = first.filter(|first| first.cycle > 0).and_then(|first| first.state.as_deref());
        self.is_start_known = state.is_some() || first.is_some_and(|first| first.cycle == 0);
        let subject = &self.subject;
        let parameters = first.and_then(|first| first.parameters.as_deref()).unwrap_or(&subject.parameters);
        let yaml = |name, text: &str| (name, "application/yaml", Cow::Owned(text.as_bytes().to_vec()));
        let mut attachments = vec![yaml("cell.yaml", &subject.cell), yaml("parameters.yaml", parameters)];
        let json = |files: &String| (TABLES, "application/json", Cow::Owned(files.as_bytes().to_vec()));
        attachments.extend(subject.files.as_ref().map(json));
        attachments.extend(subject.store.as_ref().map(|store| yaml("store.yaml", store)));
        attachments.extend(state.map(|state| ("machine_state", "application/octet-stream", Cow::Borrowed(state))));
        let record = [
            ("version", subject.version.clone()),
            ("cell_sha256", self.cell_sha256.clone()),
            ("cycle_ns", subject.cycle_ns.to_string()),
            ("node", subject.node.to_string()),
        ];
        let ahead = (time.ahead_ns() != 0).then(|| (STAMPS_AHEAD.to_owned(), time.ahead_ns().to_string()));
        let programs = subject.programs.iter().map(|(name, hash)| (format!("program_sha256.{name}"), hash.clone()));
        let scenario = subject.scenario.iter().map(|name| (SCENARIO.to_owned(), name.clone()));
        let opening = Opening {
            log_ns: time.log_ns,
            attachments,
            record: record
                .map(|(key, value)| (key.to_owned(), value))
                .into_iter()
                .chain(programs)
                .chain(scenario)
                .chain(ahead)
                .collect(),
        };
        let topics = std::mem::take(&mut self.topics);
        let (published, log_ns) = (self.subject.published.len(), time.log_ns);
        let begun = self.on_file(|file| file.begin(opening, &topics, published));
        self.topics = topics;
        begun?;
        let retained = std::mem::take(&mut self.retained);
        let written = self.on_file(|file| {
            retained.messages().try_for_each(|(topic, message)| file.put_published(topic, message, log_ns))
        });
        self.retained = retained;
        written
    }

    /// Ends the current file; `continued`: the bag continues in a further file.
    fn end_file(&mut self, continued: bool) -> Result<(), BagError> {
        let replayable = self.is_file_replayable();
        let lost = self.lost.count();
        let record =
            [("replayable", replayable.to_string()), ("lost", lost.to_string()), ("continued", continued.to_string())];
        let record: BTreeMap<_, _> = record.map(|(key, value)| (key.to_owned(), value)).into();
        self.on_file(|file| file.finish(record))?;
        self.replayable_before &= replayable;
        self.lost_before += std::mem::take(&mut self.lost).count();
        self.next = None;
        self.keep_file();
        Ok(())
    }

    /// Adds the current file to the finished ones, with the counts of its data on the disk.
    fn keep_file(&mut self) {
        if let Some(file) = self.file.take() {
            self.ended.push(Ended { counts: file.safe().clone(), size: file.size(), path: file.path });
        }
    }

    fn on_file(&mut self, act: impl FnOnce(&mut BagFile) -> io::Result<()>) -> Result<(), BagError> {
        let Some(file) = &mut self.file else { return Err(BagError::Ended(self.options.path.clone())) };
        let path = file.path.clone();
        act(file).map_err(|error| self.fail(path, error))
    }

    /// Ends the bag after an error: deletes a file without a cycle; metadata.yaml lists the rest.
    fn fail(&mut self, path: PathBuf, error: io::Error) -> BagError {
        self.is_broken = true;
        match self.file.take_if(|file| file.safe().cycles == 0) {
            Some(empty) => {
                let path = empty.path.clone();
                drop(empty);
                let _ = std::fs::remove_file(path);
            }
            None => self.keep_file(),
        }
        if self.ended.is_empty() {
            self.place.release();
        } else {
            // On a full disk this may fail too; metadata.yaml is then missing, never partial.
            let _ = self.write_metadata(false);
        }
        BagError::Write { path, error }
    }

    fn write_metadata(&self, replayable: bool) -> Result<(), BagError> {
        let count = |place: usize| self.ended.iter().filter_map(|file| file.counts.messages.get(place)).sum();
        let topic = |(place, topic): (usize, &Offered)| TopicInformation {
            name: topic.name.to_string(),
            type_name: topic.schema.0,
            qos: topic.qos,
            messages: count(place),
        };
        let (kind, is) = self.place.kind();
        let description = Metadata {
            files: self.ended.iter().map(|file| file.counts.information(&file.path)).collect::<Vec<FileInformation>>(),
            topics: self.topics.iter().enumerate().map(topic).collect(),
            custom: vec![
                (kind, is.to_owned()),
                ("lineshaft_version", self.subject.version.clone()),
                ("cell_sha256", self.cell_sha256.clone()),
                ("replayable", replayable.to_string()),
                ("lost", (self.lost_before + self.lost.count()).to_string()),
            ],
        };
        let failed = |path: &Path, error| BagError::Write { path: path.to_owned(), error };
        let usual = self.place.folder().join(metadata::FILE_NAME);
        let path = self.place.description().map_err(|error| failed(&usual, error))?;
        description.write(&path).map_err(|error| failed(&path, error))
    }
}

#[cfg(test)]
mod tests;
