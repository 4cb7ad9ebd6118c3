//! What program and ROS side say to each other.

use std::net::Ipv4Addr;

use bytes::Bytes;
use lineshaft_msgs::cdr::Endian;
use serde::{Deserialize, Serialize};

use super::guid::{Guid, Prefix};
use super::qos::Qos;

/// Names a reader or writer, for the program's life: each side gives it another [`Guid`].
pub(crate) type Endpoint = u32;

/// What the program wants of its ROS side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Order {
    /// To become a member of the DDS domain; the first order.
    Join(Join),
    Open(Endpoint, Spec),
    Close(Endpoint),
    /// To all readers of a writer.
    Write(Endpoint, Bytes),
    /// To the one reader that waits for it.
    Reply(Endpoint, Reply),
    /// So many more samples of a reader are taken.
    More(Endpoint, u32),
    /// To prove that all of it works.
    Probe(u64),
    /// The side with this participant will replace this one.
    Successor(Prefix),
}

/// The participant to be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Join {
    pub(crate) domain: u16,
    /// On the networks of these addresses; `None`: on all of the host.
    pub(crate) networks: Option<Vec<Ipv4Addr>>,
    pub(crate) namespace: String,
    pub(crate) name: String,
    /// Participants of ours that ended without a good-bye.
    pub(crate) dead: Vec<Departed>,
    /// The participant that this side will replace, during a handover.
    pub(crate) predecessor: Option<Prefix>,
}

/// A participant that is no more.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Departed {
    pub(crate) prefix: Prefix,
    pub(crate) domain: u16,
    pub(crate) networks: Option<Vec<Ipv4Addr>>,
}

/// An endpoint to be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spec {
    pub(crate) kind: Kind,
    /// In DDS.
    pub(crate) topic: String,
    pub(crate) type_name: String,
    pub(crate) qos: Qos,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Kind {
    Writer,
    /// With the number of samples that are taken without another [`Order::More`].
    Reader(u32),
}

/// A reply to one client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reply {
    pub(crate) token: u64,
    pub(crate) place: Place,
    /// For clients that know their reply by it (`related_sample_identity`).
    pub(crate) answers: Option<SampleId>,
    /// For how long to look for the client's reader (ms).
    pub(crate) patience_ms: u32,
    pub(crate) bytes: Bytes,
}

/// Where a client reads its replies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Place {
    /// With this reader.
    Reader(Guid),
    /// On the participant of this writer, which is the client's.
    SameParticipant(Guid),
}

/// What a ROS side says.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Report {
    /// It is a member of the domain.
    Joined(Prefix),
    /// It cannot be one, or cannot open an endpoint.
    Failed(String),
    /// So many readers are matched with a writer.
    Matched(Endpoint, u32),
    /// A reader has read something.
    Taken(Endpoint, Result<Sample, String>),
    /// What became of a reply.
    Replied(u64, Result<(), ReplyFailure>),
    /// All of it works: the answer to a probe.
    Alive(u64),
    /// What of it does not work: the other answer to a probe.
    Stuck(String),
    /// A line of its log.
    Line(Line),
}

/// A sample's name: who wrote it, and the how manyth of that writer it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) struct SampleId {
    pub(crate) writer: Guid,
    pub(crate) number: i64,
}

/// The `related_sample_identity` that came with a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Related {
    pub(crate) guid: Guid,
    /// `None`: unknown to the writer.
    pub(crate) number: Option<i64>,
}

/// A sample as it came.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    pub(crate) id: SampleId,
    pub(crate) related: Option<Related>,
    /// Written before the reader was there, for one of another life of the node.
    pub(crate) is_stale: bool,
    /// When it came, by the monotonic clock of the host (ns), which both processes have.
    pub(crate) came_ns: u64,
    pub(crate) is_big_endian: bool,
    pub(crate) bytes: Bytes,
}

impl Sample {
    pub(crate) fn endian(&self) -> Endian {
        if self.is_big_endian { Endian::Big } else { Endian::Little }
    }
}

/// Why a reply did not go out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum ReplyFailure {
    /// The client has no reader for it, or none any more.
    NoReader,
    /// Readers hold up too many.
    Full,
    /// The DDS library failed.
    Broken(String),
}

/// A line of a side's log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Line {
    pub(crate) severity: u8,
    /// Its place in the source, which is its kind.
    pub(crate) place: (String, u32),
    pub(crate) text: String,
}

impl Line {
    pub(crate) const ERROR: u8 = 1;
    pub(crate) const WARN: u8 = 2;
    pub(crate) const INFO: u8 = 3;
    pub(crate) const DEBUG: u8 = 4;
}

/// The monotonic clock of the host (ns): the same in all processes.
pub(crate) fn monotonic_ns() -> u64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    // Neither is ever negative.
    now.tv_sec.unsigned_abs() * 1_000_000_000 + now.tv_nsec.unsigned_abs()
}
