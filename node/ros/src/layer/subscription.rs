//! Subscriptions of topics.

use std::marker::PhantomData;
use std::time::Duration;

use lineshaft_msgs::Message;
use tokio::sync::watch;

use super::endpoint::{Context, age};
use super::name::FullName;
use crate::line_limit::MessageRateLimit;
use crate::link::Reader;
use crate::link::protocol::{EndpointKind, Sample, WireType};
use crate::link::qos::Qos;

/// Subscription of one topic; dropping it removes the topic from the node.
///
/// Messages that do not have exactly the form of the topic, or were written before the subscription existed, are refused and logged.
pub struct Subscription<M> {
    samples: Reader,
    topic: FullName,
    latched: bool,
    timeout: Duration,
    closed: watch::Receiver<()>,
    refusals: MessageRateLimit<()>,
    message: PhantomData<fn() -> M>,
}

impl<M: Message> Subscription<M> {
    pub(super) fn new(context: &Context, topic: FullName, qos: Qos) -> Self {
        let (_, samples) = context.open(EndpointKind::Subscription, &topic, WireType::message::<M>(), qos);
        Self {
            samples,
            topic,
            latched: qos.latched,
            timeout: context.request_timeout,
            closed: context.closed.clone(),
            refusals: MessageRateLimit::default(),
            message: PhantomData,
        }
    }

    /// Returns the full name of the topic.
    pub fn topic(&self) -> &FullName {
        &self.topic
    }

    /// Returns the next message; `None` once the node has ended. No message is lost if the future is dropped.
    pub async fn next(&mut self) -> Option<M> {
        loop {
            let taken = tokio::select! {
                taken = self.samples.next() => taken,
                _ = self.closed.changed() => return None,
            };
            let (from, refusal) = match taken {
                // An existing writer resends all its samples, which were meant for other readers.
                Ok(sample) if sample.is_stale && !self.latched => {
                    (sample.sender, "it is older than this node or its sender's return".to_owned())
                }
                Ok(Sample { sender, came_ns, .. }) if !self.latched && age(came_ns) > self.timeout => {
                    (sender, format!("it has waited for {:.1} s", age(came_ns).as_secs_f64()))
                }
                Ok(sample) => match sample.decode() {
                    Ok(message) => return Some(message),
                    Err(refusal) => (sample.sender, refusal),
                },
                Err(reason) => {
                    self.refusals
                        .log((), |more| tracing::warn!("{}: a message was refused: {reason}{more}", self.topic));
                    continue;
                }
            };
            self.refusals.log((), |more| {
                tracing::warn!("{}: a message of participant {from} was refused: {refusal}{more}", self.topic);
            });
        }
    }
}
