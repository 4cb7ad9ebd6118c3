//! Messages between the program and its ROS side.

use std::net::Ipv4Addr;

use bytes::Bytes;
use lineshaft_msgs::cdr::Endian;
use serde::{Deserialize, Serialize};

use super::guid::{Guid, Prefix};
use super::qos::Qos;

/// Number of a reader or writer, valid until the program ends. Each side gives it another [`Guid`].
pub(crate) type Endpoint = u32;

/// Order of the program to its ROS side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Order {
    /// Join the DDS domain; always the first order.
    Join(Join),
    Open(Endpoint, Spec),
    Close(Endpoint),
    /// Write a sample to all readers of a writer.
    Write(Endpoint, Bytes),
    /// Write a reply to the one reader that waits for it.
    Reply(Endpoint, Reply),
    /// Forward this number of additional samples of a reader.
    More(Endpoint, u32),
    /// Check that all parts of the side work.
    Probe(u64),
    /// The side with this participant will replace this one.
    Successor(Prefix),
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
    pub(crate) predecessor: Option<Prefix>,
}

/// A participant that has ended, or that leaves.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Departed {
    pub(crate) prefix: Prefix,
    pub(crate) domain: u16,
    pub(crate) networks: Option<Vec<Ipv4Addr>>,
}

/// Type of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WireType {
    /// Name in DDS.
    pub(crate) name: &'static str,
    /// Type hash (RIHS01).
    pub(crate) hash: &'static str,
}

/// Settings of an endpoint that the side creates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spec {
    pub(crate) kind: Kind,
    /// Topic name in DDS.
    pub(crate) topic: String,
    pub(crate) type_name: String,
    /// Type hash (RIHS01), which the side announces.
    pub(crate) type_hash: String,
    pub(crate) qos: Qos,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Kind {
    Writer,
    /// Reader, with the number of samples that it may forward without another [`Order::More`].
    Reader(u32),
}

/// A reply to one client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reply {
    pub(crate) token: u64,
    pub(crate) place: Place,
    /// Request that this replies to, for clients that identify their replies by it (`related_sample_identity`).
    pub(crate) answers: Option<SampleId>,
    /// Maximum time to wait for the client's reader, in milliseconds.
    pub(crate) patience_ms: u32,
    pub(crate) bytes: Bytes,
}

/// Reader on which a client receives its replies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Place {
    /// This reader.
    Reader(Guid),
    /// A reader of the same participant as this writer of the client.
    SameParticipant(Guid),
}

/// Report of a ROS side to the program.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Report {
    /// The side has joined the domain.
    Joined(Prefix),
    /// The side cannot join, or cannot open an endpoint.
    Failed(String),
    /// Number of readers that are matched with a writer.
    Matched(Endpoint, u32),
    /// A reader has received a sample, or one that it could not read.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) struct SampleId {
    pub(crate) writer: Guid,
    pub(crate) number: i64,
}

/// The `related_sample_identity` of a received sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Related {
    pub(crate) guid: Guid,
    /// Sequence number; `None` if the writer does not give it.
    pub(crate) number: Option<i64>,
}

/// A received sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    pub(crate) id: SampleId,
    pub(crate) related: Option<Related>,
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
    pub(crate) fn endian(&self) -> Endian {
        if self.is_big_endian { Endian::Big } else { Endian::Little }
    }
}

/// Reason why a reply was not sent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum ReplyFailure {
    /// The client has no reader for the reply, or its reader has ended.
    NoReader,
    /// Too many samples wait for the acknowledgements of readers.
    Full,
    /// The DDS library failed.
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
