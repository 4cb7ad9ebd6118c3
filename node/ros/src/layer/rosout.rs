//! Log lines for `/rosout`.

use lineshaft_msgs::cdr;
use lineshaft_msgs::foreign::rcl_interfaces::msg::Log;
use tokio::runtime::Handle;
use tokio::sync::mpsc::{self, Receiver, Sender};
use tokio::time::{Duration, sleep};

use super::clock::Clock;
use super::dds::{WriteFailure, Writer};
use super::endpoint::Registered;
use super::loggers::Loggers;

/// Target of lines of the program's log that are sent to `/rosout` beside it: whoever passes the log on leaves them out.
pub const TOLD: &str = "lineshaft_ros::told";

/// Lines that wait while a reader does not keep up; more are dropped.
const WAITING: usize = 1000;
/// Between two tries to write, and the number of tries: longer than the lease of a frozen reader.
const AGAIN: Duration = Duration::from_millis(10);
const TRIES: usize = 3000;

/// How much a line matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Details for developers.
    Debug,
    /// Expected.
    Info,
    /// Worth a look.
    Warn,
    /// Something failed.
    Error,
    /// The process cannot go on.
    Fatal,
}

impl Severity {
    pub(super) fn level(self) -> u8 {
        match self {
            Self::Debug => Log::DEBUG,
            Self::Info => Log::INFO,
            Self::Warn => Log::WARN,
            Self::Error => Log::ERROR,
            Self::Fatal => Log::FATAL,
        }
    }
}

/// Where a line comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Source file.
    pub file: String,
    /// Function, or module, in it.
    pub function: String,
    /// Line in it.
    pub line: u32,
}

/// Sends log lines to `/rosout`. Clones write to the same publisher, which goes with the last of them.
#[derive(Clone)]
pub struct Rosout {
    logger: String,
    clock: Clock,
    loggers: Loggers,
    /// Nothing where `/rosout` is switched off.
    lines: Option<Sender<Log>>,
}

impl Rosout {
    pub(super) fn start(
        runtime: &Handle,
        writer: Option<Registered<Writer>>,
        logger: String,
        clock: Clock,
        loggers: Loggers,
    ) -> Self {
        let lines = writer.map(|writer| {
            let (lines, receiver) = mpsc::channel(WAITING);
            runtime.spawn(run(receiver, writer));
            lines
        });
        Self { logger, clock, loggers, lines }
    }

    /// Sends a line, stamped with the present time, if the node's logger lets it through. Never waits: while a reader does not
    /// keep up, lines are dropped.
    pub fn log(&self, severity: Severity, text: impl Into<String>, source: Source) {
        let Some(lines) = self.lines.as_ref().filter(|_| self.loggers.lets_through(severity)) else { return };
        let Source { file, function, line } = source;
        let (name, level) = (self.logger.clone(), severity.level());
        let line = Log { stamp: self.clock.now(), level, name, msg: text.into(), file, function, line };
        // Full, or the runtime is gone. A log line about a lost log line would not arrive either.
        let _ = lines.try_send(line);
    }
}

async fn run(mut lines: Receiver<Log>, writer: Registered<Writer>) {
    while let Some(line) = lines.recv().await {
        let bytes = bytes::Bytes::from(cdr::encode(&line));
        // The writer's window is finite, and a new reader closes it until its first acknowledgement.
        for _ in 0..TRIES {
            match writer.write(bytes.clone()) {
                Err(WriteFailure::Full) => sleep(AGAIN).await,
                _ => break,
            }
        }
    }
}
