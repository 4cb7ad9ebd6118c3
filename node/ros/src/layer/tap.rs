//! Copies of the messages that a node publishes, for a recorder.
//!
//! Law      a publisher never waits for the recorder: a copy without room is dropped and counted. While the tap is closed, only retained
//!          topics are copied, so that a bag that starts later begins with their messages
//! Reads    the serialized messages of publishers, selected by the names that the node uses for them

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use super::name::{FullName, NodeName};
use crate::link::qos::Qos;

/// Maximum number of messages that wait for the recorder.
const ROOM: usize = 4096;
/// Encapsulation header of little-endian CDR, as in bags.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Topic whose messages are copied.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TappedTopic {
    /// Full name before remapping.
    pub name: FullName,
    /// Message type, and its definition in schema encoding `ros2msg`.
    pub schema: (&'static str, &'static str),
    /// Offered QoS.
    pub qos: Qos,
}

impl TappedTopic {
    /// Returns true if a bag that starts later begins with the latest messages of the topic: topics that are transient local and have no
    /// lifespan (`/rosout` has one).
    pub fn is_retained(&self) -> bool {
        is_retained(self.qos)
    }
}

fn is_retained(qos: Qos) -> bool {
    qos.latched && qos.lifespan.is_none()
}

/// Copy of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TappedMessage {
    /// Index of its topic in [`Tap::topics`].
    pub topic: usize,
    /// System time of publication, in ns since the Unix epoch.
    pub published_ns: u64,
    /// Serialized message, with the CDR header of 4 bytes.
    pub data: Vec<u8>,
}

/// Tap that copies published messages of a node. Clones share it.
#[derive(Clone)]
pub struct Tap(Arc<Inner>);

struct Inner {
    wants: Box<dyn Fn(&str) -> bool + Send + Sync>,
    topics: Mutex<Vec<TappedTopic>>,
    sender: SyncSender<TappedMessage>,
    /// Whether all messages are copied, instead of those of retained topics.
    is_open: AtomicBool,
    lost: AtomicU64,
}

impl Tap {
    /// Creates a tap for the publishers that `wants` selects by their names (`~/errors`), and the receiver of the copies. It starts open:
    /// the recorder starts after the first publishers, and closes the tap if there is no bag.
    pub fn new(wants: impl Fn(&str) -> bool + Send + Sync + 'static) -> (Self, Receiver<TappedMessage>) {
        let (sender, receiver) = sync_channel(ROOM);
        let (is_open, lost) = (AtomicBool::new(true), AtomicU64::new(0));
        let inner = Inner { wants: Box::new(wants), topics: Mutex::default(), sender, is_open, lost };
        (Self(Arc::new(inner)), receiver)
    }

    /// Opens or closes the tap: a closed one copies only the messages of retained topics.
    pub fn set_open(&self, is_open: bool) {
        self.0.is_open.store(is_open, Ordering::Relaxed);
    }

    /// Returns true if all messages are copied.
    pub fn is_open(&self) -> bool {
        self.0.is_open.load(Ordering::Relaxed)
    }

    /// Returns the topics so far, in the order in which they were opened.
    pub fn topics(&self) -> Vec<TappedTopic> {
        self.0.topics.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the number of messages without room so far.
    pub fn lost(&self) -> u64 {
        self.0.lost.load(Ordering::Relaxed)
    }

    /// Returns a tap of a publisher, if it is selected.
    pub(super) fn open(
        &self,
        node: &NodeName,
        name: &str,
        schema: (&'static str, &'static str),
        qos: Qos,
    ) -> Option<TappedPublisher> {
        if !(self.0.wants)(name) {
            return None;
        }
        let name = node.expand(name).ok()?;
        let mut topics = self.0.topics.lock().unwrap_or_else(PoisonError::into_inner);
        let known = topics.iter().position(|topic| topic.name == name);
        let topic = known.unwrap_or_else(|| {
            topics.push(TappedTopic { name, schema, qos });
            topics.len() - 1
        });
        Some(TappedPublisher { tap: self.clone(), topic, is_retained: is_retained(qos) })
    }
}

impl fmt::Debug for Tap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Tap").field(&self.topics()).finish()
    }
}

