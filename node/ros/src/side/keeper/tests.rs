use std::sync::{Arc, Mutex};

use proptest::prelude::*;

use super::super::dds::Discovery;
use super::super::latched::Latched;
use super::super::matches::Matches;
use super::*;
use crate::link::qos::Qos;

const WRITER: Guid = Guid([1; 16]);
/// Readers with this number or a larger one are volatile.
const VOLATILE: u8 = 200;
/// Slightly longer than the time until the last GAP.
const SETTLED: Duration = Duration::from_secs(4);

/// A message that was sent to a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sent {
    /// A value, as the sample with this number.
    Sample(u8, i64),
    /// The samples before this number are not for it.
    Gap(i64),
}

/// Records the messages to each reader, and limits the space of the writer.
#[derive(Clone, Debug)]
struct Record(Arc<Mutex<State>>);

#[derive(Debug)]
struct State {
    /// Number of the reader, and the message that was sent to it.
    sent: Vec<(u8, Sent)>,
    /// Free space in samples.
    room: usize,
}

impl Record {
    fn new() -> Self {
        Self(Arc::new(Mutex::new(State { sent: Vec::new(), room: usize::MAX })))
    }

    fn take(&self) -> Vec<(u8, Sent)> {
        std::mem::take(&mut self.0.lock().unwrap().sent)
    }

    /// Like [`Record::take`], without GAPs.
    fn take_samples(&self) -> Vec<(u8, u8)> {
        let value = |(reader, sent): (u8, Sent)| match sent {
            Sent::Sample(value, _) => Some((reader, value)),
            Sent::Gap(_) => None,
        };
        self.take().into_iter().filter_map(value).collect()
    }

    fn room(&self, samples: usize) {
        self.0.lock().unwrap().room = samples;
    }
}

impl Target for (Record, Mutex<i64>) {
    fn write(&self, value: &Bytes, reader: Guid) -> Result<i64, ReplyFailure> {
        let mut state = self.0.0.lock().unwrap();
        if state.room == 0 {
            return Err(ReplyFailure::Full);
        }
        state.room -= 1;
        let mut last = self.1.lock().unwrap();
        *last += 1;
        state.sent.push((reader.0[0], Sent::Sample(value[0], *last)));
        Ok(*last)
    }

    fn is_owed(&self, reader: Guid) -> bool {
        reader.0[0] < VOLATILE
    }

    fn addresses(&self, reader: Guid) -> Vec<SocketAddrV4> {
        vec![SocketAddrV4::new([127, 0, 0, 1].into(), reader.0[15].into())]
    }

    fn skip(&self, reader: Guid, before: i64) {
        self.0.0.lock().unwrap().sent.push((reader.0[0], Sent::Gap(before)));
    }

    fn guid(&self) -> Guid {
        WRITER
    }
}

fn start(qos: Qos, gather: Duration) -> (Latched, Record, Arc<Matches>) {
    let (record, matches) = (Record::new(), Arc::new(Matches::new()));
    let runtime = tokio::runtime::Handle::current();
    (Latched::start(&runtime, (record.clone(), Mutex::new(0)), &matches, qos, gather), record, matches)
}

fn comes(number: u8) -> Discovery {
    Discovery::Matched { writer: WRITER, reader: Guid([number; 16]) }
}

fn goes(number: u8) -> Discovery {
    Discovery::Lost { reader: Guid([number; 16]) }
}

async fn a_moment() {
    tokio::time::sleep(Duration::from_millis(10)).await;
}

