//! Services, for callers with rmw_fastrtps and with rmw_cyclonedds alike.

mod caller;
#[cfg(any(test, feature = "fuzz"))]
mod laws;
mod replies;

#[cfg(any(test, feature = "fuzz"))]
pub use laws::any_request;

use std::collections::VecDeque;
use std::marker::PhantomData;
use std::sync::Arc;
use std::time::Instant;

use futures::FutureExt;
use lineshaft_msgs::Service;
use serde::Serialize;
use tokio::sync::watch;

use self::caller::Caller;
use self::replies::Replies;
use super::dds::{LONGEST_ON_LOOPBACK, Reader, Sample};
use super::endpoint::{Context, CreateError, Registered};
use super::limiter::{Limiter, more};
use super::name::FullName;
use super::qos::Qos;

/// Requests that wait for the server, in the library and again in its line; more than the 10 of ROS, because clients of all kinds
/// share them. Not more than a burst needs, because the library keeps as many that were taken, however long they are.
const WAITING: u16 = 256;

/// A reply that did not go out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplyError {
    /// The client has no reader for it, or none any more.
    #[error("{service}: the client that asked is not there to read the reply")]
    NoReader {
        /// Full name of the service.
        service: FullName,
    },
    /// Readers hold up too many replies.
    #[error("{service}: clients do not keep up, the reply was dropped")]
    Full {
        /// Full name of the service.
        service: FullName,
    },
    /// A client of rmw_fastrtps cannot be sent that much.
    #[error(
        "{service}: the reply of {length} bytes is not sent: {longest} bytes reach a client of rmw_fastrtps {}; ask for less in one \
         request (fewer names), or use rmw_cyclonedds", networks(*.longest)
    )]
    TooLong {
        /// Full name of the service.
        service: FullName,
        /// Of the reply (bytes).
        length: usize,
        /// That can be sent (bytes).
        longest: usize,
    },
    /// The DDS library failed.
    #[error("{service}: no reply: {reason}")]
    Dds {
        /// Full name of the service.
        service: FullName,
        /// What it says.
        reason: String,
    },
}

/// Where so much can be sent, and where more.
fn networks(longest: usize) -> &'static str {
    if longest < LONGEST_ON_LOOPBACK {
        "on this network (65000 where both have ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST)"
    } else {
        "on the loopback"
    }
}

/// Takes the requests of one service; dropping it takes the service from the node.
///
/// Requests that are not exactly of the service's form are refused, logged and never handed out.
pub struct ServiceServer<S: Service> {
    requests: Registered<Reader>,
    /// Read, and not handed out yet. The library alone would be unfair: it gives the requests of one client before those of the
    /// next, and drops the oldest, so that a busy client would keep the others waiting until theirs are gone.
    line: VecDeque<(Caller, S::Request)>,
    replies: Arc<Replies>,
    closed: watch::Receiver<()>,
    refused: Limiter,
    unread: Limiter,
}

/// A request, and the way to answer it. Any number may be open at a time.
pub struct Request<S: Service> {
    /// What the client asks.
    pub message: S::Request,
    /// Where to answer.
    pub reply: Reply<S::Response>,
}

impl<S: Service> ServiceServer<S> {
    pub(super) fn new(context: &Context, name: FullName, qos: Qos) -> Result<Self, CreateError> {
        let requests = Qos { depth: WAITING, ..qos };
        let requests = context.reader(&name.request(), S::REQUEST_DDS_NAME, requests)?;
        let writer = context.writer(&name.reply(), S::RESPONSE_DDS_NAME, qos)?;
        Ok(Self {
            requests,
            line: VecDeque::new(),
            replies: Arc::new(Replies::new(context, writer, name)),
            closed: context.closed.clone(),
            refused: Limiter::default(),
            unread: Limiter::default(),
        })
    }

    /// Full name of the service.
    pub fn name(&self) -> &FullName {
        self.replies.service()
    }

    /// The next request; `None` once the node is gone. Nothing is lost when the future is dropped.
    pub async fn next(&mut self) -> Option<Request<S>> {
        loop {
            while self.line.len() < usize::from(WAITING)
                && let Some(taken) = self.requests.next().now_or_never()
            {
                self.enter(taken);
            }
            if let Some((caller, message)) = self.line.pop_front() {
                return Some(Request { message, reply: Reply::new(self.replies.clone(), caller) });
            }
            let taken = tokio::select! {
                taken = self.requests.next() => taken,
                _ = self.closed.changed() => return None,
            };
            self.enter(taken);
        }
    }

    /// Puts a request into the line, if it is one.
    fn enter(&mut self, taken: Result<Sample, String>) {
        match taken {
            Ok(sample) => match caller::read::<S::Request>(&sample) {
                Ok(request) => self.line.push_back(request),
                Err(refusal) => self.refuse(&sample, &refusal),
            },
            Err(reason) => {
                if let Some(before) = self.unread.say_of_nobody(Instant::now()) {
                    tracing::warn!("{}: a request was refused: {reason}{}", self.name(), more(before));
                }
            }
        }
    }

    fn refuse(&mut self, sample: &Sample, refusal: &caller::Refusal) {
        let from = sample.id.writer.prefix();
        if let Some(before) = self.refused.say(from, Instant::now()) {
            tracing::warn!("{}: a request of participant {from} was refused: {refusal}{}", self.name(), more(before));
        }
    }
}

/// The way to answer one request.
pub struct Reply<P> {
    replies: Arc<Replies>,
    /// `None` once it is answered.
    caller: Option<Caller>,
    response: PhantomData<fn(P)>,
}

impl<P: Serialize> Reply<P> {
    fn new(replies: Arc<Replies>, caller: Caller) -> Self {
        Self { replies, caller: Some(caller), response: PhantomData }
    }

    /// Answers. Waits until the client's reader is matched, at most 1 s; replies to other clients do not wait for
    /// it.
    pub async fn send(mut self, response: P) -> Result<(), ReplyError> {
        match self.caller.take() {
            Some(caller) => self.replies.send(&caller, caller.reply(&response)).await,
            None => Ok(()),
        }
    }

    /// Answers without waiting for it. A reply that fails is logged.
    pub fn send_soon(mut self, response: P) {
        if let Some(caller) = self.caller.take() {
            let (replies, bytes) = (self.replies.clone(), caller.reply(&response));
            self.replies.spawn(async move {
                // What fails is logged there.
                let _ = replies.send(&caller, bytes).await;
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
