//! Messages between the program and its ROS side, in the terms of ROS: only the side knows the middleware.

use std::fmt;
use std::net::Ipv4Addr;

use bytes::Bytes;
use lineshaft_msgs::cdr::{self, Endian};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::qos::Qos;

/// Number of an endpoint, valid until the program ends. Each side gives it other [`Gid`]s.
pub(crate) type Endpoint = u32;

/// Identifier of an endpoint in the network, as in `rmw`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub(crate) struct Gid(pub(crate) [u8; 16]);

/// Identifier of a participant: all endpoints of one side, or of one context of a ROS program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub(crate) struct ParticipantId(pub(crate) [u8; 12]);

impl ParticipantId {
    /// Parses the displayed form: 24 hexadecimal digits.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let digits = text.as_bytes();
        if digits.len() != 24 || !digits.iter().all(u8::is_ascii_hexdigit) {
            return None;
        }
        let mut id = [0; 12];
        for (place, byte) in id.iter_mut().enumerate() {
            *byte = u8::from_str_radix(&text[2 * place..2 * place + 2], 16).ok()?;
        }
        Some(Self(id))
    }
}

impl fmt::Display for ParticipantId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Order of the program to its ROS side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Order {
    /// Join the ROS domain; always the first order.
    Join(Join),
    Open(Endpoint, Spec),
    Close(Endpoint),
    /// Send a message of a publisher, or a request of a client.
    Write(Endpoint, Bytes),
    /// Send a reply of a server.
    Reply(Endpoint, Reply),
    /// Forward this number of additional samples of an endpoint.
    More(Endpoint, u32),
    /// Check that all parts of the side work.
    Probe(u64),
    /// The side with this participant will replace this one.
    Successor(ParticipantId),
}

/// Settings of the participant that the side creates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Join {
    pub(crate) domain: u16,
    /// Addresses of the networks to use; `None`: all networks of the host.
    pub(crate) networks: Option<Vec<Ipv4Addr>>,
    pub(crate) namespace: String,
    pub(crate) name: String,
    /// Earlier participants of this program that ended without being disposed.
    pub(crate) dead: Vec<Departed>,
    /// The participant that this side will replace, during a handover.
    pub(crate) predecessor: Option<ParticipantId>,
}

/// A participant that has ended, or that leaves.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Departed {
    pub(crate) participant: ParticipantId,
    pub(crate) domain: u16,
    pub(crate) networks: Option<Vec<Ipv4Addr>>,
}

/// Type of a topic or service.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WireType {
    /// Name in ROS, such as `std_msgs/msg/String`.
    pub(crate) name: String,
    /// Type hash (RIHS01) of the message, or of the request.
    pub(crate) hash: String,
    /// Type hash of the response; empty for a topic.
    pub(crate) response_hash: String,
}

/// Settings of an endpoint that the side creates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spec {
    pub(crate) kind: EndpointKind,
    /// Full name of the topic or service.
    pub(crate) name: String,
    pub(crate) wire: WireType,
    pub(crate) qos: Qos,
    /// Number of samples that the side may forward without another [`Order::More`].
    pub(crate) credit: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum EndpointKind {
    Publisher,
    Subscription,
    /// Server of a service: receives requests and sends replies.
    Server,
    /// Client of a service: sends requests and receives replies. The side numbers the requests from 1.
    Client,
    /// Receives the full names of the nodes of each participant, as a list of strings. It has neither a name nor a type.
    Nodes,
}

/// Maximum number of requests that wait for a server, in the middleware and again in its queue. More than the 10 of ROS, because clients of
/// all kinds share them. Not more than a burst needs, because the DDS library keeps as many samples that were already read, of any length.
pub(crate) const WAITING: u16 = 256;

/// Client that waits for a reply, in a form that only the ROS side understands; empty: unknown.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Caller(pub(crate) Bytes);

/// A reply to one client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reply {
    pub(crate) token: u64,
    pub(crate) caller: Caller,
    /// Maximum time to wait until the client can be reached, in milliseconds.
    pub(crate) patience_ms: u32,
    pub(crate) bytes: Bytes,
}

