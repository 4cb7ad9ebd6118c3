//! A member of the DDS domain: executes the program's orders, and reports received samples.

use std::collections::HashMap;
use std::future::poll_fn;
use std::net::Ipv4Addr;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::task::Poll;
use std::time::{Duration, Instant};

use bytes::Bytes;
use tokio::runtime::Handle;
use tokio::sync::Semaphore;
use tokio::task::JoinHandle;

use super::age::{Known, is_stale};
use super::dds::{DdsError, Discovery, Participant, Reader, Taken, Writer, now_ticks};
use super::dds_names::{DdsTopic, topics};
use super::graph::{self, Graph, watch_for_namesakes};
use super::guid::{Guid, Prefix};
use super::hashes::{self, Hashes};
use super::latched::{self, Latched};
use super::matches::Matches;
use super::preemptive::{self, Answers};
use super::probe::Probe;
use super::replies::Replies;
use super::returning::Returning;
use super::socket::OwnSocket;
use super::{acknowledge, dispose, requests, sedp};
use crate::link::protocol::{
    Departed, Endpoint, EndpointKind, Join, Order, ReplyFailure, Report, Sample, Spec, WAITING, monotonic_ns,
};
use crate::link::qos::Qos;

/// Values of a latched topic that keeps one value are written at most this often, each to every reader. The status of many short goals
/// would fill the memory of the library, which frees samples every 6 s.
const GATHER: Duration = Duration::from_millis(10);
/// Maximum time to wait until the library has announced the readers so far. It needs a few milliseconds, more on a busy machine.
const ANNOUNCING: Duration = Duration::from_millis(200);

/// State that the tasks of a member share.
pub(super) struct Shared {
    pub(super) participant: Arc<Participant>,
    pub(super) matches: Arc<Matches>,
    pub(super) socket: OwnSocket,
    pub(super) returning: Returning,
    pub(super) hashes: Hashes,
    pub(super) answers: Answers,
    reports: Mutex<Sender<Report>>,
    /// Writers of the program, each with its reported number of readers.
    writers: Mutex<HashMap<Guid, (Endpoint, u32)>>,
    /// Remote writers that are matched.
    heard: Mutex<HashMap<Guid, Heard>>,
    /// Addresses of this host, on which all processes share one clock.
    own: Vec<Ipv4Addr>,
    /// Participants of this program: this one, its predecessor and its successor.
    own_participants: Mutex<Vec<Prefix>>,
}

/// A remote writer.
#[derive(Clone, Copy)]
struct Heard {
    since: Instant,
    /// Whether it is on this host.
    is_local: bool,
    /// Time at which its participant was heard again after a loss.
    again: Option<Instant>,
}

impl Shared {
    pub(super) fn report(&self, report: Report) {
        // Fails if the program has ended.
        let _ = self.reports.lock().unwrap_or_else(PoisonError::into_inner).send(report);
    }

    /// Reports each writer whose number of readers has changed.
    fn tell_matches(&self) {
        let mut writers = self.writers.lock().unwrap_or_else(PoisonError::into_inner);
        for (writer, (endpoint, told)) in writers.iter_mut() {
            let count = u32::try_from(self.matches.count(*writer)).unwrap_or(u32::MAX);
            if count != *told {
                *told = count;
                self.report(Report::Matched(*endpoint, count));
            }
        }
    }

    fn heard(&self) -> MutexGuard<'_, HashMap<Guid, Heard>> {
        self.heard.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the sample that an endpoint of this kind has received, or the reason why it cannot be read.
    fn sample(&self, mut taken: Taken, kind: EndpointKind, since: Instant) -> Result<Sample, String> {
        let (caller, header) = match kind {
            EndpointKind::Server => requests::client(&taken),
            _ => Default::default(),
        };
        if kind == EndpointKind::Nodes {
            taken.bytes = graph::names(&taken).map_err(|error| error.to_string())?;
            taken.is_big_endian = false;
        }
        let Taken { id, related, written, is_big_endian, bytes } = taken;
        let heard = self.heard().get(&id.writer).copied();
        // The match of this writer will be reported shortly.
        let heard = heard.unwrap_or_else(|| self.new_writer(id.writer));
        let known = Known {
            written,
            now: now_ticks(),
            reader: heard.again.map_or(since, |again| again.max(since)).elapsed(),
            matched: heard.since.elapsed(),
            is_local: heard.is_local,
        };
        Ok(Sample {
            id,
            sender: id.writer.prefix(),
            caller,
            header,
            answers: related.and_then(|related| related.number),
            is_stale: is_stale(known),
            written,
            came_ns: monotonic_ns(),
            is_big_endian,
            bytes,
        })
    }

    /// Whether it is a participant of this program.
    pub(super) fn is_own(&self, participant: Prefix) -> bool {
        self.own_participants.lock().unwrap_or_else(PoisonError::into_inner).contains(&participant)
    }

