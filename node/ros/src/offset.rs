//! How far the system clock is ahead of the monotonic clock.

use std::time::{SystemTime, UNIX_EPOCH};

use crate::link::protocol::monotonic_ns;

/// Tries of [`SystemOffset::read`], and the error at which it is content (ns).
const TRIES: usize = 5;
const SMALL_ERROR_NS: u64 = 20_000;

/// If the system clock is set back by more than this (ns), the ROS side hands over to a new one. After less the DDS library works again before
/// a new side would.
pub(crate) const SET_BACK_NS: i64 = 1_000_000_000;

/// Offset of the system clock. It changes where the system clock is set, and while the host is suspended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SystemOffset {
    /// The offset (ns).
    pub ns: i64,
    /// Maximum error (ns): both clocks are read one after the other.
    pub error_ns: u64,
}

impl SystemOffset {
    /// Reads both clocks; once more where the thread was interrupted in between.
    pub fn read() -> Self {
        let read = || {
            let (before, system, after) = (monotonic_ns(), system_ns(), monotonic_ns());
            let window = after.saturating_sub(before);
            // Unix time as i64 lasts until 2262.
            let ns = system.wrapping_sub(before.wrapping_add(window / 2)).cast_signed();
            Self { ns, error_ns: window.div_ceil(2) }
        };
        let mut best = read();
        for _ in 1..TRIES {
            if best.error_ns <= SMALL_ERROR_NS {
                break;
            }
            let next = read();
            best = if next.error_ns < best.error_ns { next } else { best };
        }
        best
    }
}

/// Notices that the system clock was set back.
#[derive(Debug)]
pub(crate) struct SetBack {
    /// The largest offset so far (ns).
    most_ns: i64,
}

impl SetBack {
    /// Begins now.
    pub(crate) fn new() -> Self {
        Self { most_ns: SystemOffset::read().ns }
    }

    /// By how much the clock is set back now (ns), against the latest that it has shown since the beginning.
    pub(crate) fn by_ns(&mut self) -> i64 {
        self.noted(SystemOffset::read().ns)
    }

    fn noted(&mut self, offset_ns: i64) -> i64 {
        self.most_ns = self.most_ns.max(offset_ns);
        self.most_ns.saturating_sub(offset_ns)
    }
}

/// Time of the system clock (ns since the epoch); the epoch where it shows an earlier time.
pub(crate) fn system_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clock_is_set_back_against_the_latest_time_that_it_has_shown() {
        let mut clock = SetBack { most_ns: 100 };
        assert_eq!([100, 40, 70, 500, 300, 500].map(|offset| clock.noted(offset)), [0, 60, 30, 0, 200, 0]);
    }

    #[test]
    fn offset_of_the_system_clock_is_known_within_its_error() {
        let offset = SystemOffset::read();
        let ahead = i128::from(system_ns()) - i128::from(monotonic_ns());
        // Half a minute for a busy machine.
        assert!((ahead - i128::from(offset.ns)).abs() < 30_000_000_000, "{offset:?} {ahead}");
    }
}
