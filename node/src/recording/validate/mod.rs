//! Compares runs with expected runs: checks that the axes move as expected.
//!
//! Law      every expected signal of joint_states and axis_states must be in the run, begin and end with the expected
//!          one within two samples, have no gap, and stay within its tolerance; `compare.rs` describes how values are
//!          compared
//! Reads    bags of any recorder
//! Refuses  tolerances that match no signal; runs without comparable signals
//!
//! Time zero of each run is the first sample of its bag, or the first sample at which a position has moved by more than
//! its tolerance.

mod compare;
mod report;
mod rhythm;
mod tolerance;
mod units;

pub use report::{Line, Report, WorstValues};
pub use tolerance::{Tolerance, ToleranceError};

use super::clean::clean;
use super::run::Run;
use super::series::topics::{Measure, Source, Stream, Topics, names_measure};
use super::series::{Budget, SeriesError, Track};
use compare::{Allowed, Judged, Timed, compare};
use report::some;
use std::collections::{HashMap, HashSet};
use tolerance::Tolerances;
use units::Units;

/// Time zero of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// First sample of the bag.
    #[default]
    Start,
    /// First sample at which a position has moved by more than its tolerance.
    Motion,
}

/// Reason why runs cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum ValidateError {
    /// The bags cannot be read.
    #[error(transparent)]
    Series(#[from] SeriesError),
    /// The tolerances are wrong.
    #[error(transparent)]
    Tolerance(#[from] ToleranceError),
    /// There are no comparable signals.
    #[error("{0}: there is nothing to compare, neither joint_states nor axis_states")]
    Nothing(String),
    /// No axis moves.
    #[error("{0}: no position that both runs have moves further than its tolerance; there is no motion to align")]
    NoMotion(String),
}

/// Compares a run with an expected run.
///
/// # Errors
/// Returns an error if one of the bags or the tolerances are wrong.
pub fn validate(
    run: &mut Run,
    expected: &mut Run,
    tolerances: &[Tolerance],
    align: Align,
) -> Result<Report, ValidateError> {
    let names = [name(run), name(expected)];
    let (given, wanted) = (streams(run)?, streams(expected)?);
    let signals: Vec<&str> = {
        let mut seen = HashSet::new();
        let names = wanted.iter().flat_map(|stream| &stream.tracks).map(|track| track.name.as_str());
        names.filter(|name| seen.insert(*name)).collect()
    };
    if signals.is_empty() {
        let [_, expected] = names;
        return Err(ValidateError::Nothing(clean(&expected).into_owned()));
    }
    let units = Units::of([&*expected, &*run]).map_err(SeriesError::from)?;
    let tolerances = Tolerances::new(tolerances, &signals, &units)?;
    let pairs = pairs(&given, &wanted);
    let (zeros, zero) = match align {
        Align::Start => (Some((first_sample(&given), first_sample(&wanted))), "the first sample of each"),
        Align::Motion => (motion(&pairs, &names, &tolerances)?, "the first motion of each"),
    };
    let (run_zero, expected_zero) = zeros.unwrap_or_default();
    let mut lines = Vec::new();
    let mut notes: Vec<String> = units.notes().to_vec();
    for pair in &pairs {
        let track = pair.expected.track();
        if is_unmeasured(track) {
            notes
                .push(format!("{} on {} is NaN throughout in what is expected: not compared", track.name, track.topic));
            continue;
        }
        let value = tolerances.of(&track.name);
        let allowed = Allowed { value, time: tolerances.time_ns(), any_start: align == Align::Motion };
        let judged = match pair.run {
            Some(run) => {
                let (given, wanted) = (run.times(run_zero), pair.expected.times(expected_zero));
                let run = Timed { track: run.track(), zero: run_zero, samples: &given };
                compare(run, Timed { track, zero: expected_zero, samples: &wanted }, allowed)
            }
            None => Judged { worst: None, failures: vec!["missing in the run".to_owned()] },
        };
        let (name, topic) = (track.name.clone(), track.topic.clone());
        lines.push(Line { name, topic, kind: track.kind, tolerance: value, judged });
    }
    notes.extend(extra(&given, &pairs));
    notes.extend(run.cuts().chain(expected.cuts()).map(ToString::to_string));
    let [run, expected] = names;
    Ok(Report { run, expected, zero, lines, notes })
}

/// Returns the name of a run for messages.
fn name(run: &Run) -> String {
    match run.files() {
        [file] => file.name.clone(),
        files => {
            let folder = files.first().and_then(|file| file.path.parent());
            folder.map_or_else(String::new, |folder| folder.display().to_string())
        }
    }
}

/// Reads all comparable signals of a run.
fn streams(run: &mut Run) -> Result<Vec<Stream>, SeriesError> {
    run.rewind();
    let files: Vec<String> = run.files().iter().map(|file| file.name.clone()).collect();
    let (mut topics, mut budget) = (Topics::of(run), Budget::default());
    while let Some(message) = run.next_message()? {
        let taken = topics.take_if(&message, |_| true, &mut budget);
        taken.map_err(|refusal| refusal.into_error(&message, &files[message.file]))?;
    }
    Ok(topics.into_streams())
}

/// An expected signal, and the same signal of the run.
struct Pair<'t> {
    expected: Signal<'t>,
    run: Option<Signal<'t>>,
}

