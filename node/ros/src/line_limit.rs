//! Rate limit for log messages that may repeat endlessly.

use std::collections::{HashMap, VecDeque};
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Maximum number of messages of one kind in [`SPAN`].
const MOST: usize = 9;
const SPAN: Duration = Duration::from_secs(60);
/// Maximum number of kinds: more than the combinations of objects and codes of a cell within a minute.
const KINDS: usize = 1024;

/// Passes a few messages of each kind and counts the others.
///
/// Law      at most 9 messages of a kind in any 60 s; the next message that passes gives the number of skipped ones
/// Bounds   1024 kinds in a minute; further ones are skipped
#[derive(Debug)]
pub struct MessageRateLimit<K>(Mutex<HashMap<K, Kind>>);

#[derive(Debug, Default)]
struct Kind {
    /// Times of the last messages, the oldest first.
    said: VecDeque<Instant>,
    left_out: u64,
}

impl<K> Default for MessageRateLimit<K> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: Eq + Hash> MessageRateLimit<K> {
    /// Logs a message of a kind if the limit allows it, with the number of messages that were skipped before it.
    pub fn log(&self, kind: K, line: impl FnOnce(&str)) {
        if let Some(left_out) = self.skipped_if_allowed(kind, Instant::now()) {
            let more = if left_out > 0 { format!(" ({left_out} more since the last line)") } else { String::new() };
            line(&more);
        }
    }

    /// Returns the number of skipped messages if a message may pass.
    fn skipped_if_allowed(&self, kind: K, now: Instant) -> Option<u64> {
        let mut kinds = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_over = |said: Option<&Instant>| said.is_none_or(|said| now.duration_since(*said) >= SPAN);
        if kinds.len() >= KINDS && !kinds.contains_key(&kind) {
            kinds.retain(|_, kind| !is_over(kind.said.back()));
            if kinds.len() >= KINDS {
                return None;
            }
        }
        let kind = kinds.entry(kind).or_default();
        if kind.said.len() == MOST {
            if !is_over(kind.said.front()) {
                kind.left_out += 1;
                return None;
            }
            kind.said.pop_front();
        }
        kind.said.push_back(now);
        Some(std::mem::take(&mut kind.left_out))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nine_lines_of_a_kind_pass_in_a_minute_and_the_others_are_counted() {
        let (limit, start) = (MessageRateLimit::default(), Instant::now());
        let passed = |at| (0..1000).filter(|_| limit.skipped_if_allowed("enable", at).is_some()).count();
        assert_eq!(passed(start), 9);
        assert_eq!(limit.skipped_if_allowed("halt", start), Some(0), "each kind for itself");
        assert_eq!(passed(start + SPAN / 2), 0);
        assert_eq!(limit.skipped_if_allowed("enable", start + SPAN), Some(1991));
        assert_eq!(limit.skipped_if_allowed("enable", start + SPAN), Some(0));
    }

    #[test]
    fn no_minute_has_more_wherever_it_begins() {
        let (limit, start) = (MessageRateLimit::default(), Instant::now());
        let said: Vec<u64> = (0..300)
            .filter(|s| *s != 1 && limit.skipped_if_allowed("enable", start + Duration::from_secs(*s)).is_some())
            .collect();
        assert_eq!(said[..10], [0, 2, 3, 4, 5, 6, 7, 8, 9, 60], "one a second, but for the second one");
        for from in 0..240 {
            assert!(said.iter().filter(|s| (from..from + 60).contains(*s)).count() <= MOST, "{from}: {said:?}");
        }
    }

    #[test]
    fn number_of_kinds_is_limited() {
        let (limit, start) = (MessageRateLimit::default(), Instant::now());
        let passed = |at| (0..5000).filter(|kind| limit.skipped_if_allowed(*kind, at).is_some()).count();
        assert_eq!(passed(start), KINDS);
        assert_eq!(limit.0.lock().unwrap().len(), KINDS);
        assert_eq!(passed(start + SPAN), KINDS, "after a minute there is room again");
    }
}
