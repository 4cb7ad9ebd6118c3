//! Supervises the ROS side: starts it, monitors it, and starts another one when it fails or uses too much memory.
//!
//! Law      a side works while it answers probes, which pass through its DDS library, within `loss_timeout` (2 s). A side that does not is
//!          killed, the loss is reported at once, and the registry initializes the next side. A side that exceeds a memory limit hands over
//!          to a new side, and so does a side whose system clock was set back: its library holds back best-effort samples, including
//!          announcements of participants, until the clock reaches the earlier time again. Both sides run until the new one has matched as
//!          many readers. No sample is lost, and no loss is reported
//! Refuses  a side that cannot join at the first start; five in a row that never answered a probe end it permanently

use std::io;
use std::net::Ipv4Addr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::participants::{self, Entry};
use super::protocol::{Departed, EndpointKind, Join, Order, ParticipantId, WireType};
use super::qos::Qos;
use super::registry::{Orders, Reader, Registry, Writer};
use super::running::{Running, SideEvent, SideLines, WATCH};
use super::start::Side;
use crate::offset::{SET_BACK_NS, SetBack};

/// Number of sides in a row that never answered a probe, after which no other side is started.
const TRIES: u32 = 5;
/// If a side ran for at least this time, the next one starts at once. Otherwise it starts after a pause that doubles each time.
const GOOD: Duration = Duration::from_secs(5);
const PAUSE: Duration = Duration::from_millis(50);
const LONGEST_PAUSE: Duration = Duration::from_millis(800);
/// Memory limit of a side in bytes, and the period of its check. The DDS library never releases some of the memory of each client.
const MEMORY: u64 = 256 << 20;
const CHECK: Duration = Duration::from_secs(10);
/// Time for which two sides still run after the next one has matched all readers, because a reader may match it later, and the maximum time
/// for which they run.
const MIN_OVERLAP: Duration = Duration::from_secs(3);
const MAX_OVERLAP: Duration = Duration::from_secs(10);
/// Maximum time that the previous side has for its open replies.
const MAX_REPLYING: Duration = Duration::from_secs(1);

/// Reason why no ROS side is running.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct LinkError(pub(crate) String);

/// The ROS side was lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loss {
    /// Reason of the loss, as part of a sentence: "the ROS side ..".
    pub reason: String,
    /// Whether no other side is started.
    pub is_final: bool,
}

/// Settings of a link.
pub(crate) struct Settings {
    pub(crate) side: Side,
    pub(crate) domain: u16,
    pub(crate) networks: Option<Vec<Ipv4Addr>>,
    pub(crate) namespace: String,
    pub(crate) name: String,
    /// Folder with a file for each running participant; `None`: no such files are written.
    pub(crate) participants: Option<PathBuf>,
    /// Called at each loss, on the supervisor's thread, before another side starts.
    pub(crate) on_loss: Arc<dyn Fn(&Loss) + Send + Sync>,
    /// Maximum time without an answer of the side.
    pub(crate) loss_timeout: Duration,
    pub(crate) growth: MemoryLimit,
}

/// Limit of the memory of a side.
pub(crate) struct MemoryLimit {
    /// Maximum resident memory in bytes.
    pub(crate) memory: u64,
    /// Period of the check.
    pub(crate) check: Duration,
}

impl Default for MemoryLimit {
    fn default() -> Self {
        Self { memory: MEMORY, check: CHECK }
    }
}

/// Connection to the ROS side. When it is dropped, the side leaves the domain, and the drop waits for that.
pub(crate) struct Link {
    registry: Arc<Registry>,
    is_closed: Arc<AtomicBool>,
    supervisor: Option<JoinHandle<()>>,
}

impl Link {
    /// Starts a side and waits until it has joined the domain.
    pub(crate) fn start(settings: Settings) -> Result<Self, LinkError> {
        let registry = Arc::new(Registry::default());
        let is_closed = Arc::new(AtomicBool::new(false));
        let (first, joined) = sync_channel(1);
        let supervisor = Supervisor {
            settings,
            registry: Arc::clone(&registry),
            is_closed: Arc::clone(&is_closed),
            first: Some(first),
            dead: Vec::new(),
            lines: Arc::default(),
            leaving: None,
            matched: None,
            set_back: SetBack::new(),
            next_set_back: SetBack::new(),
            tried: None,
        };
        let thread = std::thread::Builder::new().name("ros link".to_owned());
        let thread = thread.spawn(move || supervisor.run()).map_err(|error| LinkError(error.to_string()))?;
        let link = Self { registry, is_closed, supervisor: Some(thread) };
        match joined.recv() {
            Ok(Ok(())) => Ok(link),
            Ok(Err(reason)) => Err(LinkError(reason)),
            Err(_) => Err(LinkError("its supervisor has failed".to_owned())),
        }
    }

