//! Endpoints that the node's graph knows, and what they need of their node.

use std::sync::Arc;
use std::time::Duration;

use lineshaft_msgs::{Action, Message, Service};
use tokio::runtime::Handle;
use tokio::sync::watch;

use super::arguments::Names;
use super::clock::Clock;
use super::tap::Tap;
use crate::link::protocol::{WireType, monotonic_ns};
use crate::link::qos::Qos;
use crate::link::{LinkError, Opener, Reader, Writer};

/// What endpoints keep of their node. None of it keeps the node in the graph.
#[derive(Clone)]
pub(super) struct Context {
    pub(super) opener: Opener,
    pub(super) runtime: Handle,
    pub(super) names: Arc<Names>,
    /// What stamps show.
    pub(super) clock: Clock,
    /// How old a request may be that is carried out.
    pub(super) request_timeout: Duration,
    /// Copies what it publishes; none: nothing is copied.
    pub(super) tap: Option<Tap>,
    /// Fails to change once the node is gone.
    pub(super) closed: watch::Receiver<()>,
    /// All that was ever opened on the wire.
    #[cfg(test)]
    pub(super) opened: Opened,
}

/// What a node has opened: whether it writes, the topic and its type in DDS, how it is delivered.
#[cfg(test)]
pub(crate) type Opened = Arc<std::sync::Mutex<Vec<(bool, String, String, Qos)>>>;

impl Context {
    pub(super) fn writer(&self, topic: &str, wire: WireType, qos: Qos) -> Writer {
        #[cfg(test)]
        self.note(true, topic, wire, qos);
        self.opener.writer(topic, wire, qos)
    }

    pub(super) fn reader(&self, topic: &str, wire: WireType, qos: Qos) -> Reader {
        #[cfg(test)]
        self.note(false, topic, wire, qos);
        self.opener.reader(topic, wire, qos)
    }

    #[cfg(test)]
    fn note(&self, writes: bool, topic: &str, wire: WireType, qos: Qos) {
        self.opened.lock().unwrap().push((writes, topic.to_owned(), wire.name.to_owned(), qos));
    }
}

impl WireType {
    /// Returns the type of a message.
    pub(super) fn message<M: Message>() -> Self {
        Self { name: M::DDS_NAME, hash: M::HASH }
    }

    /// Returns the type of the requests of a service.
    pub(super) fn request<S: Service>() -> Self {
        Self { name: S::REQUEST_DDS_NAME, hash: S::REQUEST_HASH }
    }

    /// Returns the type of the responses of a service.
    pub(super) fn response<S: Service>() -> Self {
        Self { name: S::RESPONSE_DDS_NAME, hash: S::RESPONSE_HASH }
    }

    /// Returns the type of the feedback messages of an action.
    pub(super) fn feedback<A: Action>() -> Self {
        Self { name: A::FEEDBACK_MESSAGE_DDS_NAME, hash: A::FEEDBACK_MESSAGE_HASH }
    }
}

/// How long ago a sample came: it may have waited in a program that was frozen.
pub(super) fn age(came_ns: u64) -> Duration {
    Duration::from_nanos(monotonic_ns().saturating_sub(came_ns))
}

/// Why a sample of that age is not carried out, if it is too old.
pub(super) fn late(came_ns: u64, timeout: Duration) -> Option<String> {
    let age = age(came_ns);
    (age > timeout).then(|| {
        format!(
            "it has waited for {:.1} s and is not carried out any more (request_timeout of the cell is {} s)",
            age.as_secs_f64(),
            timeout.as_secs_f64()
        )
    })
}

/// Something of a node could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CreateError {
    /// Its name is not allowed.
    #[error(transparent)]
    Name(#[from] super::name::NameError),
    /// There is no ROS side.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A parameter that was given at the start, in one sentence.
    #[error("{0}")]
    Given(String),
}
