//! How much a log line matters, and what the program should let through of the DDS library's log.

use crate::side::NOISE;
use lineshaft_msgs::foreign::rcl_interfaces::msg::Log;

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

/// Directives for a log filter (`EnvFilter` of `tracing-subscriber`): `level` for everything, warnings of the DDS
/// library, and not those of it that repeat themselves where nothing is wrong.
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
