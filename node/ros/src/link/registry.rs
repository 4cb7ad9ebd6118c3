//! All that a ROS side has to know: readers, writers, what is latched, replies under way. It outlives each side.

use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::sync::{oneshot, watch};

use super::protocol::{Endpoint, Join, Kind, Order, Place, Reply, ReplyFailure, Report, Sample, SampleId, Spec};

/// Samples of a reader that wait in this process; others wait in the DDS library, which drops the oldest beyond the reader's depth.
const CREDIT: u32 = 32;
/// Bytes that may wait for a side that does not keep up; what is published beyond them is dropped.
const QUEUED: usize = 64 << 20;
/// For how long the reader of a reply is looked for; and after a new start of the side, when it has to be found first.
const PATIENCE: Duration = Duration::from_secs(1);
const PATIENCE_ANEW: Duration = Duration::from_secs(10);

/// Nothing is written any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unwritten {
    /// The side does not keep up.
    Full,
    /// The node is gone.
    Closed,
}

#[derive(Default)]
pub(super) struct Registry {
    state: Mutex<State>,
    /// Bytes on their way to the side.
    queued: Arc<AtomicUsize>,
}

#[derive(Default)]
struct State {
    endpoints: BTreeMap<Endpoint, Known>,
    replies: BTreeMap<u64, UnderWay>,
    endpoints_made: u32,
    replies_made: u64,
    /// To the present side.
    orders: Option<Sender<Order>>,
    /// Sides so far: replies to what an earlier one has taken have to find their readers anew.
    lives: u32,
    is_closed: bool,
}

/// A reply under way: of which writer, and who waits for what becomes of it.
struct UnderWay {
    endpoint: Endpoint,
    reply: Reply,
    answer: oneshot::Sender<Result<(), ReplyFailure>>,
}

struct Known {
    spec: Spec,
    more: More,
}

enum More {
    Writer {
        readers: watch::Sender<u32>,
        /// What is latched, the newest last.
        kept: VecDeque<Bytes>,
    },
    Reader {
        samples: UnboundedSender<Result<Sample, String>>,
        /// In this process, not taken yet.
        waiting: Arc<AtomicU32>,
    },
}