    /// Whether a remote endpoint is matched with one of our endpoints.
    pub(super) fn is_matched(&self, endpoint: Guid) -> bool {
        self.matches.has(endpoint) || self.heard().contains_key(&endpoint)
    }

    fn new_writer(&self, writer: Guid) -> Heard {
        let again = self.returning.since(writer.prefix());
        Heard { since: Instant::now(), is_local: self.is_local(writer), again }
    }

    /// Whether a writer is on this host.
    fn is_local(&self, writer: Guid) -> bool {
        let addresses = self.participant.addresses_of_writer(writer);
        !addresses.is_empty() && addresses.iter().all(|a| a.ip().is_loopback() || self.own.contains(a.ip()))
    }
}

/// Participant with its endpoints.
pub(super) struct Member {
    // Dropped before the participant, which waits for the library's threads.
    endpoints: HashMap<Endpoint, Open>,
    graph: Graph,
    probe: Arc<Probe>,
    tasks: Vec<JoinHandle<()>>,
    shared: Arc<Shared>,
    runtime: Handle,
    departed: Departed,
    is_replaced: bool,
}

/// What an endpoint of the program reads and writes.
struct Open {
    input: Option<Input>,
    output: Option<Output>,
}

struct Input {
    guid: Guid,
    /// Services are created and dropped with their node; subscriptions are created and dropped at any time.
    is_subscription: bool,
    credit: Arc<Semaphore>,
    task: JoinHandle<()>,
}

enum Output {
    Samples(Box<Writer>),
    Replies(Arc<Replies>),
    Latched { guid: Guid, latched: Latched },
}

impl Output {
    fn guid(&self) -> Guid {
        match self {
            Self::Samples(writer) => writer.guid(),
            Self::Replies(replies) => replies.guid(),
            Self::Latched { guid, .. } => *guid,
        }
    }
}

impl Member {
    /// Joins the domain.
    pub(super) fn join(join: &Join, reports: Sender<Report>, runtime: Handle) -> Result<Self, String> {
        let inside = runtime.enter();
        let participant = Participant::new(join.domain, join.networks.as_deref()).map_err(|error| error.to_string())?;
        let socket = OwnSocket::new().map_err(|error| format!("no socket: {error}"))?;
        let matches = Arc::new(Matches::new());
        let barrier = participant.barrier().map_err(|error| error.to_string())?;
        let probe = Arc::new(Probe::new(&participant).map_err(|error| error.to_string())?);
        let prefix = participant.guid().prefix();
        let own = dispose::of_host();
        let networks = join.networks.clone().unwrap_or_else(|| own.clone());
        let returning = Returning::new(prefix, networks).map_err(|error| format!("no socket: {error}"))?;
        let hashes = Hashes::new(prefix).map_err(|error| format!("no socket: {error}"))?;
        let shared = Arc::new(Shared {
            participant: Arc::new(participant),
            matches,
            socket,
            returning,
            hashes,
            answers: Answers::default(),
            reports: Mutex::new(reports),
            writers: Mutex::default(),
            heard: Mutex::default(),
            own,
            own_participants: Mutex::new([prefix].into_iter().chain(join.predecessor).collect()),
        });
        let graph = Graph::new(&runtime, &shared, join).map_err(|error| error.to_string())?;
        let others = Graph::others(&shared).map_err(|error| error.to_string())?;
        let namesakes = watch_for_namesakes(others, Arc::downgrade(&shared), join.namespace.clone(), join.name.clone());
        let follow = follow(Arc::downgrade(&shared), barrier, Arc::clone(&probe), runtime.clone());
        let answers = shared.socket.listener().and_then(tokio::net::UdpSocket::from_std);
        let answers = answers.map_err(|error| format!("no socket: {error}"))?;
        let mut tasks = vec![
            runtime.spawn(follow),
            runtime.spawn(namesakes),
            runtime.spawn(preemptive::listen(answers, Arc::downgrade(&shared))),
            runtime.spawn(acknowledge::for_best_effort_readers(Arc::downgrade(&shared))),
        ];
        match Returning::start(&shared, join.domain, &runtime) {
            Ok(sockets) => tasks.extend(sockets),
            Err(error) => {
                tracing::warn!("a client that was frozen or cut off for long will not be found again: {error}")
            }
        }
        tasks.push(Hashes::start(&shared, &runtime).map_err(|error| format!("no socket: {error}"))?);
        shared.report(Report::Joined(prefix));
        drop(inside);
        let departed = Departed { participant: prefix, domain: join.domain, networks: join.networks.clone() };
        Ok(Self { endpoints: HashMap::new(), graph, probe, tasks, shared, runtime, departed, is_replaced: false })
    }

