//! Commands from messages of topics: a message has no answer, so events and log messages name its topic.
//!
//! Law      the newest 256 are stored; a command is accepted or refused within a few cycles
//! Reads    sequence numbers of commands and events

use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::{Event, Kind};
use lineshaft_core::text;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Maximum number of stored commands.
const MOST: usize = 256;

/// Newest commands from messages, with their topics.
#[derive(Debug, Default)]
pub struct TopicCommands(Mutex<VecDeque<(u64, Arc<str>)>>);

impl TopicCommands {
    /// Submits a command from a message of the topic, and stores it before the message text of its events can be requested.
    ///
    /// # Errors
    /// Those of `submit`, which returns the number of the command.
    pub fn submit<E>(&self, topic: &str, submit: impl FnOnce() -> Result<u64, E>) -> Result<u64, E> {
        let mut newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let sequence = submit()?;
        if newest.len() >= MOST {
            newest.pop_front();
        }
        newest.push_back((sequence, topic.into()));
        Ok(sequence)
    }

    /// Returns the message text of an event; if the event refuses a message, the text names the topic.
    pub fn sentence(&self, event: &Event, config: &MachineConfig) -> String {
        let sentence = text::message(event, config);
        match self.topic_of(event.command).filter(|_| event.kind == Kind::Refused) {
            Some(topic) => message_refused(&topic, &sentence),
            None => sentence,
        }
    }

    fn topic_of(&self, sequence: u64) -> Option<Arc<str>> {
        let newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        newest.iter().find(|(known, _)| *known == sequence).map(|(_, topic)| Arc::clone(topic))
    }
}

/// Returns the text about a refused message.
pub(super) fn message_refused(topic: &str, sentence: &str) -> String {
    format!("{topic}: message refused: {sentence}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::code::Code;
    use lineshaft_core::event::Severity;
    use lineshaft_core::object::Object;

    #[test]
    fn refusal_of_a_message_names_its_topic_and_no_other_event_does() {
        let commands = TopicCommands::default();
        let config = MachineConfig::default();
        let topic = "/lineshaft/joint_trajectory";
        assert_eq!(commands.submit(topic, || Ok::<_, ()>(7)), Ok(7));
        assert_eq!(commands.submit(topic, || Err("full")), Err("full"));
        let event = |kind, command| {
            Event::new(Severity::Warn, kind, Object::Machine, Code::LIMIT_VIOLATION).of_command(command)
        };
        let refused = event(Kind::Refused, 7);
        let plain = text::message(&refused, &config);
        assert_eq!(commands.sentence(&refused, &config), format!("{topic}: message refused: {plain}"));
        for other in [event(Kind::Refused, 8), event(Kind::Done, 7)] {
            assert_eq!(commands.sentence(&other, &config), text::message(&other, &config));
        }
        (100..100 + MOST as u64).for_each(|sequence| {
            commands.submit(topic, || Ok::<_, ()>(sequence)).unwrap();
        });
        assert_eq!(commands.sentence(&refused, &config), plain, "too long ago");
    }
}