/// A signal of a topic, by its index.
#[derive(Clone, Copy)]
struct Signal<'t> {
    stream: &'t Stream,
    place: usize,
}

impl<'t> Signal<'t> {
    /// Returns all signals of a topic.
    fn all(stream: &'t Stream) -> impl Iterator<Item = Self> {
        (0..stream.tracks.len()).map(move |place| Self { stream, place })
    }

    fn track(&self) -> &'t Track {
        &self.stream.tracks[self.place]
    }

    /// Returns the times of its samples relative to `zero`, in ns.
    fn times(&self, zero: u64) -> Vec<i64> {
        self.stream.times(self.place).map(|time| time.wrapping_sub(zero).cast_signed()).collect()
    }
}

/// Returns the expected signals with those of the run. Topics are matched by name, or by type if each run has only one
/// of that type.
fn pairs<'t>(given: &'t [Stream], wanted: &'t [Stream]) -> Vec<Pair<'t>> {
    let mut pairs = Vec::new();
    for stream in wanted {
        let of_type = |stream: &&Stream, source: Source| stream.source == source;
        let same_type: Vec<&Stream> = given.iter().filter(|other| of_type(other, stream.source)).collect();
        let is_only = wanted.iter().filter(|other| of_type(other, stream.source)).count() == 1;
        let other = match same_type[..] {
            [other] if is_only => Some(other),
            _ => same_type.into_iter().find(|other| other.topic == stream.topic),
        };
        let signals = other.into_iter().flat_map(Signal::all);
        let by_name: HashMap<&str, Signal<'_>> = signals.map(|signal| (signal.track().name.as_str(), signal)).collect();
        let run = |expected: &Signal<'_>| by_name.get(expected.track().name.as_str()).copied();
        pairs.extend(Signal::all(stream).map(|expected| Pair { expected, run: run(&expected) }));
    }
    pairs
}

/// Returns the time of the first sample of a bag, in ns.
fn first_sample(streams: &[Stream]) -> u64 {
    let tracks = streams.iter().flat_map(|stream| &stream.tracks);
    tracks.filter_map(|track| track.points.first()).map(|(time, _)| *time).min().unwrap_or(0)
}

/// Returns the times, in ns, at which the positions that both runs have begin to move.
fn motion(
    pairs: &[Pair<'_>],
    names: &[String; 2],
    tolerances: &Tolerances<'_>,
) -> Result<Option<(u64, u64)>, ValidateError> {
    let positions = || {
        let both = pairs.iter().filter_map(|pair| pair.run.map(|run| (run.track(), pair.expected.track())));
        both.filter(|(_, expected)| expected.name.ends_with(".position"))
    };
    let first = |times: &mut dyn Iterator<Item = Option<u64>>, name: &String| {
        times.flatten().min().ok_or_else(|| ValidateError::NoMotion(clean(name).into_owned()))
    };
    let run = first(&mut positions().map(|(run, _)| first_motion(run, tolerances.of(&run.name))), &names[0])?;
    let expected =
        first(&mut positions().map(|(_, expected)| first_motion(expected, tolerances.of(&expected.name))), &names[1])?;
    Ok(Some((run, expected)))
}

/// Returns the time, in ns, of the first sample that differs from the first value by more than `tolerance`; smaller
/// differences are noise.
fn first_motion(track: &Track, tolerance: f64) -> Option<u64> {
    let mut points = track.points.iter().filter(|(_, value)| !value.is_nan());
    let (_, start) = points.next()?;
    points.find(|(_, value)| (value - start).abs() > tolerance).map(|(time, _)| *time)
}

/// Whether all values are NaN, as a recorder writes them for a value that a joint does not measure.
fn is_unmeasured(track: &Track) -> bool {
    track.points.iter().all(|(_, value)| value.is_nan()) && names_measure(&track.name) != Measure::Steps
}

/// Returns a note about signals that only the run has.
fn extra(given: &[Stream], pairs: &[Pair<'_>]) -> Option<String> {
    let known: HashSet<(&str, &str)> = pairs
        .iter()
        .filter_map(|pair| pair.run)
        .map(|run| run.track())
        .map(|track| (track.topic.as_str(), track.name.as_str()))
        .collect();
    let tracks = given.iter().flat_map(|stream| &stream.tracks);
    let more = tracks.filter(|track| !known.contains(&(track.topic.as_str(), track.name.as_str())));
    let more: Vec<&str> = more.map(|track| track.name.as_str()).collect();
    (!more.is_empty()).then(|| format!("the run has more signals: {}", some(&more)))
}

#[cfg(test)]
mod tests;
