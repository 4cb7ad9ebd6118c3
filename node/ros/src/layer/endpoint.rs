//! Endpoints of the node, and the state of the node that they share.

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

/// State of the node that endpoints keep. It does not keep the node in the graph.
#[derive(Clone)]
pub(super) struct Context {
    pub(super) opener: Opener,
    pub(super) runtime: Handle,
    pub(super) names: Arc<Names>,
    /// Clock for stamps.
    pub(super) clock: Clock,
    /// Maximum age of a request that is executed.
    pub(super) request_timeout: Duration,
    /// Tap that copies published messages; `None`: nothing is copied.
    pub(super) tap: Option<Tap>,
    /// Receiver whose channel is closed when the node ends.
    pub(super) closed: watch::Receiver<()>,
    /// All endpoints that were ever opened.
    #[cfg(test)]
    pub(super) opened: Opened,
}

/// Endpoints that a node has opened: whether it is a writer, topic and type in DDS, QoS.
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

/// Returns the age of a sample, which may have waited while the program was suspended.
pub(super) fn age(came_ns: u64) -> Duration {
    Duration::from_nanos(monotonic_ns().saturating_sub(came_ns))
}

/// Returns the reason why a sample is not used if it is too old.
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

/// Error: an object of a node could not be created.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CreateError {
    /// The name is not allowed.
    #[error(transparent)]
    Name(#[from] super::name::NameError),
    /// The ROS side is not available.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Invalid parameter override, as a message.
    #[error("{0}")]
    Given(String),
}
