//! Sends each reply to the one reader that waits for it.

use std::collections::HashMap;
use std::net::SocketAddrV4;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use bytes::Bytes;
use tokio::time::{Instant, sleep, sleep_until, timeout_at};

use super::dds::{Address, LONGEST_IDENTIFIED, Writer, now_ticks, padded};
use super::guid::Guid;
use super::long_reply::LongReply;
use super::member::Shared;
use super::requests::{DdsClient, Place};
use super::rtps::{Message, entity};
use crate::link::protocol::{Reply, ReplyFailure, SampleId};

/// Maximum time for which a reply waits for space in the writer.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between two attempts to write.
const AGAIN: Duration = Duration::from_millis(5);
/// Maximum number of clients whose readers are cached; others are looked up each time.
const KNOWN: usize = 256;
/// Number of datagrams of a long reply that are sent together, and the pause after them. A socket's buffer can hold this number.
const TOGETHER: usize = 32;
const PAUSE: Duration = Duration::from_millis(1);
/// Time after the first reply to an address for which this module sends replies itself, too. Then the reader has had a HEARTBEAT.
const EARLY: Duration = Duration::from_secs(2);
/// Maximum length in bytes of a reply that this module sends itself early, so that it fits into a UDP datagram.
const LONGEST_EARLY: usize = 60_000;
/// A long reply of fewer datagrams is sent twice.
const FEW: usize = 8;

/// Writes the replies of one service.
pub(super) struct Replies {
    writer: Writer,
    topic: String,
    /// Reader of each client, by the client's writer, if a search has found exactly one reader.
    known: Mutex<HashMap<Guid, Guid>>,
    /// Locked while a reply is sent, so that the sequence number of a long reply is known in advance.
    numbers: tokio::sync::Mutex<Numbers>,
}

/// Sequence numbers of the writer's samples.
#[derive(Default)]
struct Numbers {
    last: i64,
    to: HashMap<Guid, Reached>,
}

/// A reader that has got a sample.
struct Reached {
    /// Number of its last sample.
    last: i64,
    /// Time of the first sample to a reader at its addresses.
    since: Instant,
    addresses: Vec<SocketAddrV4>,
}

impl Numbers {
    /// Records that a reply is sent to a reader. If it is one of the first to the addresses of the reader, returns these and the first
    /// number of the GAP before it.
    ///
    /// The readers of a process with Cyclone DDS have the same address, and share the state of a writer. The GAP covers no sample to any of
    /// them, because that sample may still be in transit.
    fn early(
        &mut self,
        reader: Guid,
        addresses: impl FnOnce() -> Vec<SocketAddrV4>,
        is_matched: impl Fn(Guid) -> bool,
    ) -> Option<(Vec<SocketAddrV4>, i64)> {
        let now = Instant::now();
        let is_early = |since: Instant| now < since + EARLY;
        let addresses = match self.to.get(&reader) {
            Some(reached) if !is_early(reached.since) => return None,
            Some(reached) => reached.addresses.clone(),
            None => addresses(),
        };
        if self.to.len() >= KNOWN {
            self.to.retain(|reader, _| is_matched(*reader));
        }
        // A reader that has left may have used the port of this one.
        let there = self.to.iter().filter(|(other, reached)| {
            reached.addresses.iter().any(|address| addresses.contains(address)) && is_matched(**other)
        });
        let (last, since) =
            there.fold((0, now), |(last, since), (_, other)| (last.max(other.last), since.min(other.since)));
        self.to.entry(reader).or_insert_with(|| Reached { last: 0, since, addresses: addresses.clone() });
        is_early(since).then_some((addresses, last + 1))
    }
}

impl Replies {
    pub(super) fn new(writer: Writer, topic: String) -> Self {
        Self { writer, topic, known: Mutex::default(), numbers: tokio::sync::Mutex::default() }
    }

    /// Returns the GUID of the writer.
    pub(super) fn guid(&self) -> Guid {
        self.writer.guid()
    }

