//! Loads the signals of a run over time, for plots and comparisons.
//!
//! Law      a series has a point at each change of a value, and one before it, at the last time of the old value: a
//!          line through the points is the signal, except in gaps, in which the value is unknown. Times are those of
//!          the cycles (log times) in a bag of this program, and the stamps of the messages, not the times of
//!          reception, in a bag of any other recorder
//! Reads    ~/signals with the attached cell: every signal of the board in every cycle. Without them, joint_states and
//!          axis_states of any recorder, found by type. In both cases the events, as marks
//! Refuses  messages that cannot be decoded, patterns that match nothing, more points than the memory limit
//!
//! Positions and their derivatives are in the unit of their axis if the cell is attached, otherwise in SI.

mod board;
mod gaps;
mod select;
pub(crate) mod topics;
mod track;

pub use select::SelectError;

pub(crate) use select::{alias, no_match, pattern};
pub(crate) use track::{Budget, Track};

use super::bag::repeats_events;
use super::run::{Cut, Message, Run, RunError};
use crate::document::Problems;
use board::BoardTracks;
use lineshaft_core::config::ConfigError;
use lineshaft_core::signal::Type;
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::Message as _;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::msg::{Event, Signals};
use select::Select;
use serde::de::DeserializeOwned;
use std::fmt::{self, Display, Formatter};
use topics::Topics;

/// Type of the values of a series.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// f64
    Real,
    /// i64
    Int,
    /// 0 or 1
    Bit,
    /// Enumeration: the value is the index of its name in the list.
    Enum(Vec<String>),
    /// Unsigned bit field.
    Word,
    /// A [`Code`](lineshaft_core::code::Code); 0 for none.
    Code,
}

impl Kind {
    fn of(track: &Track) -> Self {
        match track.kind {
            Type::Int if track.unit.is_empty() && track.name.ends_with(".error") => Self::Code,
            Type::Int => Self::Int,
            Type::Real => Self::Real,
            Type::Bit => Self::Bit,
            Type::Enum(names) => Self::Enum(names.iter().map(|name| (*name).to_owned()).collect()),
            Type::Word => Self::Word,
        }
    }
}

/// One signal over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name, such as `x.command.position`.
    pub name: String,
    /// Unit, such as `mm/s`; empty for none, `SI` if the unit is known only from the message.
    pub unit: String,
    /// Type of the values.
    pub kind: Kind,
    /// Topic on which it was recorded.
    pub topic: String,
    /// Times from the start of the run, in s, and values; in order of time.
    pub points: Vec<(f64, f64)>,
    /// Start and end, in s, of each time without known values, in order of time: cycles are missing, or no sample came
    /// for much longer than usual. Both ends are points.
    pub gaps: Vec<(f64, f64)>,
}

/// An event of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct EventMark {
    /// Time from the start of the run, in s.
    pub time: f64,
    /// 0 info, 1 warning, 2 error.
    pub severity: u8,
    /// Kind, such as `refused`.
    pub kind: String,
    /// Name of the object, or `machine`.
    pub source: String,
    /// Message of one sentence.
    pub text: String,
}

/// Signals and events of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Signals in the order of the board; those of other recorders in the order of their first messages.
    pub series: Vec<Series>,
    /// Events in the order of the recording.
    pub marks: Vec<EventMark>,
    /// Time of the first value, in ns.
    pub start_ns: u64,
    /// Time of the last value, in ns.
    pub end_ns: u64,
    /// Missing parts of files that were cut off.
    pub cuts: Vec<Cut>,
    /// Topics with decreasing stamps.
    pub late: Vec<LateMessages>,
}

/// Messages of a topic whose stamp is before that of an earlier message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LateMessages {
    /// Name of the topic.
    pub topic: String,
    /// Minimum number of such messages.
    pub messages: u64,
    /// Whether such messages are missing in the series; otherwise they have the latest time before them.
    pub are_left_out: bool,
}

impl Display for LateMessages {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { topic, messages, are_left_out } = self;
        let (messages, have) =
            if *messages == 1 { ("1 message", "has") } else { (&*format!("{messages} messages"), "have") };
        let fate = if *are_left_out { "left out" } else { "shown at the time of the message before" };
        let are = if have == "has" { "is" } else { "are" };
        write!(f, "{topic}: {messages} {have} an earlier stamp than a message before and {are} {fate}")
    }
}

