//! The time that stamps show.

use std::time::{SystemTime, UNIX_EPOCH};

use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;

/// The system's time; the epoch when the clock stands before it.
pub fn now() -> Time {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Time { sec: i32::try_from(since.as_secs()).unwrap_or(i32::MAX), nanosec: since.subsec_nanos() }
}
