//! Encodes a cycle as messages of a bag.
//!
//! Law      the same cycles give the same bytes: no clock and no thread is used
//! Reads    a [`Cycle`], and the rates of the state topics from the cell
//! Writes   in the order of [`Topic`]: a message per command and one for setpoints, the inputs, a message per event,
//!          the signals; and at their rate axis_states and joint_states
//!
//! ~/signals has all values in a key cycle, otherwise only those that differ from the previous encoded cycle.

use super::cadence::Cadence;
use super::{Cycle, Encoded, FrameDirection, Topic, key_cycles};
use super::{inputs, verb};
use crate::cell::Cell;
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Command};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::drive::FrameKind;
use lineshaft_core::event::Event;
use lineshaft_core::signal::{Directory, Signal};
use lineshaft_core::text;
use lineshaft_msgs::cdr::append_with_header;
use lineshaft_msgs::foreign::can_msgs::msg::Frame;
use lineshaft_msgs::msg::{AppliedCommand, CycleInputs, Signals};
use lineshaft_ros::surface::JointNames;
use lineshaft_ros::surface::messages::{self, AxisView};
use serde::Serialize;

/// Encodes one cycle after the other.
#[derive(Clone, Debug)]
pub struct Encoder {
    config: MachineConfig,
    views: Vec<AxisView>,
    joint_names: JointNames,
    axis_states: Cadence,
    joint_states: Cadence,
    signals: Vec<Signal>,
    /// Values of the previous cycle; empty before the first one.
    words: Vec<u64>,
    inputs: CycleInputs,
    changed: Signals,
    /// Size of the last cycle, in bytes.
    size: usize,
}

impl Encoder {
    /// Creates an encoder for a machine of `config` with the signals of `directory`. The cell gives the rates and the
    /// joint names.
    pub fn new(cell: &Cell, config: &MachineConfig, directory: &Directory) -> Self {
        Self {
            views: AxisView::all(config, directory),
            joint_names: cell.joint_names.clone(),
            axis_states: Cadence::new(cell.ros.axis_states_rate, config.cycle_ns),
            joint_states: Cadence::new(cell.ros.joint_states_rate, config.cycle_ns),
            signals: directory.iter().map(|(signal, _)| signal).collect(),
            words: Vec::new(),
            inputs: CycleInputs::default(),
            changed: Signals::default(),
            size: 0,
            config: config.clone(),
        }
    }

    /// Returns the messages of a cycle; in a key cycle they contain all signals.
    pub fn encode(&mut self, cycle: &Cycle<'_>) -> Encoded {
        let number = cycle.inputs.cycle;
        let is_key = number.is_multiple_of(key_cycles(self.config.cycle_ns));
        let stamp_ns = cycle.time.stamp_ns;
        let mut encoded = Encoded { cycle: number, time: cycle.time, is_key, ..Encoded::default() };
        encoded.bytes.reserve(self.size + self.size / 4);
        for command in cycle.commands {
            let message = AppliedCommand {
                cycle: number,
                sequence: command.sequence,
                source: command.source.name().to_owned(),
                command: verb::to_json(command, &self.config),
            };
            encoded.push(Topic::Commands, &message);
        }
        if let Some(set) = cycle.stream {
            let (source, command) = (set.source.name().to_owned(), verb::setpoints_to_json(set, &self.config));
            // A stream of setpoints is no command: it has no sequence number and gets no answer.
            encoded.push(Topic::Commands, &AppliedCommand { cycle: number, sequence: 0, source, command });
        }
        inputs::fill(&mut self.inputs, cycle.inputs, &self.config);
        encoded.push(Topic::Inputs, &self.inputs);
        let inputs_crc = encoded.messages().last().map_or(0, |(_, message)| crc32fast::hash(message));
        for event in cycle.events {
            let text = sentence(event, cycle.commands, &self.config);
            encoded.push(Topic::Events, &messages::event(event, stamp_ns, &self.config, text));
        }
        self.note_changes(cycle, is_key, inputs_crc);
        encoded.push(Topic::Signals, &self.changed);
        if self.axis_states.is_due(number) {
            encoded.push(Topic::AxisStates, &messages::axis_states(&self.views, cycle.board, number, stamp_ns));
        }
        if self.joint_states.is_due(number) {
            let message = messages::joint_states(&self.views, &self.joint_names, cycle.board, stamp_ns);
            encoded.push(Topic::JointStates, &message);
        }
        self.size = encoded.size();
        encoded
    }

    fn note_changes(&mut self, cycle: &Cycle<'_>, is_key: bool, inputs_crc: u32) {
        let message = &mut self.changed;
        (message.cycle, message.inputs_crc) = (cycle.inputs.cycle, inputs_crc);
        message.index.clear();
        message.word.clear();
        let is_first = self.words.is_empty();
        self.words.resize(self.signals.len(), 0);
        for (&signal, before) in self.signals.iter().zip(&mut self.words) {
            let word = cycle.board.word(signal);
            if is_key || is_first || word != *before {
                // Indices of signals on the board are u32.
                message.index.push(signal.index() as u32);
                message.word.push(word);
                *before = word;
            }
        }
    }
}

/// Returns the text of an event. A request that was invalid in itself has its own message, stored among the commands of
/// the cycle.
pub fn sentence<'c>(event: &Event, commands: impl IntoIterator<Item = &'c Command>, config: &MachineConfig) -> String {
    let refused = |command: &Command| match &command.action {
        Action::Refuse(sentence) if command.sequence == event.command => Some(sentence.to_string()),
        _ => None,
    };
    let is_bad = event.code == Code::BAD_REQUEST;
    let refused = if is_bad { commands.into_iter().find_map(refused) } else { None };
    refused.unwrap_or_else(|| text::message(event, config))
}

/// LINKTYPE_CAN_SOCKETCAN, whose frames are messages of type can_msgs/Frame.
const SOCKET_CAN: FrameKind = FrameKind(227);

/// Returns a frame of this kind without its header: identifier and flags (big-endian; 11 bits here), length, three
/// reserved bytes, data.
fn can_frame(bytes: &[u8]) -> Option<Frame> {
    const REMOTE: u32 = 1 << 30;
    const ID: u32 = 0x7FF;
    let (word, rest) = bytes.split_first_chunk()?;
    let ([dlc, ..], rest) = rest.split_first_chunk::<4>()?;
    let (word, data) = (u32::from_be_bytes(*word), *rest.first_chunk()?);
    Some(Frame { id: word & ID, is_rtr: word & REMOTE != 0, dlc: *dlc, data, ..Frame::default() })
}

impl Encoded {
    /// Adds a frame of the bus with this index, transmitted `offset_ns` after the beginning of the cycle. Frames of a kind
    /// without a message type are left out.
    pub fn add_frame(&mut self, bus: usize, way: FrameDirection, offset_ns: i64, (kind, bytes): (FrameKind, &[u8])) {
        let Some(frame) = (kind == SOCKET_CAN).then(|| can_frame(bytes)).flatten() else { return };
        let header = messages::header(self.time.stamp_ns.saturating_add_signed(offset_ns));
        let message = Frame { header, ..frame };
        let start = self.bytes.len();
        append_with_header(&mut self.bytes, &message);
        self.frames.push((bus, way, start..self.bytes.len()));
    }

    fn push<T: Serialize>(&mut self, topic: Topic, message: &T) {
        let start = self.bytes.len();
        append_with_header(&mut self.bytes, message);
        self.parts.push((topic, start..self.bytes.len()));
    }
}

#[cfg(test)]
mod tests;
