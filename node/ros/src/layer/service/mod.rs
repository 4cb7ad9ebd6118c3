//! Servers of services.

mod replies;

use std::collections::VecDeque;
use std::marker::PhantomData;
use std::sync::Arc;
use std::time::Duration;

use futures::FutureExt;
use lineshaft_msgs::{Service, cdr};
use serde::Serialize;
use tokio::sync::watch;

use self::replies::Replies;
use super::endpoint::{Context, late};
use super::name::FullName;
use crate::line_limit::MessageRateLimit;
use crate::link::Reader;
use crate::link::protocol::{Caller, EndpointKind, ParticipantId, Sample, WAITING, WireType};
use crate::link::qos::Qos;

/// Requests whose arrivals differ by less than this, in ns, may have been reordered.
const REORDER_WINDOW_NS: u64 = 100_000_000;

/// Error: a reply was not sent.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplyError {
    /// The client does not receive it, or has ended.
    #[error("{service}: the client that asked is not there to read the reply")]
    NoReader {
        /// Full name of the service.
        service: FullName,
    },
    /// Slow clients hold too many replies.
    #[error("{service}: clients do not keep up, the reply was dropped")]
    Full {
        /// Full name of the service.
        service: FullName,
    },
    /// The ROS side failed.
    #[error("{service}: no reply: {reason}")]
    Failed {
        /// Full name of the service.
        service: FullName,
        /// Message of the side.
        reason: String,
    },
}

/// Server of one service; dropping it removes the service from the node, once its open requests are answered.
///
/// Requests that do not have exactly the form of the service are refused and logged. They are answered if the service has a response with a
/// reason and the request identifies its client, which would wait otherwise. A request from Cyclone DDS that can be read without the header
/// of rmw_cyclonedds is refused without an answer, because its client may read no header.
pub struct ServiceServer<S: Service> {
    requests: Reader,
    /// Requests that were read but not yet returned. The queue of the side alone is not fair: it returns the requests of one client
    /// before those of the next, and drops the oldest, so that a busy client would block the others until their requests are lost.
    line: VecDeque<QueuedRequest<S>>,
    replies: Arc<Replies>,
    closed: watch::Receiver<()>,
    refusals: MessageRateLimit<()>,
    request_timeout: Duration,
    care: RequestPolicy<S>,
}

/// Requests that a server refuses, and how.
pub enum RequestPolicy<S: Service> {
    /// None: the requests only read state.
    Asks,
    /// Requests for an earlier instance of the node; a stop is never too late.
    Stops(Refusal<S>),
    /// Requests for an earlier instance of the node, and requests that have waited too long.
    Commands(Refusal<S>),
}

impl<S: Service> Clone for RequestPolicy<S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Service> Copy for RequestPolicy<S> {}

/// Creates the response to a refused request, with a message that gives the reason.
pub type Refusal<S> = fn(&<S as Service>::Request, String) -> <S as Service>::Response;

/// Request in the queue.
struct QueuedRequest<S: Service> {
    caller: Caller,
    message: S::Request,
    origin: Origin,
}

/// Origin of a request: sender and times.
#[derive(Clone, Copy, Debug)]
pub(in crate::layer) struct Origin {
    /// Participant that has sent it.
    sender: ParticipantId,
    /// Time of writing by the clock of its sender, in ticks of 2^-32 s; `None` if the sender does not give it.
    written: Option<u64>,
    /// Time of arrival by the monotonic clock of the host, in ns.
    came_ns: u64,
    /// Whether it was written for an earlier instance of the node.
    is_stale: bool,
}

impl Origin {
    /// Returns true if the request was sent before a request to another service, or may have been.
    ///
    /// Requests to different services are read independently: of two that arrive together, the later one may be read first. Then the clock
    /// of their sender decides. Between different senders, and over a longer time, in which that clock may have been set, the order of
    /// arrival decides.
    pub(in crate::layer) fn is_before(self, other: Self) -> bool {
        let is_together = self.came_ns.abs_diff(other.came_ns) < REORDER_WINDOW_NS;
        if !is_together || self.sender != other.sender {
            return self.came_ns <= other.came_ns;
        }
        match (self.written, other.written) {
            (Some(written), Some(other)) => written <= other,
            _ => true,
        }
    }

    fn of_sample(sample: &Sample) -> Self {
        let Sample { sender, written, came_ns, is_stale, .. } = *sample;
        Self { sender, written, came_ns, is_stale }
    }

