//! Deadlines of the cycles, which follow the clock of the host or that of a backend.
//!
//! Law      deadline(k + 1) = deadline(k) + T + s(k), where T is the cycle time and s(k) the part of the pending shifts
//!          that cycle k applies: at most T / 1000 in either direction. The rest stays pending. Without a shift the
//!          deadlines are exactly start + k T. A cycle that ends later than the next deadline skips whole multiples of
//!          T, so the phase to a clock with period T is kept
//! Bound    the quartz of a device and that of the host differ by some 100 ppm at most, so T / 1000 (1000 ppm) follows
//!          it with a wide margin. The time of the machine stays k T, so a shift changes the velocity of all moving
//!          axes by s / T: with T = 1 ms an axis at 1 m/s feels at most 1 m/s^2 (with a bound of T / 16: 62 m/s^2). The
//!          price is the time to find a phase: at most T / 2, that is 500 cycles

/// Fraction of the cycle time by which a cycle may shift its successor.
const SHIFT_FRACTION: u64 = 1000;

/// Returns the maximum shift per cycle, in ns, in either direction.
pub fn shift_bound(cycle_ns: u64) -> i64 {
    (cycle_ns / SHIFT_FRACTION).cast_signed()
}

/// Deadlines of successive cycles, in ns of the monotonic clock.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// Cycle time, in ns.
    cycle_ns: u64,
    /// Deadline of the current cycle.
    deadline_ns: u64,
    /// Sum of the shifts that are not applied yet, in ns, positive for later.
    pending_ns: i64,
}

impl Schedule {
    /// Creates a schedule whose first cycle is due at `start_ns`. `cycle_ns` is positive.
    pub fn new(start_ns: u64, cycle_ns: u64) -> Self {
        Self { cycle_ns, deadline_ns: start_ns, pending_ns: 0 }
    }

    /// Returns the deadline of the current cycle, in ns of the monotonic clock.
    pub fn deadline(&self) -> u64 {
        self.deadline_ns
    }

    /// Returns the sum of the shifts that are not applied yet, in ns, positive for later.
    pub fn pending(&self) -> i64 {
        self.pending_ns
    }

    /// Returns how much later than its deadline the current cycle has begun, in ns; 0 if it was early.
    pub fn lateness(&self, woken_ns: u64) -> u64 {
        woken_ns.saturating_sub(self.deadline_ns)
    }

    /// Shifts the next deadline by this time, in ns, positive for later. The part that exceeds the bound shifts the
    /// deadlines after it.
    pub fn shift(&mut self, by_ns: i64) {
        self.pending_ns = self.pending_ns.saturating_add(by_ns);
    }

    /// Goes to the next cycle that has not been missed; `now_ns` is the end of the current one. Returns the number of
    /// missed cycles.
    pub fn advance(&mut self, now_ns: u64) -> u64 {
        let bound = shift_bound(self.cycle_ns);
        let applied = self.pending_ns.clamp(-bound, bound);
        self.pending_ns -= applied;
        self.deadline_ns = (self.deadline_ns + self.cycle_ns).saturating_add_signed(applied);
        let missed = now_ns.saturating_sub(self.deadline_ns) / self.cycle_ns;
        self.deadline_ns += missed * self.cycle_ns;
        missed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::backends::Backends;
    use lineshaft_core::drive::{Backend, Capabilities, Inputs, Outputs};
    use proptest::prelude::*;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};

    const START_NS: u64 = 1_234_567_891;
    const CYCLE_NS: u64 = 1_000_000;
    /// Bound of a cycle of 1 ms.
    const BOUND_NS: i64 = 1000;

    /// A backend with a clock of its own. Its exchange k is due when its clock has reached k cycles.
    struct ClockOwner {
        /// Time of the host, which the test sets.
        host_ns: Arc<AtomicU64>,
        /// Rate against the host, in ppm.
        ppm: i64,
        /// Sum of the jumps of its clock, in ns.
        jumped_ns: Arc<AtomicI64>,
        cycle: i64,
        /// Phase error of the last exchange, in ns, positive if it was late.
        error_ns: Arc<AtomicI64>,
    }

    impl Backend for ClockOwner {
        fn capabilities(&self, _: usize) -> Option<Capabilities> {
            None
        }

        fn read(&mut self, _: &mut Inputs) {
            let passed = (self.host_ns.load(Ordering::Relaxed) - START_NS).cast_signed();
            let own = (passed * (1_000_000 + self.ppm)).div_euclid(1_000_000) + self.jumped_ns.load(Ordering::Relaxed);
            self.error_ns.store(own - self.cycle * CYCLE_NS.cast_signed(), Ordering::Relaxed);
            self.cycle += 1;
        }