    /// Writes a reply as soon as its reader is matched. A reply that is written before the match is lost.
    pub(super) async fn send(&self, shared: &Shared, reply: Reply) -> Result<(), ReplyFailure> {
        // The program returns only callers of this or an earlier side.
        let Some(client) = DdsClient::read(&reply.caller) else { return Err(ReplyFailure::NoReader) };
        let bytes = client.reply(reply.bytes);
        let deadline = Instant::now() + Duration::from_millis(reply.patience_ms.into());
        let mut changes = shared.matches.changes();
        let readers = loop {
            changes.mark_unchanged();
            let found = self.readers(shared, client.place);
            if found.complete {
                break found.matched;
            }
            let change = timeout_at(deadline, changes.changed()).await;
            if !matches!(change, Ok(Ok(()))) {
                break found.matched;
            }
        };
        if readers.is_empty() {
            return Err(ReplyFailure::NoReader);
        }
        for reader in readers {
            self.write(shared, reader, client.answers, &bytes).await?;
        }
        Ok(())
    }

    async fn write(
        &self,
        shared: &Shared,
        reader: Guid,
        answers: Option<SampleId>,
        bytes: &Bytes,
    ) -> Result<(), ReplyFailure> {
        let long = answers.filter(|_| bytes.len() > LONGEST_IDENTIFIED);
        let deadline = Instant::now() + PATIENCE;
        let mut numbers = self.numbers.lock().await;
        if let Some(answers) = long {
            let bytes = padded(bytes.clone());
            let from = numbers.to.get(&reader).map_or(0, |reached| reached.last) + 1;
            let number = numbers.last + 1;
            let (time, writer) = (now_ticks(), self.writer.guid());
            let reply = LongReply { writer, reader, number, from, time, answers, bytes: &bytes };
            say(shared, reader, &reply.datagrams()).await;
        }
        let addresses = || shared.participant.addresses_of_reader(reader);
        let early = numbers.early(reader, addresses, |reader| self.is_matched(shared, reader));
        if let Some((addresses, from)) = early.filter(|_| answers.is_none() && bytes.len() <= LONGEST_EARLY) {
            // Sent before the library has the sample, because the library might announce the sample in a HEARTBEAT before it sends it. A
            // Cyclone DDS reader that has just matched accepts only samples after its first HEARTBEAT.
            let datagram = early_reply(self.writer.guid(), reader, from..numbers.last + 1, bytes);
            addresses.iter().for_each(|address| shared.socket.send(&datagram, *address));
        }
        let address = Address { reader, answers: answers.filter(|_| long.is_none()) };
        loop {
            match self.writer.write_to(bytes.clone(), address) {
                Ok(number) => {
                    numbers.last = number;
                    numbers.to.entry(reader).and_modify(|reached| reached.last = number);
                    return Ok(());
                }
                // The fragments of a long reply were sent with this number already. No other sample may use the number while the reader is
                // matched: a GAP that covers fragments that the reader has would hang it.
                Err(ReplyFailure::Full)
                    if Instant::now() < deadline || long.is_some() && self.is_matched(shared, reader) =>
                {
                    sleep_until(Instant::now() + AGAIN).await;
                }
                Err(failure) => return Err(failure),
            }
        }
    }

    fn is_matched(&self, shared: &Shared, reader: Guid) -> bool {
        shared.matches.contains(self.writer.guid(), reader)
    }

    /// Locks the cached readers. They are consistent even after a panic elsewhere, because each change is one call.
    fn known(&self) -> MutexGuard<'_, HashMap<Guid, Guid>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn readers(&self, shared: &Shared, place: Place) -> Found {
        let is_matched = |reader| self.is_matched(shared, reader);
        let client = match place {
            Place::Reader(reader) => return Found::of(vec![reader], is_matched),
            Place::SameParticipant(client) => client,
        };
        if let Some(reader) = self.known().get(&client).copied().filter(|reader| is_matched(*reader)) {
            return Found { matched: vec![reader], complete: true };
        }
        let found = Found::of(shared.participant.readers_beside(client, &self.topic), is_matched);
        if let (true, [reader]) = (found.complete, found.matched.as_slice()) {
            let mut known = self.known();
            if known.len() >= KNOWN {
                known.retain(|_, reader| is_matched(*reader));
            }
            if known.len() < KNOWN {
                known.insert(client, *reader);
            }
        }
        found
    }
}

