//! Endpoints, latched values and open replies of the node. The registry outlives each ROS side, and initializes the next one.
//!
//! Law      during a handover both sides receive the same samples, and each sample is forwarded once. The side in charge publishes and
//!          replies; both sides get the latched values

use std::collections::{BTreeMap, HashSet, VecDeque};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use bytes::Bytes;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::sync::{oneshot, watch};

use super::protocol::{
    Caller, Endpoint, EndpointKind, Join, Order, Reply, ReplyFailure, Report, Sample, SampleId, Spec, WireType,
};
use super::qos::Qos;

/// Maximum number of samples of an endpoint that wait in this process. Others wait in the middleware, which drops the oldest ones that
/// exceed the depth.
const CREDIT: u32 = 32;
/// Maximum number of bytes that wait for a side that does not keep up. Samples that exceed it are dropped.
const QUEUED: usize = 64 << 20;
/// Maximum time until the client of a reply can be reached. The second value applies after a restart of the side, which has to discover the
/// client first.
const PATIENCE: Duration = Duration::from_secs(1);
const PATIENCE_ANEW: Duration = Duration::from_secs(10);

/// Reason why a sample was not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WriteError {
    /// The side does not keep up.
    Full,
    /// The node has ended.
    Closed,
}

#[derive(Default)]
pub(super) struct Registry {
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    endpoints: BTreeMap<Endpoint, EndpointState>,
    replies: BTreeMap<u64, PendingReply>,
    endpoints_made: u32,
    replies_made: u64,
    /// The side in charge.
    side: Option<SideLink>,
    /// The side that will take charge.
    next: Option<NextSide>,
    /// The side that has handed over, until it has sent its replies.
    previous: Option<SideLink>,
    /// During a handover: samples that were forwarded.
    forwarded: Option<HashSet<(Endpoint, SampleId)>>,
    /// Number of sides so far. A new side has to discover the clients whose requests an earlier side has received.
    sides: u32,
    is_closed: bool,
}

/// Orders to a side.
struct SideLink {
    /// Number of the side, from 1.
    number: u32,
    orders: Sender<Order>,
    /// Number of bytes of orders that the side did not read yet.
    queued: Arc<AtomicUsize>,
}

impl SideLink {
    fn send(&self, order: Order) {
        self.queued.fetch_add(size(&order), Ordering::Relaxed);
        // A side that has just ended is treated as no side.
        let _ = self.orders.send(order);
    }
}

struct NextSide {
    side: SideLink,
    /// Number of matched receivers of each endpoint.
    receivers: BTreeMap<Endpoint, u32>,
}

/// Orders of one side, for the thread that sends them.
pub(super) struct Orders {
    /// Number of the side, from 1.
    pub(super) number: u32,
    queue: Receiver<Order>,
    /// Bytes in the queue.
    queued: Arc<AtomicUsize>,
}

impl Orders {
    /// Waits for the next order. Returns `None` if the side must end.
    pub(super) fn next(&self) -> Option<Order> {
        let order = self.queue.recv().ok()?;
        self.queued.fetch_sub(size(&order), Ordering::Relaxed);
        Some(order)
    }
}

/// A reply that was not sent yet: its server, and the channel for its result.
struct PendingReply {
    /// Number of the side that has the order; 0: none.
    side: u32,
    endpoint: Endpoint,
    reply: Reply,
    answer: oneshot::Sender<Result<(), ReplyFailure>>,
}

struct EndpointState {
    spec: Spec,
    /// Number of matched receivers of what it sends.
    receivers: watch::Sender<u32>,
    /// Latched values that it has sent, the newest last.
    kept: VecDeque<Bytes>,
    samples: UnboundedSender<Result<Sample, String>>,
    /// Number of samples in this process that were not read yet.
    waiting: Arc<AtomicU32>,
}

