//! A running ROS side: sends its orders, receives its reports, probes it and ends it.

use std::io;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::frame;
use super::participants::Entry;
use super::protocol::{Departed, Line, Order, ParticipantId, Report};
use super::registry::{Orders, Registry};
use super::start::{Side, Started};
use crate::line_limit::MessageRateLimit;
use crate::silence::{Check, Silence};

/// Period of the probes.
const PROBES: Duration = Duration::from_millis(100);
/// Period of the calls of [`Running::watch`].
pub(super) const WATCH: Duration = Duration::from_millis(50);
/// Maximum time from the start of a side to its first answer. This includes the disposal of earlier participants.
const START: Duration = Duration::from_secs(5);
/// Maximum time that a side takes to leave, and maximum wait for the exit status of a side that has failed.
const LEAVE: Duration = Duration::from_secs(2);
const EXIT_STATUS: Duration = Duration::from_millis(20);

/// Rate limit for the log messages of all sides: a side that restarts repeatedly logs the same messages.
pub(super) type SideLines = MessageRateLimit<(String, u32)>;

/// A side and its state.
pub(super) struct Running {
    /// Number of the side in the registry.
    number: u32,
    stream: UnixStream,
    started: Started,
    threads: [JoinHandle<()>; 2],
    heard: Receiver<ReaderMessage>,
    since: Instant,
    /// Its participant, once it has joined the domain.
    pub(super) joined: Option<Departed>,
    pub(super) entry: Option<Entry>,
    pub(super) has_answered: bool,
    probe: Probe,
}

/// Last probe and its answer.
struct Probe {
    number: u64,
    is_answered: bool,
    next: Instant,
    /// Time since the last good answer.
    silence: Silence,
    /// Part of the side that does not work.
    stuck: Option<String>,
}

/// A message from the thread that reads the reports.
enum ReaderMessage {
    Reported(Report),
    Silent(io::Error),
}

/// Result of [`Running::watch`].
pub(super) enum SideEvent {
    Nothing,
    /// The side has joined the domain.
    Joined(ParticipantId),
    /// The side has failed, with the reason.
    Failed(String),
}

impl Running {
    /// Starts a side with these orders.
    pub(super) fn start(
        side: &Side,
        registry: &Arc<Registry>,
        lines: &Arc<SideLines>,
        timeout: Duration,
        orders: impl FnOnce() -> Orders,
    ) -> io::Result<Self> {
        let (stream, started) = side.start()?;
        let (told, heard) = channel();
        let (writing, reading) = (stream.try_clone()?, stream.try_clone()?);
        let orders = orders();
        let number = orders.number;
        let write = move || write_orders(writing, &orders);
        let (registry, lines) = (Arc::clone(registry), Arc::clone(lines));
        let read = move || read_reports(reading, number, &registry, &told, &lines);
        let thread = |name: &str| std::thread::Builder::new().name(name.to_owned());
        let threads = [thread("ros orders").spawn(write)?, thread("ros reports").spawn(read)?];
        let now = Instant::now();
        let silence = Silence::new(started.threads(), timeout, WATCH);
        let probe = Probe { number: 0, is_answered: true, next: now, silence, stuck: None };
        let (joined, entry, has_answered) = (None, None, false);
        Ok(Self { number, stream, started, threads, heard, since: now, joined, entry, has_answered, probe })
    }

    /// Returns the time since its start.
    pub(super) fn age(&self) -> Duration {
        self.since.elapsed()
    }

    /// Resident memory in bytes, if the system reports it.
    pub(super) fn memory(&self) -> Option<u64> {
        self.started.memory()
    }

