//! Client of a service: sends requests and receives the reply of each.
//!
//! Law      the ROS side numbers the requests from 1, so the number of a request is the number of requests so far. The reply repeats it
//! Refuses  replies without a number, and with that of no request; both are ignored

use std::collections::HashMap;

use lineshaft_msgs::{Service, cdr};
use tokio::sync::watch;

use crate::layer::endpoint::Context;
use crate::layer::name::FullName;
use crate::link::protocol::{EndpointKind, Sample, WireType};
use crate::link::qos::Qos;
use crate::link::{Reader, Writer};

/// Error: a request was not sent, or a reply was not received.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ClientError {
    /// The ROS side does not keep up, or has ended.
    #[error("{service}: the request was not sent: the DDS library does not take it")]
    Unsent {
        /// Full name of the service.
        service: FullName,
    },
    /// The reply does not have the form of the service.
    #[error("{service}: the reply cannot be read: {reason}; the node may be of another version")]
    Unreadable {
        /// Full name of the service.
        service: FullName,
        /// The error of the decoder.
        reason: String,
    },
    /// The node of the client has ended.
    #[error("{service}: no reply: the client's own node has ended")]
    Closed {
        /// Full name of the service.
        service: FullName,
    },
}

/// Number of a request of one client, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RequestNumber(i64);

/// Sends the requests of one service. Any number of requests may be open at a time.
///
/// A request that is sent while no server is matched is lost: wait until [`ServiceClient::servers`] is 1.
pub struct ServiceClient<S: Service> {
    replies: Reader,
    requests: Writer,
    name: FullName,
    /// Number of requests so far.
    sent: i64,
    /// Replies that were received while another one was awaited.
    early: HashMap<i64, Result<S::Response, ClientError>>,
    closed: watch::Receiver<()>,
}

impl<S: Service> ServiceClient<S> {
    pub(in crate::layer) fn new(context: &Context, name: FullName, qos: Qos) -> Self {
        let (requests, replies) = context.open(EndpointKind::Client, &name, WireType::service::<S>(), qos);
        Self { replies, requests, name, sent: 0, early: HashMap::new(), closed: context.closed.clone() }
    }

    /// Returns the full name of the service.
    pub fn name(&self) -> &FullName {
        &self.name
    }

    /// Returns the number of servers that are matched now. During a handover of the server's ROS side it is 2 for some seconds.
    pub fn servers(&self) -> usize {
        self.requests.matched()
    }

    /// Sends a request.
    ///
    /// # Errors
    /// [`ClientError::Unsent`].
    pub fn send(&mut self, request: &S::Request) -> Result<RequestNumber, ClientError> {
        let unsent = |_| ClientError::Unsent { service: self.name.clone() };
        self.requests.write(cdr::encode(request)).map_err(unsent)?;
        self.sent += 1;
        Ok(RequestNumber(self.sent))
    }

    /// Waits for the reply to a request. No reply is lost if the future is dropped.
    ///
    /// # Errors
    /// [`ClientError::Unreadable`], [`ClientError::Closed`].
    pub async fn reply(&mut self, number: RequestNumber) -> Result<S::Response, ClientError> {
        let (_, response) = self.any_reply(&[number]).await?;
        Ok(response)
    }

    /// Waits for the first reply to any of these requests, and returns it with the number of its request. No reply is lost if the future is
    /// dropped.
    ///
    /// # Errors
    /// As [`ServiceClient::reply`].
    pub async fn any_reply(&mut self, numbers: &[RequestNumber]) -> Result<(RequestNumber, S::Response), ClientError> {
        loop {
            let early = numbers.iter().find_map(|number| Some((*number, self.early.remove(&number.0)?)));
            if let Some((number, reply)) = early {
                return reply.map(|response| (number, response));
            }
            let taken = tokio::select! {
                taken = self.replies.next() => taken,
                _ = self.closed.changed() => return Err(ClientError::Closed { service: self.name.clone() }),
            };
            // A sample that the side could not read belongs to no known request.
            if let Ok(sample) = taken {
                self.enter(&sample);
            }
        }
    }

    /// Stores a reply to one of this client's requests.
    fn enter(&mut self, sample: &Sample) {
        let Some(number) = answered(sample, self.sent) else { return };
        let unreadable = |reason| ClientError::Unreadable { service: self.name.clone(), reason };
        self.early.insert(number, sample.decode().map_err(unreadable));
    }
}

/// Returns the number of the request that a reply answers, if it is one of the first `sent`.
fn answered(sample: &Sample, sent: i64) -> Option<i64> {
    sample.answers.filter(|number| (1..=sent).contains(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reply(answers: Option<i64>) -> Sample {
        Sample { answers, ..Sample::default() }
    }

    #[test]
    fn reply_belongs_to_the_request_that_it_names() {
        assert_eq!(answered(&reply(Some(2)), 2), Some(2));
        assert_eq!(answered(&reply(Some(3)), 2), None, "not sent yet");
        assert_eq!(answered(&reply(Some(0)), 2), None);
        assert_eq!(answered(&reply(None), 2), None, "a reply without a number is for clients of another kind");
    }
}
