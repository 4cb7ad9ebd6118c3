//! Tests the clock without setting it: the base of the stamps is wrong instead, which needs the same correction.

use super::*;
use crate::cell::Cell;
use crate::run::lanes::{CommandQueues, lanes};
use crate::run::trials::trials;
use lineshaft_core::command::Command;
use lineshaft_core::machine::Machine;
use lineshaft_ros::surface::host::Host;
use proptest::prelude::*;
use std::sync::mpsc::channel;

const MS: i64 = 1_000_000;
const HOUR: i64 = 3_600_000 * MS;

#[test]
fn more_than_50_ms_is_a_step_and_less_is_followed_by_a_twentieth_of_the_time() {
    let after = |difference_ns, error_ns| Correction::of(difference_ns, error_ns, Duration::from_millis(50));
    assert_eq!(after(0, 0), Correction::Nothing);
    assert_eq!(after(-300, 300), Correction::Nothing, "nobody knows it so exactly");
    assert_eq!(after(301, 300), Correction::Slew(301));
    assert_eq!(after(2 * MS, 300), Correction::Slew(2 * MS));
    // 50 ms / 20.
    assert_eq!(after(50 * MS, 0), Correction::Slew(2_500_000));
    assert_eq!(after(-50 * MS, 0), Correction::Slew(-2_500_000));
    assert_eq!(after(50 * MS + 1, 0), Correction::Step(50 * MS + 1));
    assert_eq!(after(-200 * MS, 300), Correction::Step(-200 * MS));
    assert_eq!(after(60 * MS, 10_000_000), Correction::Slew(2_500_000), "it may be 50 ms");
    for step in [5_000 * MS, HOUR, -HOUR, i64::MAX, i64::MIN] {
        assert_eq!(after(step, 300), Correction::Step(step));
    }
}

proptest! {
    /// A host clock that NTP slews (at most 500 ppm in the kernel), read with errors: stamps follow it within a
    /// millisecond, and no step is reported.
    #[test]
    fn slewing_is_followed_without_a_step(
        ppm in -500_i64..=500,
        errors in prop::collection::vec((0_u64..200_000, -1.0..1.0), 1..400),
    ) {
        let (mut system, mut shown) = (0, 0);
        for (error_ns, part) in errors {
            system += ppm * 50_000_000 / 1_000_000;
            let read = system + (part * error_ns as f64) as i64;
            match Correction::of(read - shown, error_ns, Duration::from_millis(50)) {
                Correction::Nothing => {}
                Correction::Slew(by) => shown += by,
                Correction::Step(by) => prop_assert!(false, "step by {by}"),
            }
            prop_assert!((system - shown).abs() < MS, "{system} {shown}");
        }
    }

    /// For any changes of the clock, log times grow by one cycle per cycle, within 1/16, and stamps differ from them
    /// only by the steps.
    #[test]
    fn log_times_grow_with_each_cycle_and_stamps_step(
        cycle_ns in prop::sample::select(vec![50_000_u64, 125_000, 1_000_000, 20_000_000]),
        changes in prop::collection::vec((1_u64..4, -60 * MS..60 * MS, prop::option::of(-HOUR..HOUR)), 1..300),
    ) {
        let clock = HostClock::with_base(1_700_000_000_000 * MS);
        let mut cycles = CycleClock::new(clock.clone());
        let (mut deadline, mut steps) = (10 * cycle_ns, 0);
        let mut last = cycles.at(deadline, cycle_ns);
        prop_assert_eq!(last.log_ns, last.stamp_ns);
        for (passed, slew, step) in changes {
            clock.slew(slew);
            if let Some(step) = step {
                clock.step(step);
                steps += step;
            }
            deadline += passed * cycle_ns;
            let time = cycles.at(deadline, cycle_ns);
            let grown = time.log_ns - last.log_ns;
            prop_assert!(grown >= passed * cycle_ns - cycle_ns / 16 && grown <= passed * cycle_ns + cycle_ns / 16);
            prop_assert_eq!(time.ahead_ns(), steps);
            last = time;
        }
    }
}

#[test]
fn cycles_catch_up_with_a_slewed_clock() {
    let clock = HostClock::with_base(1000 * HOUR);
    let mut cycles = CycleClock::new(clock.clone());
    clock.slew(-MS);
    // 1/16 of each cycle of 1 ms.
    let behind = |cycle: u64, cycles: &mut CycleClock| {
        let deadline = cycle * MS.unsigned_abs();
        cycles.at(deadline, MS.unsigned_abs()).log_ns.cast_signed() - (1000 * HOUR - MS + deadline.cast_signed())
    };
    assert_eq!([1, 2, 3].map(|cycle| behind(cycle, &mut cycles)), [937_500, 875_000, 812_500]);
    // The correction takes 16 cycles.
    assert_eq!((4..=16).map(|cycle| behind(cycle, &mut cycles)).min(), Some(0));
    assert_eq!(behind(17, &mut cycles), 0);
}