        fn write(&mut self, _: &Outputs) {}

        fn owns_clock(&self) -> bool {
            true
        }

        fn clock_shift(&mut self, pending_ns: i64) -> i64 {
            -self.error_ns.load(Ordering::Relaxed) - pending_ns
        }
    }

    /// Backends and schedule as in the cycle thread, without a thread and without waiting.
    struct Bench {
        backends: Backends,
        schedule: Schedule,
        host_ns: Arc<AtomicU64>,
        jumped_ns: Arc<AtomicI64>,
        error_ns: Arc<AtomicI64>,
    }

    impl Bench {
        fn without_owner() -> Self {
            let [jumped_ns, error_ns] = [(); 2].map(|()| Arc::<AtomicI64>::default());
            let (backends, schedule) = (Backends::default(), Schedule::new(START_NS, CYCLE_NS));
            Self { backends, schedule, host_ns: Arc::new(AtomicU64::new(START_NS)), jumped_ns, error_ns }
        }

        fn with_owner(ppm: i64) -> Self {
            let bench = Self::without_owner();
            let owner = ClockOwner {
                host_ns: Arc::clone(&bench.host_ns),
                ppm,
                jumped_ns: Arc::clone(&bench.jumped_ns),
                cycle: 0,
                error_ns: Arc::clone(&bench.error_ns),
            };
            Self { backends: bench.backends.with("owner", Box::new(owner)), ..bench }
        }

        /// Runs one cycle; returns by how much the next deadline differs from one cycle time later.
        fn run(&mut self) -> i64 {
            let deadline = self.schedule.deadline();
            self.host_ns.store(deadline, Ordering::Relaxed);
            self.backends.read(&mut Inputs::default());
            self.backends.write(&Outputs::default());
            self.schedule.shift(self.backends.clock_shift(self.schedule.pending()));
            assert_eq!(self.schedule.advance(deadline + CYCLE_NS / 10), 0);
            (self.schedule.deadline() - deadline).cast_signed() - CYCLE_NS.cast_signed()
        }

        /// Time from the first deadline to the current one, less the same number of cycle times, in ns.
        fn drift(&self, cycles: u64) -> i64 {
            (self.schedule.deadline() - START_NS).cast_signed() - (cycles * CYCLE_NS).cast_signed()
        }
    }

    #[test]
    fn without_an_owner_deadlines_are_start_plus_k_cycles() {
        let mut bench = Bench::without_owner();
        for cycle in 0..10_000 {
            assert_eq!(bench.schedule.deadline(), START_NS + cycle * CYCLE_NS);
            bench.run();
        }
    }

    /// The error is the drift of one cycle, 100 ns, because a shift acts one cycle after its measurement; 1 ns more by
    /// rounding. In 60 s of the owner, the host passes 60 s / 1.0001 or 60 s / 0.9999.
    #[test]
    fn deadlines_follow_a_clock_that_is_100_ppm_fast_or_slow() {
        let cases = [(100, -5_999_301..=-5_999_298), (-100, 6_000_499..=6_000_502), (0, 0..=0)];
        for (ppm, expected) in cases {
            let mut bench = Bench::with_owner(ppm);
            for cycle in 0..60_000 {
                let shift = bench.run();
                let error = bench.error_ns.load(Ordering::Relaxed);
                assert!(error.abs() <= 101 && shift.abs() <= 101, "{ppm} ppm, cycle {cycle}: {error} ns, {shift} ns");
                assert_eq!(bench.schedule.pending(), 0, "{ppm} ppm, cycle {cycle}");
            }
            let drift = bench.drift(60_000);
            assert!(expected.contains(&drift), "{ppm} ppm: {drift} ns");
        }
    }

    /// 10 ms at 1 us per cycle are 10,000 cycles, with the error that remains asked for again in each of them.
    #[test]
    fn jump_of_the_clock_by_10_ms_is_followed_in_10_000_cycles() {
        for (jump_ns, sign) in [(-10_000_000_i64, 1), (10_000_000, -1)] {
            let mut bench = Bench::with_owner(0);
            (0..1000).for_each(|_| assert_eq!(bench.run(), 0));
            bench.jumped_ns.store(jump_ns, Ordering::Relaxed);
            for cycle in 1..=10_000 {
                assert_eq!(bench.run(), sign * BOUND_NS, "cycle {cycle}");
                assert_eq!(bench.schedule.pending(), -jump_ns - sign * BOUND_NS * cycle, "cycle {cycle}");
            }
            assert_eq!(bench.drift(11_000), -jump_ns);
            (0..1000).for_each(|_| assert_eq!(bench.run(), 0));
            assert_eq!(bench.error_ns.load(Ordering::Relaxed), 0);
        }
    }

