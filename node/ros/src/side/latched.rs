//! What is latched: for whoever comes later the newest samples of a topic, and nothing else.
//!
//! The DDS library keeps all that a transient local writer has written for seconds, without a reader for good, and sends all
//! of it to whoever comes later.
//!
//! Law      nothing is written while nobody reads. A reader that comes is told that all samples so far are not for it (GAP), then
//!          gets those that count, which are kept here, alone, unless it is volatile; what is set from then on goes to all

use std::collections::{HashSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use tokio::runtime::Handle;
use tokio::sync::mpsc::{self, UnboundedReceiver, UnboundedSender};
use tokio::time::{Instant, sleep, sleep_until};

use super::dds::{Address, Writer};
use super::matches::Matches;
use super::member::Shared;
use super::rtps::{Message, entity};
use crate::link::guid::Guid;
use crate::link::protocol::ReplyFailure;
use crate::link::qos::Qos;

/// Between two tries to write.
const AGAIN: Duration = Duration::from_millis(10);
/// A reader may know our writer a little later than we know it: it is told again, and Fast DDS gets its samples only then, as it asks for
/// what it has missed by its next heartbeat alone, seconds later.
const AGAIN_TOLD: [Duration; 3] = [Duration::from_millis(30), Duration::from_millis(60), LATER];
const LATER: Duration = Duration::from_millis(100);

/// What a latched value is written with.
pub(super) trait Target: Send + Sync + 'static {
    /// Writes to all matched readers, or to one; the sample's number.
    fn write(&self, value: &Bytes, reader: Option<Guid>) -> Result<i64, ReplyFailure>;
    /// Does the reader want what was set before it came?
    fn is_owed(&self, reader: Guid) -> bool;
    /// Tells a reader that the samples before this one are not for it.
    fn skip(&self, reader: Guid, before: i64);
    fn guid(&self) -> Guid;
}

/// A writer, and the socket beside it.
pub(super) struct Beside {
    pub(super) writer: Writer,
    pub(super) shared: Arc<Shared>,
}

impl Target for Beside {
    fn write(&self, value: &Bytes, reader: Option<Guid>) -> Result<i64, ReplyFailure> {
        match reader {
            None => self.writer.write(value.clone()),
            Some(reader) => self.writer.write_to(value.clone(), Address { reader, answers: None }),
        }
    }

    fn is_owed(&self, reader: Guid) -> bool {
        self.shared.participant.keeps_for(reader)
    }

    fn skip(&self, reader: Guid, before: i64) {
        let writer = self.writer.guid();
        let mut message = Message::from(writer.prefix());
        message.to(reader.prefix()).gap(entity(reader), entity(writer), 1, before);
        let datagram = message.bytes();
        for address in self.shared.participant.addresses_of_reader(reader) {
            self.shared.beside.send(&datagram, address);
        }
    }

    fn guid(&self) -> Guid {
        self.writer.guid()
    }
}

/// Where to set the value. The writer goes when this goes.
pub(super) struct Latched {
    values: UnboundedSender<Bytes>,
}

impl Latched {
    /// Values that come within `gather` of each other are one; zero: each is written.
    pub(super) fn start(
        runtime: &Handle,
        target: impl Target,
        matches: &Arc<Matches>,
        qos: Qos,
        gather: Duration,
    ) -> Self {
        let (values, receiver) = mpsc::unbounded_channel();
        let matches = Arc::clone(matches);
        runtime.spawn(async move { run(receiver, target, &matches, qos, gather).await });
        Self { values }
    }

    /// Sets the value; never blocks.
    pub(super) fn set(&self, value: impl Into<Bytes>) {
        // The task ends only after this sender, or with the runtime.
        let _ = self.values.send(value.into());
    }
}

/// The task of a latched value.
struct Keeper<T> {
    target: T,
    depth: usize,
    lifespan: Option<Duration>,
    /// What counts, the newest last.
    kept: VecDeque<(Instant, Bytes)>,
    /// Set, and not written to those who were there.
    fresh: VecDeque<Bytes>,
    readers: HashSet<Guid>,
    /// Readers that came and have still to get what counts, and from when on.
    owed: VecDeque<(Instant, Guid)>,
    /// Readers that are told again what is not for them, when, and up to where.
    told: VecDeque<(Instant, Guid, i64)>,
    last: i64,
}

impl<T: Target> Keeper<T> {
    fn set(&mut self, value: Bytes) {
        self.kept.push_back((Instant::now(), value.clone()));
        while self.kept.len() > self.depth {
            self.kept.pop_front();
        }
        if !self.readers.is_empty() {
            self.fresh.push_back(value);
            while self.fresh.len() > self.depth {
                self.fresh.pop_front();
            }
        }
    }

