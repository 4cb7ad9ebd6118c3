//! Log messages for `/rosout`.

use lineshaft_msgs::cdr;
use lineshaft_msgs::foreign::rcl_interfaces::msg::Log;
use std::sync::Arc;

use super::clock::Clock;
use super::log::Severity;
use super::loggers::Loggers;
use super::tap::TappedPublisher;
use crate::link::Writer;

/// Target of log messages that are sent to `/rosout` directly: code that forwards the log must skip them.
pub const SENT_TO_ROSOUT: &str = "lineshaft_ros::told";

/// Origin of a log message.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Source file.
    pub file: String,
    /// Function or module.
    pub function: String,
    /// Line number.
    pub line: u32,
}

/// Publisher with its tap.
type Lines = (Writer, Option<TappedPublisher>);

/// Sends log messages to `/rosout`. Clones share the publisher, which is dropped with the last of them.
#[derive(Clone)]
pub struct Rosout {
    logger: String,
    clock: Clock,
    loggers: Loggers,
    /// Publisher, with a tap if a recorder selects it; `None` if `/rosout` is disabled.
    lines: Option<Arc<Lines>>,
}

impl Rosout {
    pub(super) fn new(lines: Option<Lines>, logger: String, clock: Clock, loggers: Loggers) -> Self {
        Self { logger, clock, loggers, lines: lines.map(Arc::new) }
    }

    /// Sends a message, stamped with the present time, if the level of the node's logger allows it. Never blocks: messages are dropped
    /// while a reader does not keep up.
    pub fn log(&self, severity: Severity, text: impl Into<String>, source: Source) {
        let Some(lines) = self.lines.as_ref().filter(|_| self.loggers.is_enabled(severity)) else { return };
        let Source { file, function, line } = source;
        let (name, level) = (self.logger.clone(), severity.level());
        let line = Log { stamp: self.clock.now(), level, name, msg: text.into(), file, function, line };
        let (writer, copies) = &**lines;
        let line = cdr::encode(&line);
        if let Some(copies) = copies {
            copies.copy(&line);
        }
        // The writer is full, or the node has ended. A log message about a lost log message would not arrive either.
        let _ = writer.write(line);
    }
}
