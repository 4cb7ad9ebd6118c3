//! Offset of the system clock from the monotonic clock.

use std::time::{SystemTime, UNIX_EPOCH};

use crate::link::protocol::monotonic_ns;

/// Maximum number of attempts of [`SystemOffset::read`], and the error that it accepts, in ns.
const TRIES: usize = 5;
const SMALL_ERROR_NS: u64 = 20_000;

/// If the system clock is set back by more than this, in ns, the ROS side hands over to a new one. After a smaller step the DDS library
/// works again before a new side would.
pub(crate) const SET_BACK_NS: i64 = 1_000_000_000;

/// Offset of the system clock. It changes when the system clock is set, and while the host is suspended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SystemOffset {
    /// Offset, in ns.
    pub ns: i64,
    /// Maximum error, in ns, because the clocks are read one after the other.
    pub error_ns: u64,
}

impl SystemOffset {
    /// Reads both clocks; repeats that if the thread was interrupted in between.
    pub fn read() -> Self {
        let read = || {
            let (before, system, after) = (monotonic_ns(), system_ns(), monotonic_ns());
            let window = after.saturating_sub(before);
            // Unix time in ns fits in i64 until 2262.
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

/// Detects that the system clock was set back.
#[derive(Debug)]
pub(crate) struct SetBack {
    /// Largest offset so far, in ns.
    most_ns: i64,
}

impl SetBack {
    /// Starts the detection.
    pub(crate) fn new() -> Self {
        Self { most_ns: SystemOffset::read().ns }
    }

    /// Returns by how much the clock is set back at present, in ns, compared with its latest time since the start of the detection.
    pub(crate) fn by_ns(&mut self) -> i64 {
        self.noted(SystemOffset::read().ns)
    }

    fn noted(&mut self, offset_ns: i64) -> i64 {
        self.most_ns = self.most_ns.max(offset_ns);
        self.most_ns.saturating_sub(offset_ns)
    }
}

/// Returns the time of the system clock, in ns since the epoch; 0 if it is before the epoch.
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
        // Half a minute as tolerance for a busy machine.
        assert!((ahead - i128::from(offset.ns)).abs() < 30_000_000_000, "{offset:?} {ahead}");
    }
}