    /// Creates a request of participant `sender` for tests.
    #[cfg(test)]
    pub(in crate::layer) fn of(sender: u8, written: Option<u64>, came_ns: u64) -> Self {
        Self { sender: ParticipantId([sender; 12]), written, came_ns, is_stale: false }
    }

    /// Returns the reason why the request must not be executed, if there is one.
    pub(in crate::layer) fn refused(self, request_timeout: Option<Duration>) -> Option<String> {
        if self.is_stale {
            let sentence = "it was written before this node was there or heard its sender again, or by a clock that differs from the node's; ask again";
            return Some(sentence.to_owned());
        }
        late(self.came_ns, request_timeout?)
    }
}

/// Request with its reply. Any number may be open at a time.
pub struct Request<S: Service> {
    /// Request message.
    pub message: S::Request,
    /// Reply to be sent.
    pub reply: Reply<S::Response>,
}

impl<S: Service> ServiceServer<S> {
    pub(super) fn new(context: &Context, name: FullName, qos: Qos) -> Self {
        let (writer, requests) = context.open(EndpointKind::Server, &name, WireType::service::<S>(), qos);
        Self {
            requests,
            line: VecDeque::new(),
            replies: Arc::new(Replies::new(context, writer, name)),
            closed: context.closed.clone(),
            refusals: MessageRateLimit::default(),
            request_timeout: context.request_timeout,
            care: RequestPolicy::Asks,
        }
    }

    /// Sets which requests are refused: a node must not execute requests that were sent to an earlier instance, nor those that arrived
    /// while it was suspended.
    pub fn with_policy(self, care: RequestPolicy<S>) -> Self {
        Self { care, ..self }
    }

    /// Returns the full name of the service.
    pub fn name(&self) -> &FullName {
        self.replies.service()
    }

    /// Returns the next request; `None` once the node has ended. No request is lost if the future is dropped.
    pub async fn next(&mut self) -> Option<Request<S>> {
        loop {
            while self.line.len() < usize::from(WAITING)
                && let Some(taken) = self.requests.next().now_or_never()
            {
                self.enter(taken);
            }
            if let Some(waiting) = self.line.pop_front() {
                if let Some(request) = self.accept_if_allowed(waiting) {
                    return Some(request);
                }
                continue;
            }
            let taken = tokio::select! {
                taken = self.requests.next() => taken,
                _ = self.closed.changed() => return None,
            };
            self.enter(taken);
        }
    }

    /// Returns the next request that has already arrived, if there is one.
    pub(in crate::layer) fn waiting(&mut self) -> Option<Request<S>> {
        // Without the cooperative budget of the task, which would hide requests after many reads.
        while self.line.len() < usize::from(WAITING)
            && let Some(taken) = tokio::task::unconstrained(self.requests.next()).now_or_never()
        {
            self.enter(taken);
        }
        loop {
            let waiting = self.line.pop_front()?;
            if let Some(request) = self.accept_if_allowed(waiting) {
                return Some(request);
            }
        }
    }

    /// Returns the request, unless it is refused.
    fn accept_if_allowed(&mut self, QueuedRequest { caller, message, origin }: QueuedRequest<S>) -> Option<Request<S>> {
        let reply = Reply::new(self.replies.clone(), caller, origin);
        let (refusal, timeout) = match self.care {
            RequestPolicy::Asks => return Some(Request { message, reply }),
            RequestPolicy::Stops(refusal) => (refusal, None),
            RequestPolicy::Commands(refusal) => (refusal, Some(self.request_timeout)),
        };
        let Some(sentence) = origin.refused(timeout) else { return Some(Request { message, reply }) };
        self.refusals.log((), |more| tracing::warn!("{}: a request was refused: {sentence}{more}", self.name()));
        reply.send_soon(refusal(&message, format!("the request was refused: {sentence}")));
        None
    }

    /// Adds a request to the queue, if it is valid.
    fn enter(&mut self, taken: Result<Sample, String>) {
        match taken {
            Ok(sample) => {
                let origin = Origin::of_sample(&sample);
                match sample.decode() {
                    Ok(message) => self.line.push_back(QueuedRequest { caller: sample.caller, message, origin }),
                    Err(refusal) => self.refuse(sample, origin, &refusal),
                }
            }
            Err(reason) => {
                self.refusals.log((), |more| tracing::warn!("{}: a request was refused: {reason}{more}", self.name()));
            }
        }
    }