impl Registry {
    /// A panic elsewhere leaves the state whole: each change is one step.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn open_writer(self: &Arc<Self>, topic: &str, type_name: &str, qos: super::qos::Qos) -> Writer {
        let (readers, matched) = watch::channel(0);
        let more = More::Writer { readers, kept: VecDeque::new() };
        let endpoint = self.open(Kind::Writer, topic, type_name, qos, more);
        Writer { endpoint, registry: Arc::clone(self), matched }
    }

    pub(super) fn open_reader(self: &Arc<Self>, topic: &str, type_name: &str, qos: super::qos::Qos) -> Reader {
        let (samples, taken) = unbounded_channel();
        let waiting = Arc::new(AtomicU32::new(0));
        let more = More::Reader { samples, waiting: Arc::clone(&waiting) };
        let endpoint = self.open(Kind::Reader(CREDIT), topic, type_name, qos, more);
        Reader { endpoint, registry: Arc::clone(self), samples: taken, waiting, owed: 0 }
    }

    fn open(&self, kind: Kind, topic: &str, type_name: &str, qos: super::qos::Qos, more: More) -> Endpoint {
        let spec = Spec { kind, topic: topic.to_owned(), type_name: type_name.to_owned(), qos };
        let mut state = self.state();
        let endpoint = state.endpoints_made;
        state.endpoints_made += 1;
        self.tell(&state, Order::Open(endpoint, spec.clone()));
        state.endpoints.insert(endpoint, Known { spec, more });
        endpoint
    }

    fn close(&self, endpoint: Endpoint) {
        let mut state = self.state();
        state.endpoints.remove(&endpoint);
        self.tell(&state, Order::Close(endpoint));
    }

    /// Without a side nothing is lost: a new one is told all that stands here.
    fn tell(&self, state: &State, order: Order) {
        if let Some(orders) = &state.orders {
            self.queued.fetch_add(size(&order), Ordering::Relaxed);
            // A side that has just ended: as without one.
            let _ = orders.send(order);
        }
    }

    fn write(&self, endpoint: Endpoint, bytes: Bytes) -> Result<(), Unwritten> {
        let mut state = self.state();
        if state.is_closed {
            return Err(Unwritten::Closed);
        }
        let is_latched = match state.endpoints.get_mut(&endpoint) {
            Some(Known { spec, more: More::Writer { kept, .. } })
                if spec.qos.latched && spec.qos.lifespan.is_none() =>
            {
                if kept.len() >= usize::from(spec.qos.depth) {
                    kept.pop_front();
                }
                kept.push_back(bytes.clone());
                true
            }
            _ => false,
        };
        if !is_latched && self.queued.load(Ordering::Relaxed) > QUEUED {
            return Err(Unwritten::Full);
        }
        self.tell(&state, Order::Write(endpoint, bytes));
        Ok(())
    }

    fn reply(
        &self,
        endpoint: Endpoint,
        place: Place,
        answers: Option<SampleId>,
        bytes: Bytes,
    ) -> oneshot::Receiver<Result<(), ReplyFailure>> {
        let (answer, answered) = oneshot::channel();
        let mut state = self.state();
        if state.is_closed || self.queued.load(Ordering::Relaxed) > QUEUED {
            // Who asked may have gone.
            let _ = answer.send(Err(if state.is_closed { ReplyFailure::NoReader } else { ReplyFailure::Full }));
            return answered;
        }
        let token = state.replies_made;
        state.replies_made += 1;
        let patience = if state.lives > 1 { PATIENCE_ANEW } else { PATIENCE };
        let reply = Reply { token, place, answers, patience_ms: milliseconds(patience), bytes };
        self.tell(&state, Order::Reply(endpoint, reply.clone()));
        state.replies.insert(token, UnderWay { endpoint, reply, answer });
        answered
    }

    /// A new side: what it has to be told, in its order, and from now on more.
    pub(super) fn begin(&self, join: Join) -> Receiver<Order> {
        let (orders, queue) = channel();
        let mut state = self.state();
        self.queued.store(0, Ordering::Relaxed);
        state.orders = Some(orders);
        state.lives += 1;
        self.tell(&state, Order::Join(join));
        for (endpoint, known) in &state.endpoints {
            let mut spec = known.spec.clone();
            if let More::Reader { waiting, .. } = &known.more {
                spec.kind = Kind::Reader(CREDIT.saturating_sub(waiting.load(Ordering::Relaxed)));
            }
            self.tell(&state, Order::Open(*endpoint, spec));
            if let More::Writer { kept, .. } = &known.more {
                kept.iter().for_each(|bytes| self.tell(&state, Order::Write(*endpoint, bytes.clone())));
            }
        }
        for UnderWay { endpoint, reply, .. } in state.replies.values() {
            let reply = Reply { patience_ms: milliseconds(PATIENCE_ANEW), ..reply.clone() };
            self.tell(&state, Order::Reply(*endpoint, reply));
        }
        queue
    }

    /// The side is no more.
    pub(super) fn end(&self) {
        let mut state = self.state();
        state.orders = None;
        for known in state.endpoints.values() {
            if let More::Writer { readers, .. } = &known.more {
                readers.send_replace(0);
            }
        }
    }

    /// There will be no side any more.
    pub(super) fn close_all(&self) {
        let mut state = self.state();
        state.orders = None;
        state.is_closed = true;
        state.replies.clear();
    }

    /// An order has left this process.
    pub(super) fn told(&self, order: &Order) {
        let size = size(order);
        // Of an earlier side: the count began anew with this one.
        let _ =
            self.queued.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |queued| Some(queued.saturating_sub(size)));
    }

    pub(super) fn order(&self, order: Order) {
        self.tell(&self.state(), order);
    }

    /// Brings what a side says to whom it concerns.
    pub(super) fn heard(&self, report: Report) {
        let mut state = self.state();
        match report {
            Report::Matched(endpoint, count) => {
                if let Some(Known { more: More::Writer { readers, .. }, .. }) = state.endpoints.get(&endpoint) {
                    readers.send_replace(count);
                }
            }
            Report::Taken(endpoint, sample) => {
                if let Some(Known { more: More::Reader { samples, waiting }, .. }) = state.endpoints.get(&endpoint) {
                    waiting.fetch_add(1, Ordering::Relaxed);
                    // Its reader is just being dropped.
                    let _ = samples.send(sample);
                }
            }
            Report::Replied(token, outcome) => {
                if let Some(UnderWay { answer, .. }) = state.replies.remove(&token) {
                    // Who answers in passing does not wait.
                    let _ = answer.send(outcome);
                }
            }
            Report::Joined(_) | Report::Failed(_) | Report::Alive(_) | Report::Stuck(_) | Report::Line(_) => {}
        }
    }
}

