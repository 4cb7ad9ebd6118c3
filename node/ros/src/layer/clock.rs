//! Clocks for stamps: system time or simulation time.
//!
//! Law      stamps of system time are the monotonic clock plus an offset ([`HostClock`]). The owner of the host clock adjusts the offset to
//!          the system clock, and reports a step before stamps include it. Requests of other nodes are checked with the system clock itself

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};

use lineshaft_msgs::foreign::builtin_interfaces::msg::Time;

use crate::link::protocol::monotonic_ns;
use crate::offset::{SystemOffset, system_ns};

/// Returns the system time; the epoch if the clock is before it.
pub fn now() -> Time {
    time(system_ns())
}

/// Returns a time as a message; the seconds fit until 2038, as in ROS 2.
fn time(ns: u64) -> Time {
    Time { sec: i32::try_from(ns / 1_000_000_000).unwrap_or(i32::MAX), nanosec: (ns % 1_000_000_000) as u32 }
}

/// Returns the nanoseconds of a message; a time before the epoch is the epoch.
fn nanoseconds(time: &Time) -> u64 {
    u64::try_from(time.sec).map_or(0, |sec| sec * 1_000_000_000 + u64::from(time.nanosec))
}

/// System time for stamps. Clones share one clock. Reading it neither waits nor locks.
///
/// Steady time is system time without the steps of the system clock since the start: it never goes back.
#[derive(Clone, Debug)]
pub struct HostClock(Arc<Offsets>);

#[derive(Debug)]
struct Offsets {
    /// Steady time minus monotonic clock, in ns.
    base_ns: AtomicI64,
    /// Sum of the steps that stamps include, in ns.
    steps_ns: AtomicI64,
    /// Newest steady time that was read, in ns.
    newest_ns: AtomicU64,
}

impl Default for HostClock {
    /// Creates a clock that starts at the present system time and follows the monotonic clock.
    fn default() -> Self {
        Self::with_base(SystemOffset::read().ns)
    }
}

impl HostClock {
    /// Creates a clock whose steady time is ahead of the monotonic clock by `base_ns`.
    pub fn with_base(base_ns: i64) -> Self {
        Self(Arc::new(Offsets {
            base_ns: AtomicI64::new(base_ns),
            steps_ns: AtomicI64::new(0),
            newest_ns: AtomicU64::new(0),
        }))
    }

    /// Returns how far steady time is ahead of the monotonic clock, in ns.
    pub fn base_ns(&self) -> i64 {
        self.0.base_ns.load(Ordering::Relaxed)
    }

    /// Returns the sum of the steps that stamps include, in ns: how far they are ahead of steady time.
    pub fn steps_ns(&self) -> i64 {
        self.0.steps_ns.load(Ordering::Relaxed)
    }

    /// Adjusts steady time, in ns. Readers never see it go back, so a negative adjustment must be smaller than the time since the last
    /// call.
    pub fn slew(&self, by_ns: i64) {
        self.0.base_ns.fetch_add(by_ns, Ordering::Relaxed);
    }

    /// Adds a step of the system clock to all following stamps, in ns.
    pub fn step(&self, by_ns: i64) {
        self.0.steps_ns.fetch_add(by_ns, Ordering::Relaxed);
    }

    /// Returns the present stamp, in ns since the epoch.
    pub fn now_ns(&self) -> u64 {
        let now = monotonic_ns().saturating_add_signed(self.base_ns());
        let steady = self.0.newest_ns.fetch_max(now, Ordering::Relaxed).max(now);
        steady.saturating_add_signed(self.steps_ns())
    }
}

/// Clock of a node. Clones share one clock. Reading it neither waits nor locks.
#[derive(Clone, Debug, Default)]
pub struct Clock(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    /// System time for stamps; `None`: the system clock itself.
    host: Option<HostClock>,
    is_simulated: AtomicBool,
    /// Newest simulation time, in ns; 0 before the first one.
    simulated_ns: AtomicU64,
}

impl Clock {
    /// Creates a clock with the time of `host`, or of the system clock if there is none.
    pub(super) fn of(host: Option<HostClock>) -> Self {
        Self(Arc::new(Inner { host, ..Inner::default() }))
    }

    /// Returns true if the clock uses simulation time.
    pub fn is_simulated(&self) -> bool {
        self.0.is_simulated.load(Ordering::Acquire)
    }

    /// Returns the present stamp, in ns since the epoch; 0 before the first message of `/clock` with simulation time.
    pub fn now_ns(&self) -> u64 {
        self.stamp_or(|| self.0.host.as_ref().map_or_else(system_ns, HostClock::now_ns))
    }

    /// Returns the time with which stamps of requests are compared: the system clock, which their senders use, also right after a step;
    /// with simulation time as [`Clock::now_ns`].
    pub fn request_ns(&self) -> u64 {
        self.stamp_or(system_ns)
    }

    /// Returns the present stamp as a message.
    pub fn now(&self) -> Time {
        time(self.now_ns())
    }

    /// Returns [`Clock::request_ns`] as a message.
    pub fn request_time(&self) -> Time {
        time(self.request_ns())
    }

    /// Returns the stamp, in ns, of an event at `system_ns` of system time: that time itself, or the newest simulation time, which has no
    /// values between its messages.
    pub fn stamp(&self, system_ns: u64) -> u64 {
        self.stamp_or(|| system_ns)
    }

    fn stamp_or(&self, system_ns: impl FnOnce() -> u64) -> u64 {
        if self.is_simulated() { self.0.simulated_ns.load(Ordering::Acquire) } else { system_ns() }
    }

    /// Switches to simulation time, which starts unknown, or back to system time.
    pub(super) fn simulate(&self, is_simulated: bool) {
        self.0.simulated_ns.store(0, Ordering::Release);
        self.0.is_simulated.store(is_simulated, Ordering::Release);
    }

    /// Sets the simulation time; it may go forward, go back, or stop.
    pub(super) fn set(&self, now: &Time) {
        self.0.simulated_ns.store(nanoseconds(now), Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The offsets differ by an hour, so that each value shows which one was used.
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
        // Simulation time has no steps.
        clock.simulate(true);
        clock.set(&Time { sec: 5, nanosec: 0 });
        host.step(hour);
        assert_eq!((clock.now_ns(), clock.request_ns()), (5_000_000_000, 5_000_000_000));
    }

    #[test]
    fn slewing_back_never_decreases_time() {
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
    fn simulation_time_starts_with_first_message() {
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
        // Simulation time goes back.
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