#[tokio::test(start_paused = true)]
async fn a_late_reader_gets_the_newest_value_alone() {
    let (latched, record, matches) = start(Qos::STATUS, Duration::ZERO);
    for value in 0..60 {
        latched.set(vec![value]);
        a_moment().await;
    }
    assert_eq!(record.take(), [], "without a reader nothing is written");
    matches.note(comes(7));
    a_moment().await;
    assert_eq!(record.take(), [(7, Sent::Sample(59, 1))]);
    for value in [60, 61] {
        latched.set(vec![value]);
        a_moment().await;
    }
    assert_eq!(record.take(), [(7, Sent::Sample(60, 2)), (7, Sent::Sample(61, 3))]);
    matches.note(comes(8));
    a_moment().await;
    assert_eq!(record.take(), [(8, Sent::Gap(4)), (8, Sent::Sample(61, 4))]);
    tokio::time::sleep(SETTLED).await;
    assert_eq!(record.take(), [(8, Sent::Gap(4)); GAP_REPEATS.len()]);
    matches.note(goes(7));
    latched.set(vec![62]);
    a_moment().await;
    assert_eq!(record.take_samples(), [(8, 62)]);
}

/// Two readers join at once: the sample of the first one is not for the second one, which would wait for it without a GAP.
#[tokio::test(start_paused = true)]
async fn second_of_two_new_readers_gets_a_gap_over_the_sample_of_the_first() {
    let (latched, record, matches) = start(Qos::STATUS, Duration::ZERO);
    latched.set(vec![1]);
    a_moment().await;
    matches.note(comes(7));
    matches.note(comes(8));
    tokio::time::sleep(SETTLED).await;
    let mut expected = vec![(7, Sent::Sample(1, 1)), (8, Sent::Sample(1, 2))];
    expected.extend([(8, Sent::Gap(2)); GAP_REPEATS.len()]);
    assert_eq!(record.take(), expected);
}

#[tokio::test(start_paused = true)]
async fn a_volatile_reader_gets_what_is_set_after_its_match() {
    let (latched, record, matches) = start(Qos::STATUS, Duration::ZERO);
    latched.set(vec![1]);
    a_moment().await;
    matches.note(comes(VOLATILE));
    a_moment().await;
    assert_eq!(record.take(), []);
    latched.set(vec![2]);
    a_moment().await;
    matches.note(comes(VOLATILE + 1));
    a_moment().await;
    assert_eq!(record.take(), [(VOLATILE, Sent::Sample(2, 1)), (VOLATILE + 1, Sent::Gap(2))]);
}

#[tokio::test(start_paused = true)]
async fn values_that_come_together_are_joined() {
    let (latched, record, matches) = start(Qos::STATUS, Duration::from_millis(10));
    a_moment().await;
    matches.note(comes(7));
    tokio::time::sleep(Duration::from_millis(30)).await;
    latched.set(vec![1]);
    latched.set(vec![2]);
    tokio::time::sleep(Duration::from_millis(30)).await;
    assert_eq!(record.take_samples(), [(7, 2)]);
}

#[tokio::test(start_paused = true)]
async fn a_full_writer_is_tried_again_and_expired_values_are_left_out() {
    let (latched, record, matches) = start(Qos::ROSOUT, Duration::ZERO);
    latched.set(vec![1]);
    tokio::time::sleep(Duration::from_secs(6)).await;
    latched.set(vec![2]);
    tokio::time::sleep(Duration::from_secs(6)).await;
    record.room(0);
    matches.note(comes(7));
    tokio::time::sleep(Duration::from_millis(30)).await;
    assert_eq!(record.take(), []);
    record.room(5);
    tokio::time::sleep(Duration::from_millis(30)).await;
    assert_eq!(record.take_samples(), [(7, 2)], "lines live for 10 s");
}

