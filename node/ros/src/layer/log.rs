//! Severities of log messages, and the filter for the log of the DDS library.

use crate::side::NOISE;
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

/// Returns directives for a log filter (`EnvFilter` of `tracing-subscriber`): `level` for all, but only warnings of the DDS library,
/// without those that it repeats although nothing is wrong.
pub fn log_filter(level: &str) -> String {
    let noise = NOISE.iter().map(|(target, level)| format!(",{target}={level}"));
    format!("{level},rustdds=warn{}", noise.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_is_understood_and_keeps_the_level() {
        let filter: tracing_subscriber::EnvFilter = log_filter("debug").parse().unwrap();
        let text = filter.to_string();
        for directive in ["debug", "rustdds=warn", "rustdds::rtps::writer=error", "rustdds::network=error"] {
            assert!(text.split(',').any(|part| part == directive), "{directive} in {text}");
        }
    }
}
