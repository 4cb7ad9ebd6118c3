//! Latched messages that the node has published. A bag that begins later starts with them, and so does each further
//! file of a bag.
//!
//! Law      the newest messages of a topic with durability transient local are retained, as many as a late-joining
//!          reader gets; messages with a lifespan (`/rosout`) are not retained

use lineshaft_ros::layer::TappedTopic;
use std::collections::VecDeque;

/// The retained messages of each topic.
#[derive(Clone, Debug, Default)]
pub(crate) struct Retained(Vec<Kept>);

/// Retained messages of a topic, the oldest one first.
#[derive(Clone, Debug)]
struct Kept {
    most: usize,
    messages: VecDeque<Vec<u8>>,
}

impl Retained {
    /// Creates an empty store for the topics, in their order.
    pub(crate) fn new(topics: &[TappedTopic]) -> Self {
        let kept = |topic: &TappedTopic| {
            let most = if topic.is_retained() { usize::from(topic.qos.depth) } else { 0 };
            Kept { most, messages: VecDeque::new() }
        };
        Self(topics.iter().map(kept).collect())
    }

    /// Retains a message, if its topic is latched.
    pub(crate) fn take(&mut self, topic: usize, message: &[u8]) {
        let Some(kept) = self.0.get_mut(topic).filter(|kept| kept.most > 0) else { return };
        if kept.messages.len() >= kept.most {
            kept.messages.pop_front();
        }
        kept.messages.push_back(message.to_vec());
    }

    /// Returns all retained messages, each with the index of its topic.
    pub(crate) fn messages(&self) -> impl Iterator<Item = (usize, &[u8])> {
        let each = self.0.iter().enumerate();
        each.flat_map(|(topic, kept)| kept.messages.iter().map(move |message| (topic, message.as_slice())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_ros::layer::{NodeName, Qos};

    #[test]
    fn newest_messages_of_latched_topics_are_retained() {
        let node = NodeName::new("/", "n").unwrap();
        let topic = |name: &str, qos| TappedTopic { name: node.expand(name).unwrap(), schema: ("a/msg/B", ""), qos };
        let topics =
            [topic("robot_description", Qos::STATUS), topic("/rosout", Qos::ROSOUT), topic("~/shaft", Qos::STREAM)];
        let mut retained = Retained::new(&topics);
        for (topic, message) in [(0, [1]), (1, [2]), (2, [3]), (0, [4]), (9, [5])] {
            retained.take(topic, &message);
        }
        assert_eq!(retained.messages().collect::<Vec<_>>(), [(0, &[4_u8][..])]);
        let mut errors = Retained::new(&[topic("~/errors", Qos::HISTORY)]);
        (0..40_u8).for_each(|number| errors.take(0, &[number]));
        let numbers: Vec<_> = errors.messages().map(|(_, message)| message[0]).collect();
        assert_eq!(numbers, (8..40).collect::<Vec<_>>(), "as many as its depth");
    }
}