/// Reason why the signals of a run cannot be loaded.
#[derive(Debug, thiserror::Error)]
pub enum SeriesError {
    /// The files cannot be read.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The names of the signals are wrong.
    #[error(transparent)]
    Select(#[from] SelectError),
    /// A message does not match its type.
    #[error("{file}: message on {topic} at {}: {reason}", seconds(*.log_time))]
    Message {
        /// Name of the file.
        file: String,
        /// Topic of the message.
        topic: String,
        /// Log time, in ns.
        log_time: u64,
        /// Reason.
        reason: String,
    },
    /// The attached cell has errors.
    #[error("the attached cell has errors:\n{0}")]
    Cell(Problems),
    /// No machine can be made from the attached cell.
    #[error("the attached cell makes no machine: {0}")]
    Machine(#[from] ConfigError),
    /// The run has no signals.
    #[error("{0}: the run holds neither ~/signals with the cell, nor joint_states, nor axis_states")]
    Nothing(String),
    /// The signals need too much memory.
    #[error("the signals have more than {} points; choose fewer of them", track::MAX_POINTS)]
    TooMany,
}

/// Loads the signals that match at least one of the patterns (such as `x.*`); without patterns, all signals.
///
/// # Errors
/// Returns an error if the run, a message or the attached cell is wrong, or if a pattern matches nothing.
pub fn load(run: &mut Run, patterns: &[String]) -> Result<Recorded, SeriesError> {
    run.rewind();
    let mut select = Select::new(patterns)?;
    let cell = run.attachment("cell.yaml")?;
    let attached = super::attached_files(run)?;
    let files: Vec<String> = run.files().iter().map(|file| file.name.clone()).collect();
    let (mut budget, mut topics, mut board, mut events) = (Budget::default(), Topics::of(run), None, Vec::new());
    let by_log_time = is_of_this_program(run);
    while let Some(message) = run.next_message()? {
        let file = &files[message.file];
        match (message.kind, &cell) {
            (Signals::NAME, Some(cell)) => {
                let board = match &mut board {
                    Some(board) => board,
                    None => {
                        // From here on the board has all values, with more precision.
                        topics = Topics::default();
                        select.start_again();
                        budget = Budget::default();
                        board.insert(BoardTracks::new((cell, attached.as_deref()), message.topic, &mut select)?)
                    }
                };
                let signals: Signals = decode(&message, file)?;
                let taken = board.take(message.log_time, &signals, &mut budget);
                taken.map_err(|refusal| refusal.into_error(&message, file))?;
            }
            (Event::NAME, _) if !repeats_events(message.topic) => {
                let event: Event = decode(&message, file)?;
                let time = match by_log_time {
                    true => message.log_time.saturating_sub(event.age_ns.into()),
                    false => stamp(&event.header.stamp).map_err(|reason| refused(&message, file, reason))?,
                };
                budget.spend(2 + event.text.len() as u64 / 16).ok_or(SeriesError::TooMany)?;
                events.push((time, event));
            }
            _ if board.is_none() => {
                let taken = topics.take(&message, &mut select, &mut budget);
                taken.map_err(|refusal| refusal.into_error(&message, file))?;
            }
            _ => {}
        }
    }
    let is_board = board.is_some();
    let (tracks, late) = match board {
        Some(board) => {
            let (tracks, late) = board.finish(&mut budget).map_err(|_| SeriesError::TooMany)?;
            (tracks, late.into_iter().collect())
        }
        None => {
            let tracks = topics.into_best_tracks();
            let late = late(&tracks);
            (tracks, late)
        }
    };
    if select.is_empty() {
        return Err(SeriesError::Nothing(files.join(", ")));
    }
    select.finish(is_board)?;
    let cuts = run.cuts().cloned().collect();
    Ok(Recorded { cuts, late, ..recorded(tracks, events) })
}

/// Returns the late messages of each topic.
fn late(tracks: &[Track]) -> Vec<LateMessages> {
    let mut all: Vec<LateMessages> = Vec::new();
    for track in tracks.iter().filter(|track| track.late > 0) {
        match all.iter_mut().find(|late| late.topic == track.topic) {
            Some(known) => known.messages = known.messages.max(track.late),
            None => all.push(LateMessages { topic: track.topic.clone(), messages: track.late, are_left_out: true }),
        }
    }
    all
}

fn recorded(tracks: Vec<Track>, events: Vec<(u64, Event)>) -> Recorded {
    let start = tracks.iter().filter_map(|track| track.points.first()).map(|(time, _)| *time).min();
    let end = tracks.iter().filter_map(|track| track.points.last()).map(|(time, _)| *time).max();
    let start_ns = start.unwrap_or(0);
    let series = tracks.into_iter().map(|track| {
        let gaps = track.gaps();
        let kind = Kind::of(&track);
        let points = with_ends(track.points, &gaps);
        let since = |time| since(time, start_ns);
        Series {
            points: points.into_iter().map(|(time, value)| (since(time), value)).collect(),
            gaps: gaps.into_iter().map(|(from, to)| (since(from), since(to))).collect(),
            name: track.name,
            unit: track.unit,
            kind,
            topic: track.topic,
        }
    });
    let marks = events.into_iter().map(|(time, event)| EventMark {
        time: since(time, start_ns),
        severity: event.severity.min(Event::ERROR),
        kind: event.kind,
        source: event.source,
        text: event.text,
    });
    let (series, marks, end_ns) = (series.collect(), marks.collect(), end.unwrap_or(0));
    Recorded { series, marks, start_ns, end_ns, cuts: Vec::new(), late: Vec::new() }
}

/// Returns the points, with one added at each end of a gap, because a value that stays the same has none there.
fn with_ends(points: Vec<(u64, f64)>, gaps: &[(u64, u64)]) -> Vec<(u64, f64)> {
    if gaps.is_empty() {
        return points;
    }
    let mut ends = gaps.iter().flat_map(|&(from, to)| [from, to]).peekable();
    let mut all: Vec<(u64, f64)> = Vec::with_capacity(points.len() + 2 * gaps.len());
    for point in points {
        while let Some(end) = ends.next_if(|&end| end < point.0) {
            match all.last() {
                Some(&(at, held)) if at < end => all.push((end, held)),
                _ => {}
            }
        }
        ends.next_if_eq(&point.0);
        all.push(point);
    }
    all
}

/// Returns the time since `start`, in s; negative before it.
fn since(time: u64, start: u64) -> f64 {
    time.wrapping_sub(start).cast_signed() as f64 / 1e9
}

/// Formats a time, in ns, for a message.
pub(crate) fn seconds(time: u64) -> String {
    format!("{}.{:09} s", time / 1_000_000_000, time % 1_000_000_000)
}

/// Whether this program recorded the run; log times are then those of the cycles.
fn is_of_this_program(run: &Run) -> bool {
    run.metadata("lineshaft").is_some()
}

/// Returns a stamp in ns.
pub(crate) fn stamp(time: &Time) -> Result<u64, String> {
    let seconds =
        u64::try_from(time.sec).map_err(|_| format!("the stamp is {} s; 0 and above is allowed", time.sec))?;
    Ok(seconds * 1_000_000_000 + u64::from(time.nanosec))
}

/// Decodes the content of a message.
pub(crate) fn decode<T: DeserializeOwned>(message: &Message<'_>, file: &str) -> Result<T, SeriesError> {
    message.decode().map_err(|reason| refused(message, file, reason))
}

/// Returns the error for a message with invalid content.
pub(crate) fn refused(message: &Message<'_>, file: &str, reason: String) -> SeriesError {
    let topic = excerpt(message.topic);
    SeriesError::Message { file: file.to_owned(), topic, log_time: message.log_time, reason }
}

/// Reason why a message is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Refusal {
    /// Error message.
    Reason(String),
    /// The maximum number of points is reached.
    TooMany,
}

impl Refusal {
    pub(crate) fn into_error(self, message: &Message<'_>, file: &str) -> SeriesError {
        match self {
            Self::Reason(reason) => refused(message, file, reason),
            Self::TooMany => SeriesError::TooMany,
        }
    }
}

impl From<String> for Refusal {
    fn from(reason: String) -> Self {
        Self::Reason(reason)
    }
}

#[cfg(test)]
mod tests;
