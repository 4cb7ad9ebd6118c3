//! What the node publishes, on its way into the bag.
//!
//! Law      a message is written with the cycle that it came before, by the system time of both; a bag that begins later
//!          begins with the latched messages so far
//!
//! No publisher waits for this. A message without room is left out and counted, and a line of the log says so.

use crate::recording::Encoded;
use crate::recording::bag::Retained;
use lineshaft_ros::layer::{Tap, TappedMessage};
use std::collections::VecDeque;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Messages that may wait for their cycle, while none runs for instance; the oldest ones are left out then.
const MOST_WAITING: usize = 4096;
/// A message that is later than its cycle by more than this (ns) is of a system clock that was set: it waits no longer.
const LATEST_NS: u64 = 1_000_000_000;
/// Least time between two lines about messages that are missing.
const SECOND: Duration = Duration::from_secs(1);

/// The messages that a node publishes, for the recorder.
pub struct Published {
    tap: Tap,
    copies: Receiver<TappedMessage>,
    retained: Retained,
    waiting: VecDeque<TappedMessage>,
    /// Messages that had no room here.
    left_out: u64,
    /// Missing messages that were told.
    told: u64,
    told_at: Option<Instant>,
}

impl Published {
    /// For the topics that the tap has so far.
    pub fn new(tap: Tap, copies: Receiver<TappedMessage>) -> Self {
        let retained = Retained::new(&tap.topics());
        Self { tap, copies, retained, waiting: VecDeque::new(), left_out: 0, told: 0, told_at: None }
    }

    /// Takes what has come. Only while a bag `is_recorded` it waits for its cycle.
    pub(super) fn hear(&mut self, is_recorded: bool) {
        if !is_recorded {
            self.waiting.clear();
        }
        while let Ok(message) = self.copies.try_recv() {
            self.retained.take(message.topic, &message.data);
            if !is_recorded {
                continue;
            }
            if self.waiting.len() >= MOST_WAITING {
                self.waiting.pop_front();
                self.left_out += 1;
            }
            self.waiting.push_back(message);
        }
        let missing = self.tap.lost() + self.left_out;
        if !is_recorded {
            self.told = missing;
        } else if missing > self.told && self.told_at.is_none_or(|told| told.elapsed() >= SECOND) {
            let more = missing - self.told;
            tracing::warn!(
                "{more} messages that the node has published are missing in the recording: too many came at once"
            );
            (self.told, self.told_at) = (missing, Some(Instant::now()));
        }
    }

    /// Adds the latched messages so far to the first cycle of a bag.
    pub(super) fn begin(&self, cycle: &mut Encoded) {
        self.retained.messages().for_each(|(topic, message)| cycle.add_published(topic, message));
    }

    /// Adds the messages that came before this cycle.
    pub(super) fn add_to(&mut self, cycle: &mut Encoded) {
        let now_ns = cycle.time.stamp_ns;
        let is_due =
            |message: &TappedMessage| message.published_ns <= now_ns || message.published_ns - now_ns > LATEST_NS;
        while self.waiting.front().is_some_and(is_due)
            && let Some(message) = self.waiting.pop_front()
        {
            cycle.add_published(message.topic, &message.data);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::CycleTime;
    use lineshaft_ros::layer::{NodeName, Qos, TappedTopic};

    fn cycle(stamp_ns: u64) -> Encoded {
        let mut cycle = Encoded::default();
        cycle.time = CycleTime::same(stamp_ns);
        cycle
    }

    fn message(published_ns: u64) -> TappedMessage {
        TappedMessage { topic: 0, published_ns, data: vec![0, 1, 0, 0] }
    }

    #[test]
    fn published_message_is_written_with_the_cycle_that_it_came_before() {
        let (tap, copies) = Tap::new(|_| true);
        let mut published = Published::new(tap, copies);
        published.waiting.extend([message(5), message(1_000_007), message(9_000_000_000_000)]);
        let sizes = [0, 10, 1_000_010].map(|stamp_ns| {
            let mut cycle = cycle(stamp_ns);
            published.add_to(&mut cycle);
            cycle.size()
        });
        // The last one is of a clock that was set, and does not hold up what comes after it.
        assert_eq!(sizes, [0, 4, 8]);
        assert!(published.waiting.is_empty());
        published.waiting.push_back(message(1));
        published.hear(false);
        assert!(published.waiting.is_empty(), "without a bag nothing waits");
    }

    #[test]
    fn bag_that_begins_later_begins_with_latched_messages() {
        let (tap, copies) = Tap::new(|_| true);
        let name = NodeName::new("/", "n").unwrap().expand("robot_description").unwrap();
        let topic = TappedTopic { name, schema: ("std_msgs/msg/String", "string data"), qos: Qos::STATUS };
        let mut published = Published { retained: Retained::new(&[topic]), ..Published::new(tap, copies) };
        published.retained.take(0, &[0, 1, 0, 0, 1, 2, 3, 4]);
        let mut first = cycle(7);
        published.begin(&mut first);
        assert_eq!(first.size(), 8);
    }
}
