//! Says at most one line per caller and time.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use crate::link::guid::Prefix;

/// Between two lines about the same caller.
const PAUSE: Duration = Duration::from_secs(5);
/// Callers that are remembered.
const CALLERS: usize = 64;

/// Who was spoken of, when, and how often not since.
#[derive(Debug, Default)]
pub(super) struct Limiter {
    callers: HashMap<Prefix, (Instant, u64)>,
}

impl Limiter {
    /// [`Self::say`] where nobody knows who it was: all of them are one.
    pub(super) fn say_of_nobody(&mut self, now: Instant) -> Option<u64> {
        self.say(Prefix([0; 12]), now)
    }

    /// `Some(n)`: say it, n were left out since the last line. `None`: leave it out.
    pub(super) fn say(&mut self, caller: Prefix, now: Instant) -> Option<u64> {
        let over = |(since, _): &(Instant, u64)| now.duration_since(*since) >= PAUSE;
        match self.callers.get_mut(&caller) {
            Some(entry) if !over(entry) => {
                entry.1 += 1;
                None
            }
            Some(entry) => {
                let left_out = std::mem::replace(entry, (now, 0)).1;
                Some(left_out)
            }
            None => {
                if self.callers.len() >= CALLERS {
                    self.callers.retain(|_, entry| !over(entry));
                }
                // With so many callers at fault a line about each would be the flood that this prevents.
                if self.callers.len() >= CALLERS {
                    return None;
                }
                self.callers.insert(caller, (now, 0));
                Some(0)
            }
        }
    }
}

/// What a line says of those that were left out before it.
pub(super) fn more(before: u64) -> String {
    if before > 0 { format!(" ({before} more since the last line)") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_per_caller_and_pause() {
        let (mut limiter, start) = (Limiter::default(), Instant::now());
        let (a, b) = (Prefix([1; 12]), Prefix([2; 12]));
        assert_eq!(limiter.say(a, start), Some(0));
        assert_eq!(limiter.say(a, start + Duration::from_secs(1)), None);
        assert_eq!(limiter.say(a, start + Duration::from_secs(4)), None);
        assert_eq!(limiter.say(b, start + Duration::from_secs(4)), Some(0), "each caller for itself");
        assert_eq!(limiter.say(a, start + PAUSE), Some(2));
        assert_eq!(limiter.say(a, start + PAUSE * 2), Some(0));
    }

    #[test]
    fn many_callers_neither_flood_nor_grow() {
        let (mut limiter, start) = (Limiter::default(), Instant::now());
        let said =
            |limiter: &mut Limiter, now| (0..200u8).filter(|n| limiter.say(Prefix([*n; 12]), now).is_some()).count();
        assert_eq!(said(&mut limiter, start), CALLERS);
        assert_eq!(limiter.callers.len(), CALLERS);
        assert_eq!(said(&mut limiter, start + PAUSE), CALLERS, "after the pause there is room again");
    }
}
