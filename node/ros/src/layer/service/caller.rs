//! Who sent a request, where its message begins, and in which form the reply goes back.
//!
//! Both RMWs use the same topics and types, but tell a reply's request in different ways:
//!
//! |         | rmw_fastrtps                                         | rmw_cyclonedds                                |
//! | ------- | ---------------------------------------------------- | --------------------------------------------- |
//! | request | `related_sample_identity` with the GUID of the       | 16 bytes {client u64, sequence i64} before    |
//! |         | client's reply reader; then the message              | the message                                   |
//! | reply   | `related_sample_identity`: that GUID and the number  | the same 16 bytes before the message          |
//! |         | of the request's sample                              |                                               |
//!
//! Law      with a `related_sample_identity`: plain. Else from Cyclone DDS: with the 16 bytes. Else (clients that follow
//!          DDS-RPC): plain, answered by writer and number of the sample. In the two cases without a mark the message must
//!          not fit the other form as well, so that one RMW's request is never taken for the other's
//! Refuses  what the strict CDR reader refuses, more than 3 bytes left over among it; what fits both forms

use lineshaft_msgs::cdr::{self, DecodeError};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::link::protocol::{Place, Related, Sample, SampleId};

/// Length of rmw_cyclonedds' header; a multiple of 8, so that the message behind it is aligned as without it.
pub(super) const HEADER: usize = 16;

/// rmw_cyclonedds' header.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Header {
    client: u64,
    sequence: i64,
}

/// A request that is not handed out.
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

/// A client that waits for a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Caller {
    pub(super) place: Place,
    pub(super) answers: SampleId,
    header: Option<Header>,
}

impl Caller {
    /// The request, for a client that knows its reply by `related_sample_identity`; none where the header tells it, so that
    /// such a reply may be of any length.
    pub(super) fn identity(&self) -> Option<SampleId> {
        if self.header.is_some() { None } else { Some(self.answers) }
    }

    /// The reply's bytes in the form that this client understands.
    pub(super) fn reply(&self, response: &impl Serialize) -> Vec<u8> {
        let mut bytes = self.header.as_ref().map(cdr::encode).unwrap_or_default();
        bytes.extend(cdr::encode(response));
        bytes
    }
}

/// The caller of a request and its message.
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

/// The caller that its `related_sample_identity` describes.
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
