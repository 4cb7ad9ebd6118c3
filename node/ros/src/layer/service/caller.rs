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
//! Refuses  messages that the strict CDR reader refuses, including more than 3 extra bytes; messages from Cyclone DDS that fit both forms

use lineshaft_msgs::cdr::{self, DecodeError};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::link::protocol::{Place, Related, Sample, SampleId};

/// Length of the header of rmw_cyclonedds, in bytes; a multiple of 8, so that the message after it has the same alignment as without it.
pub(super) const HEADER: usize = 16;

/// Header of rmw_cyclonedds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Header {
    client: u64,
    sequence: i64,
}

/// Reason why a request is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Refusal {
    #[error("{0}")]
    Decode(#[from] DecodeError),
    #[error("{length} bytes are too short for rmw_cyclonedds, whose header alone has {HEADER}")]
    NoHeader { length: usize },
    #[error(
        "{length} bytes can be read with and without rmw_cyclonedds' header of {HEADER} bytes, and nothing tells which is right"
    )]
    Ambiguous { length: usize },
}

/// Client that waits for a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Caller {
    pub(super) place: Place,
    pub(super) answers: SampleId,
    header: Option<Header>,
}

impl Caller {
    /// Returns the request, for a client that identifies its reply by `related_sample_identity`; `None` if the header identifies it, so
    /// that such a reply may have any length.
    pub(super) fn identity(&self) -> Option<SampleId> {
        if self.header.is_some() { None } else { Some(self.answers) }
    }

    /// Returns the bytes of the reply in the form that this client expects.
    pub(super) fn reply(&self, response: &impl Serialize) -> Vec<u8> {
        let mut bytes = self.header.as_ref().map(cdr::encode).unwrap_or_default();
        bytes.extend(cdr::encode(response));
        bytes
    }
}

/// Returns the client of a request and its message.
pub(super) fn read<Q: DeserializeOwned>(sample: &Sample) -> Result<(Caller, Q), Refusal> {
    let length = sample.bytes.len();
    let caller = client(sample).ok_or(Refusal::NoHeader { length })?;
    let plain = || cdr::decode::<Q>(&sample.bytes, sample.endian());
    if caller.header.is_none() {
        return Ok((caller, plain()?));
    }
    let message = cdr::decode(&sample.bytes[HEADER..], sample.endian())?;
    if plain().is_ok() { Err(Refusal::Ambiguous { length }) } else { Ok((caller, message)) }
}

/// Returns the client of a request, which waits for a reply even if its message cannot be read; `None` if the request is too short to
/// identify its client.
pub(super) fn client(sample: &Sample) -> Option<Caller> {
    if let Some(related) = sample.related {
        return Some(marked(sample.id, related));
    }
    let beside = Caller { place: Place::SameParticipant(sample.id.writer), answers: sample.id, header: None };
    if !sample.id.writer.is_cyclone() {
        return Some(beside);
    }
    let header = cdr::decode(sample.bytes.get(..HEADER)?, sample.endian()).ok()?;
    Some(Caller { header: Some(header), ..beside })
}

/// Returns true if a request from Cyclone DDS can be read without the header of rmw_cyclonedds. Its client may be plain and would read
/// a header as the response itself.
pub(super) fn is_plain<Q: DeserializeOwned>(sample: &Sample) -> bool {
    let is_unmarked = sample.related.is_none() && sample.id.writer.is_cyclone();
    is_unmarked && cdr::decode::<Q>(&sample.bytes, sample.endian()).is_ok()
}

/// Returns the client that a `related_sample_identity` describes.
fn marked(request: SampleId, related: Related) -> Caller {
    let answers = SampleId { writer: related.guid, number: related.number.unwrap_or(request.number) };
    let place =
        if related.guid.is_reader() { Place::Reader(related.guid) } else { Place::SameParticipant(request.writer) };
    Caller { place, answers, header: None }
}

#[cfg(test)]
mod tests;