    /// Returns the participant that leaves when this is dropped.
    pub(super) fn departed(&self) -> Departed {
        self.departed.clone()
    }

    /// Whether a successor replaces this member.
    pub(super) fn is_replaced(&self) -> bool {
        self.is_replaced
    }

    /// Executes an order.
    pub(super) fn follow(&mut self, order: Order) {
        match order {
            // The order that has created this member.
            Order::Join(_) => {}
            Order::Open(endpoint, spec) => {
                if let Err(error) = self.open(endpoint, &spec) {
                    self.shared.report(Report::Failed(error.to_string()));
                }
            }
            Order::Close(endpoint) => self.close(endpoint),
            Order::Write(endpoint, bytes) => self.write(endpoint, bytes),
            Order::Reply(endpoint, reply) => match self.endpoints.get(&endpoint) {
                Some(Open { output: Some(Output::Replies(replies)), .. }) => {
                    let (replies, shared) = (Arc::clone(replies), Arc::clone(&self.shared));
                    self.runtime.spawn(async move {
                        let token = reply.token;
                        let outcome = replies.send(&shared, reply).await;
                        shared.report(Report::Replied(token, outcome));
                    });
                }
                // The service was closed meanwhile.
                _ => self.shared.report(Report::Replied(reply.token, Err(ReplyFailure::NoReader))),
            },
            Order::More(endpoint, count) => {
                if let Some(Open { input: Some(input), .. }) = self.endpoints.get(&endpoint) {
                    input.credit.add_permits(count as usize);
                }
            }
            Order::Successor(participant) => {
                self.is_replaced = true;
                self.shared.hashes.end();
                self.shared.own_participants.lock().unwrap_or_else(PoisonError::into_inner).push(participant);
            }
            Order::Probe(number) => {
                let (probe, shared) = (Arc::clone(&self.probe), Arc::clone(&self.shared));
                self.runtime.spawn(async move {
                    shared.report(match probe.check(&shared).await {
                        Ok(()) => Report::Alive(number),
                        Err(what) => Report::Stuck(what.to_owned()),
                    });
                });
            }
        }
    }

    fn open(&mut self, endpoint: Endpoint, spec: &Spec) -> Result<(), DdsError> {
        let (read, written) = topics(spec);
        let input = read.map(|topic| self.open_input(endpoint, spec, &topic)).transpose()?;
        let output = written.map(|topic| self.open_output(endpoint, spec, topic)).transpose()?;
        self.endpoints.insert(endpoint, Open { input, output });
        Ok(())
    }

    fn open_input(&mut self, endpoint: Endpoint, spec: &Spec, topic: &DdsTopic) -> Result<Input, DdsError> {
        let Spec { kind, qos, credit, .. } = *spec;
        let depth = if kind == EndpointKind::Server { WAITING } else { qos.depth };
        let reader = self.shared.participant.reader(&topic.name, &topic.type_name, Qos { depth, ..qos })?;
        let guid = reader.guid();
        let credit = Arc::new(Semaphore::new(credit as usize));
        let task = self.runtime.spawn(read(reader, endpoint, kind, Arc::clone(&credit), Arc::clone(&self.shared)));
        self.announce(guid, &topic.hash);
        Ok(Input { guid, is_subscription: kind == EndpointKind::Subscription, credit, task })
    }

    fn open_output(&mut self, endpoint: Endpoint, spec: &Spec, topic: DdsTopic) -> Result<Output, DdsError> {
        let (qos, shared) = (spec.qos, &self.shared);
        let writer = shared.participant.writer(&topic.name, &topic.type_name, qos)?;
        let guid = writer.guid();
        shared.writers.lock().unwrap_or_else(PoisonError::into_inner).insert(guid, (endpoint, 0));
        let output = if spec.kind == EndpointKind::Server {
            Output::Replies(Arc::new(Replies::new(writer, topic.name)))
        } else if qos.latched {
            let target = latched::DirectedWriter { writer, shared: Arc::clone(shared) };
            let gather = if qos.depth == 1 { GATHER } else { Duration::ZERO };
            let latched = Latched::start(&self.runtime, target, &shared.matches, qos, gather);
            Output::Latched { guid, latched }
        } else {
            Output::Samples(Box::new(writer))
        };
        self.announce(guid, &topic.hash);
        Ok(output)
    }

    /// Announces a reader or writer, with the hash of its type.
    fn announce(&mut self, guid: Guid, hash: &str) {
        self.shared.hashes.add(guid, hash);
        self.graph.add(guid);
    }

    fn close(&mut self, endpoint: Endpoint) {
        let Some(Open { input, output }) = self.endpoints.remove(&endpoint) else { return };
        let guids: Vec<_> = input.iter().map(|input| input.guid).chain(output.iter().map(Output::guid)).collect();
        if let Some(input) = input {
            self.close_input(input);
        }
        for guid in guids {
            self.shared.hashes.remove(guid);
            self.graph.remove(guid);
            self.shared.writers.lock().unwrap_or_else(PoisonError::into_inner).remove(&guid);
            self.shared.matches.forget(guid);
        }
    }

