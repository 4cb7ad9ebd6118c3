//! Loads signals from joint_states and axis_states of any recorder.
//!
//! A field that is a signal of the board has the name of the signal; other fields have their own name.

use super::select::{Select, alias};
use super::{Budget, Refusal, Track, is_of_this_program, stamp};
use crate::recording::run::{Message, Run};
use lineshaft_core::signal::Type;
use lineshaft_core::state::{AXIS_STATES, DRIVE_STATES, REFERENCES};
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::Message as _;
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::foreign::std_msgs::msg::Header;
use lineshaft_msgs::msg::{AxisState, AxisStates};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Unit of values in m or rad and of their derivatives: a message does not contain the unit.
const SI: &str = "SI";
/// Maximum number of signals of one run.
const MAX_TRACKS: usize = 100_000;

type Field = (&'static str, Type, &'static str, fn(&AxisState) -> f64);

/// Fields of [`AxisState`] in their order: signal, type, unit, value.
const AXIS_FIELDS: [Field; 21] = [
    ("state", Type::Enum(AXIS_STATES), "", |axis| axis.state.into()),
    ("drive_state", Type::Enum(DRIVE_STATES), "", |axis| axis.drive_state.into()),
    ("reference", Type::Enum(REFERENCES), "", |axis| axis.reference.into()),
    ("mode_of_operation", Type::Int, "", |axis| axis.mode_of_operation.into()),
    ("enabled", Type::Bit, "", |axis| axis.enabled.into()),
    ("homed", Type::Bit, "", |axis| axis.homed.into()),
    ("in_position", Type::Bit, "", |axis| axis.in_position.into()),
    ("in_velocity", Type::Bit, "", |axis| axis.in_velocity.into()),
    ("in_sync", Type::Bit, "", |axis| axis.in_sync.into()),
    ("warning", Type::Bit, "", |axis| axis.warning.into()),
    ("positive_limit", Type::Bit, "", |axis| axis.positive_limit.into()),
    ("negative_limit", Type::Bit, "", |axis| axis.negative_limit.into()),
    ("error", Type::Int, "", |axis| axis.error_code.into()),
    ("command.position", Type::Real, SI, |axis| axis.command_position),
    ("command.velocity", Type::Real, SI, |axis| axis.command_velocity),
    ("command.acceleration", Type::Real, SI, |axis| axis.command_acceleration),
    ("actual.position", Type::Real, SI, |axis| axis.position),
    ("actual.velocity", Type::Real, SI, |axis| axis.velocity),
    ("actual.effort", Type::Real, SI, |axis| axis.effort),
    ("following_error", Type::Real, SI, |axis| axis.following_error),
    ("sync.error", Type::Real, SI, |axis| axis.sync_error),
];
const JOINT_FIELDS: [&str; 3] = ["actual.position", "actual.velocity", "actual.effort"];

/// Kind of the values of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measure {
    /// Position, or its derivative of that order.
    Order(u8),
    /// Force or torque.
    Effort,
    /// Number that changes in steps.
    Steps,
}

/// Message type of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    Joints,
    Axes,
}

/// A topic and its signals.
#[derive(Debug)]
pub(crate) struct Stream {
    pub topic: String,
    pub source: Source,
    pub tracks: Vec<Track>,
    /// Stamps of its messages, in ns.
    stamps: Vec<u64>,
    /// Ranges of the messages that gave a sample, for each track.
    samples: Vec<Vec<Range<usize>>>,
    objects: HashMap<String, Object>,
}

/// A joint or an axis.
#[derive(Debug)]
struct Object {
    /// Its tracks, in the order of its fields.
    places: Vec<Place>,
    /// Last message that contains it.
    message: Option<usize>,
}

impl Stream {
    /// Returns the times of all samples of a track, in ns, never decreasing; also of samples without a point.
    pub(crate) fn times(&self, track: usize) -> impl Iterator<Item = u64> {
        let ranges = self.samples.get(track).into_iter().flatten();
        ranges.filter_map(|range| self.stamps.get(range.clone())).flatten().copied()
    }

