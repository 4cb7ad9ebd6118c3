//! Keeps a ROS side: starts it, watches it, and starts another one when it fails.
//!
//! Law      a side is good while it answers probes, each of which goes through its DDS library, within 0.7 s. One that is not is
//!          killed; the loss is told at once, and the next one starts with all that the registry knows
//! Refuses  a side that cannot join at the first start; five in a row that never answered a probe end it for good

use std::io;
use std::net::{Ipv4Addr, Shutdown};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::bury::{self, Entry};
use super::frame;
use super::guid::Prefix;
use super::protocol::{Departed, Join, Line, Order, Report};
use super::qos::Qos;
use super::registry::{Reader, Registry, Writer};
use super::start::Side;
use crate::line_limit::LineLimit;

/// Between two probes.
const PROBES: Duration = Duration::from_millis(100);
/// Longest time without an answer.
const SILENCE: Duration = Duration::from_millis(700);
/// Longest time from the start of a side to its first answer: it says good-bye for the dead first.
const START: Duration = Duration::from_secs(5);
/// How long a side may take to say good-bye; and one that has failed, until the system tells how it ended.
const GOOD_BYE: Duration = Duration::from_secs(2);
const CORPSE: Duration = Duration::from_millis(20);
/// Sides in a row that never answered, after which there is none any more.
const TRIES: u32 = 5;
/// A side that lived so long was good: the next one starts at once. Before the others, a pause that doubles.
const GOOD: Duration = Duration::from_secs(5);
const PAUSE: Duration = Duration::from_millis(50);
const LONGEST_PAUSE: Duration = Duration::from_millis(800);

/// Why there is no ROS side.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct LinkError(pub(crate) String);

/// The ROS side was lost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loss {
    /// What is known of it, as a part of a sentence: "the ROS side ..".
    pub reason: String,
    /// No other one is started.
    pub is_final: bool,
}

/// What a link needs.
pub(crate) struct Settings {
    pub(crate) side: Side,
    pub(crate) domain: u16,
    pub(crate) networks: Option<Vec<Ipv4Addr>>,
    pub(crate) namespace: String,
    pub(crate) name: String,
    /// Where it is written down who lives; nothing: nowhere.
    pub(crate) participants: Option<PathBuf>,
    /// Told of each loss, on the supervisor's thread, before another side starts.
    pub(crate) on_loss: Arc<dyn Fn(&Loss) + Send + Sync>,
}

/// The connection to the ROS side. Dropping it has the side say good-bye, and waits for that.
pub(crate) struct Link {
    registry: Arc<Registry>,
    is_closed: Arc<AtomicBool>,
    supervisor: Option<JoinHandle<()>>,
}

impl Link {
    /// Starts a side and waits until it is in the domain.
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
        // First, so that the end of the side is none that it has by itself.
        self.is_closed.store(true, Ordering::Release);
        self.registry.close_all();
        if let Some(supervisor) = self.supervisor.take() {
            supervisor.thread().unpark();
            // One that has panicked has nobody to tell.
            let _ = supervisor.join();
        }
    }
}

/// Opens readers and writers, and does not keep the link.
#[derive(Clone)]
pub(crate) struct Opener(Arc<Registry>);

impl Opener {
    pub(crate) fn writer(&self, topic: &str, type_name: &str, qos: Qos) -> Writer {
        self.0.open_writer(topic, type_name, qos)
    }

    pub(crate) fn reader(&self, topic: &str, type_name: &str, qos: Qos) -> Reader {
        self.0.open_reader(topic, type_name, qos)
    }
}

struct Supervisor {
    settings: Settings,
    registry: Arc<Registry>,
    is_closed: Arc<AtomicBool>,
    /// Who waits for the first side.
    first: Option<SyncSender<Result<(), String>>>,
    /// Participants of earlier sides that ended without a good-bye.
    dead: Vec<Departed>,
    lines: Arc<SideLines>,
}

/// Lines of the logs of all sides: one that is started again and again tells the same each time.
type SideLines = LineLimit<(String, u32)>;

/// How a side ended.
enum End {
    /// It was to.
    Closed,
    Lost {
        reason: String,
        has_answered: bool,
    },
}

/// What is heard of a side.
enum Word {
    Reported(Report),
    Silent(io::Error),
}