    fn refuse(&mut self, sample: Sample, origin: Origin, refusal: &str) {
        let from = origin.sender;
        self.refusals.log((), |more| {
            tracing::warn!("{}: a request of participant {from} was refused: {refusal}{more}", self.name());
        });
        let (RequestPolicy::Stops(answer) | RequestPolicy::Commands(answer)) = self.care else { return };
        if !sample.caller.0.is_empty() && !sample.may_be_plain::<S::Request>() {
            let reply = Reply::new(self.replies.clone(), sample.caller, origin);
            reply.send_soon(answer(&S::Request::default(), format!("the request was refused: {refusal}")));
        }
    }
}

/// Reply to one request.
pub struct Reply<P> {
    replies: Arc<Replies>,
    /// Client; `None` once it is answered.
    caller: Option<Caller>,
    origin: Origin,
    response: PhantomData<fn(P)>,
}

impl<P: Serialize> Reply<P> {
    fn new(replies: Arc<Replies>, caller: Caller, origin: Origin) -> Self {
        Self { replies, caller: Some(caller), origin, response: PhantomData }
    }

    /// Returns the origin of the request.
    pub(in crate::layer) fn origin(&self) -> Origin {
        self.origin
    }

    /// Sends the reply. Waits until the client can be reached, at most 1 s, after a restart of the ROS side 10 s; replies to other
    /// clients are not delayed by that.
    pub async fn send(mut self, response: P) -> Result<(), ReplyError> {
        match self.caller.take() {
            Some(caller) => self.replies.send(caller, self.origin.sender, cdr::encode(&response)).await,
            None => Ok(()),
        }
    }

    /// Sends the reply without waiting. A failure is logged.
    pub fn send_soon(mut self, response: P) {
        if let Some(caller) = self.caller.take() {
            let (replies, to, bytes) = (self.replies.clone(), self.origin.sender, cdr::encode(&response));
            self.replies.spawn(async move {
                // A failure is logged there.
                let _ = replies.send(caller, to, bytes).await;
            });
        }
    }
}

impl<P> Drop for Reply<P> {
    fn drop(&mut self) {
        if self.caller.is_some() {
            tracing::warn!("{}: a request was dropped without an answer", self.replies.service());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::protocol::monotonic_ns;

    /// Times of writing are in ticks of the sender's clock, arrivals in ns of the host clock.
    #[test]
    fn requests_that_arrive_together_are_ordered_by_time_of_writing() {
        const MS: u64 = 1_000_000;
        let one = |written, came_ns| Origin::of(1, Some(written), came_ns);
        // The later request has overtaken the other one.
        assert!(one(10, 7 * MS).is_before(one(11, 5 * MS)));
        assert!(!one(11, 5 * MS).is_before(one(10, 7 * MS)));
        assert!(one(10, 5 * MS).is_before(one(10, 5 * MS)));
        // The clock of the sender was set back between the two requests.
        assert!(one(900, 5 * MS).is_before(one(3, 505 * MS)) && !one(3, 505 * MS).is_before(one(900, 5 * MS)));
        // Clocks of different senders differ.
        let other = |came_ns| Origin::of(2, Some(0), came_ns);
        assert!(one(10, 5 * MS).is_before(other(6 * MS)) && !one(10, 7 * MS).is_before(other(6 * MS)));
        // Without a time of writing the request may be earlier.
        assert!(Origin::of(1, None, 7 * MS).is_before(one(11, 5 * MS)));
    }

    #[test]
    fn request_for_earlier_instance_or_too_old_is_refused() {
        let timeout = Some(Duration::from_secs(2));
        let origin = |age: Duration, is_stale| Origin {
            is_stale,
            ..Origin::of(1, None, monotonic_ns().saturating_sub(age.as_nanos() as u64))
        };
        let fresh = Duration::ZERO;
        assert_eq!(origin(fresh, false).refused(timeout), None);
        assert_eq!(origin(Duration::from_millis(1900), false).refused(timeout), None);
        let late = origin(Duration::from_millis(2500), false).refused(timeout).unwrap();
        assert_eq!(
            late,
            "it has waited for 2.5 s and is not carried out any more (request_timeout of the cell is 2 s)"
        );
        assert_eq!(origin(Duration::from_secs(9), false).refused(None), None, "a stop is never too late");
        for timeout in [timeout, None] {
            let stale = origin(fresh, true).refused(timeout).unwrap();
            assert!(stale.starts_with("it was written before this node was there"), "{stale}");
        }
    }
}
