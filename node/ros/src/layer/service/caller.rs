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
//!          (clients that follow DDS-RPC) is plain, and is answered by writer and number of the sample. In the two cases without
//!          `related_sample_identity`, the message must not fit the other form as well, so that a request of one RMW is never interpreted
//!          as one of the other
//! Refuses  messages that the strict CDR reader refuses, including more than 3 extra bytes; messages that fit both forms

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
    if let Some(related) = sample.related {
        return Ok((marked(sample.id, related), cdr::decode(&sample.bytes, sample.endian())?));
    }
    let beside = Caller { place: Place::SameParticipant(sample.id.writer), answers: sample.id, header: None };
    let plain = || cdr::decode::<Q>(&sample.bytes, sample.endian());
    let ambiguous = Err(Refusal::Ambiguous { length: sample.bytes.len() });
    if sample.id.writer.is_cyclone() {
        let (header, message) = headed(sample)?;
        return if plain().is_ok() { ambiguous } else { Ok((Caller { header: Some(header), ..beside }, message)) };
    }
    let message = plain()?;
    if headed::<Q>(sample).is_ok() { ambiguous } else { Ok((beside, message)) }
}

/// Returns the client that a `related_sample_identity` describes.
fn marked(request: SampleId, related: Related) -> Caller {
    let answers = SampleId { writer: related.guid, number: related.number.unwrap_or(request.number) };
    let place =
        if related.guid.is_reader() { Place::Reader(related.guid) } else { Place::SameParticipant(request.writer) };
    Caller { place, answers, header: None }
}

fn headed<Q: DeserializeOwned>(sample: &Sample) -> Result<(Header, Q), Refusal> {
    let length = sample.bytes.len();
    let (header, message) = sample.bytes.split_at_checked(HEADER).ok_or(Refusal::NoHeader { length })?;
    Ok((cdr::decode(header, sample.endian())?, cdr::decode(message, sample.endian())?))
}

#[cfg(test)]
mod tests;