    /// Handles its reports, waits at most `wait` for the first one, and probes it.
    pub(super) fn watch(&mut self, wait: Duration, registry: &Registry) -> SideEvent {
        let mut wait = wait;
        loop {
            match self.heard.recv_timeout(std::mem::take(&mut wait)) {
                Ok(ReaderMessage::Reported(Report::Joined(participant))) => {
                    return SideEvent::Joined(participant);
                }
                Ok(ReaderMessage::Reported(Report::Failed(reason))) => return SideEvent::Failed(reason),
                Ok(ReaderMessage::Reported(report)) => self.on_report(report),
                Ok(ReaderMessage::Silent(error)) => return SideEvent::Failed(silence(&error)),
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return SideEvent::Failed("is not heard any more".to_owned()),
            }
        }
        let probe = &mut self.probe;
        let silence = probe.silence.check();
        if self.joined.is_none() || !self.has_answered {
            if self.since.elapsed() > START {
                return SideEvent::Failed(format!("did not begin to work within {} s", START.as_secs()));
            }
        } else if silence == Check::Silent {
            let what = probe.stuck.as_ref().map(|what| format!(" ({what})")).unwrap_or_default();
            return SideEvent::Failed(format!("has not answered for {} ms{what}", probe.silence.since().as_millis()));
        } else if let Check::Overdue(doing) = silence {
            tracing::warn!("the ROS side has not answered for {doing}");
        }
        if self.joined.is_some() && probe.is_answered && Instant::now() >= probe.next {
            probe.number += 1;
            (probe.is_answered, probe.next) = (false, Instant::now() + PROBES);
            registry.order_side(self.number, Order::Probe(probe.number));
        }
        SideEvent::Nothing
    }

    /// Handles an answer to a probe.
    fn on_report(&mut self, report: Report) {
        let probe = &mut self.probe;
        match report {
            Report::Alive(number) if number == probe.number => {
                (probe.is_answered, probe.stuck) = (true, None);
                probe.silence.answered();
                self.has_answered = true;
            }
            // The next probe may succeed again.
            Report::Stuck(what) => (probe.is_answered, probe.stuck) = (true, Some(what)),
            _ => {}
        }
    }

    /// Sends it an order.
    pub(super) fn order(&self, registry: &Registry, order: Order) {
        registry.order_side(self.number, order);
    }

    /// Ends the side after its last order. Returns its exit status if that is an error, and its participant if that was not disposed.
    pub(super) fn end(self, has_failed: bool) -> (Option<String>, Option<Departed>) {
        if has_failed {
            // Fails if the side has ended already.
            let _ = self.stream.shutdown(Shutdown::Both);
        }
        let died = self.started.end(if has_failed { EXIT_STATUS } else { LEAVE });
        let _ = self.stream.shutdown(Shutdown::Both);
        for thread in self.threads {
            // A thread that panicked has ended as well.
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
        // The thread that reads the reports notices the end of the side.
        if frame::write(&mut stream, &order).is_err() {
            return;
        }
    }
    // The side ends at the end of its orders.
    let _ = stream.shutdown(Shutdown::Write);
}

fn read_reports(
    mut stream: UnixStream,
    number: u32,
    registry: &Registry,
    heard: &Sender<ReaderMessage>,
    lines: &SideLines,
) {
    let mut buffer = Vec::new();
    loop {
        let word = match frame::read(&mut stream, &mut buffer) {
            Ok(Report::Line(line)) => {
                lines.log(line.place, |more| repeat(line.severity, &(line.text + more)));
                continue;
            }
            Ok(report @ (Report::Joined(_) | Report::Failed(_) | Report::Alive(_) | Report::Stuck(_))) => {
                ReaderMessage::Reported(report)
            }
            Ok(report) => {
                registry.handle_report(number, report);
                continue;
            }
            Err(error) => ReaderMessage::Silent(error),
        };
        let is_last = matches!(word, ReaderMessage::Silent(_));
        if heard.send(word).is_err() || is_last {
            return;
        }
    }
}

/// Repeats a log message of a side in the log of the program.
fn repeat(severity: u8, text: &str) {
    const TARGET: &str = "rustdds";
    match severity {
        Line::ERROR => tracing::error!(target: TARGET, "{text}"),
        Line::WARN => tracing::warn!(target: TARGET, "{text}"),
        Line::INFO => tracing::info!(target: TARGET, "{text}"),
        _ => tracing::debug!(target: TARGET, "{text}"),
    }
}