    pub(crate) fn opener(&self) -> Opener {
        Opener(Arc::clone(&self.registry))
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        // First, so that the end of the side is not treated as a failure.
        self.is_closed.store(true, Ordering::Release);
        self.registry.close_all();
        if let Some(supervisor) = self.supervisor.take() {
            supervisor.thread().unpark();
            // If the supervisor has panicked, there is nothing to report to.
            let _ = supervisor.join();
        }
    }
}

/// Opens endpoints, and does not keep the link alive.
#[derive(Clone)]
pub(crate) struct Opener(Arc<Registry>);

impl Opener {
    /// Opens an endpoint. Returns the part that sends and the part that receives; it is closed when both are dropped.
    pub(crate) fn open(&self, kind: EndpointKind, name: String, wire: WireType, qos: Qos) -> (Writer, Reader) {
        self.0.open(kind, name, wire, qos)
    }
}

struct Supervisor {
    settings: Settings,
    registry: Arc<Registry>,
    is_closed: Arc<AtomicBool>,
    /// Reports the result of the first start to [`Link::start`].
    first: Option<SyncSender<Result<(), String>>>,
    /// Participants of earlier sides that ended without being disposed.
    dead: Vec<Departed>,
    lines: Arc<SideLines>,
    /// Thread that waits for the end of the previous side.
    leaving: Option<JoinHandle<()>>,
    /// Time since which the next side has matched all readers.
    matched: Option<Instant>,
    /// Detectors for steps back of the system clock, of the present side and of the newest one.
    set_back: SetBack,
    next_set_back: SetBack,
    /// Time of the last handover attempt of the present side.
    tried: Option<Instant>,
}

/// Cause of the end of a side.
enum End {
    /// The link was closed.
    Closed,
    Lost {
        reason: String,
        has_answered: bool,
    },
}

impl Supervisor {
    fn run(mut self) {
        let (mut failures, mut pause) = (0, PAUSE);
        while !self.is_closed.load(Ordering::Acquire) {
            let begun = Instant::now();
            let (reason, has_answered) = match self.run_sides() {
                Ok(End::Closed) => break,
                Ok(End::Lost { reason, has_answered }) => (reason, has_answered),
                Err(error) => (format!("cannot be started: {error}"), false),
            };
            self.registry.end();
            failures = if has_answered { 0 } else { failures + 1 };
            if let Some(first) = self.first.take() {
                // `Link::start` waits for this.
                let _ = first.send(Err(reason));
                break;
            }
            let is_final = failures >= TRIES;
            (self.settings.on_loss)(&Loss { reason, is_final });
            if is_final {
                break;
            }
            pause = if begun.elapsed() >= GOOD { PAUSE } else { (pause * 2).min(LONGEST_PAUSE) };
            if begun.elapsed() < GOOD {
                std::thread::park_timeout(pause);
            }
        }
        self.registry.close_all();
    }

    /// Runs a side, and the sides to which it hands over, until one of them ends.
    fn run_sides(&mut self) -> io::Result<End> {
        let left = self.settings.participants.as_deref().map(participants::dead).unwrap_or_default();
        let dead = left.iter().map(|(who, _)| who.clone()).chain(self.dead.clone()).collect();
        (self.set_back, self.tried) = (SetBack::new(), None);
        let mut side = self.start(Registry::begin, dead, None)?;
        let (mut next, mut checked) = (None, Instant::now());
        let failure = loop {
            if self.is_closed.load(Ordering::Acquire) {
                break None;
            }
            match side.watch(WATCH, &self.registry) {
                SideEvent::Nothing => {}
                SideEvent::Joined(participant) => self.joined(participant, &mut side, &left),
                // The link may have been closed meanwhile.
                SideEvent::Failed(_) if self.is_closed.load(Ordering::Acquire) => break None,
                SideEvent::Failed(reason) => break Some(reason),
            }
            let (back_ns, _) = (self.set_back.by_ns(), self.next_set_back.by_ns());
            let was_tried = self.tried.is_some_and(|tried| tried.elapsed() < self.settings.growth.check);
            if let Some(starting) = next.take() {
                next = self.watch_next(&mut side, starting);
            } else if side.has_answered && back_ns > SET_BACK_NS && !was_tried {
                tracing::info!("the ROS side hands over to a new one, because time went back for its DDS library");
                next = self.begin_next(&side);
            } else if side.has_answered && checked.elapsed() >= self.settings.growth.check {
                next = self.check_memory(&side);
                checked = Instant::now();
            }
        };
        self.registry.end();
        let has_answered = side.has_answered;
        let (died, dead) = side.end(failure.is_some());
        self.dead.extend(dead);
        if let Some(next) = next {
            self.dead.extend(next.end(failure.is_some()).1);
        }
        if failure.is_none() {
            self.wait_for_previous();
        }
        Ok(match (failure, died) {
            (None, _) => End::Closed,
            (Some(reason), None) => End::Lost { reason, has_answered },
            (Some(reason), Some(died)) => End::Lost { reason: format!("{reason} ({died})"), has_answered },
        })
    }

