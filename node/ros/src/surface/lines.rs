//! Lines of a log that may repeat without end.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Lines that pass in a second.
const LINES: u32 = 10;
const SECOND: Duration = Duration::from_secs(1);

/// Lets a few lines a second pass, and counts the others.
#[derive(Debug, Default)]
pub struct LineLimit(Mutex<Window>);

#[derive(Debug, Default)]
struct Window {
    start: Option<Instant>,
    passed: u32,
    held: u64,
}

impl LineLimit {
    /// Says a line, if it may: with a note of how many were held back before it.
    pub fn say(&self, line: impl FnOnce(&str)) {
        if let Some(held) = self.pass(Instant::now()) {
            let more = if held > 0 { format!(" ({held} lines before it were held back)") } else { String::new() };
            line(&more);
        }
    }

    /// May a line pass? Then, how many were held back before it.
    fn pass(&self, now: Instant) -> Option<u64> {
        let mut window = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if window.start.is_none_or(|start| now.duration_since(start) >= SECOND) {
            (window.start, window.passed) = (Some(now), 0);
        }
        if window.passed >= LINES {
            window.held += 1;
            return None;
        }
        window.passed += 1;
        Some(std::mem::take(&mut window.held))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_lines_a_second_pass_and_the_others_are_counted() {
        let limit = LineLimit::default();
        let start = Instant::now();
        let passed = (0..1000).filter(|_| limit.pass(start).is_some()).count();
        assert_eq!(passed, 10);
        assert_eq!(limit.pass(start + SECOND), Some(990));
        assert_eq!(limit.pass(start + SECOND), Some(0));
    }
}
