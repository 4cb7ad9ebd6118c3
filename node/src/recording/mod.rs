//! Recordings: writes runs as rosbag2 bags (MCAP) and reads them again (contract section 6).
//!
//! A [`Cycle`] has all data of one cycle. An [`Encoder`](encoder::Encoder) converts it to an [`Encoded`] cycle with the
//! messages of a bag; a [`Bag`](bag::Bag) writes them. [`Run`](run::Run) reads bags of this program and of any other
//! recorder.
//!
//! This module uses no thread and no clock: [`run`](crate::run) drives it for a machine in real time.

pub mod bag;
pub mod cadence;
pub(crate) mod clean;
pub mod encoder;
pub mod info;
pub mod inputs;
pub mod metadata;
pub mod packed;
pub mod plot;
pub mod replay;
#[cfg(test)]
pub(crate) mod rig;
pub mod run;
pub mod series;
pub mod simulation;
#[cfg(test)]
pub(crate) mod test_bags;
pub mod validate;
pub mod verb;

use jiff::Timestamp;
use lineshaft_core::command::{Command, Setpoints};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::drive::Inputs;
use lineshaft_core::event::Event;
use lineshaft_core::machine::State;
use lineshaft_core::parameter::AxisParameters;
use lineshaft_core::signal::Board;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::ops::Range;

/// Returns the attached files of tables, in the form that [`Cell::parse_recorded`](crate::cell::Cell::parse_recorded)
/// reads.
pub(crate) fn attached_files(run: &run::Run) -> Result<Option<String>, run::RunError> {
    let bytes = run.attachment(bag::TABLES)?;
    Ok(bytes.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
}

/// Minimum change of the system clock that counts as a step, in ns; a smaller difference is followed smoothly.
pub const CLOCK_STEP_NS: u64 = 50_000_000;

/// Time t_k of a cycle, since the Unix epoch or since the start of a simulation.
///
/// Both times are equal until the system clock is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CycleTime {
    /// Log time, in ns. It never decreases.
    pub log_ns: u64,
    /// System time, in ns, as in the stamps of messages.
    pub stamp_ns: u64,
}

impl CycleTime {
    /// Returns the time of a cycle whose log time is its system time, in ns.
    pub fn same(ns: u64) -> Self {
        Self { log_ns: ns, stamp_ns: ns }
    }

    /// Returns the time by which the stamp is ahead of the log time, in ns.
    pub fn ahead_ns(self) -> i64 {
        self.stamp_ns.wrapping_sub(self.log_ns).cast_signed()
    }
}

/// Inputs and results of one cycle.
#[derive(Clone, Copy, Debug)]
pub struct Cycle<'a> {
    /// Time t_k.
    pub time: CycleTime,
    /// Inputs as read by the machine; they contain the cycle number k.
    pub inputs: &'a Inputs,
    /// Commands in the order in which they were applied.
    pub commands: &'a [Command],
    /// New streamed setpoints, if any.
    pub stream: Option<&'a Setpoints>,
    /// Events in their order.
    pub events: &'a [Event],
    /// Signal values at the end of the cycle.
    pub board: &'a Board,
}

/// Topics of a bag, in the order in which a cycle writes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Topic {
    /// ~/commands
    Commands,
    /// ~/inputs
    Inputs,
    /// ~/events
    Events,
    /// ~/signals
    Signals,
    /// ~/axis_states
    AxisStates,
    /// joint_states
    JointStates,
}

/// Direction of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameDirection {
    /// From this program to the bus.
    Sent,
    /// From the bus to this program.
    Received,
}

impl FrameDirection {
    /// Both directions, in the order of their topics.
    pub const ALL: [Self; 2] = [Self::Sent, Self::Received];

    /// Returns the last part of the topic name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sent => "sent",
            Self::Received => "received",
        }
    }
}

/// The messages of one cycle, serialized.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Encoded {
    /// Cycle number k.
    pub cycle: u64,
    /// Time t_k.
    pub time: CycleTime,
    /// Whether the message on ~/signals has all signals, so that a file may begin here.
    pub is_key: bool,
    /// State of the machine before this cycle, if stored; only key cycles have it.
    pub state: Option<Vec<u8>>,
    /// Parameters in force before this cycle, as text; present with the state.
    pub parameters: Option<String>,
    /// Ranges of the messages in `bytes`.
    parts: Vec<(Topic, Range<usize>)>,
    /// Frames of buses: index of the bus, direction, and range of the message in `bytes`.
    frames: Vec<(usize, FrameDirection, Range<usize>)>,
    /// Messages that the node published since the previous cycle: index of the topic in [`Subject`](bag::Subject), and
    /// range of the message in `bytes`.
    published: Vec<(usize, Range<usize>)>,
    bytes: Vec<u8>,
}

