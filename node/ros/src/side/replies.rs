//! Sends each reply to the one reader that waits for it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use bytes::Bytes;
use tokio::time::{Instant, sleep, sleep_until, timeout_at};

use super::dds::{Address, LONGEST_IDENTIFIED, Writer, now_ticks, padded};
use super::long_reply::LongReply;
use super::member::Shared;
use super::rtps::{Message, entity};
use crate::link::guid::Guid;
use crate::link::protocol::{Place, Reply, ReplyFailure, SampleId};

/// Maximum time for which a reply waits for space in the writer.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between two attempts to write.
const AGAIN: Duration = Duration::from_millis(5);
/// Maximum number of clients whose readers are cached; others are looked up each time.
const KNOWN: usize = 256;
/// Number of datagrams of a long reply that are sent together, and the pause after them. A socket's buffer can hold this number.
const TOGETHER: usize = 32;
const PAUSE: Duration = Duration::from_millis(1);
/// Maximum length in bytes of a first reply that this module sends itself, so that it fits into a UDP datagram.
const LONGEST_FIRST: usize = 60_000;
/// A long reply of fewer datagrams is sent twice.
const FEW: usize = 8;

/// Writes the replies of one service.
pub(super) struct Replies {
    writer: Arc<Writer>,
    topic: String,
    /// Reader of each client, by the client's writer, if a search has found exactly one reader.
    known: Mutex<HashMap<Guid, Guid>>,
    /// Locked while a reply is sent, so that a long reply knows its sequence number in advance.
    numbers: tokio::sync::Mutex<Numbers>,
}

/// Sequence numbers of the writer's samples.
#[derive(Default)]
struct Numbers {
    last: i64,
    /// Number of the last sample to each reader.
    to: HashMap<Guid, i64>,
}

impl Numbers {
    /// Whether no reader of this reader's participant has got a sample. The readers of a Cyclone DDS participant share what they know of
    /// a writer: a GAP to one of them would cover samples that are still under way to another.
    fn is_first_to(&self, reader: Guid) -> bool {
        self.to.keys().all(|other| other.prefix() != reader.prefix())
    }
}

impl Replies {
    pub(super) fn new(writer: Arc<Writer>, topic: String) -> Self {
        Self { writer, topic, known: Mutex::default(), numbers: tokio::sync::Mutex::default() }
    }

    /// Writes a reply as soon as its reader is matched. A reply that is written before the match is lost.
    pub(super) async fn send(&self, shared: &Shared, reply: Reply) -> Result<(), ReplyFailure> {
        let deadline = Instant::now() + Duration::from_millis(reply.patience_ms.into());
        let mut changes = shared.matches.changes();
        let readers = loop {
            changes.mark_unchanged();
            let found = self.readers(shared, reply.place);
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
            self.write(shared, reader, reply.answers, &reply.bytes).await?;
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
            let from = numbers.to.get(&reader).copied().unwrap_or_default() + 1;
            let number = numbers.last + 1;
            let (time, writer) = (now_ticks(), self.writer.guid());
            let reply = LongReply { writer, reader, number, from, time, answers, bytes: &bytes };
            say(shared, reader, &reply.datagrams()).await;
        }
        if answers.is_none() && bytes.len() <= LONGEST_FIRST && numbers.is_first_to(reader) {
            // Sent before the library has the sample, because the library might announce the sample in a HEARTBEAT before it sends it. A
            // Cyclone DDS reader that has just matched accepts only samples after its first HEARTBEAT.
            let datagram = first_reply(self.writer.guid(), reader, numbers.last + 1, bytes);
            let addresses = shared.participant.addresses_of_reader(reader);
            addresses.iter().for_each(|address| shared.socket.send(&datagram, *address));
        }
        let address = Address { reader, answers: answers.filter(|_| long.is_none()) };
        loop {
            match self.writer.write_to(bytes.clone(), address) {
                Ok(number) => {
                    numbers.last = number;
                    if numbers.to.len() >= KNOWN {
                        numbers.to.retain(|reader, _| shared.matches.contains(self.writer.guid(), *reader));
                    }
                    numbers.to.insert(reader, number);
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

/// Returns the datagram of the first reply to a reader, as the sample with this number.
fn first_reply(writer: Guid, reader: Guid, number: i64, bytes: &Bytes) -> Vec<u8> {
    let mut message = Message::from(writer.prefix());
    message.time(now_ticks()).to(reader.prefix());
    let (to, from) = (entity(reader), entity(writer));
    if number > 1 {
        message.gap(to, from, 1, number);
    }
    message.data(to, from, number, &[&[0, 1, 0, 0], &padded(bytes.clone())[..]].concat());
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

    #[test]
    fn second_reader_of_a_participant_gets_no_first_reply() {
        let reader =
            |participant, entity| [vec![participant; 12], vec![entity; 4]].concat().try_into().map(Guid).unwrap();
        let numbers = Numbers { last: 1, to: HashMap::from([(reader(1, 1), 1)]) };
        assert!(!numbers.is_first_to(reader(1, 1)));
        assert!(!numbers.is_first_to(reader(1, 2)));
        assert!(numbers.is_first_to(reader(2, 1)));
    }

    #[test]
    fn first_reply_is_data_after_a_gap_over_earlier_samples() {
        let (writer, reader) = (Guid([1; 16]), Guid([2; 16]));
        // Header, INFO_TS, INFO_DST; GAP; DATA: its header, flags and octets to inline QoS, reader, writer, number, payload.
        let reply = |number| first_reply(writer, reader, number, &Bytes::from_static(&[7, 8, 9]))[48..].to_vec();
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
        assert_eq!(reply(1), data(1));
        let gap =
            [&[0x08, 1, 28, 0], &[2; 4][..], &[1; 4], &[0; 4], &[1, 0, 0, 0], &[0; 4], &[3, 0, 0, 0], &[0; 4]].concat();
        assert_eq!(reply(3), [gap, data(3)].concat());
    }
}