    fn start(
        &self,
        begin: impl FnOnce(&Registry, Join) -> Orders,
        dead: Vec<Departed>,
        predecessor: Option<ParticipantId>,
    ) -> io::Result<Running> {
        let Settings { side, domain, networks, namespace, name, loss_timeout, .. } = &self.settings;
        let (networks, namespace, name) = (networks.clone(), namespace.clone(), name.clone());
        let join = Join { domain: *domain, networks, namespace, name, dead, predecessor };
        Running::start(side, &self.registry, &self.lines, *loss_timeout, || begin(&self.registry, join))
    }

    /// Starts the next side if this one exceeds its memory limit.
    fn check_memory(&mut self, side: &Running) -> Option<Running> {
        let memory = side.memory().filter(|memory| *memory > self.settings.growth.memory)?;
        tracing::info!("the ROS side uses {} MiB, and hands over to a new one", memory >> 20);
        self.begin_next(side)
    }

    /// Starts the next side.
    fn begin_next(&mut self, side: &Running) -> Option<Running> {
        self.wait_for_previous();
        (self.next_set_back, self.tried) = (SetBack::new(), Some(Instant::now()));
        let predecessor = side.joined.as_ref().map(|who| who.participant);
        match self.start(Registry::begin_next, self.dead.clone(), predecessor) {
            Ok(next) => Some(next),
            Err(error) => {
                self.registry.end_handover();
                tracing::warn!("no new ROS side can be started: {error}; the present one continues");
                None
            }
        }
    }

    /// Waits for the end of the previous side.
    fn wait_for_previous(&mut self) {
        if let Some(leaving) = self.leaving.take() {
            // A thread that panicked has ended as well.
            let _ = leaving.join();
        }
    }

    /// Monitors the next side, and puts it in charge when it is ready.
    fn watch_next(&mut self, side: &mut Running, mut next: Running) -> Option<Running> {
        match next.watch(Duration::ZERO, &self.registry) {
            SideEvent::Nothing => {}
            SideEvent::Joined(participant) => {
                side.order(&self.registry, Order::Successor(participant));
                self.joined(participant, &mut next, &[]);
            }
            SideEvent::Failed(reason) => {
                self.registry.end_handover();
                tracing::warn!("the new ROS side {reason}; the present one continues");
                self.dead.extend(next.end(true).1);
                return None;
            }
        }
        let is_matched = next.has_answered && self.registry.is_next_matched();
        self.matched = is_matched.then(|| self.matched.unwrap_or_else(Instant::now));
        let is_ready = self.matched.is_some_and(|since| since.elapsed() >= MIN_OVERLAP) || next.age() >= MAX_OVERLAP;
        if !(next.has_answered && is_ready) {
            return Some(next);
        }
        self.matched = None;
        self.registry.hand_over();
        self.set_back = std::mem::replace(&mut self.next_set_back, SetBack::new());
        self.tried = None;
        tracing::info!("the new ROS side is in charge, {} ms after its start", next.age().as_millis());
        let previous = std::mem::replace(side, next);
        let registry = Arc::clone(&self.registry);
        // In a separate thread, because this thread monitors the new side meanwhile.
        let leave = move || {
            let until = Instant::now() + MAX_REPLYING;
            while registry.previous_has_replies() && Instant::now() < until {
                std::thread::sleep(Duration::from_millis(5));
            }
            registry.end_previous();
            previous.end(false);
            // Its reports are forwarded until then.
            registry.end_handover();
        };
        let thread = std::thread::Builder::new().name("ros side leaves".to_owned());
        match thread.spawn(leave) {
            Ok(leaving) => self.leaving = Some(leaving),
            Err(error) => tracing::error!("cannot wait for the end of the previous ROS side: {error}"),
        }
        None
    }