impl Encoded {
    /// Returns true if a file of a bag, and so a replay, can begin with this cycle.
    pub fn can_begin(&self) -> bool {
        self.is_key && (self.cycle == 0 || self.state.is_some())
    }

    /// Returns the messages, each with the CDR header of 4 bytes.
    pub fn messages(&self) -> impl Iterator<Item = (Topic, &[u8])> {
        self.parts.iter().map(|(topic, range)| (*topic, &self.bytes[range.clone()]))
    }

    /// Returns all messages, frames after the others, each with the index of its topic in a bag: those of
    /// [`Topic::ALL`], then two for each bus.
    fn places(&self) -> impl Iterator<Item = (usize, &[u8])> {
        let frames = self.frames.iter().map(|(bus, way, range)| {
            let place = Topic::ALL.len() + bus * FrameDirection::ALL.len() + *way as usize;
            (place, self.bytes.get(range.clone()).unwrap_or_default())
        });
        self.messages().map(|(topic, message)| (topic as usize, message)).chain(frames)
    }

    /// Adds a message that the node published, with the CDR header of 4 bytes.
    pub fn add_published(&mut self, topic: usize, message: &[u8]) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(message);
        self.published.push((topic, start..self.bytes.len()));
    }

    /// Returns the messages that the node published, each with the index of its topic in [`Subject`](bag::Subject).
    pub(crate) fn published(&self) -> impl Iterator<Item = (usize, &[u8])> {
        self.published.iter().map(|(topic, range)| (*topic, self.bytes.get(range.clone()).unwrap_or_default()))
    }

    /// Returns the cycle with the state of the machine before it.
    pub fn with_state(self, state: &State, config: &MachineConfig) -> Self {
        let parameters: Vec<AxisParameters> = state.parameters().copied().collect();
        let text = crate::parameters::parameters_text(config, state.machine_parameters(), &parameters);
        // Every state can be serialized; without one, no file would begin here.
        let bytes = postcard::to_allocvec(state).ok();
        Self { state: bytes, parameters: Some(text), ..self }
    }

    /// Returns the memory in use, in bytes.
    pub fn memory(&self) -> usize {
        let texts = self.state.as_ref().map_or(0, Vec::capacity) + self.parameters.as_ref().map_or(0, String::capacity);
        let frames = self.frames.capacity() * size_of::<(usize, FrameDirection, Range<usize>)>();
        let published = self.published.capacity() * size_of::<(usize, Range<usize>)>();
        size_of::<Self>() + self.bytes.capacity() + size_of_val(self.parts.as_slice()) + frames + published + texts
    }

    /// Returns the size of all messages, in bytes.
    pub fn size(&self) -> usize {
        self.bytes.len()
    }
}

/// Returns the number of cycles between two key cycles: those of one second.
pub fn key_cycles(cycle_ns: u64) -> u64 {
    (1_000_000_000 / cycle_ns.max(1)).max(1)
}

/// Returns the SHA-256 as 64 hexadecimal digits.
pub(crate) fn sha256(bytes: impl AsRef<[u8]>) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut digits, byte| {
        // Writing to a string cannot fail.
        let _ = write!(digits, "{byte:02x}");
        digits
    })
}

/// Returns date and time in UTC for file names: `20261121_152804`.
pub fn date_and_time(stamp_ns: u64) -> String {
    Timestamp::from_nanosecond(stamp_ns.into())
        .map_or_else(|_| stamp_ns.to_string(), |stamp| stamp.strftime("%Y%m%d_%H%M%S").to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn key_cycles_come_once_a_second() {
        assert_eq!([125_000, 1_000_000, 3_000_000, 20_000_000].map(key_cycles), [8000, 1000, 333, 50]);
    }

    #[test]
    fn file_names_contain_the_time_in_utc() {
        assert_eq!(date_and_time(0), "19700101_000000");
        assert_eq!(date_and_time(1_795_275_384_999_999_999), "20261121_153624");
    }
}