    /// Disposes a reader ourselves if its disposal has a number that is certain, and drops it.
    fn close_input(&self, Input { guid, is_subscription, task, .. }: Input) {
        let end = self.shared.participant.end_of_reader();
        if is_subscription && self.shared.hashes.are_readers_announced_before(end, ANNOUNCING) {
            dispose::tell_all(&self.departed, &sedp::reader_gone(guid, end));
        }
        // The reader is dropped with its task, and the library disposes it after our disposal. A reader that is opened next must not be
        // announced before that: it would have the number of our disposal, and other participants would ignore it.
        task.abort();
        let _ = self.runtime.block_on(task);
    }

    fn write(&self, endpoint: Endpoint, bytes: Bytes) {
        match self.endpoints.get(&endpoint).and_then(|open| open.output.as_ref()) {
            Some(Output::Samples(writer)) => match writer.write(bytes) {
                Ok(_) => {}
                Err(ReplyFailure::Broken(reason)) => tracing::error!("a message was not published: {reason}"),
                Err(ReplyFailure::Full | ReplyFailure::NoReader) => {
                    tracing::warn!("a reader does not keep up, a message was dropped");
                }
            },
            Some(Output::Latched { latched, .. }) => latched.set(bytes),
            Some(Output::Replies(_)) | None => {}
        }
    }
}

impl Drop for Member {
    fn drop(&mut self) {
        self.tasks.iter().for_each(JoinHandle::abort);
        let inputs = self.endpoints.values().filter_map(|open| open.input.as_ref());
        inputs.for_each(|input| input.task.abort());
    }
}

/// Forwards samples, as far as the credit allows.
async fn read(mut reader: Reader, endpoint: Endpoint, kind: EndpointKind, credit: Arc<Semaphore>, shared: Arc<Shared>) {
    let since = Instant::now();
    loop {
        // Never closed.
        let Ok(permit) = credit.acquire().await else { return };
        let taken = reader.next().await;
        permit.forget();
        shared.report(Report::Taken(endpoint, taken.and_then(|taken| shared.sample(taken, kind, since))));
    }
}

/// Records all matches until the member is dropped, each as soon as the library is ready for samples to that reader.
async fn follow(shared: Weak<Shared>, barrier: super::dds::Barrier, probe: Arc<Probe>, runtime: Handle) {
    while let Some(changes) = poll_fn(|context| poll_changes(&shared, context)).await {
        let Some(shared) = shared.upgrade() else { return };
        for change in &changes {
            shared.returning.note(*change);
            match *change {
                Discovery::Heard { writer, reader } => {
                    let new = shared.new_writer(writer);
                    shared.heard().insert(writer, new);
                    if writer.is_fast_dds() && !writer.is_builtin() {
                        runtime.spawn(preemptive::ask(Arc::downgrade(&shared), reader, writer));
                    }
                }
                Discovery::Silent { writer } => drop(shared.heard().remove(&writer)),
                Discovery::Gone { participant, .. } => {
                    shared.heard().retain(|writer, _| writer.prefix() != participant);
                    probe.gone(participant);
                    shared.hashes.forget(participant);
                }
                Discovery::Found { participant } => probe.found(participant),
                Discovery::Matched { reader, .. } => {
                    if !reader.is_builtin() && shared.participant.is_best_effort(reader) {
                        shared.matches.note_best_effort(reader);
                    }
                }
                Discovery::Lost { .. } => {}
            }
        }
        if changes.iter().any(|change| matches!(change, Discovery::Matched { .. } | Discovery::Found { .. })) {
            barrier.pass().await;
        }
        for change in &changes {
            if let Discovery::Found { participant } = *change {
                hashes::found(&shared, participant, &runtime);
            }
        }
        changes.into_iter().for_each(|change| shared.matches.note(change));
        shared.tell_matches();
    }
}

/// Returns all discovery events so far, at least one, or `None` if the member was dropped.
fn poll_changes(shared: &Weak<Shared>, context: &mut std::task::Context<'_>) -> Poll<Option<Vec<Discovery>>> {
    // The participant is held only during each poll, because it must be dropped with its member.
    let Some(shared) = shared.upgrade() else { return Poll::Ready(None) };
    let mut changes = Vec::new();
    loop {
        match shared.participant.poll_discovery(context) {
            Poll::Ready(Some(change)) => changes.push(change),
            Poll::Pending if changes.is_empty() => return Poll::Pending,
            Poll::Ready(None) if changes.is_empty() => return Poll::Ready(None),
            Poll::Pending | Poll::Ready(None) => return Poll::Ready(Some(changes)),
        }
    }
}