/// Publisher whose messages are copied.
pub(super) struct TappedPublisher {
    tap: Tap,
    topic: usize,
    is_retained: bool,
}

impl TappedPublisher {
    /// Copies a serialized message without header, if the tap is open or its topic is retained. Never blocks.
    pub(super) fn copy(&self, body: &[u8]) {
        if !self.is_retained && !self.tap.is_open() {
            return;
        }
        // A clock before 1970 gives 1970; the conversion overflows in the year 2554.
        let published_ns = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_nanos() as u64);
        let data = [&HEADER[..], body].concat();
        let message = TappedMessage { topic: self.topic, published_ns, data };
        // Without a recorder a message does not count as lost.
        if let Err(TrySendError::Full(_)) = self.tap.0.sender.try_send(message) {
            self.tap.0.lost.fetch_add(1, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node() -> NodeName {
        NodeName::new("/cell", "press").unwrap()
    }

    #[test]
    fn tap_copies_chosen_publishers_with_header_and_place() {
        let (tap, copies) = Tap::new(|name| name != "~/events");
        let schema = ("std_msgs/msg/String", "string data");
        assert!(tap.open(&node(), "~/events", schema, Qos::EVENTS).is_none());
        let rosout = tap.open(&node(), "/rosout", schema, Qos::ROSOUT).unwrap();
        let errors = tap.open(&node(), "~/errors", schema, Qos::HISTORY).unwrap();
        let again = tap.open(&node(), "~/errors", schema, Qos::HISTORY).unwrap();
        let names: Vec<_> = tap.topics().iter().map(|topic| topic.name.to_string()).collect();
        assert_eq!(names, ["/rosout", "/cell/press/errors"]);
        assert_eq!(tap.topics()[1].qos, Qos::HISTORY);
        for (publisher, body) in [(&errors, [1, 2]), (&rosout, [3, 4]), (&again, [5, 6])] {
            publisher.copy(&body);
        }
        let seen: Vec<_> = copies.try_iter().map(|copy| (copy.topic, copy.data)).collect();
        assert_eq!(seen, [(1, vec![0, 1, 0, 0, 1, 2]), (0, vec![0, 1, 0, 0, 3, 4]), (1, vec![0, 1, 0, 0, 5, 6])]);
    }

    #[test]
    fn closed_tap_copies_retained_topics_alone() {
        let (tap, copies) = Tap::new(|_| true);
        let schema = ("std_msgs/msg/String", "string data");
        let [errors, rosout, shaft, description] = [
            ("~/errors", Qos::HISTORY),
            ("/rosout", Qos::ROSOUT),
            ("~/shaft", Qos::STREAM),
            ("robot_description", Qos::STATUS),
        ]
        .map(|(name, qos)| tap.open(&node(), name, schema, qos).unwrap());
        let retained: Vec<_> = tap.topics().iter().map(TappedTopic::is_retained).collect();
        assert_eq!(retained, [true, false, false, true]);
        let publish = || {
            [&errors, &rosout, &shaft, &description].iter().for_each(|publisher| publisher.copy(&[7]));
            copies.try_iter().map(|copy| copy.topic).collect::<Vec<_>>()
        };
        assert_eq!(publish(), [0, 1, 2, 3], "it begins open");
        tap.set_open(false);
        assert_eq!(publish(), [0, 3]);
        for _ in 0..=ROOM {
            shaft.copy(&[7]);
        }
        assert_eq!(tap.lost(), 0, "a message that is not copied does not count as lost");
        tap.set_open(true);
        assert_eq!(publish(), [0, 1, 2, 3]);
    }

    #[test]
    fn publisher_does_not_wait_for_blocked_recorder() {
        let (tap, copies) = Tap::new(|_| true);
        let publisher = tap.open(&node(), "~/errors", ("a/msg/B", ""), Qos::HISTORY).unwrap();
        for _ in 0..ROOM + 3 {
            publisher.copy(&[0]);
        }
        assert_eq!((tap.lost(), copies.try_iter().count()), (3, ROOM));
        drop(copies);
        publisher.copy(&[0]);
        assert_eq!(tap.lost(), 3, "without a recorder nothing is lost");
    }
}
