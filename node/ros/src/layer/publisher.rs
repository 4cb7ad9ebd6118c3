//! Publishers of topics.

use std::marker::PhantomData;

use lineshaft_msgs::{Message, cdr};
use serde::Serialize;
use tokio::sync::watch;

use super::endpoint::Context;
use super::name::FullName;
use super::tap::TappedPublisher;
use crate::link::protocol::{EndpointKind, WireType};
use crate::link::qos::Qos;
use crate::link::{WriteError, Writer};

/// Error: a message was not published.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PublishError {
    /// Too many messages wait; this one is lost, but the next one may be sent.
    #[error("{topic}: the ROS side does not keep up, the message was dropped")]
    Full {
        /// Full name of the topic.
        topic: FullName,
    },
    /// The node has ended.
    #[error("{topic}: not published: the node is closed")]
    Closed {
        /// Full name of the topic.
        topic: FullName,
    },
}

/// Publisher of one topic; dropping it removes the topic from the node.
pub struct Publisher<M> {
    inner: UntypedPublisher,
    message: PhantomData<fn(&M)>,
}

impl<M: Message> Publisher<M> {
    pub(super) fn new(context: &Context, topic: FullName, qos: Qos, copies: Option<TappedPublisher>) -> Self {
        let inner = UntypedPublisher { copies, ..UntypedPublisher::new(context, topic, WireType::message::<M>(), qos) };
        Self { inner, message: PhantomData }
    }

    /// Publishes a message, stamped with the present time. Never blocks, but allocates.
    pub fn publish(&self, message: &M) -> Result<(), PublishError> {
        self.inner.publish(message)
    }

    /// Returns the number of subscriptions that are matched now.
    pub fn subscriptions(&self) -> usize {
        self.inner.writer.matched()
    }

    /// Returns the full name of the topic.
    pub fn topic(&self) -> &FullName {
        &self.inner.topic
    }
}

/// Publisher whose caller ensures the message type.
pub(super) struct UntypedPublisher {
    writer: Writer,
    topic: FullName,
    closed: watch::Receiver<()>,
    /// Copies for a recorder, if it selects the topic.
    copies: Option<TappedPublisher>,
}

impl UntypedPublisher {
    pub(super) fn new(context: &Context, topic: FullName, wire: WireType, qos: Qos) -> Self {
        let (writer, _) = context.open(EndpointKind::Publisher, &topic, wire, qos);
        Self { writer, topic, closed: context.closed.clone(), copies: None }
    }

    pub(super) fn publish(&self, message: &impl Serialize) -> Result<(), PublishError> {
        let topic = || self.topic.clone();
        // The samples would stay in the writer forever.
        if self.closed.has_changed().is_err() {
            return Err(PublishError::Closed { topic: topic() });
        }
        let message = cdr::encode(message);
        if let Some(copies) = &self.copies {
            copies.copy(&message);
        }
        self.writer.write(message).map_err(|failure| match failure {
            WriteError::Full => PublishError::Full { topic: topic() },
            WriteError::Closed => PublishError::Closed { topic: topic() },
        })
    }
}