    /// Who reads now.
    fn look(&mut self, readers: HashSet<Guid>) {
        let now = Instant::now();
        let lifespan = self.lifespan;
        self.kept.retain(|(since, _)| lifespan.is_none_or(|lifespan| now.duration_since(*since) < lifespan));
        for reader in readers.difference(&self.readers) {
            let from = if reader.is_fast_dds() { now + LATER } else { now };
            if self.target.is_owed(*reader) {
                self.owed.push_back((from, *reader));
            }
            if self.last > 0 {
                self.target.skip(*reader, self.last + 1);
                self.told.extend(AGAIN_TOLD.map(|later| (now + later, *reader, self.last + 1)));
            }
        }
        self.readers = readers;
        self.owed.retain(|(_, reader)| self.readers.contains(reader));
        if self.readers.is_empty() {
            self.fresh.clear();
        }
    }

    /// Writes what there is and may go; false where there was no room.
    fn write(&mut self) -> bool {
        let now = Instant::now();
        // What is not written yet goes to all, those that came among them.
        let old = self.kept.len().saturating_sub(self.fresh.len());
        for _ in 0..self.owed.len() {
            let Some((from, reader)) = self.owed.pop_front() else { break };
            if from > now {
                self.owed.push_back((from, reader));
                continue;
            }
            for (_, value) in self.kept.iter().take(old) {
                if !done(self.target.write(value, Some(reader)), &mut self.last) {
                    self.owed.push_front((from, reader));
                    return false;
                }
            }
        }
        while let Some(value) = self.fresh.front() {
            if !done(self.target.write(value, None), &mut self.last) {
                return false;
            }
            self.fresh.pop_front();
        }
        true
    }

    /// Tells those again whose time has come.
    fn tell(&mut self) {
        let now = Instant::now();
        let due: Vec<_> =
            self.told.iter().filter(|(at, ..)| *at <= now).map(|(_, who, before)| (*who, *before)).collect();
        self.told.retain(|(at, ..)| *at > now);
        due.into_iter().for_each(|(reader, before)| self.target.skip(reader, before));
    }

    /// When there is something to do next, by itself.
    fn next(&self) -> Option<Instant> {
        let told = self.told.iter().map(|(at, ..)| *at).min();
        let owed = self.owed.iter().map(|(from, _)| *from).min();
        told.into_iter().chain(owed).min()
    }
}

/// Whether a sample needs no other try.
fn done(written: Result<i64, ReplyFailure>, last: &mut i64) -> bool {
    match written {
        Ok(number) => {
            *last = number;
            true
        }
        Err(ReplyFailure::Broken(reason)) => {
            tracing::error!("a latched value was not published: {reason}");
            true
        }
        Err(ReplyFailure::Full | ReplyFailure::NoReader) => false,
    }
}

