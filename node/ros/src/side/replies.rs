//! Replies, each to the one reader that waits for it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use bytes::Bytes;
use tokio::time::{Instant, sleep, sleep_until, timeout_at};

use super::dds::{Address, LONGEST_IDENTIFIED, Writer, now_ticks, padded};
use super::long_reply::LongReply;
use super::member::Shared;
use crate::link::guid::Guid;
use crate::link::protocol::{Place, Reply, ReplyFailure, SampleId};

/// For how long a reply waits for room.
const PATIENCE: Duration = Duration::from_secs(1);
/// Between two tries to write.
const AGAIN: Duration = Duration::from_millis(5);
/// Clients whose readers are remembered; more are looked up again.
const KNOWN: usize = 256;
/// Datagrams of a long reply that go out together, and the pause behind them: what a socket's buffer holds.
const TOGETHER: usize = 32;
const PAUSE: Duration = Duration::from_millis(1);
/// A long reply of fewer datagrams goes out twice.
const FEW: usize = 8;

/// Writes the replies of one service.
pub(super) struct Replies {
    writer: Arc<Writer>,
    topic: String,
    /// The reader of a client that writes with this writer, where a search has found exactly one.
    known: Mutex<HashMap<Guid, Guid>>,
    /// One reply after the other: a long one has to know its number before.
    numbers: tokio::sync::Mutex<Numbers>,
}

/// Numbers of the writer's samples.
#[derive(Default)]
struct Numbers {
    last: i64,
    /// The last one to each reader.
    to: HashMap<Guid, i64>,
}

impl Replies {
    pub(super) fn new(writer: Arc<Writer>, topic: String) -> Self {
        Self { writer, topic, known: Mutex::default(), numbers: tokio::sync::Mutex::default() }
    }

    /// Writes a reply as soon as its reader is matched: one that is written before is lost.
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
                // The number of a long reply is taken: under it, no other sample may go to anyone while its reader is there, whom a GAP
                // over the fragments that it has would hang.
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

    /// A panic elsewhere leaves the readers whole: each change is one call.
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

/// Readers that may be the client's.
struct Found {
    matched: Vec<Guid>,
    /// There are some, and all are matched.
    complete: bool,
}

impl Found {
    fn of(candidates: Vec<Guid>, is_matched: impl Fn(Guid) -> bool) -> Self {
        let count = candidates.len();
        let matched: Vec<_> = candidates.into_iter().filter(|reader| is_matched(*reader)).collect();
        Self { complete: count > 0 && matched.len() == count, matched }
    }
}