fn size(order: &Order) -> usize {
    match order {
        Order::Write(_, bytes) => bytes.len() + 64,
        Order::Reply(_, reply) => reply.bytes.len() + 64,
        Order::Join(_) | Order::Open(..) | Order::Close(_) | Order::More(..) | Order::Probe(_) => 64,
    }
}

fn milliseconds(time: Duration) -> u32 {
    u32::try_from(time.as_millis()).unwrap_or(u32::MAX)
}

/// Writes samples of one topic; dropping it takes it from the node.
pub(crate) struct Writer {
    endpoint: Endpoint,
    registry: Arc<Registry>,
    matched: watch::Receiver<u32>,
}

impl Writer {
    /// Writes to all matched readers; never waits.
    pub(crate) fn write(&self, bytes: impl Into<Bytes>) -> Result<(), Unwritten> {
        self.registry.write(self.endpoint, bytes.into())
    }

    /// Writes to the one reader that waits for it, as soon as it is matched: at most 1 s later, where the ROS side began anew
    /// 10 s. The order goes out at once, also where nobody awaits what becomes of it.
    pub(crate) fn reply(
        &self,
        place: Place,
        answers: Option<SampleId>,
        bytes: Bytes,
    ) -> impl Future<Output = Result<(), ReplyFailure>> + use<> {
        let answered = self.registry.reply(self.endpoint, place, answers, bytes);
        async { answered.await.unwrap_or(Err(ReplyFailure::NoReader)) }
    }

    /// Readers that are matched now.
    pub(crate) fn matched(&self) -> usize {
        *self.matched.borrow() as usize
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.registry.close(self.endpoint);
    }
}

/// Reads samples of one topic; dropping it takes it from the node.
pub(crate) struct Reader {
    endpoint: Endpoint,
    registry: Arc<Registry>,
    samples: UnboundedReceiver<Result<Sample, String>>,
    waiting: Arc<AtomicU32>,
    /// Taken, and not told to the side yet.
    owed: u32,
}