impl Supervisor {
    fn run(mut self) {
        let (mut failures, mut pause) = (0, PAUSE);
        while !self.is_closed.load(Ordering::Acquire) {
            let begun = Instant::now();
            let (reason, has_answered) = match self.live() {
                Ok(End::Closed) => break,
                Ok(End::Lost { reason, has_answered }) => (reason, has_answered),
                Err(error) => (format!("cannot be started: {error}"), false),
            };
            self.registry.end();
            failures = if has_answered { 0 } else { failures + 1 };
            if let Some(first) = self.first.take() {
                // Whoever has asked waits for it.
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

    /// The life of a side.
    fn live(&mut self) -> io::Result<End> {
        let (stream, started) = self.settings.side.start()?;
        let buried = self.buried();
        let join = Join {
            domain: self.settings.domain,
            networks: self.settings.networks.clone(),
            namespace: self.settings.namespace.clone(),
            name: self.settings.name.clone(),
            dead: buried.iter().map(|(who, _)| who.clone()).chain(self.dead.clone()).collect(),
        };
        let orders = self.registry.begin(join);
        let (words, heard) = channel();
        let writing = stream.try_clone()?;
        let reading = stream.try_clone()?;
        let threads = {
            let registry = Arc::clone(&self.registry);
            let write = move || write_orders(writing, &orders, &registry);
            let registry = Arc::clone(&self.registry);
            let lines = Arc::clone(&self.lines);
            let read = move || read_reports(reading, &registry, &words, &lines);
            let thread = |name: &str| std::thread::Builder::new().name(name.to_owned());
            [thread("ros orders").spawn(write)?, thread("ros reports").spawn(read)?]
        };
        let mut life = Life { entry: None, joined: None, has_answered: false };
        let end = self.watch(&heard, &mut life, &buried);
        // The side reads the end of its orders, and ends in its turn.
        self.registry.end();
        let is_hopeless = matches!(&end, End::Lost { .. });
        if is_hopeless {
            let _ = stream.shutdown(Shutdown::Both);
        }
        let died = started.end(if is_hopeless { CORPSE } else { GOOD_BYE });
        let _ = stream.shutdown(Shutdown::Both);
        for thread in threads {
            // One that panicked has ended, too.
            let _ = thread.join();
        }
        match (&end, life.joined) {
            (End::Closed, _) => drop(life.entry.map(Entry::remove)),
            (End::Lost { .. }, Some(who)) => self.dead.push(who),
            (End::Lost { .. }, None) => {}
        }
        Ok(match (end, died) {
            (End::Lost { reason, has_answered }, Some(died)) => {
                End::Lost { reason: format!("{reason} ({died})"), has_answered }
            }
            (end, _) => end,
        })
    }

    /// The dead that other programs left.
    fn buried(&self) -> Vec<(Departed, PathBuf)> {
        self.settings.participants.as_deref().map(bury::dead).unwrap_or_default()
    }

    /// Watches a side until it ends, or has to.
    fn watch(&mut self, heard: &Receiver<Word>, life: &mut Life, buried: &[(Departed, PathBuf)]) -> End {
        let lost = |reason: String, life: &Life| End::Lost { reason, has_answered: life.has_answered };
        let (mut asked, mut is_answered, mut next_probe) = (0, true, Instant::now());
        let (mut good, mut tick) = (Instant::now(), Instant::now());
        let mut stuck: Option<String> = None;
        let started = Instant::now();
        loop {
            if self.is_closed.load(Ordering::Acquire) {
                return End::Closed;
            }
            match heard.recv_timeout(PROBES / 2) {
                Ok(Word::Reported(Report::Joined(prefix))) => self.joined(prefix, life, buried),
                Ok(Word::Reported(Report::Failed(reason))) => return lost(reason, life),
                Ok(Word::Reported(Report::Alive(number))) if number == asked => {
                    (is_answered, good, life.has_answered) = (true, Instant::now(), true);
                    stuck = None;
                }
                // The next probe may find that it works again.
                Ok(Word::Reported(Report::Stuck(what))) => (is_answered, stuck) = (true, Some(what)),
                Ok(Word::Reported(_)) | Err(RecvTimeoutError::Timeout) => {}
                Ok(Word::Silent(_)) if self.is_closed.load(Ordering::Acquire) => return End::Closed,
                Ok(Word::Silent(error)) => return lost(silence(&error), life),
                Err(RecvTimeoutError::Disconnected) => return lost("is not heard any more".to_owned(), life),
            }
            // Where this process itself was frozen or had no time, the side gets its time anew.
            if tick.elapsed() > SILENCE / 3 {
                good = Instant::now();
            }
            tick = Instant::now();
            if life.joined.is_none() || !life.has_answered {
                if started.elapsed() > START {
                    return lost(format!("did not begin to work within {} s", START.as_secs()), life);
                }
            } else if good.elapsed() > SILENCE {
                let what = stuck.map(|what| format!(" ({what})")).unwrap_or_default();
                return lost(format!("has not answered for {} ms{what}", SILENCE.as_millis()), life);
            }
            if life.joined.is_some() && is_answered && Instant::now() >= next_probe {
                asked += 1;
                (is_answered, next_probe) = (false, Instant::now() + PROBES);
                self.registry.order(Order::Probe(asked));
            }
        }
    }

    /// A side is in the domain.
    fn joined(&mut self, prefix: Prefix, life: &mut Life, buried: &[(Departed, PathBuf)]) {
        let who = Departed { prefix, domain: self.settings.domain, networks: self.settings.networks.clone() };
        if let Some(folder) = &self.settings.participants {
            match Entry::write(folder, &who) {
                Ok(entry) => life.entry = Some(entry),
                Err(error) => tracing::warn!(
                    "{}: {error}; a node that starts after this one was killed cannot say good-bye for it",
                    folder.display()
                ),
            }
        }
        for (_, path) in buried {
            // Another node may have been faster.
            let _ = std::fs::remove_file(path);
        }
        self.dead.clear();
        life.joined = Some(who);
        if let Some(first) = self.first.take() {
            // Whoever has asked waits for it.
            let _ = first.send(Ok(()));
        }
    }
}

/// What is known of a side.
struct Life {
    entry: Option<Entry>,
    joined: Option<Departed>,
    has_answered: bool,
}

fn silence(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof | io::ErrorKind::ConnectionReset => "has ended".to_owned(),
        _ => format!("is not understood: {error}"),
    }
}

fn write_orders(mut stream: UnixStream, orders: &Receiver<Order>, registry: &Registry) {
    while let Ok(order) = orders.recv() {
        registry.told(&order);
        // What becomes of the side is heard by the other direction.
        if frame::write(&mut stream, &order).is_err() {
            return;
        }
    }
    // No more orders: the side ends.
    let _ = stream.shutdown(Shutdown::Write);
}

fn read_reports(mut stream: UnixStream, registry: &Registry, words: &Sender<Word>, lines: &SideLines) {
    let mut buffer = Vec::new();
    loop {
        let word = match frame::read(&mut stream, &mut buffer) {
            Ok(Report::Line(line)) => {
                lines.say(line.place, |more| repeat(line.severity, &(line.text + more)));
                continue;
            }
            Ok(report @ (Report::Joined(_) | Report::Failed(_) | Report::Alive(_) | Report::Stuck(_))) => {
                Word::Reported(report)
            }
            Ok(report) => {
                registry.heard(report);
                continue;
            }
            Err(error) => Word::Silent(error),
        };
        let is_last = matches!(word, Word::Silent(_));
        if words.send(word).is_err() || is_last {
            return;
        }
    }
}

/// A line of a side's log stands in the program's.
fn repeat(severity: u8, text: &str) {
    const TARGET: &str = "rustdds";
    match severity {
        Line::ERROR => tracing::error!(target: TARGET, "{text}"),
        Line::WARN => tracing::warn!(target: TARGET, "{text}"),
        Line::INFO => tracing::info!(target: TARGET, "{text}"),
        _ => tracing::debug!(target: TARGET, "{text}"),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    fn settings(side: Side) -> (Settings, Arc<Mutex<Vec<Loss>>>) {
        let losses = Arc::<Mutex<Vec<Loss>>>::default();
        let told = Arc::clone(&losses);
        let on_loss = Arc::new(move |loss: &Loss| told.lock().unwrap().push(loss.clone()));
        let (namespace, name) = ("/".to_owned(), "supervised".to_owned());
        // A domain of its own: no side of these tests ever joins it.
        let networks = Some(vec![Ipv4Addr::LOCALHOST]);
        let settings = Settings { side, domain: 232, networks, namespace, name, participants: None, on_loss };
        (settings, losses)
    }

    fn refused(program: &str) -> String {
        let (settings, losses) = settings(Side::Process(PathBuf::from(program)));
        let error = Link::start(settings).err().unwrap().to_string();
        assert_eq!(*losses.lock().unwrap(), [], "there was none that could be lost");
        error
    }

    #[test]
    fn a_side_that_never_works_is_told_at_the_first_start() {
        assert_eq!(refused("/bin/false"), "has ended (exit status: 1)");
        assert_eq!(refused("/no/such/program"), "cannot be started: No such file or directory (os error 2)");
    }

    #[test]
    fn a_side_that_is_to_end_is_no_loss() {
        let (mut settings, losses) = settings(Side::Thread);
        settings.domain = 201 + u16::try_from(std::process::id() % 30).unwrap();
        let link = Link::start(settings).unwrap();
        let writer = link.opener().writer("rt/supervised", "std_msgs::msg::dds_::Empty_", Qos::STREAM);
        writer.write(vec![0; 4]).unwrap();
        drop(link);
        assert!(writer.write(vec![0; 4]).is_err());
        assert_eq!(*losses.lock().unwrap(), []);
    }
}