    /// Records that the last message gave a sample for a track.
    fn sampled(&mut self, track: usize, budget: &mut Budget) -> Result<(), Refusal> {
        let next = self.stamps.len();
        let Some(ranges) = self.samples.get_mut(track) else { return Ok(()) };
        match ranges.last_mut() {
            Some(last) if last.end + 1 == next => last.end = next,
            _ => {
                budget.spend(1).ok_or(Refusal::TooMany)?;
                ranges.push(next - 1..next);
            }
        }
        Ok(())
    }
}

/// Destination of the values of a field.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// The field had no value yet.
    Unseen,
    /// The signal is not selected.
    Unwanted,
    Track(usize),
}

/// All topics of these types in a run.
#[derive(Debug, Default)]
pub(crate) struct Topics {
    streams: Vec<Stream>,
    tracks: usize,
    /// Whether times are log times. In a bag of this program they are those of the cycles, and are not affected by
    /// steps of the system clock.
    by_log_time: bool,
}

impl Topics {
    /// Creates the topics of a run, before its first message.
    pub(crate) fn of(run: &Run) -> Self {
        Self { by_log_time: is_of_this_program(run), ..Self::default() }
    }

    fn time(&self, message: &Message<'_>, header: &Header) -> Result<u64, String> {
        if self.by_log_time { Ok(message.log_time) } else { stamp(&header.stamp) }
    }

    /// Adds a message if it has one of the types.
    pub(super) fn take(
        &mut self,
        message: &Message<'_>,
        select: &mut Select,
        budget: &mut Budget,
    ) -> Result<(), Refusal> {
        self.take_if(message, |name| select.wants(name, alias(name).as_deref()), budget)
    }

    /// Does the same as [`Topics::take`] for the signals selected by `wants`.
    pub(crate) fn take_if(
        &mut self,
        message: &Message<'_>,
        wants: impl FnMut(&str) -> bool,
        budget: &mut Budget,
    ) -> Result<(), Refusal> {
        match message.kind {
            AxisStates::NAME => self.axes(message, wants, budget),
            JointState::NAME => self.joints(message, wants, budget),
            _ => Ok(()),
        }
    }

    /// Returns the topics in the order of their first messages.
    pub(crate) fn into_streams(mut self) -> Vec<Stream> {
        for stream in &mut self.streams {
            stream.tracks.iter_mut().for_each(Track::finish_samples);
        }
        self.streams
    }

    /// Returns all tracks, except those of joint_states that axis_states has as well.
    pub(super) fn into_best_tracks(self) -> Vec<Track> {
        let (axes, joints): (Vec<_>, Vec<_>) =
            self.into_streams().into_iter().partition(|stream| stream.source == Source::Axes);
        let mut tracks: Vec<Track> = axes.into_iter().flat_map(|stream| stream.tracks).collect();
        let known: HashSet<String> = tracks.iter().map(|track| track.name.clone()).collect();
        let joints = joints.into_iter().flat_map(|stream| stream.tracks);
        tracks.extend(joints.filter(|track| !known.contains(&track.name)));
        tracks
    }

    fn axes(
        &mut self,
        message: &Message<'_>,
        mut wants: impl FnMut(&str) -> bool,
        budget: &mut Budget,
    ) -> Result<(), Refusal> {
        let states: AxisStates = message.decode()?;
        let time = self.time(message, &states.header)?;
        let place = self.place(message.topic, Source::Axes, time, budget)?;
        for axis in &states.axes {
            let fields = AXIS_FIELDS.iter().map(|&(signal, kind, unit, value)| (signal, kind, unit, Some(value(axis))));
            self.object(place, &axis.name, fields, time, &mut wants, budget)?;
        }
        Ok(())
    }

    fn joints(
        &mut self,
        message: &Message<'_>,
        mut wants: impl FnMut(&str) -> bool,
        budget: &mut Budget,
    ) -> Result<(), Refusal> {
        let joints: JointState = message.decode()?;
        let time = self.time(message, &joints.header)?;
        let values = [&joints.position, &joints.velocity, &joints.effort];
        for (values, field) in values.iter().zip(["position", "velocity", "effort"]) {
            let (values, names) = (values.len(), joints.name.len());
            if values != 0 && values != names {
                return Err(
                    format!("{field} has {values} values for {names} joints; none, or one each, is allowed").into()
                );
            }
        }
        let place = self.place(message.topic, Source::Joints, time, budget)?;
        for (index, joint) in joints.name.iter().enumerate() {
            let values = values.map(|values| values.get(index).copied());
            let fields = JOINT_FIELDS.iter().zip(values).map(|(&signal, value)| (signal, Type::Real, SI, value));
            self.object(place, joint, fields, time, &mut wants, budget)?;
        }
        Ok(())
    }

