//! A side that runs: tells it its orders, hears its reports, probes it, ends it.

use std::io;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::bury::Entry;
use super::frame;
use super::guid::Prefix;
use super::protocol::{Departed, Line, Order, Report};
use super::registry::{Orders, Registry};
use super::start::{Side, Started};
use crate::line_limit::LineLimit;

/// Between two probes.
pub(super) const PROBES: Duration = Duration::from_millis(100);
/// Longest time without an answer.
const SILENCE: Duration = Duration::from_millis(700);
/// Longest time from the start of a side to its first answer: it says good-bye for the dead first.
const START: Duration = Duration::from_secs(5);
/// How long a side may take to say good-bye; and one that has failed, until the system tells how it ended.
const GOOD_BYE: Duration = Duration::from_secs(2);
const CORPSE: Duration = Duration::from_millis(20);

/// Lines of the logs of all sides: one that is started again and again tells the same each time.
pub(super) type SideLines = LineLimit<(String, u32)>;

/// A side, and what is known of it.
pub(super) struct Running {
    /// Which one, for the registry.
    number: u32,
    stream: UnixStream,
    started: Started,
    threads: [JoinHandle<()>; 2],
    words: Receiver<Word>,
    since: Instant,
    /// Its participant, from when it is in the domain.
    pub(super) joined: Option<Departed>,
    pub(super) entry: Option<Entry>,
    pub(super) has_answered: bool,
    probe: Probe,
}

/// The last probe, and the answers.
struct Probe {
    number: u64,
    is_answered: bool,
    next: Instant,
    /// When the side was last known to work.
    good: Instant,
    /// When this process last looked.
    tick: Instant,
    /// What does not work.
    stuck: Option<String>,
}

/// What is heard of a side.
enum Word {
    Reported(Report),
    Silent(io::Error),
}

/// What a watch has seen.
pub(super) enum Seen {
    Nothing,
    /// It is in the domain.
    Joined(Prefix),
    /// It has failed, and why.
    Failed(String),
}

impl Running {
    /// Starts a side, which is told what `orders` begins.
    pub(super) fn start(
        side: &Side,
        registry: &Arc<Registry>,
        lines: &Arc<SideLines>,
        orders: impl FnOnce() -> Orders,
    ) -> io::Result<Self> {
        let (stream, started) = side.start()?;
        let (told, words) = channel();
        let (writing, reading) = (stream.try_clone()?, stream.try_clone()?);
        let orders = orders();
        let number = orders.number;
        let write = move || write_orders(writing, &orders);
        let (registry, lines) = (Arc::clone(registry), Arc::clone(lines));
        let read = move || read_reports(reading, number, &registry, &told, &lines);
        let thread = |name: &str| std::thread::Builder::new().name(name.to_owned());
        let threads = [thread("ros orders").spawn(write)?, thread("ros reports").spawn(read)?];
        let now = Instant::now();
        let probe = Probe { number: 0, is_answered: true, next: now, good: now, tick: now, stuck: None };
        let (joined, entry, has_answered) = (None, None, false);
        Ok(Self { number, stream, started, threads, words, since: now, joined, entry, has_answered, probe })
    }

    /// How long it has run.
    pub(super) fn age(&self) -> Duration {
        self.since.elapsed()
    }

    /// Resident memory (bytes), where the system tells.
    pub(super) fn memory(&self) -> Option<u64> {
        self.started.memory()
    }

    /// Hears what it says, waits for that at most so long, and probes it.
    pub(super) fn watch(&mut self, wait: Duration, registry: &Registry) -> Seen {
        let mut wait = wait;
        loop {
            match self.words.recv_timeout(std::mem::take(&mut wait)) {
                Ok(Word::Reported(Report::Joined(prefix))) => return Seen::Joined(prefix),
                Ok(Word::Reported(Report::Failed(reason))) => return Seen::Failed(reason),
                Ok(Word::Reported(report)) => self.hear(report),
                Ok(Word::Silent(error)) => return Seen::Failed(silence(&error)),
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return Seen::Failed("is not heard any more".to_owned()),
            }
        }
        let probe = &mut self.probe;
        // Where this process itself was frozen or had no time, the side gets its time anew.
        if probe.tick.elapsed() > SILENCE / 3 {
            probe.good = Instant::now();
        }
        probe.tick = Instant::now();
        if self.joined.is_none() || !self.has_answered {
            if self.since.elapsed() > START {
                return Seen::Failed(format!("did not begin to work within {} s", START.as_secs()));
            }
        } else if probe.good.elapsed() > SILENCE {
            let what = probe.stuck.as_ref().map(|what| format!(" ({what})")).unwrap_or_default();
            return Seen::Failed(format!("has not answered for {} ms{what}", SILENCE.as_millis()));
        }
        if self.joined.is_some() && probe.is_answered && Instant::now() >= probe.next {
            probe.number += 1;
            (probe.is_answered, probe.next) = (false, Instant::now() + PROBES);
            registry.order_side(self.number, Order::Probe(probe.number));
        }
        Seen::Nothing
    }

    /// The answers to probes.
    fn hear(&mut self, report: Report) {
        let probe = &mut self.probe;
        match report {
            Report::Alive(number) if number == probe.number => {
                (probe.is_answered, probe.good, probe.stuck) = (true, Instant::now(), None);
                self.has_answered = true;
            }
            // The next probe may find that it works again.
            Report::Stuck(what) => (probe.is_answered, probe.stuck) = (true, Some(what)),
            _ => {}
        }
    }

    /// Tells it.
    pub(super) fn order(&self, registry: &Registry, order: Order) {
        registry.order_side(self.number, order);
    }

    /// Ends it, whose orders have ended: it says good-bye, unless it has failed. What it died of, where that can be told; and its
    /// participant, where nobody has said good-bye for it.
    pub(super) fn end(self, has_failed: bool) -> (Option<String>, Option<Departed>) {
        if has_failed {
            // Where it has ended by itself there is nothing to shut.
            let _ = self.stream.shutdown(Shutdown::Both);
        }
        let died = self.started.end(if has_failed { CORPSE } else { GOOD_BYE });
        let _ = self.stream.shutdown(Shutdown::Both);
        for thread in self.threads {
            // One that panicked has ended, too.
            let _ = thread.join();
        }
        if has_failed {
            return (died, self.joined);
        }
        if let Some(entry) = self.entry {
            entry.remove();
        }
        (died, None)
    }
}

fn silence(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof | io::ErrorKind::ConnectionReset => "has ended".to_owned(),
        _ => format!("is not understood: {error}"),
    }
}

fn write_orders(mut stream: UnixStream, orders: &Orders) {
    while let Some(order) = orders.next() {
        // What becomes of the side is heard by the other direction.
        if frame::write(&mut stream, &order).is_err() {
            return;
        }
    }
    // No more orders: the side ends.
    let _ = stream.shutdown(Shutdown::Write);
}

fn read_reports(mut stream: UnixStream, number: u32, registry: &Registry, words: &Sender<Word>, lines: &SideLines) {
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
                registry.heard(number, report);
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
