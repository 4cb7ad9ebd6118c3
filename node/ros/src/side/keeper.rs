//! State of the sender of a latched topic: the samples that each reader still has to get. It has no clock, tasks or sockets of its own.
//!
//! Law      each sample is sent to one reader. A reader that joins gets a GAP, which covers all samples so far. Then it gets the
//!          latched values, the newest last, unless it is volatile. Then it gets each value that is set.
//!          No GAP covers a sample that was sent to its reader. Otherwise Fast DDS (2.6 to 2.14) hangs: a reader that has some
//!          fragments of a sample, and then gets such a GAP, loops endlessly at the topic's next sample while it holds its lock.
//!          The readers of a process with Cyclone DDS have the same address, and share the GAPs of a writer: a GAP to one of them
//!          must not overtake a sample to another. So a reader at the address of another one first gets a GAP over the samples that
//!          are surely sent. With the repeats it gets a GAP over all samples before its own first one: also over those that were written to
//!          other readers since it joined.

use std::collections::{BTreeMap, HashSet, VecDeque};
use std::net::SocketAddrV4;
use std::time::Duration;

use bytes::Bytes;
use tokio::time::Instant;

use super::guid::Guid;
use crate::link::protocol::ReplyFailure;

/// Times after the match at which a GAP is repeated. The reader may match the writer later than the writer matches the reader, and
/// datagrams get lost.
const GAP_REPEATS: [Duration; 8] = [
    Duration::from_millis(30),
    Duration::from_millis(60),
    Duration::from_millis(100),
    Duration::from_millis(200),
    Duration::from_millis(400),
    Duration::from_millis(800),
    Duration::from_millis(1600),
    Duration::from_millis(3200),
];

/// Time after which a sample is surely sent: the library sends it within a few milliseconds.
const SENDING: Duration = GAP_REPEATS[0];

/// Destination of the samples.
pub(super) trait Target: Send + Sync + 'static {
    /// Writes a sample to one matched reader and returns its number.
    fn write(&self, value: &Bytes, reader: Guid) -> Result<i64, ReplyFailure>;
    /// Whether the reader gets the values that were set before it joined.
    fn is_owed(&self, reader: Guid) -> bool;
    /// Returns the addresses on which a reader reads.
    fn addresses(&self, reader: Guid) -> Vec<SocketAddrV4>;
    /// Sends a GAP to a reader: the samples before this number are not for it.
    fn skip(&self, reader: Guid, before: i64);
    /// Returns the GUID of the writer.
    fn guid(&self) -> Guid;
}

/// State of the sender.
pub(super) struct Keeper<T> {
    target: T,
    depth: usize,
    lifespan: Option<Duration>,
    /// Latched values, the newest last.
    kept: VecDeque<(Instant, Bytes)>,
    readers: BTreeMap<Guid, Reader>,
    /// Number of the newest sample.
    last: i64,
    /// Times and numbers of the samples that are perhaps not sent yet, the oldest first.
    sending: VecDeque<(Instant, i64)>,
}

/// A matched reader.
struct Reader {
    addresses: Vec<SocketAddrV4>,
    /// Values that it still has to get, the oldest first.
    pending: VecDeque<Bytes>,
    since: Instant,
    /// The samples before this number are not for it.
    first: i64,
    /// Whether a sample was written to it.
    has_sample: bool,
    /// Number of repeated GAPs.
    repeats: usize,
}

impl<T: Target> Keeper<T> {
    pub(super) fn new(target: T, depth: usize, lifespan: Option<Duration>) -> Self {
        Self {
            target,
            depth: depth.max(1),
            lifespan,
            kept: VecDeque::new(),
            readers: BTreeMap::new(),
            last: 0,
            sending: VecDeque::new(),
        }
    }

    pub(super) fn guid(&self) -> Guid {
        self.target.guid()
    }

    /// Sets a value.
    pub(super) fn set(&mut self, value: Bytes, now: Instant) {
        for reader in self.readers.values_mut() {
            reader.pending.push_back(value.clone());
            if reader.pending.len() > self.depth {
                reader.pending.pop_front();
            }
        }
        self.kept.push_back((now, value));
        if self.kept.len() > self.depth {
            self.kept.pop_front();
        }
    }

    /// Updates the set of readers that are matched now.
    pub(super) fn matched(&mut self, readers: &HashSet<Guid>, now: Instant) {
        self.readers.retain(|reader, _| readers.contains(reader));
        let lifespan = self.lifespan;
        self.kept.retain(|(since, _)| lifespan.is_none_or(|lifespan| now.duration_since(*since) < lifespan));
        for guid in readers {
            if self.readers.contains_key(guid) {
                continue;
            }
            let pending = match self.target.is_owed(*guid) {
                true => self.kept.iter().map(|(_, value)| value.clone()).collect(),
                false => VecDeque::new(),
            };
            let addresses = self.target.addresses(*guid);
            let reader = Reader { addresses, pending, since: now, first: self.last + 1, has_sample: false, repeats: 0 };
            let is_at = |address| reader.addresses.contains(address);
            let has_sibling = self.readers.values().any(|other| other.addresses.iter().any(is_at));
            let before = if has_sibling { self.first_unsent(now) } else { reader.first };
            if before > 1 {
                self.target.skip(*guid, before);
            }
            self.readers.insert(*guid, reader);
        }
    }

    /// Returns the number of the first sample that is perhaps not sent yet.
    fn first_unsent(&mut self, now: Instant) -> i64 {
        while self.sending.pop_front_if(|(since, _)| *since + SENDING <= now).is_some() {}
        self.sending.front().map_or(self.last + 1, |(_, number)| *number)
    }

    /// Repeats the GAPs that are due.
    pub(super) fn repeat_gaps(&mut self, now: Instant) {
        let sent = self.first_unsent(now);
        for (guid, reader) in &mut self.readers {
            if reader.next_repeat().is_some_and(|due| due <= now) {
                let before = reader.first.min(sent);
                if before > 1 {
                    self.target.skip(*guid, before);
                }
                // If several repetitions are due after a long sleep, one GAP replaces them.
                let passed = GAP_REPEATS.iter().take_while(|after| reader.since + **after <= now).count();
                reader.repeats = passed.max(reader.repeats + 1);
            }
        }
    }

    /// Returns the time at which the next GAP is due.
    pub(super) fn next_repeat(&self) -> Option<Instant> {
        self.readers.values().filter_map(Reader::next_repeat).min()
    }

    /// Writes the pending values. Returns false if the writer has no space for all of them.
    pub(super) fn write(&mut self, now: Instant) -> bool {
        self.first_unsent(now);
        for (guid, reader) in &mut self.readers {
            while let Some(value) = reader.pending.front() {
                match self.target.write(value, *guid) {
                    Ok(number) => {
                        self.last = number;
                        self.sending.push_back((now, number));
                        // Samples that were written to other readers since this one joined: the library may not have discovered it yet, and
                        // would send them to it.
                        if !reader.has_sample {
                            (reader.first, reader.has_sample) = (number, true);
                        }
                    }
                    Err(ReplyFailure::Broken(reason)) => {
                        tracing::error!("a latched value was not published: {reason}");
                    }
                    Err(ReplyFailure::Full | ReplyFailure::NoReader) => return false,
                }
                reader.pending.pop_front();
            }
        }
        true
    }
}

impl Reader {
    fn has_gap(&self) -> bool {
        self.first > 1
    }

    fn next_repeat(&self) -> Option<Instant> {
        let after = GAP_REPEATS.get(self.repeats).filter(|_| self.has_gap());
        after.map(|after| self.since + *after)
    }
}

#[cfg(test)]
mod tests;
