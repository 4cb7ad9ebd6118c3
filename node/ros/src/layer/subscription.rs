//! Topics that the node reads.

use std::marker::PhantomData;
use std::time::Duration;

use lineshaft_msgs::{Message, cdr};
use tokio::sync::watch;

use super::endpoint::{Context, age};
use super::name::FullName;
use crate::line_limit::LineLimit;
use crate::link::Reader;
use crate::link::protocol::{Sample, WireType};
use crate::link::qos::Qos;

/// Reads the messages of one topic; dropping it takes the topic from the node.
///
/// Messages that are not exactly of the topic's form, or were written before the subscription was there, are refused, logged
/// and never handed out.
pub struct Subscription<M> {
    samples: Reader,
    topic: FullName,
    latched: bool,
    timeout: Duration,
    closed: watch::Receiver<()>,
    refusals: LineLimit<()>,
    message: PhantomData<fn() -> M>,
}

impl<M: Message> Subscription<M> {
    pub(super) fn new(context: &Context, topic: FullName, qos: Qos) -> Self {
        Self {
            samples: context.reader(&topic.topic(), WireType::message::<M>(), qos),
            topic,
            latched: qos.latched,
            timeout: context.request_timeout,
            closed: context.closed.clone(),
            refusals: LineLimit::default(),
            message: PhantomData,
        }
    }

    /// Full name of the topic.
    pub fn topic(&self) -> &FullName {
        &self.topic
    }

    /// The next message; `None` once the node is gone. Nothing is lost when the future is dropped.
    pub async fn next(&mut self) -> Option<M> {
        loop {
            let taken = tokio::select! {
                taken = self.samples.next() => taken,
                _ = self.closed.changed() => return None,
            };
            let (from, refusal) = match taken {
                // A writer that is there already is asked for all that it has: that was meant for others.
                Ok(sample) if sample.is_stale && !self.latched => {
                    (sample.id.writer, "it is older than this node or its sender's return".to_owned())
                }
                Ok(Sample { id, came_ns, .. }) if !self.latched && age(came_ns) > self.timeout => {
                    (id.writer, format!("it has waited for {:.1} s", age(came_ns).as_secs_f64()))
                }
                Ok(sample) => match cdr::decode(&sample.bytes, sample.endian()) {
                    Ok(message) => return Some(message),
                    Err(error) => (sample.id.writer, error.to_string()),
                },
                Err(reason) => {
                    self.refusals
                        .say((), |more| tracing::warn!("{}: a message was refused: {reason}{more}", self.topic));
                    continue;
                }
            };
            let from = from.prefix();
            self.refusals.say((), |more| {
                tracing::warn!("{}: a message of participant {from} was refused: {refusal}{more}", self.topic);
            });
        }
    }
}