impl Registry {
    /// Locks the state. It is consistent even after a panic elsewhere, because each change is one step.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Opens an endpoint. Returns the part that sends and the part that receives; it is closed when both are dropped.
    pub(super) fn open(
        self: &Arc<Self>,
        kind: EndpointKind,
        name: String,
        wire: WireType,
        qos: Qos,
    ) -> (Writer, Reader) {
        let ((receivers, matched), (samples, taken)) = (watch::channel(0), unbounded_channel());
        let waiting = Arc::<AtomicU32>::default();
        let spec = Spec { kind, name, wire, qos, credit: CREDIT };
        let mut state = self.state();
        let endpoint = state.endpoints_made;
        state.endpoints_made += 1;
        state.send_to_all(&Order::Open(endpoint, spec.clone()));
        let known = EndpointState { spec, receivers, kept: VecDeque::new(), samples, waiting: Arc::clone(&waiting) };
        state.endpoints.insert(endpoint, known);
        let open = Arc::new(OpenEndpoint { endpoint, registry: Arc::clone(self) });
        (Writer { open: Arc::clone(&open), matched }, Reader { open, samples: taken, waiting, owed: 0 })
    }

    fn close(&self, endpoint: Endpoint) {
        let mut state = self.state();
        state.endpoints.remove(&endpoint);
        state.send_to_all(&Order::Close(endpoint));
    }

    fn write(&self, endpoint: Endpoint, bytes: Bytes) -> Result<(), WriteError> {
        let mut state = self.state();
        if state.is_closed {
            return Err(WriteError::Closed);
        }
        let is_latched = match state.endpoints.get_mut(&endpoint) {
            Some(EndpointState { spec, kept, .. }) if spec.qos.latched && spec.qos.lifespan.is_none() => {
                if kept.len() >= usize::from(spec.qos.depth) {
                    kept.pop_front();
                }
                kept.push_back(bytes.clone());
                true
            }
            _ => false,
        };
        let order = Order::Write(endpoint, bytes);
        if is_latched {
            state.send_to_all(&order);
        } else if state.queued() > QUEUED {
            return Err(WriteError::Full);
        } else {
            state.send(order);
        }
        Ok(())
    }

    fn reply(&self, endpoint: Endpoint, caller: Caller, bytes: Bytes) -> oneshot::Receiver<Result<(), ReplyFailure>> {
        let (answer, answered) = oneshot::channel();
        let mut state = self.state();
        if state.is_closed || state.queued() > QUEUED {
            // Fails if the caller has dropped the receiver.
            let _ = answer.send(Err(if state.is_closed { ReplyFailure::NoReader } else { ReplyFailure::Full }));
            return answered;
        }
        let token = state.replies_made;
        state.replies_made += 1;
        let patience = if state.sides > 1 { PATIENCE_ANEW } else { PATIENCE };
        let reply = Reply { token, caller, patience_ms: milliseconds(patience), bytes };
        state.send(Order::Reply(endpoint, reply.clone()));
        let side = state.side.as_ref().map_or(0, |side| side.number);
        state.replies.insert(token, PendingReply { side, endpoint, reply, answer });
        answered
    }

    /// Initializes a new side, which is in charge at once. Returns its orders.
    pub(super) fn begin(&self, join: Join) -> Orders {
        let mut state = self.state();
        let (side, orders) = state.new_side(join);
        state.side = Some(side);
        state.resume_replies();
        orders
    }

    /// Initializes a new side, which is in charge after [`Self::hand_over`]. Returns its orders.
    pub(super) fn begin_next(&self, join: Join) -> Orders {
        let mut state = self.state();
        let (side, orders) = state.new_side(join);
        state.next = Some(NextSide { side, receivers: BTreeMap::new() });
        state.forwarded = Some(HashSet::new());
        orders
    }

    /// Whether the next side has matched as many receivers as the side in charge.
    pub(super) fn is_next_matched(&self) -> bool {
        let state = self.state();
        let Some(next) = &state.next else { return false };
        let matched = |endpoint: &Endpoint| next.receivers.get(endpoint).copied().unwrap_or(0);
        state.endpoints.iter().all(|(endpoint, known)| matched(endpoint) >= *known.receivers.borrow())
    }

    /// Puts the next side in charge. Samples that the previous side receives until its end are still forwarded.
    pub(super) fn hand_over(&self) {
        let mut state = self.state();
        let Some(NextSide { side, receivers }) = state.next.take() else { return };
        for (endpoint, known) in &state.endpoints {
            known.receivers.send_replace(receivers.get(endpoint).copied().unwrap_or(0));
        }
        state.previous = state.side.replace(side);
    }

