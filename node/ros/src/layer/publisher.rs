//! Topics that the node publishes.

use std::marker::PhantomData;

use lineshaft_msgs::{Message, cdr};
use serde::Serialize;
use tokio::sync::watch;

use super::dds::{WriteFailure, Writer};
use super::endpoint::{Context, CreateError, Registered};
use super::name::FullName;
use super::qos::Qos;

/// A message that was not published.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PublishError {
    /// A reader holds up too many; the message is lost, the next may pass.
    #[error("{topic}: a reader does not keep up, the message was dropped")]
    Full {
        /// Full name of the topic.
        topic: FullName,
    },
    /// The node is gone.
    #[error("{topic}: not published: the node is closed")]
    Closed {
        /// Full name of the topic.
        topic: FullName,
    },
    /// The DDS library failed.
    #[error("{topic}: not published: {reason}")]
    Dds {
        /// Full name of the topic.
        topic: FullName,
        /// What it says.
        reason: String,
    },
}

/// Publishes messages of one topic; dropping it takes the topic from the node.
pub struct Publisher<M> {
    inner: Untyped,
    message: PhantomData<fn(&M)>,
}

impl<M: Message> Publisher<M> {
    pub(super) fn new(context: &Context, topic: FullName, qos: Qos) -> Result<Self, CreateError> {
        Ok(Self { inner: Untyped::new(context, topic, M::DDS_NAME, qos)?, message: PhantomData })
    }

    /// Publishes a message, stamped with the present time. Never waits, but allocates and makes a system call.
    pub fn publish(&self, message: &M) -> Result<(), PublishError> {
        self.inner.publish(message)
    }

    /// Subscriptions that are matched now.
    pub fn subscriptions(&self) -> usize {
        self.inner.writer.matched()
    }

    /// Full name of the topic.
    pub fn topic(&self) -> &FullName {
        &self.inner.topic
    }
}

/// A publisher that leaves the type to its caller.
pub(super) struct Untyped {
    writer: Registered<Writer>,
    topic: FullName,
    closed: watch::Receiver<()>,
}

impl Untyped {
    pub(super) fn new(context: &Context, topic: FullName, type_name: &str, qos: Qos) -> Result<Self, CreateError> {
        let writer = context.writer(&topic.topic(), type_name, qos)?;
        Ok(Self { writer, topic, closed: context.closed.clone() })
    }

    pub(super) fn publish(&self, message: &impl Serialize) -> Result<(), PublishError> {
        let topic = || self.topic.clone();
        // Nobody would ever take the samples out of the writer.
        if self.closed.has_changed().is_err() {
            return Err(PublishError::Closed { topic: topic() });
        }
        self.writer.write(cdr::encode(message)).map_err(|failure| match failure {
            WriteFailure::Full => PublishError::Full { topic: topic() },
            WriteFailure::Broken(reason) => PublishError::Dds { topic: topic(), reason },
        })
    }
}
