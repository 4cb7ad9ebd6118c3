//! The time that stamps show: the system's, or that of a simulation.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;

/// The system's time; the epoch when the clock stands before it.
pub fn now() -> Time {
    time(system_ns())
}

fn system_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

/// As a message; seconds fit until 2038, as ROS 2 has it.
fn time(ns: u64) -> Time {
    Time { sec: i32::try_from(ns / 1_000_000_000).unwrap_or(i32::MAX), nanosec: (ns % 1_000_000_000) as u32 }
}

/// The time of a message before the epoch is the epoch.
fn nanoseconds(time: &Time) -> u64 {
    u64::try_from(time.sec).map_or(0, |sec| sec * 1_000_000_000 + u64::from(time.nanosec))
}

/// The clock of a node; clones are one clock. Reading it neither waits nor locks.
#[derive(Clone, Debug, Default)]
pub struct Clock(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    is_simulated: AtomicBool,
    /// The newest time of the simulation (ns); 0 before the first.
    simulated_ns: AtomicU64,
}

impl Clock {
    /// Whether it shows the time of a simulation.
    pub fn is_simulated(&self) -> bool {
        self.0.is_simulated.load(Ordering::Acquire)
    }

    /// Nanoseconds since the epoch; 0 while a simulation has not said any.
    pub fn now_ns(&self) -> u64 {
        self.stamp_or(system_ns)
    }

    /// The same as a message.
    pub fn now(&self) -> Time {
        time(self.now_ns())
    }

    /// The stamp (ns) of what happened at `system_ns` of the system's time: that one itself, or the newest time of the simulation,
    /// which knows nothing between its messages.
    pub fn stamp(&self, system_ns: u64) -> u64 {
        self.stamp_or(|| system_ns)
    }

    fn stamp_or(&self, system_ns: impl FnOnce() -> u64) -> u64 {
        if self.is_simulated() { self.0.simulated_ns.load(Ordering::Acquire) } else { system_ns() }
    }

    /// From here on it shows the time of a simulation, which has not begun, or that of the system.
    pub(super) fn simulate(&self, is_simulated: bool) {
        self.0.simulated_ns.store(0, Ordering::Release);
        self.0.is_simulated.store(is_simulated, Ordering::Release);
    }

    /// What the simulation says; it may go forward, back, or stand.
    pub(super) fn set(&self, now: &Time) {
        self.0.simulated_ns.store(nanoseconds(now), Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simulation_says_the_time_from_its_first_message_on() {
        let clock = Clock::default();
        let before = system_ns();
        assert!(clock.now_ns() >= before && !clock.is_simulated());
        assert_eq!(clock.stamp(7), 7, "of the system");
        let other = clock.clone();
        other.simulate(true);
        assert_eq!((clock.now_ns(), clock.stamp(before)), (0, 0), "before its first message");
        other.set(&Time { sec: 5, nanosec: 25 });
        assert_eq!((clock.now_ns(), clock.stamp(before)), (5_000_000_025, 5_000_000_025));
        assert_eq!(clock.now(), Time { sec: 5, nanosec: 25 });
        // Back.
        other.set(&Time { sec: 1, nanosec: 0 });
        assert_eq!(clock.now_ns(), 1_000_000_000);
        other.set(&Time { sec: -3, nanosec: 5 });
        assert_eq!(clock.now_ns(), 0);
        other.set(&Time { sec: i32::MAX, nanosec: u32::MAX });
        assert_eq!(clock.now().sec, i32::MAX);
        other.simulate(false);
        assert!(clock.now_ns() >= before);
    }
}