#[tokio::test(start_paused = true)]
async fn a_gap_to_a_second_reader_at_an_address_does_not_overtake_samples_to_the_first() {
    let (latched, record, matches) = start(Qos::STATUS, Duration::ZERO);
    // Readers of two participants in one process.
    let reader = |participant| [vec![participant; 12], vec![9; 4]].concat().try_into().map(Guid).unwrap();
    matches.note(Discovery::Matched { writer: WRITER, reader: reader(7) });
    latched.set(vec![1]);
    tokio::time::sleep(SENDING).await;
    latched.set(vec![2]);
    a_moment().await;
    matches.note(Discovery::Matched { writer: WRITER, reader: reader(8) });
    a_moment().await;
    let samples = [(7, Sent::Sample(1, 1)), (7, Sent::Sample(2, 2))];
    assert_eq!(record.take(), [&samples[..], &[(8, Sent::Gap(2)), (8, Sent::Sample(2, 3))]].concat());
    tokio::time::sleep(GAP_REPEATS[0]).await;
    assert_eq!(record.take(), [(8, Sent::Gap(3))]);
}

/// Events of the sender of a latched topic.
#[derive(Clone, Copy, Debug)]
enum Event {
    Set,
    /// A reader joins, or leaves if it is matched.
    Match(u8),
    Room(usize),
    Wait(u64),
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        3 => Just(Event::Set),
        3 => prop_oneof![Just(7u8), Just(8), Just(9), Just(VOLATILE)].prop_map(Event::Match),
        1 => (0usize..4).prop_map(Event::Room),
        2 => (0u64..400).prop_map(Event::Wait),
    ]
}

/// Samples that a reader has got since it joined, and values that it still has to get.
#[derive(Default)]
struct Seen {
    samples: Vec<(u8, i64)>,
    due: VecDeque<u8>,
}

proptest! {
    /// For any order of events: no GAP covers a sample that was sent to its reader, because fragments of it may be in transit. Each
    /// reader gets the newest values once, in their order.
    #[test]
    fn no_gap_covers_a_sample_of_its_reader(events in prop::collection::vec(event(), 1..80), depth in 1usize..4) {
        let record = Record::new();
        let mut keeper = Keeper::new((record.clone(), Mutex::new(0)), depth, None);
        let (mut now, mut value) = (Instant::now(), 0u8);
        let (mut there, mut seen, mut kept) = (HashSet::new(), BTreeMap::<u8, Seen>::new(), VecDeque::new());
        let end = [Event::Room(usize::MAX), Event::Wait(4000)];
        for event in events.into_iter().chain(end) {
            match event {
                Event::Set => {
                    value += 1;
                    keeper.set(vec![value].into(), now);
                    kept.push_back(value);
                    kept.keep_newest(depth);
                    seen.values_mut().for_each(|seen| {
                        seen.due.push_back(value);
                        seen.due.keep_newest(depth);
                    });
                }
                Event::Match(reader) => {
                    if there.remove(&Guid([reader; 16])) {
                        seen.remove(&reader);
                    } else {
                        there.insert(Guid([reader; 16]));
                        let due = if reader < VOLATILE { kept.clone() } else { VecDeque::new() };
                        seen.insert(reader, Seen { samples: Vec::new(), due });
                    }
                    keeper.matched(&there, now);
                }
                Event::Room(samples) => record.room(samples),
                Event::Wait(ms) => now += Duration::from_millis(ms),
            }
            keeper.repeat_gaps(now);
            keeper.write(now);
            for (reader, sent) in record.take() {
                let of = seen.get_mut(&reader).expect("nothing goes to a reader that is not matched");
                match sent {
                    Sent::Sample(value, number) => {
                        prop_assert_eq!(of.due.pop_front(), Some(value));
                        of.samples.push((value, number));
                    }
                    Sent::Gap(before) => {
                        prop_assert!(of.samples.iter().all(|(_, number)| *number >= before), "{:?}", of.samples);
                    }
                }
            }
        }
        prop_assert!(seen.values().all(|seen| seen.due.is_empty()), "a value is missing");
        prop_assert_eq!(keeper.next_repeat(), None);
    }
}

/// Keeps the newest entries.
trait KeepNewest {
    fn keep_newest(&mut self, depth: usize);
}

impl KeepNewest for VecDeque<u8> {
    fn keep_newest(&mut self, depth: usize) {
        while self.len() > depth {
            self.pop_front();
        }
    }
}
