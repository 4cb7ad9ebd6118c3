//! Passes messages that the node publishes into the bag.
//!
//! Law      a message is written with the next cycle by system time; a bag that begins later starts with the latched
//!          messages so far; a bag ends with the messages after its last cycle
//!
//! Without a bag, only messages of latched topics are received. No publisher waits. A message without room is dropped
//! and counted, and logged.

use crate::recording::Encoded;
use crate::recording::bag::Retained;
use lineshaft_ros::layer::{Tap, TappedMessage};
use std::collections::VecDeque;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Maximum number of messages that wait for their cycle, for example while no cycle runs; the oldest ones are then
/// dropped.
const MOST_WAITING: usize = 4096;
/// Maximum time, in ns, by which a message may be later than its cycle; a larger difference is due to a step of the
/// system clock, and the message waits no longer.
const LATEST_NS: u64 = 1_000_000_000;
/// Minimum time between two log lines about missing messages.
const SECOND: Duration = Duration::from_secs(1);

/// Messages that a node publishes, for the recorder.
pub struct Published {
    tap: Tap,
    copies: Receiver<TappedMessage>,
    retained: Retained,
    waiting: VecDeque<TappedMessage>,
    /// Number of messages that were dropped, here or in the bag.
    left_out: u64,
    /// Number of missing messages that were logged.
    told: u64,
    told_at: Option<Instant>,
}

impl Published {
    /// Creates a receiver for the current topics of the tap.
    pub fn new(tap: Tap, copies: Receiver<TappedMessage>) -> Self {
        let retained = Retained::new(&tap.topics());
        Self { tap, copies, retained, waiting: VecDeque::new(), left_out: 0, told: 0, told_at: None }
    }

    /// Enables the copies of all messages.
    pub(super) fn open(&self) {
        self.tap.set_open(true);
    }

    /// Receives pending messages. They wait for their cycle only if a bag `is_wanted`, that is, being written or about
    /// to begin.
    pub(super) fn hear(&mut self, is_wanted: bool) {
        self.tap.set_open(is_wanted);
        if !is_wanted {
            self.take_waiting(|_| true, |_| {});
        }
        while let Ok(message) = self.copies.try_recv() {
            if !is_wanted {
                self.retained.take(message.topic, &message.data);
                continue;
            }
            if self.waiting.len() >= MOST_WAITING
                && let Some(oldest) = self.waiting.pop_front()
            {
                self.retained.take(oldest.topic, &oldest.data);
                self.left_out += 1;
            }
            self.waiting.push_back(message);
        }
        let missing = self.tap.lost() + self.left_out;
        if !is_wanted {
            self.told = missing;
        } else if missing > self.told && self.told_at.is_none_or(|told| told.elapsed() >= SECOND) {
            let more = missing - self.told;
            tracing::warn!(
                "{more} messages that the node has published are missing in the recording: too many came at once"
            );
            (self.told, self.told_at) = (missing, Some(Instant::now()));
        }
    }

    /// Adds the latched messages before the first cycle of a bag to it.
    pub(super) fn begin(&mut self, cycle: &mut Encoded) {
        self.skip(cycle.time.stamp_ns);
        self.retained.messages().for_each(|(topic, message)| cycle.add_published(topic, message));
    }

    /// Adds the messages before this cycle to it.
    pub(super) fn add_to(&mut self, cycle: &mut Encoded) {
        let now_ns = cycle.time.stamp_ns;
        self.take_waiting(
            |message| is_due(message, now_ns),
            |message| cycle.add_published(message.topic, &message.data),
        );
    }

    /// Counts the messages of a cycle for which the bag had no room.
    pub(super) fn leave_out(&mut self, cycle: &Encoded) {
        self.left_out += cycle.published().count() as u64;
    }

    /// Skips a cycle that is in no bag; the messages before it are in none either.
    pub(super) fn skip(&mut self, now_ns: u64) {
        self.take_waiting(|message| is_due(message, now_ns), |_| {});
    }

    /// Returns the messages after the last cycle of a bag.
    pub(super) fn take_rest(&mut self) -> Vec<TappedMessage> {
        self.hear(true);
        let mut rest = Vec::new();
        self.take_waiting(|_| true, |message| rest.push(message.clone()));
        rest
    }

    /// Takes messages from the oldest one on while `is_due` is true; those of latched topics are retained.
    fn take_waiting(&mut self, is_due: impl Fn(&TappedMessage) -> bool, mut take: impl FnMut(&TappedMessage)) {
        while self.waiting.front().is_some_and(&is_due)
            && let Some(message) = self.waiting.pop_front()
        {
            take(&message);
            self.retained.take(message.topic, &message.data);
        }
    }
}

/// Whether a message is before a cycle at that system time, in ns.
fn is_due(message: &TappedMessage, now_ns: u64) -> bool {
    message.published_ns <= now_ns || message.published_ns - now_ns > LATEST_NS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::CycleTime;
    use lineshaft_ros::layer::{NodeName, Qos, TappedTopic};
    use std::sync::mpsc::sync_channel;

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
        // The last one has the time before a step of the clock, and does not delay those after it.
        assert_eq!(sizes, [0, 4, 8]);
        assert!(published.waiting.is_empty());
        published.waiting.push_back(message(1));
        published.hear(false);
        assert!(published.waiting.is_empty(), "without a bag nothing waits");
    }

    #[test]
    fn messages_of_a_cycle_without_room_count_as_missing() {
        let (tap, copies) = Tap::new(|_| true);
        let mut published = Published::new(tap, copies);
        published.waiting.extend([message(5), message(6), message(20)]);
        let mut cycle = cycle(10);
        published.add_to(&mut cycle);
        published.leave_out(&cycle);
        published.hear(true);
        assert_eq!((published.left_out, published.told), (2, 2));
    }

    #[test]
    fn tap_is_open_only_while_a_bag_is_written_or_about_to_begin() {
        let (tap, copies) = Tap::new(|_| true);
        let mut published = Published::new(tap.clone(), copies);
        published.hear(false);
        assert!(!tap.is_open());
        published.open();
        assert!(tap.is_open());
        published.hear(true);
        assert!(tap.is_open());
        published.hear(false);
        assert!(!tap.is_open());
    }

    /// Messages at 5, 20 and 30 ns, and a bag that begins with the cycle at 10 ns: the first message is in the bag only
    /// as a retained one, and each only once.
    #[test]
    fn messages_around_the_first_cycle_are_written_once() {
        let name = NodeName::new("/", "n").unwrap().expand("~/errors").unwrap();
        let topic = TappedTopic { name, schema: ("a/msg/B", ""), qos: Qos::HISTORY };
        let (tap, _) = Tap::new(|_| true);
        let (send, copies) = sync_channel(8);
        let mut published = Published { retained: Retained::new(&[topic]), ..Published::new(tap, copies) };
        [5, 20, 30].into_iter().for_each(|ns| send.send(message(ns)).unwrap());
        published.hear(true);
        let (mut first, mut second) = (cycle(10), cycle(25));
        published.begin(&mut first);
        published.add_to(&mut second);
        assert_eq!([first.size(), second.size()], [4, 4]);
        send.send(message(40)).unwrap();
        let rest: Vec<_> = published.take_rest().iter().map(|message| message.published_ns).collect();
        assert_eq!(rest, [30, 40]);
        assert_eq!(published.retained.messages().count(), 4);
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
