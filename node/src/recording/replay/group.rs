//! Recorded messages of one cycle.

use super::ReplayError;
use crate::recording::run::Message;
use crate::recording::series::stamp;
use crate::recording::{Topic, inputs};
use lineshaft_core::unit::excerpt;
use lineshaft_msgs::cdr;
use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;
use lineshaft_msgs::msg::{AppliedCommand, CycleInputs, Event};

/// The messages of one log time.
#[derive(Debug, Default)]
pub(super) struct Group {
    /// Time t_k, in ns.
    pub log_time: u64,
    /// Index of the file of the first message.
    pub file: usize,
    pub commands: Vec<AppliedCommand>,
    pub inputs: Option<RecordedInputs>,
    /// All other messages of a known type, not decoded.
    pub others: Vec<(Topic, Vec<u8>)>,
    /// Whether a message was added since the last clear.
    is_begun: bool,
}

/// Recorded inputs.
#[derive(Debug)]
pub(super) struct RecordedInputs {
    pub message: CycleInputs,
    /// CRC of the bytes in the file.
    pub crc: u32,
}

impl Group {
    /// Whether a message of that time belongs to this group.
    pub(super) fn is_of(&self, log_time: u64) -> bool {
        !self.is_begun || self.log_time == log_time
    }

    /// Whether it has a message of a cycle. Joint states may have another sender, unless the recording is ours.
    pub(super) fn is_of_a_cycle(&self, is_ours: bool) -> bool {
        !self.commands.is_empty() || self.others.iter().any(|(topic, _)| is_ours || *topic != Topic::JointStates)
    }

    /// Returns the messages of a topic.
    pub(super) fn of(&self, topic: Topic) -> impl Iterator<Item = &[u8]> {
        self.others.iter().filter(move |(of, _)| *of == topic).map(|(_, data)| data.as_slice())
    }

    /// Returns the system time of the cycle, in ns, from its first message with a stamp; `None` if there is none.
    pub(super) fn stamp_ns(&self) -> Option<u64> {
        if let Some(data) = [Topic::AxisStates, Topic::JointStates].into_iter().find_map(|topic| self.of(topic).next())
        {
            // The messages begin with the stamp: CDR header, then seconds and nanoseconds.
            let time: Time = cdr::decode_with_header(data.get(..12)?).ok()?;
            return stamp(&time).ok();
        }
        let event: Event = cdr::decode_with_header(self.of(Topic::Events).next()?).ok()?;
        Some(stamp(&event.header.stamp).ok()?.saturating_add(event.age_ns.into()))
    }

    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds a message; messages of other types are ignored.
    pub(super) fn add(&mut self, message: &Message<'_>) -> Result<(), ReplayError> {
        if !self.is_begun {
            (self.log_time, self.file, self.is_begun) = (message.log_time, message.file, true);
        }
        let bad =
            |reason: String| ReplayError::Message { topic: excerpt(message.topic), log_time: message.log_time, reason };
        match Topic::of_message(message.topic, message.kind) {
            Some(Topic::Commands) => self.commands.push(message.decode().map_err(bad)?),
            Some(Topic::Inputs) => {
                let inputs = inputs::decode(message).map_err(bad)?;
                self.inputs = Some(RecordedInputs { message: inputs, crc: crc32fast::hash(message.data) });
            }
            Some(topic) => self.others.push((topic, message.cdr().map_err(bad)?.to_vec())),
            None => {}
        }
        Ok(())
    }

    /// Returns the error for a message of this cycle that cannot be replayed.
    pub(super) fn bad(&self, kind: &str, reason: String) -> ReplayError {
        ReplayError::Message { topic: kind.to_owned(), log_time: self.log_time, reason }
    }
}