    /// Adds a message to the stream of a topic and returns the index of the stream.
    fn place(&mut self, topic: &str, source: Source, time: u64, budget: &mut Budget) -> Result<usize, Refusal> {
        budget.spend(1).ok_or(Refusal::TooMany)?;
        let known = self.streams.iter().position(|stream| stream.topic == topic && stream.source == source);
        let place = known.unwrap_or_else(|| {
            let (topic, tracks, stamps, samples) = (topic.to_owned(), Vec::new(), Vec::new(), Vec::new());
            self.streams.push(Stream { topic, source, tracks, stamps, samples, objects: HashMap::new() });
            self.streams.len() - 1
        });
        self.streams[place].stamps.push(time);
        Ok(place)
    }

    /// Adds the values of one joint or axis; a message without it gives no sample.
    fn object(
        &mut self,
        stream: usize,
        object: &str,
        fields: impl ExactSizeIterator<Item = (&'static str, Type, &'static str, Option<f64>)>,
        time: u64,
        wants: &mut impl FnMut(&str) -> bool,
        budget: &mut Budget,
    ) -> Result<(), Refusal> {
        let stream = &mut self.streams[stream];
        let message = Some(stream.stamps.len());
        let known = match stream.objects.get_mut(object) {
            Some(known) => known,
            None => {
                self.tracks += fields.len();
                if self.tracks > MAX_TRACKS {
                    return Err(format!("with {} there are more than {MAX_TRACKS} signals", excerpt(object)).into());
                }
                let new = Object { places: vec![Place::Unseen; fields.len()], message: None };
                stream.objects.entry(object.to_owned()).or_insert(new)
            }
        };
        if known.message == message {
            let what = if stream.source == Source::Axes { "axis" } else { "joint" };
            return Err(format!("{what} {} stands twice", excerpt(object)).into());
        }
        known.message = message;
        // Moved out while its stream is changed.
        let mut places = std::mem::take(&mut known.places);
        let taken = stream.fields(object, &mut places, fields, time, wants, budget);
        if let Some(known) = stream.objects.get_mut(object) {
            known.places = places;
        }
        taken
    }
}

impl Stream {
    /// Adds the values of the fields of an object.
    fn fields(
        &mut self,
        object: &str,
        places: &mut [Place],
        fields: impl Iterator<Item = (&'static str, Type, &'static str, Option<f64>)>,
        time: u64,
        wants: &mut impl FnMut(&str) -> bool,
        budget: &mut Budget,
    ) -> Result<(), Refusal> {
        for (place, (signal, kind, unit, value)) in places.iter_mut().zip(fields) {
            let Some(value) = value else { continue };
            if let Place::Unseen = place {
                let name = format!("{object}.{signal}");
                *place = if wants(&name) { Place::Track(self.tracks.len()) } else { Place::Unwanted };
                if let Place::Track(_) = place {
                    self.tracks.push(Track::new(name, unit.to_owned(), kind, self.topic.clone()));
                    self.samples.push(Vec::new());
                }
            }
            if let Place::Track(place) = *place
                && let Some(track) = self.tracks.get_mut(place)
            {
                let late = track.late;
                track.sample(time, value, budget)?;
                if track.late == late {
                    self.sampled(place, budget)?;
                }
            }
        }
        Ok(())
    }
}

/// Returns the kind of the values of a signal, by its name.
pub(crate) fn names_measure(name: &str) -> Measure {
    let is = |ends: &[&str]| ends.iter().any(|end| name.strip_suffix(end).is_some_and(|object| object.ends_with('.')));
    if is(&["command.position", "actual.position", "following_error", "sync.error"]) {
        Measure::Order(0)
    } else if is(&["command.velocity", "actual.velocity"]) {
        Measure::Order(1)
    } else if is(&["command.acceleration"]) {
        Measure::Order(2)
    } else if is(&["actual.effort"]) {
        Measure::Effort
    } else {
        Measure::Steps
    }
}
