//! Severities of log messages.

use lineshaft_msgs::foreign::rcl_interfaces::msg::Log;

/// Severity of a log message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Details for developers.
    Debug,
    /// Expected event.
    Info,
    /// Unexpected event that needs attention.
    Warn,
    /// Failure.
    Error,
    /// Failure that ends the process.
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