/// A clock that is wrong by `wrong_ns`, and the machine to which it is reported.
struct Rig {
    watch: ClockWatch,
    clock: HostClock,
    handle: Handle,
    lanes: CommandQueues,
}

impl Rig {
    fn new(wrong_ns: i64) -> Self {
        let machine = Machine::new(Cell::demo().machine).unwrap();
        let (config, directory) = (machine.config().clone(), machine.directory().clone());
        let (commander, lanes) = lanes(config.axes.len());
        let signals = triple_buffer::triple_buffer(&Default::default()).1;
        let handle = Handle::new(config, directory, commander, trials().0, channel().0, signals, Default::default());
        let clock = HostClock::with_base(SystemOffset::read().ns + wrong_ns);
        Self { watch: ClockWatch::new(clock.clone()), clock, handle, lanes }
    }

    /// Watches until a condition is true; returns the time that this took.
    fn until(&mut self, holds: impl Fn(&mut Self) -> bool) -> Duration {
        let start = Instant::now();
        while !holds(self) {
            assert!(start.elapsed() < Duration::from_secs(30), "{:?}", self.watch);
            self.watch.look(&self.handle);
            std::thread::sleep(Duration::from_millis(1));
        }
        start.elapsed()
    }

    fn is_right(&mut self) -> bool {
        let shown = self.clock.base_ns() + self.clock.steps_ns();
        (shown - SystemOffset::read().ns).abs() < 50 * MS
    }

    /// Returns the commands submitted to the machine since the last call.
    fn given(&mut self) -> Vec<Command> {
        self.lanes.take();
        self.lanes.drain().1.collect()
    }
}

/// Returns the step in ns, once it was submitted, and its command number.
fn noted(rig: &mut Rig) -> (i64, u64) {
    rig.until(|rig| !rig.lanes.are_empty());
    let given = rig.given();
    let [Command { sequence, source: Source::Machine, action: Action::Note { code: Code::CLOCK_STEPPED, number } }] =
        &given[..]
    else {
        panic!("{given:?}")
    };
    (*number, *sequence)
}

#[test]
fn stamps_show_a_step_only_after_its_event_was_published() {
    for wrong in [HOUR, -HOUR, -5000 * MS, 200 * MS] {
        let mut rig = Rig::new(wrong);
        let (step, sequence) = noted(&mut rig);
        assert!((step + wrong).abs() < 40 * MS, "{step} {wrong}");
        for _ in 0..5 {
            rig.watch.look(&rig.handle);
        }
        assert_eq!((rig.clock.steps_ns(), rig.given().len()), (0, 0), "not before it is reported, and once");
        let event =
            Event::new(Severity::Warn, Kind::Warning, Object::Machine, Code::CLOCK_STEPPED).of_command(sequence);
        rig.handle.published(&event);
        assert!(rig.until(|rig| rig.clock.steps_ns() != 0) >= HOLD);
        assert_eq!(rig.clock.steps_ns(), step);
        assert!(rig.is_right() && rig.given().is_empty());
    }
}

#[test]
fn step_whose_event_is_never_published_is_followed_within_a_second() {
    let (mut rig, start) = (Rig::new(HOUR), Instant::now());
    noted(&mut rig);
    rig.until(Rig::is_right);
    assert!(start.elapsed() >= PATIENCE + HOLD);
    // Of LOOK, PATIENCE and HOLD.
    assert!(POLL_INTERVAL + PATIENCE + HOLD < Duration::from_secs(1));
}

#[test]
fn without_cycles_a_step_is_followed_and_no_command_is_given() {
    let mut rig = Rig::new(-HOUR);
    rig.handle = rig.handle.unconfigured();
    assert!(rig.until(Rig::is_right) >= HOLD);
    assert!(rig.given().is_empty());
}

#[test]
fn small_difference_is_followed_without_an_event() {
    let mut rig = Rig::new(20 * MS);
    let looked = rig.until(|rig| (rig.clock.base_ns() - SystemOffset::read().ns).abs() < 2 * MS);
    // 18 of 20 ms at most, at 1/20 of the elapsed time.
    assert!(looked >= Duration::from_millis(18 * 20 - 50), "{looked:?}");
    assert_eq!((rig.clock.steps_ns(), rig.given().len()), (0, 0));
}

#[test]
fn sentence_without_cycles_is_that_of_the_event() {
    let rig = Rig::new(0);
    assert_eq!(sentence(-HOUR, &rig.handle), "machine: the system clock was set back by 3600.000 s; stamps follow");
}