    /// Whether the previous side still has replies to send.
    pub(super) fn previous_has_replies(&self) -> bool {
        let state = self.state();
        let previous = state.previous.as_ref().map(|side| side.number);
        state.replies.values().any(|under_way| Some(under_way.side) == previous)
    }

    /// Ends the previous side. The side in charge sends the replies that are left.
    pub(super) fn end_previous(&self) {
        let mut state = self.state();
        state.previous = None;
        state.resume_replies();
    }

    /// Ends the handover; one side is left.
    pub(super) fn end_handover(&self) {
        let mut state = self.state();
        (state.next, state.forwarded) = (None, None);
    }

    /// Ends all sides.
    pub(super) fn end(&self) {
        let mut state = self.state();
        (state.side, state.next, state.previous, state.forwarded) = (None, None, None, None);
        for known in state.endpoints.values() {
            known.receivers.send_replace(0);
        }
    }

    /// Closes the registry; no other side follows.
    pub(super) fn close_all(&self) {
        let mut state = self.state();
        (state.side, state.next, state.previous) = (None, None, None);
        state.is_closed = true;
        state.replies.clear();
    }

    /// Lets the sides send `count` more samples of an endpoint.
    fn more(&self, endpoint: Endpoint, count: u32) {
        self.state().send_to_all(&Order::More(endpoint, count));
    }

    /// Sends an order to the side with this number.
    pub(super) fn order_side(&self, number: u32, order: Order) {
        self.state().send_to_side(number, order);
    }

    #[cfg(test)]
    pub(super) fn sides(&self) -> u32 {
        self.state().sides
    }

    /// Forwards a report of a side to its receiver.
    pub(super) fn handle_report(&self, number: u32, report: Report) {
        let mut state = self.state();
        match report {
            Report::Matched(endpoint, count) => state.on_match(number, endpoint, count),
            Report::Taken(endpoint, sample) => state.on_sample(number, endpoint, sample),
            Report::Replied(token, outcome) => {
                if let Some(PendingReply { answer, .. }) = state.replies.remove(&token) {
                    // Fails if the caller does not wait for the result.
                    let _ = answer.send(outcome);
                }
            }
            Report::Joined(_) | Report::Failed(_) | Report::Alive(_) | Report::Stuck(_) | Report::Line(_) => {}
        }
    }
}

impl State {
    /// Sends an order to the side in charge. Nothing is lost if there is no side: the registry initializes the next one.
    fn send(&self, order: Order) {
        if let Some(side) = &self.side {
            side.send(order);
        }
    }

    /// Sends an order to the side in charge and to the next one.
    fn send_to_all(&self, order: &Order) {
        self.send(order.clone());
        if let Some(next) = &self.next {
            next.side.send(order.clone());
        }
    }

    /// Returns the number of bytes of orders that the side in charge did not read yet.
    fn queued(&self) -> usize {
        self.side.as_ref().map_or(0, |side| side.queued.load(Ordering::Relaxed))
    }

    fn send_to_side(&self, number: u32, order: Order) {
        let mut sides = self.side.iter().chain(self.next.as_ref().map(|next| &next.side));
        if let Some(side) = sides.find(|side| side.number == number) {
            side.send(order);
        }
    }

    fn is_in_charge(&self, number: u32) -> bool {
        self.side.as_ref().is_some_and(|side| side.number == number)
    }

    /// Initializes a new side, except for the replies.
    fn new_side(&mut self, join: Join) -> (SideLink, Orders) {
        let (orders, queue) = channel();
        let queued = Arc::<AtomicUsize>::default();
        self.sides += 1;
        let side = SideLink { number: self.sides, orders, queued: Arc::clone(&queued) };
        side.send(Order::Join(join));
        for (endpoint, known) in &self.endpoints {
            let credit = CREDIT.saturating_sub(known.waiting.load(Ordering::Relaxed));
            side.send(Order::Open(*endpoint, Spec { credit, ..known.spec.clone() }));
            known.kept.iter().for_each(|bytes| side.send(Order::Write(*endpoint, bytes.clone())));
        }
        (side, Orders { number: self.sides, queue, queued })
    }

    /// Gives the open replies of other sides to the side in charge.
    fn resume_replies(&mut self) {
        let Some(side) = &self.side else { return };
        for under_way in self.replies.values_mut().filter(|under_way| under_way.side != side.number) {
            under_way.side = side.number;
            let reply = Reply { patience_ms: milliseconds(PATIENCE_ANEW), ..under_way.reply.clone() };
            side.send(Order::Reply(under_way.endpoint, reply));
        }
    }