/// Returns the datagram of an early reply to a reader: a GAP, and the sample with the number after it.
fn early_reply(writer: Guid, reader: Guid, gap: Range<i64>, bytes: &Bytes) -> Vec<u8> {
    let mut message = Message::from(writer.prefix());
    message.time(now_ticks()).to(reader.prefix());
    let (to, from) = (entity(reader), entity(writer));
    if !gap.is_empty() {
        message.gap(to, from, gap.start, gap.end);
    }
    message.data(to, from, gap.end, &[&[0, 1, 0, 0], &padded(bytes.clone())[..]].concat());
    message.bytes()
}

/// Sends the datagrams of a long reply to every address of its reader.
async fn say(shared: &Shared, reader: Guid, datagrams: &[Vec<u8>]) {
    let addresses = shared.participant.addresses_of_reader(reader);
    for _ in 0..if datagrams.len() < FEW { 2 } else { 1 } {
        for some in datagrams.chunks(TOGETHER) {
            for address in &addresses {
                some.iter().for_each(|datagram| shared.socket.send(datagram, *address));
            }
            sleep(PAUSE).await;
        }
    }
}

/// Readers that may belong to the client.
struct Found {
    matched: Vec<Guid>,
    /// Whether there is at least one reader, and all of them are matched.
    complete: bool,
}

impl Found {
    fn of(candidates: Vec<Guid>, is_matched: impl Fn(Guid) -> bool) -> Self {
        let count = candidates.len();
        let matched: Vec<_> = candidates.into_iter().filter(|reader| is_matched(*reader)).collect();
        Self { complete: count > 0 && matched.len() == count, matched }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test(start_paused = true)]
    async fn first_replies_to_an_address_have_a_gap_that_covers_no_sample_to_it() {
        let at = |port| vec![SocketAddrV4::new([127, 0, 0, 1].into(), port)];
        let mut numbers = Numbers::default();
        let mut send = |reader: u8, port, are_matched| {
            let early = numbers.early(Guid([reader; 16]), || at(port), |_| are_matched);
            numbers.last += 1;
            let last = numbers.last;
            numbers.to.entry(Guid([reader; 16])).and_modify(|reached| reached.last = last);
            early.map(|(addresses, from)| (addresses, from..last))
        };
        assert_eq!(send(1, 7411, true), Some((at(7411), 1..1)));
        assert_eq!(send(2, 7413, true), Some((at(7413), 1..2)));
        // Another reader at the address of reader 1, and then reader 1 again.
        assert_eq!(send(3, 7411, true), Some((at(7411), 2..3)));
        assert_eq!(send(2, 7413, true), Some((at(7413), 3..4)));
        assert_eq!(send(1, 7411, true), Some((at(7411), 4..5)));
        tokio::time::sleep(EARLY).await;
        assert_eq!(send(1, 7411, true), None);
        assert_eq!(send(4, 7411, true), None, "its process has been reached for long");
        assert_eq!(send(5, 7411, false), Some((at(7411), 1..8)), "that process is gone, and a new one has its port");
    }

    #[test]
    fn early_reply_is_data_after_a_gap() {
        let (writer, reader) = (Guid([1; 16]), Guid([2; 16]));
        // Header, INFO_TS, INFO_DST; GAP; DATA: its header, flags and octets to inline QoS, reader, writer, number, payload.
        let reply = |gap| early_reply(writer, reader, gap, &Bytes::from_static(&[7, 8, 9]))[48..].to_vec();
        let data = |number: u8| {
            [
                &[0x15, 5, 28, 0, 0, 0, 16, 0],
                &[2; 4][..],
                &[1; 4],
                &[0; 4],
                &[number, 0, 0, 0],
                &[0, 1, 0, 0, 7, 8, 9, 0],
            ]
            .concat()
        };
        assert_eq!(reply(1..1), data(1));
        let gap =
            [&[0x08, 1, 28, 0], &[2; 4][..], &[1; 4], &[0; 4], &[1, 0, 0, 0], &[0; 4], &[3, 0, 0, 0], &[0; 4]].concat();
        assert_eq!(reply(1..3), [gap, data(3)].concat());
    }
}
