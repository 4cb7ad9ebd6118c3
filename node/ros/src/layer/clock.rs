//! The time that stamps show: the system's, or that of a simulation.
//!
//! Law      stamps of the system's time are the monotonic clock plus an offset ([`HostClock`]). Who owns the host clock makes the offset
//!          follow the system clock, and reports a step before stamps show it. Requests of others are judged by the system clock itself

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};

use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;

use crate::link::protocol::monotonic_ns;
use crate::offset::{SystemOffset, system_ns};

/// The system's time; the epoch when the clock stands before it.
pub fn now() -> Time {
    time(system_ns())
}

/// As a message; seconds fit until 2038, as ROS 2 has it.
fn time(ns: u64) -> Time {
    Time { sec: i32::try_from(ns / 1_000_000_000).unwrap_or(i32::MAX), nanosec: (ns % 1_000_000_000) as u32 }
}

/// The time of a message before the epoch is the epoch.
fn nanoseconds(time: &Time) -> u64 {
    u64::try_from(time.sec).map_or(0, |sec| sec * 1_000_000_000 + u64::from(time.nanosec))
}

/// The system's time for stamps. Clones are one clock. Reading it neither waits nor locks.
///
/// Steady time is the system's time without the steps of the system clock since the start: it never goes back.
#[derive(Clone, Debug)]
pub struct HostClock(Arc<Offsets>);

#[derive(Debug)]
struct Offsets {
    /// Steady time less the monotonic clock (ns).
    base_ns: AtomicI64,
    /// Sum of the steps that stamps show (ns).
    steps_ns: AtomicI64,
    /// The newest steady time that was read (ns).
    newest_ns: AtomicU64,
}

impl Default for HostClock {
    /// A clock that shows the time of the system clock now, and goes on with the monotonic clock.
    fn default() -> Self {
        Self::with_base(SystemOffset::read().ns)
    }
}

impl HostClock {
    /// A clock whose steady time is so much ahead of the monotonic clock (ns).
    pub fn with_base(base_ns: i64) -> Self {
        Self(Arc::new(Offsets {
            base_ns: AtomicI64::new(base_ns),
            steps_ns: AtomicI64::new(0),
            newest_ns: AtomicU64::new(0),
        }))
    }

    /// How far steady time is ahead of the monotonic clock (ns).
    pub fn base_ns(&self) -> i64 {
        self.0.base_ns.load(Ordering::Relaxed)
    }

    /// Sum of the steps that stamps show (ns): how far they are ahead of steady time.
    pub fn steps_ns(&self) -> i64 {
        self.0.steps_ns.load(Ordering::Relaxed)
    }

    /// Moves steady time (ns). Its readers never see it go back, so by less than the time since the last call.
    pub fn slew(&self, by_ns: i64) {
        self.0.base_ns.fetch_add(by_ns, Ordering::Relaxed);
    }

    /// From here on stamps show a step of the system clock (ns).
    pub fn step(&self, by_ns: i64) {
        self.0.steps_ns.fetch_add(by_ns, Ordering::Relaxed);
    }

    /// The stamp of this moment: nanoseconds since the epoch.
    pub fn now_ns(&self) -> u64 {
        let now = monotonic_ns().saturating_add_signed(self.base_ns());
        let steady = self.0.newest_ns.fetch_max(now, Ordering::Relaxed).max(now);
        steady.saturating_add_signed(self.steps_ns())
    }
}

/// The clock of a node; clones are one clock. Reading it neither waits nor locks.
#[derive(Clone, Debug, Default)]
pub struct Clock(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    /// The system's time for stamps; none: the system clock itself.
    host: Option<HostClock>,
    is_simulated: AtomicBool,
    /// The newest time of the simulation (ns); 0 before the first.
    simulated_ns: AtomicU64,
}

impl Clock {
    /// A clock that shows the time of `host`, if there is one, else that of the system clock.
    pub(super) fn of(host: Option<HostClock>) -> Self {
        Self(Arc::new(Inner { host, ..Inner::default() }))
    }

    /// Whether it shows the time of a simulation.
    pub fn is_simulated(&self) -> bool {
        self.0.is_simulated.load(Ordering::Acquire)
    }

    /// Present stamp (ns since the epoch); 0 before the first message of `/clock` under sim time.
    pub fn now_ns(&self) -> u64 {
        self.stamp_or(|| self.0.host.as_ref().map_or_else(system_ns, HostClock::now_ns))
    }

    /// What stamps of requests are judged by: the system clock itself, which their senders read, also in the moment after a step; else as
    /// [`Clock::now_ns`].
    pub fn request_ns(&self) -> u64 {
        self.stamp_or(system_ns)
    }

    /// The stamp of this moment as a message.
    pub fn now(&self) -> Time {
        time(self.now_ns())
    }

    /// As [`Clock::request_ns`], as a message.
    pub fn request_time(&self) -> Time {
        time(self.request_ns())
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

    /// Offsets differ by an hour, so that each value shows which one was used.
    #[test]
    fn stamps_show_a_step_once_it_is_in_force_and_requests_at_once() {
        let hour = 3_600_000_000_000;
        let host = HostClock::with_base(SystemOffset::read().ns - hour);
        let clock = Clock::of(Some(host.clone()));
        let ahead = |ns: u64| (ns.abs_diff(system_ns()) + 30_000_000_000) / hour.unsigned_abs();
        assert_eq!((ahead(clock.now_ns()), ahead(clock.request_ns())), (1, 0));
        host.step(hour);
        assert_eq!((ahead(clock.now_ns()), ahead(clock.request_ns())), (0, 0));
        host.step(-hour);
        assert_eq!((ahead(clock.now_ns()), host.steps_ns()), (1, 0));
        // A simulation knows no steps.
        clock.simulate(true);
        clock.set(&Time { sec: 5, nanosec: 0 });
        host.step(hour);
        assert_eq!((clock.now_ns(), clock.request_ns()), (5_000_000_000, 5_000_000_000));
    }

    #[test]
    fn slewing_back_never_shows_an_earlier_time() {
        let host = HostClock::default();
        let mut last = host.now_ns();
        for _ in 0..1000 {
            host.slew(-1_000_000);
            let now = host.now_ns();
            assert!(now >= last, "{now} {last}");
            last = now;
        }
    }

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