    /// Handles the report that a side has joined the domain.
    fn joined(&mut self, participant: ParticipantId, side: &mut Running, left: &[(Departed, PathBuf)]) {
        let who = Departed { participant, domain: self.settings.domain, networks: self.settings.networks.clone() };
        if let Some(folder) = &self.settings.participants {
            match Entry::write(folder, &who) {
                Ok(entry) => side.entry = Some(entry),
                Err(error) => tracing::warn!(
                    "{}: {error}; a node that starts after this one was killed cannot say good-bye for it",
                    folder.display()
                ),
            }
        }
        for (_, path) in left {
            // Another node may have removed the file already.
            let _ = std::fs::remove_file(path);
        }
        self.dead.clear();
        side.joined = Some(who);
        if let Some(first) = self.first.take() {
            // `Link::start` waits for this.
            let _ = first.send(Ok(()));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    fn open(link: &Link, kind: EndpointKind, name: &str, qos: Qos) -> (Writer, Reader) {
        let wire = WireType { name: "std_msgs/msg/UInt32".to_owned(), ..WireType::default() };
        link.opener().open(kind, name.to_owned(), wire, qos)
    }

    fn settings(side: Side) -> (Settings, Arc<Mutex<Vec<Loss>>>) {
        let losses = Arc::<Mutex<Vec<Loss>>>::default();
        let told = Arc::clone(&losses);
        let on_loss = Arc::new(move |loss: &Loss| told.lock().unwrap().push(loss.clone()));
        let (namespace, name) = ("/".to_owned(), "supervised".to_owned());
        // A separate domain: no side of these tests ever joins it.
        let networks = Some(vec![Ipv4Addr::LOCALHOST]);
        let growth = MemoryLimit::default();
        let settings = Settings {
            side,
            domain: 232,
            networks,
            namespace,
            name,
            participants: None,
            on_loss,
            loss_timeout: Duration::from_secs(2),
            growth,
        };
        (settings, losses)
    }

    fn refused(program: &str) -> String {
        let (settings, losses) = settings(Side::Process(PathBuf::from(program)));
        let error = Link::start(settings).err().unwrap().to_string();
        assert_eq!(*losses.lock().unwrap(), [], "there was none that could be lost");
        error
    }

    #[test]
    fn side_that_never_works_is_reported_at_first_start() {
        assert_eq!(refused("/bin/false"), "has ended (exit status: 1)");
        assert_eq!(refused("/no/such/program"), "cannot be started: No such file or directory (os error 2)");
    }

    #[test]
    fn requested_end_of_side_is_not_a_loss() {
        let (mut settings, losses) = settings(Side::Thread);
        settings.domain = 201 + u16::try_from(std::process::id() % 30).unwrap();
        let link = Link::start(settings).unwrap();
        let (writer, _) = open(&link, EndpointKind::Publisher, "/supervised", Qos::STREAM);
        writer.write(vec![0; 4]).unwrap();
        drop(link);
        assert!(writer.write(vec![0; 4]).is_err());
        assert_eq!(*losses.lock().unwrap(), []);
    }

    /// A node whose sides hand over repeatedly, and another node that exchanges numbers with it.
    #[tokio::test]
    async fn a_side_that_hands_over_loses_nothing() {
        let domain = 201 + u16::try_from(std::process::id() % 30).unwrap();
        let start = |memory| {
            let (mut settings, losses) = settings(Side::Thread);
            settings.domain = domain;
            settings.growth = MemoryLimit { memory, check: Duration::from_millis(100) };
            (Link::start(settings).unwrap(), losses)
        };
        let ((grows, losses), (other, _)) = (start(0), start(u64::MAX));
        let qos = Qos { depth: 1000, ..Qos::SERVICE };
        let topic = |name: &str, from: &Link, to: &Link| {
            let (writer, _) = open(from, EndpointKind::Publisher, name, qos);
            let (_, reader) = open(to, EndpointKind::Subscription, name, qos);
            (writer, reader)
        };
        let ((to, heard), (from, seen)) = (topic("/to", &other, &grows), topic("/from", &grows, &other));
        while to.matched() == 0 || from.matched() == 0 {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let check = |topic: &'static str, mut reader: Reader| async move {
            for number in 0_u32.. {
                let sample = tokio::time::timeout(Duration::from_secs(10), reader.next()).await;
                let sample = sample.unwrap_or_else(|_| panic!("{topic}: {number} was lost")).unwrap();
                if sample.bytes.is_empty() {
                    return number;
                }
                assert_eq!((topic, &sample.bytes[..]), (topic, &number.to_le_bytes()[..]));
            }
            unreachable!()
        };
        let checks = [tokio::spawn(check("to", heard)), tokio::spawn(check("from", seen))];
        let (begun, mut number) = (grows.registry.sides(), 0_u32);
        // Until three sides have ended and were replaced.
        while grows.registry.sides() < begun + 4 {
            to.write(number.to_le_bytes().to_vec()).unwrap();
            from.write(number.to_le_bytes().to_vec()).unwrap();
            number += 1;
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        to.write(Vec::new()).unwrap();
        from.write(Vec::new()).unwrap();
        for check in checks {
            assert_eq!(check.await.unwrap(), number);
        }
        assert_eq!(*losses.lock().unwrap(), []);
    }
}