/// Report of a ROS side to the program.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Report {
    /// The side has joined the domain.
    Joined(ParticipantId),
    /// The side cannot join, or cannot open an endpoint.
    Failed(String),
    /// Number of matched endpoints that receive the messages, requests or replies of an endpoint.
    Matched(Endpoint, u32),
    /// An endpoint has received a sample, or one that it could not read.
    Taken(Endpoint, Result<Sample, String>),
    /// Result of a reply.
    Replied(u64, Result<(), ReplyFailure>),
    /// Answer to a probe: all parts of the side work.
    Alive(u64),
    /// Answer to a probe: this part of the side does not work.
    Stuck(String),
    /// Log message of the side.
    Line(Line),
}

/// Identity of a sample: its writer and its sequence number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) struct SampleId {
    pub(crate) writer: Gid,
    pub(crate) number: i64,
}

/// Bytes that some clients send before the message of a request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    pub(crate) length: usize,
    /// Reason to refuse a request that is too short for the header, or that can be read without it, too.
    pub(crate) doubt: String,
}

/// A received sample.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    pub(crate) id: SampleId,
    /// Participant that has sent it.
    pub(crate) sender: ParticipantId,
    /// Client of a request.
    pub(crate) caller: Caller,
    /// Header of a request, if its client sends one.
    pub(crate) header: Option<Header>,
    /// Number of the request that a reply answers; `None` if the server does not give it.
    pub(crate) answers: Option<i64>,
    /// Whether it was written before the reader existed, for an earlier run of the node.
    pub(crate) is_stale: bool,
    /// Time of writing by the clock of its writer, in ticks of 2^-32 s since 1970; `None` if the writer does not send it.
    pub(crate) written: Option<u64>,
    /// Reception time in nanoseconds, by the monotonic clock of the host, which both processes share.
    pub(crate) came_ns: u64,
    pub(crate) is_big_endian: bool,
    pub(crate) bytes: Bytes,
}

impl Sample {
    /// Returns the message, or the reason why the sample is refused.
    pub(crate) fn decode<M: DeserializeOwned>(&self) -> Result<M, String> {
        let Some(Header { length, doubt }) = &self.header else { return self.read(&self.bytes) };
        let message = self.read(self.bytes.get(*length..).ok_or(doubt)?)?;
        if self.may_be_plain::<M>() { Err(doubt.clone()) } else { Ok(message) }
    }

    /// Returns true if a message with a header can also be read without it. Its client may use no header and would read that of a reply as
    /// the response itself.
    pub(crate) fn may_be_plain<M: DeserializeOwned>(&self) -> bool {
        self.header.is_some() && self.read::<M>(&self.bytes).is_ok()
    }

    fn read<M: DeserializeOwned>(&self, bytes: &[u8]) -> Result<M, String> {
        let endian = if self.is_big_endian { Endian::Big } else { Endian::Little };
        cdr::decode(bytes, endian).map_err(|error| error.to_string())
    }
}

/// Reason why a reply was not sent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum ReplyFailure {
    /// The client does not receive the reply, or has ended.
    NoReader,
    /// Too many samples wait for the acknowledgements of clients.
    Full,
    /// The middleware failed.
    Broken(String),
}

/// Log message of a side.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Line {
    pub(crate) severity: u8,
    /// File and line in the source code. Lines with the same place are of the same kind.
    pub(crate) place: (String, u32),
    pub(crate) text: String,
}

impl Line {
    pub(crate) const ERROR: u8 = 1;
    pub(crate) const WARN: u8 = 2;
    pub(crate) const INFO: u8 = 3;
    pub(crate) const DEBUG: u8 = 4;
}

/// Returns the time of the monotonic clock of the host in nanoseconds; it is the same in all processes.
pub(crate) fn monotonic_ns() -> u64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    // Neither of the two is ever negative.
    now.tv_sec.unsigned_abs() * 1_000_000_000 + now.tv_nsec.unsigned_abs()
}
