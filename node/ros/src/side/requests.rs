//! Client of a request, start of its message, and form of the reply.
//!
//! Both RMWs use the same topics and types, but identify the request of a reply in different ways:
//!
//! |         | rmw_fastrtps                                         | rmw_cyclonedds                                |
//! | ------- | ---------------------------------------------------- | --------------------------------------------- |
//! | request | `related_sample_identity` with the GUID of the       | 16 bytes {client u64, sequence i64} before    |
//! |         | client's reply reader; then the message              | the message                                   |
//! | reply   | `related_sample_identity`: that GUID and the number  | the same 16 bytes before the message          |
//! |         | of the request's sample                              |                                               |
//!
//! Law      a request with a `related_sample_identity` is plain. Otherwise a request from Cyclone DDS has the 16 bytes. Any other request
//!          (clients that follow DDS-RPC) is plain, and is answered by writer and number of the sample. A request from Cyclone DDS must not
//!          fit the plain form as well, because a client on Cyclone DDS need not use rmw_cyclonedds. A request from another DDS library is
//!          read as plain even if it fits the other form, as a list of one name with 8 characters does: its last 4 bytes are zeros, which
//!          are an empty list after the first 16 bytes
//! Clients  of this program follow DDS-RPC (OMG DDS-RPC 1.0, basic mapping): the library numbers the samples of a writer from 1, and the
//!          server repeats writer and number of the request in the `related_sample_identity` of the reply
//! Refuses  messages that the strict CDR reader refuses, including more than 3 extra bytes; messages from Cyclone DDS that fit both forms
//!          ([`Sample::decode`](crate::link::protocol::Sample::decode), which knows the message)

#[cfg(any(test, feature = "fuzz"))]
mod laws;

#[cfg(any(test, feature = "fuzz"))]
pub use laws::any_request;

use bytes::Bytes;
use lineshaft_msgs::cdr;
use serde::{Deserialize, Serialize};

use super::dds::Taken;
use super::guid::Guid;
use crate::link::protocol::{Caller, Header, SampleId};

/// Length of the header of rmw_cyclonedds, in bytes; a multiple of 8, so that the message after it has the same alignment as without it.
const HEADER: usize = 16;

/// Header of rmw_cyclonedds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct CycloneHeader {
    client: u64,
    sequence: i64,
}

/// The `related_sample_identity` of a received sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Related {
    pub(super) guid: Guid,
    /// Sequence number; `None` if the writer does not give it.
    pub(super) number: Option<i64>,
}

/// Reader on which a client receives its replies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Place {
    /// This reader.
    Reader(Guid),
    /// A reader of the same participant as this writer of the client.
    SameParticipant(Guid),
}

/// Client that waits for a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct DdsClient {
    pub(super) place: Place,
    /// Request, for a client that identifies its reply by `related_sample_identity`; `None` if the header identifies it, so that such a
    /// reply may have any length.
    pub(super) answers: Option<SampleId>,
    header: Option<CycloneHeader>,
}

impl DdsClient {
    /// Reads what [`DdsClient::caller`] has written.
    pub(super) fn read(Caller(bytes): &Caller) -> Option<Self> {
        postcard::from_bytes(bytes).ok()
    }

    fn caller(&self) -> Caller {
        // Cannot fail: it contains only numbers.
        Caller(postcard::to_stdvec(self).unwrap_or_default().into())
    }

    /// Returns the reply in the form that this client expects.
    pub(super) fn reply(&self, response: Bytes) -> Bytes {
        match &self.header {
            Some(header) => [&cdr::encode(header)[..], &response[..]].concat().into(),
            None => response,
        }
    }
}

/// Returns the client of a request, which waits for a reply even if its message cannot be read, and the header before the message. A
/// request that is too short for its header does not identify its client.
pub(super) fn client(request: &Taken) -> (Caller, Option<Header>) {
    let Taken { id, related, bytes, .. } = request;
    if let Some(related) = related {
        return (marked(*id, *related).caller(), None);
    }
    let beside = DdsClient { place: Place::SameParticipant(id.writer), answers: Some(*id), header: None };
    if !id.writer.is_cyclone() {
        return (beside.caller(), None);
    }
    let length = bytes.len();
    let header = bytes.get(..HEADER).and_then(|bytes| cdr::decode(bytes, request.endian()).ok());
    let (caller, doubt) = match header {
        Some(_) => (
            DdsClient { answers: None, header, ..beside }.caller(),
            format!(
                "{length} bytes can be read with and without rmw_cyclonedds' header of {HEADER} bytes, and nothing shows which is right"
            ),
        ),
        None => (
            Caller::default(),
            format!("{length} bytes are too short for rmw_cyclonedds, whose header alone has {HEADER}"),
        ),
    };
    (caller, Some(Header { length: HEADER, doubt }))
}

/// Returns the client that a `related_sample_identity` describes.
fn marked(request: SampleId, related: Related) -> DdsClient {
    let answers = SampleId { writer: related.guid, number: related.number.unwrap_or(request.number) };
    let place =
        if related.guid.is_reader() { Place::Reader(related.guid) } else { Place::SameParticipant(request.writer) };
    DdsClient { place, answers: Some(answers), header: None }
}

#[cfg(test)]
mod tests;
