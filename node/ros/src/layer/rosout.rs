//! Log lines for `/rosout`.

use lineshaft_msgs::cdr;
use lineshaft_msgs::foreign::rcl_interfaces::msg::Log;
use std::sync::Arc;

use super::clock::Clock;
use super::log::Severity;
use super::loggers::Loggers;
use super::tap::TappedPublisher;
use crate::link::Writer;

/// Target of lines of the program's log that are sent to `/rosout` beside it: whoever passes the log on leaves them out.
pub const TOLD: &str = "lineshaft_ros::told";

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

/// The publisher, and its copies.
type Lines = (Writer, Option<TappedPublisher>);

/// Sends log lines to `/rosout`. Clones write to the same publisher, which goes with the last of them.
#[derive(Clone)]
pub struct Rosout {
    logger: String,
    clock: Clock,
    loggers: Loggers,
    /// With its copies, where a recorder wants them. Nothing where `/rosout` is switched off.
    lines: Option<Arc<Lines>>,
}

impl Rosout {
    pub(super) fn new(lines: Option<Lines>, logger: String, clock: Clock, loggers: Loggers) -> Self {
        Self { logger, clock, loggers, lines: lines.map(Arc::new) }
    }

    /// Sends a line, stamped with the present time, if the node's logger lets it through. Never waits: while a reader does not
    /// keep up, lines are dropped.
    pub fn log(&self, severity: Severity, text: impl Into<String>, source: Source) {
        let Some(lines) = self.lines.as_ref().filter(|_| self.loggers.lets_through(severity)) else { return };
        let Source { file, function, line } = source;
        let (name, level) = (self.logger.clone(), severity.level());
        let line = Log { stamp: self.clock.now(), level, name, msg: text.into(), file, function, line };
        let (writer, copies) = &**lines;
        let line = cdr::encode(&line);
        if let Some(copies) = copies {
            copies.copy(&line);
        }
        // Full, or the node is gone. A log line about a lost log line would not arrive either.
        let _ = writer.write(line);
    }
}