impl Reader {
    /// The next sample, or why it could not be read. Nothing is lost when the future is dropped.
    pub(crate) async fn next(&mut self) -> Result<Sample, String> {
        let Some(sample) = self.samples.recv().await else { return std::future::pending().await };
        self.waiting.fetch_sub(1, Ordering::Relaxed);
        self.owed += 1;
        if self.owed >= CREDIT / 4 {
            self.registry.order(Order::More(self.endpoint, std::mem::take(&mut self.owed)));
        }
        sample
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.registry.close(self.endpoint);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::guid::Guid;
    use crate::link::qos::Qos;

    fn join() -> Join {
        Join { domain: 7, networks: None, namespace: "/".to_owned(), name: "n".to_owned(), dead: Vec::new() }
    }

    fn all(orders: &Receiver<Order>) -> Vec<Order> {
        orders.try_iter().collect()
    }

    fn sample() -> Sample {
        let id = SampleId { writer: Guid([1; 16]), number: 1 };
        Sample { id, related: None, is_stale: false, came_ns: 0, is_big_endian: false, bytes: Bytes::new() }
    }

    #[tokio::test]
    async fn a_new_side_is_told_all_that_counts() {
        let registry = Arc::new(Registry::default());
        let first = registry.begin(join());
        let stream = registry.open_writer("rt/stream", "T", Qos::STREAM);
        let latched = registry.open_writer("rt/latched", "T", Qos::STATUS);
        let service = registry.open_writer("rr/service", "T", Qos::SERVICE);
        let mut requests = registry.open_reader("rq/service", "T", Qos::SERVICE);
        let gone = registry.open_writer("rt/gone", "T", Qos::STREAM);
        drop(gone);
        stream.write(vec![1]).unwrap();
        latched.write(vec![2]).unwrap();
        latched.write(vec![3]).unwrap();
        let place = Place::Beside(Guid([9; 16]));
        let open = service.reply(place, None, vec![4].into());
        let answered = service.reply(place, None, vec![5].into());
        registry.heard(Report::Replied(1, Ok(())));
        assert_eq!(answered.await, Ok(()));
        registry.heard(Report::Matched(0, 2));
        for _ in 0..5 {
            registry.heard(Report::Taken(3, Ok(sample())));
        }
        requests.next().await.unwrap();
        assert_eq!((all(&first).len(), stream.matched()), (12, 2), "one order for each step");

        registry.end();
        assert_eq!(stream.matched(), 0, "of a side that is no more");
        stream.write(vec![6]).unwrap();
        let second = registry.begin(join());
        let told = all(&second);
        let [
            Order::Join(_),
            Order::Open(0, _),
            Order::Open(1, _),
            latest,
            Order::Open(2, _),
            Order::Open(3, spec),
            reply,
        ] = told.as_slice()
        else {
            panic!("{told:?}")
        };
        assert_eq!(latest, &Order::Write(1, vec![3].into()), "what is latched; nobody heard what was published");
        assert_eq!(spec.kind, Kind::Reader(CREDIT - 4), "four wait here");
        let Order::Reply(2, reply) = reply else { panic!("{reply:?}") };
        assert_eq!((reply.token, reply.bytes[0], reply.patience_ms), (0, 4, 10_000));
        registry.heard(Report::Replied(0, Err(ReplyFailure::NoReader)));
        assert_eq!(open.await, Err(ReplyFailure::NoReader));
    }

    #[tokio::test]
    async fn samples_are_taken_as_fast_as_they_are_read() {
        let registry = Arc::new(Registry::default());
        let orders = registry.begin(join());
        let mut reader = registry.open_reader("rt/a", "T", Qos::STREAM);
        all(&orders);
        for taken in 1..=CREDIT {
            registry.heard(Report::Taken(0, Ok(sample())));
            reader.next().await.unwrap();
            let wanted = if taken % 8 == 0 { vec![Order::More(0, 8)] } else { Vec::new() };
            assert_eq!(all(&orders), wanted, "{taken}");
        }
    }

    #[test]
    fn what_a_side_does_not_take_is_bounded() {
        let registry = Arc::new(Registry::default());
        let orders = registry.begin(join());
        let (stream, latched) =
            (registry.open_writer("rt/a", "T", Qos::STREAM), registry.open_writer("rt/b", "T", Qos::STATUS));
        let megabyte = Bytes::from(vec![0; 1 << 20]);
        let written = (0..100).take_while(|_| stream.write(megabyte.clone()).is_ok()).count();
        assert_eq!(written, 64);
        assert_eq!(latched.write(vec![1]), Ok(()), "the newest value that counts is never left out");
        all(&orders).iter().for_each(|order| registry.told(order));
        assert_eq!(stream.write(megabyte), Ok(()));
        registry.close_all();
        assert_eq!(stream.write(vec![1]), Err(Unwritten::Closed));
    }
}
