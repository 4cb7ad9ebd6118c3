//! Endpoints of the node, and the state of the node that they share.

use std::sync::Arc;
use std::time::Duration;

use lineshaft_msgs::{Action, Message, Service};
use tokio::runtime::Handle;
use tokio::sync::watch;

use super::arguments::Names;
use super::clock::Clock;
use super::name::FullName;
use super::tap::Tap;
use crate::link::protocol::{EndpointKind, WireType, monotonic_ns};
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

/// Endpoints that a node has opened: kind, name, type, QoS.
#[cfg(test)]
pub(crate) type Opened = Arc<std::sync::Mutex<Vec<(EndpointKind, String, String, Qos)>>>;

impl Context {
    /// Opens an endpoint. Returns the part that sends and the part that receives; it is closed when both are dropped.
    pub(super) fn open(&self, kind: EndpointKind, name: &FullName, wire: WireType, qos: Qos) -> (Writer, Reader) {
        let name = name.to_string();
        #[cfg(test)]
        self.opened.lock().unwrap().push((kind, name.clone(), wire.name.clone(), qos));
        self.opener.open(kind, name, wire, qos)
    }
}

impl WireType {
    /// Returns the type of a message.
    pub(super) fn message<M: Message>() -> Self {
        Self { name: M::NAME.to_owned(), hash: M::HASH.to_owned(), ..Self::default() }
    }

    /// Returns the type of a service.
    pub(super) fn service<S: Service>() -> Self {
        let (hash, response_hash) = (S::REQUEST_HASH.to_owned(), S::RESPONSE_HASH.to_owned());
        Self { name: S::NAME.to_owned(), hash, response_hash }
    }

    /// Returns the type of the feedback messages of an action.
    pub(super) fn feedback<A: Action>() -> Self {
        let hash = A::FEEDBACK_MESSAGE_HASH.to_owned();
        Self { name: format!("{}_FeedbackMessage", A::NAME), hash, ..Self::default() }
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