    fn on_match(&mut self, number: u32, endpoint: Endpoint, count: u32) {
        if let Some(next) = &mut self.next
            && next.side.number == number
        {
            next.receivers.insert(endpoint, count);
        } else if self.is_in_charge(number)
            && let Some(known) = self.endpoints.get(&endpoint)
        {
            known.receivers.send_replace(count);
        }
    }

    fn on_sample(&mut self, number: u32, endpoint: Endpoint, sample: Result<Sample, String>) {
        let is_newest = number == self.sides;
        if let Some(forwarded) = &mut self.forwarded {
            match &sample {
                // Both sides use credit for the same sample, and both get it back when the sample is read.
                Ok(Sample { id, is_stale, .. }) if !(is_newest && *is_stale) => {
                    let is_first = forwarded.insert((endpoint, *id));
                    if !is_first {
                        return;
                    }
                }
                // The older side forwards the samples that are stale for the newest side, and those that cannot be read.
                _ if is_newest => return self.send_to_side(number, Order::More(endpoint, 1)),
                _ => {}
            }
        }
        if let Some(known) = self.endpoints.get(&endpoint) {
            known.waiting.fetch_add(1, Ordering::Relaxed);
            // Fails if the reader was dropped.
            let _ = known.samples.send(sample);
        }
    }
}

fn size(order: &Order) -> usize {
    match order {
        Order::Write(_, bytes) => bytes.len() + 64,
        Order::Reply(_, reply) => reply.bytes.len() + 64,
        Order::Join(_)
        | Order::Open(..)
        | Order::Close(_)
        | Order::More(..)
        | Order::Probe(_)
        | Order::Successor(_) => 64,
    }
}

fn milliseconds(time: Duration) -> u32 {
    u32::try_from(time.as_millis()).unwrap_or(u32::MAX)
}

/// Closes its endpoint when it is dropped.
struct OpenEndpoint {
    endpoint: Endpoint,
    registry: Arc<Registry>,
}

impl Drop for OpenEndpoint {
    fn drop(&mut self) {
        self.registry.close(self.endpoint);
    }
}

/// Sends the messages, requests or replies of an endpoint.
pub(crate) struct Writer {
    open: Arc<OpenEndpoint>,
    matched: watch::Receiver<u32>,
}

impl Writer {
    /// Sends a message to all subscriptions, or a request to all servers; never waits.
    pub(crate) fn write(&self, bytes: impl Into<Bytes>) -> Result<(), WriteError> {
        self.open.registry.write(self.open.endpoint, bytes.into())
    }

    /// Sends a reply to the client that waits for it, as soon as the client can be reached. It waits at most 1 s for that, or 10 s after
    /// a restart of the ROS side. The order is sent at once, even if the returned future is not awaited.
    pub(crate) fn reply(&self, caller: Caller, bytes: Bytes) -> impl Future<Output = Result<(), ReplyFailure>> + use<> {
        let answered = self.open.registry.reply(self.open.endpoint, caller, bytes);
        async { answered.await.unwrap_or(Err(ReplyFailure::NoReader)) }
    }

    /// Number of receivers that are matched now.
    pub(crate) fn matched(&self) -> usize {
        *self.matched.borrow() as usize
    }
}

/// Receives the messages, requests or replies of an endpoint.
pub(crate) struct Reader {
    open: Arc<OpenEndpoint>,
    samples: UnboundedReceiver<Result<Sample, String>>,
    waiting: Arc<AtomicU32>,
    /// Number of samples that were read, but not reported to the side yet.
    owed: u32,
}

impl Reader {
    /// Returns the next sample, or the reason why it could not be read. No sample is lost if the future is dropped.
    pub(crate) async fn next(&mut self) -> Result<Sample, String> {
        let Some(sample) = self.samples.recv().await else { return std::future::pending().await };
        self.waiting.fetch_sub(1, Ordering::Relaxed);
        self.owed += 1;
        if self.owed >= CREDIT / 4 {
            self.open.registry.more(self.open.endpoint, std::mem::take(&mut self.owed));
        }
        sample
    }
}

#[cfg(test)]
mod tests;
