//! What the program should let through of the DDS library's log.

use crate::side::NOISE;

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