async fn run(mut values: UnboundedReceiver<Bytes>, target: impl Target, matches: &Matches, qos: Qos, gather: Duration) {
    let mut changes = matches.changes();
    let mut keeper = Keeper {
        target,
        depth: usize::from(qos.depth).max(1),
        lifespan: qos.lifespan,
        kept: VecDeque::new(),
        fresh: VecDeque::new(),
        readers: HashSet::new(),
        owed: VecDeque::new(),
        told: VecDeque::new(),
        last: 0,
    };
    let mut has_room = true;
    loop {
        let again = if has_room { keeper.next() } else { Some(Instant::now() + AGAIN) };
        tokio::select! {
            value = values.recv() => match value {
                Some(value) => keeper.set(value),
                None => return,
            },
            change = changes.changed() => if change.is_err() { return },
            () = sleep_until(again.unwrap_or_else(Instant::now)), if again.is_some() => {}
        }
        if !gather.is_zero() {
            sleep(gather).await;
        }
        while let Ok(value) = values.try_recv() {
            keeper.set(value);
        }
        changes.mark_unchanged();
        keeper.look(matches.readers(keeper.target.guid()));
        keeper.tell();
        has_room = keeper.write();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::super::dds::Discovery;
    use super::*;

    const WRITER: Guid = Guid([1; 16]);

    /// What was written to whom (0: all), and how much room there is.
    type Written = (Vec<(u8, u8)>, usize);

    #[derive(Clone)]
    struct Fake(Arc<Mutex<Written>>);

    /// From this number on readers are volatile.
    const VOLATILE: u8 = 200;

    /// In the place of a value: samples before this number were not for the reader.
    const SKIPPED: u8 = 100;

    impl Target for Fake {
        fn write(&self, value: &Bytes, reader: Option<Guid>) -> Result<i64, ReplyFailure> {
            let mut state = self.0.lock().unwrap();
            if state.1 == 0 {
                return Err(ReplyFailure::Full);
            }
            state.1 -= 1;
            state.0.push((reader.map_or(0, |reader| reader.0[0]), value[0]));
            Ok(state.0.iter().filter(|(_, value)| *value < SKIPPED).count() as i64)
        }

        fn is_owed(&self, reader: Guid) -> bool {
            reader.0[0] < VOLATILE
        }

        fn skip(&self, reader: Guid, before: i64) {
            self.0.lock().unwrap().0.push((reader.0[0], SKIPPED + before as u8));
        }

        fn guid(&self) -> Guid {
            WRITER
        }
    }

    fn start(qos: Qos, gather: Duration) -> (Latched, Fake, Arc<Matches>) {
        let (fake, matches) = (Fake(Arc::new(Mutex::new((Vec::new(), 1000)))), Arc::new(Matches::new()));
        (Latched::start(&Handle::current(), fake.clone(), &matches, qos, gather), fake, matches)
    }

    fn reader(number: u8) -> Discovery {
        Discovery::Matched { writer: WRITER, reader: Guid([number; 16]) }
    }

    fn lost(number: u8) -> Discovery {
        Discovery::Lost { reader: Guid([number; 16]) }
    }

    #[tokio::test(start_paused = true)]
    async fn whoever_comes_gets_the_newest_and_nothing_else() {
        let (latched, fake, matches) = start(Qos::STATUS, Duration::ZERO);
        for value in 0..60 {
            latched.set(vec![value]);
            sleep(AGAIN).await;
        }
        assert_eq!(fake.0.lock().unwrap().0, [], "nobody reads");
        matches.note(reader(7));
        sleep(AGAIN).await;
        assert_eq!(fake.0.lock().unwrap().0, [(7, 59)]);
        for value in [60, 61] {
            latched.set(vec![value]);
            sleep(AGAIN).await;
        }
        matches.note(reader(8));
        sleep(AGAIN).await;
        let told = (8, SKIPPED + 4);
        assert_eq!(fake.0.lock().unwrap().0, [(7, 59), (0, 60), (0, 61), told, (8, 61)]);
        sleep(LATER).await;
        assert_eq!(fake.0.lock().unwrap().0[5..], [told; 3], "once more, and again");
        matches.note(lost(7));
        matches.note(lost(8));
        latched.set(vec![62]);
        latched.set(vec![63]);
        sleep(AGAIN).await;
        matches.note(reader(9));
        sleep(AGAIN).await;
        assert_eq!(fake.0.lock().unwrap().0[8..], [(9, SKIPPED + 5), (9, 63)]);
    }

    #[tokio::test(start_paused = true)]
    async fn a_volatile_reader_gets_what_is_set_once_it_is_there() {
        let (latched, fake, matches) = start(Qos::STATUS, Duration::ZERO);
        latched.set(vec![1]);
        sleep(AGAIN).await;
        matches.note(reader(VOLATILE));
        sleep(LATER).await;
        assert_eq!(fake.0.lock().unwrap().0, []);
        latched.set(vec![2]);
        sleep(AGAIN).await;
        matches.note(reader(VOLATILE + 1));
        sleep(AGAIN).await;
        assert_eq!(fake.0.lock().unwrap().0, [(0, 2), (VOLATILE + 1, SKIPPED + 2)], "nothing of before is for it");
    }

    #[tokio::test(start_paused = true)]
    async fn values_that_come_together_are_one() {
        let (latched, fake, matches) = start(Qos::STATUS, Duration::from_millis(10));
        sleep(AGAIN).await;
        matches.note(reader(7));
        sleep(AGAIN * 3).await;
        latched.set(vec![1]);
        latched.set(vec![2]);
        sleep(AGAIN * 3).await;
        assert_eq!(fake.0.lock().unwrap().0, [(0, 2)]);
    }

    #[tokio::test(start_paused = true)]
    async fn what_finds_no_room_is_tried_again_and_what_is_too_old_is_left_out() {
        let (latched, fake, matches) = start(Qos::ROSOUT, Duration::ZERO);
        latched.set(vec![1]);
        sleep(Duration::from_secs(6)).await;
        latched.set(vec![2]);
        sleep(Duration::from_secs(6)).await;
        fake.0.lock().unwrap().1 = 0;
        matches.note(reader(7));
        sleep(AGAIN * 3).await;
        assert_eq!(fake.0.lock().unwrap().0, []);
        fake.0.lock().unwrap().1 = 5;
        sleep(AGAIN * 3).await;
        assert_eq!(fake.0.lock().unwrap().0, [(7, 2)], "lines live for 10 s");
    }
}