    #[test]
    fn lateness_is_measured_against_the_shifted_deadline() {
        let mut schedule = Schedule::new(START_NS, CYCLE_NS);
        for cycle in 1..=100 {
            schedule.shift(BOUND_NS);
            schedule.advance(schedule.deadline());
            let deadline = START_NS + cycle * (CYCLE_NS + 1000);
            assert_eq!(schedule.deadline(), deadline);
            assert_eq!([0, 300, 1_500_000].map(|late| schedule.lateness(deadline + late)), [0, 300, 1_500_000]);
            assert_eq!(schedule.lateness(deadline - 1), 0);
        }
    }

    #[test]
    fn missed_cycles_keep_the_phase_and_are_counted_against_the_shifted_deadline() {
        let mut schedule = Schedule::new(START_NS, CYCLE_NS);
        schedule.shift(400);
        // The next deadline, 1,000,400 ns after the start, is past by more than one cycle, but not by two.
        assert_eq!(schedule.advance(START_NS + 3_000_399), 1);
        assert_eq!(schedule.deadline(), START_NS + 2_000_400);
        assert_eq!(schedule.advance(START_NS + 5_000_400), 2);
        assert_eq!(schedule.deadline(), START_NS + 5_000_400);
        // A cycle that ends exactly at the next deadline misses none.
        assert_eq!(schedule.advance(START_NS + 6_000_400), 0);
        assert_eq!(schedule.deadline(), START_NS + 6_000_400);
    }

    #[test]
    fn bound_is_a_thousandth_of_the_cycle() {
        assert_eq!([125_000, 1_000_000, 20_000_000].map(shift_bound), [125, 1000, 20_000]);
    }

    proptest! {
        /// With the shifts a(1) .. a(k) and the bound B, what is left is at most the largest of |a(j) + .. + a(k)| -
        /// (k - j + 1) B and 0: the shifts since the last cycle in which nothing of this direction was left, less a
        /// whole bound for each cycle.
        #[test]
        fn all_shifts_are_applied_as_fast_as_the_bound_allows(
            cycle_ns in 125_000..=20_000_000_u64,
            asked in prop::collection::vec(prop_oneof![-30_000..30_000_i64, -10_000_000..10_000_000_i64, Just(0)], 1..80),
            busy in prop::collection::vec(prop_oneof![9 => 0..100_000_u64, 1 => 0..200_000_000_u64], 80),
        ) {
            let bound = shift_bound(cycle_ns);
            let mut schedule = Schedule::new(START_NS, cycle_ns);
            let (mut applied, mut skipped) = (0, 0);
            for (count, (&by, &busy)) in asked.iter().zip(&busy).enumerate() {
                let before = schedule.deadline();
                schedule.shift(by);
                let missed = schedule.advance(before + busy);
                let step = (schedule.deadline() - before).cast_signed() - ((1 + missed) * cycle_ns).cast_signed();
                prop_assert!(step.abs() <= bound);
                prop_assert!(schedule.deadline() > before);
                // The deadline is the first that is not a whole cycle in the past.
                prop_assert!(schedule.deadline() + cycle_ns > before + busy);
                (applied, skipped) = (applied + step, skipped + missed);
                let sum = asked[..=count].iter().sum::<i64>();
                prop_assert_eq!(schedule.pending(), sum - applied);
                let left = (0..=count).map(|first| {
                    asked[first..=count].iter().sum::<i64>().abs() - (count - first + 1) as i64 * bound
                });
                let most = left.max().unwrap_or(0).max(0);
                prop_assert!(schedule.pending().abs() <= most, "{} is left, {} at most", schedule.pending(), most);
            }
            let cycles = asked.len() as u64 + skipped;
            let expected = (START_NS + cycles * cycle_ns).cast_signed() + applied;
            prop_assert_eq!(schedule.deadline().cast_signed(), expected);
            // The rest takes one cycle for each bound, and no longer.
            let rest = schedule.pending();
            let cycles = rest.unsigned_abs().div_ceil(bound.unsigned_abs());
            for cycle in 0..cycles {
                prop_assert!(schedule.pending() != 0, "cycle {} of {}", cycle, cycles);
                schedule.advance(schedule.deadline());
            }
            prop_assert_eq!(schedule.pending(), 0);
        }
    }
}
