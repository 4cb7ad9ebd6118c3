//! Coupling by marks over a curve (SYNCMSTART 7): index pulses of a belt every 1000 inc, and of a roll with twice the
//! travel, every 2000 from 300 on.

use super::direction::set;
use super::marks::BeltAndRoll;
use super::rig::{Rig, X, at, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Synchronize};
use crate::encoder::PulseCheck;
use crate::object::{AxisSet, Leader};
use crate::sim::{Fixtures, Index};
use crate::sync::SyncMode;
use proptest::prelude::*;

const TO_BELT: Leader = Leader::Encoder(0);
/// Acceleration of goals without a given one (inc per cycle^2).
const ACCELERATION: f64 = 0.5;

fn by_marks(ratio: i64) -> Action {
    Action::Synchronize(Synchronize { mode: SyncMode::Marker, ..couple(X, TO_BELT, ratio, 1) })
}

/// Returns a rig whose roll is at rest at `place`, after it has passed an index pulse; the belt has run with `speed`
/// for 100 cycles.
fn world(place: i64, speed: i64, changes: &[(&str, i64)]) -> Rig {
    let mut config = config(0);
    config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 10 });
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 2_000, at: 300 }), ..Fixtures::default() });
    rig.enable();
    for target in [5_000, place] {
        rig.give(Action::Move(to(X, target)));
        rig.run(1_200);
    }
    assert_eq!(rig.int("x.command.position"), place);
    for changes in [&[("syncmpulsm", 1_000), ("syncmpulss", 2_000), ("syncmstart", 7)], changes] {
        let given = set(&mut rig, changes);
        assert!(rig.was_accepted(given), "{}", rig.refusal(given));
    }
    run(&mut rig, speed, 100);
    rig
}

/// Gives a command in a cycle in which the belt continues.
fn give(rig: &mut Rig, speed: i64, action: Action) -> u64 {
    rig.plant.jump_encoder(0, speed);
    rig.give(action)
}

fn run(rig: &mut Rig, speed: i64, cycles: usize) {
    for _ in 0..cycles {
        rig.plant.jump_encoder(0, speed);
        rig.run(1);
    }
}

/// Measured values of a smooth start.
#[derive(Debug)]
struct StartMeasurement {
    /// Travel of the belt during the wait, and on the curve.
    waited: i64,
    led: i64,
    /// Maxima of the axis (inc per cycle^2, inc per cycle), without signs.
    acceleration: f64,
    velocity: f64,
    /// Maximum backward travel in a cycle (inc).
    back: f64,
    /// Distance from the positions given by the marks at the end of the curve (inc).
    apart: i64,
}

/// Couples, and runs until the coupling is in sync; `change` gives a new speed of the belt and the number of cycles on
/// the curve after which it applies.
fn start(rig: &mut Rig, ratio: i64, speed: i64, change: Option<(u32, i64)>) -> StartMeasurement {
    let goal = give(rig, speed, by_marks(ratio));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    let mut seen = StartMeasurement { waited: 0, led: 0, acceleration: 0.0, velocity: 0.0, back: 0.0, apart: 0 };
    let mut before = rig.real("x.command.velocity") / 1e3;
    let (mut now, mut age) = (speed, 0);
    for _ in 0..3_000 {
        if rig.int("x.sync.waiting") != 0 {
            seen.waited += now.abs();
        } else {
            seen.led += now.abs();
            age += 1;
        }
        if let Some((_, later)) = change.filter(|(when, _)| age == *when) {
            now = later;
        }
        run(rig, now, 1);
        let velocity = rig.real("x.command.velocity") / 1e3;
        // One inc of the belt causes unevenness even at constant speed.
        seen.acceleration = seen.acceleration.max((velocity - before).abs());
        seen.velocity = seen.velocity.max(velocity.abs());
        let sense = (speed * ratio).signum() as f64;
        seen.back = seen.back.max(-velocity * sense);
        before = velocity;
        if rig.int("x.sync.waiting") == 0 && rig.int("x.in_sync") == 1 {
            // The belt has a mark at 0, the roll at 300.
            let apart = rig.int("x.command.position") - 300 - ratio * rig.int("belt.position");
            let apart = apart.rem_euclid(2_000);
            seen.apart = if apart > 1_000 { apart - 2_000 } else { apart };
            return seen;
        }
    }
    panic!("never in step: {seen:?}");
}

/// From rest at any position: the curve starts within two marks of the belt and ends with the marks together, without a
/// jump, a step back, or a violation of acceleration and jerk limits. Marks have nothing left to correct except the lag
/// of the drive, 20 inc.
/// Proves: MACS-MARK-14, MACS-MARK-15
#[test]
fn a_roll_at_rest_comes_to_its_marks_on_a_curve() {
    for (ratio, speed) in [(2, 10), (-2, 10), (2, -10), (-2, -10)] {
        for place in [300, 700, 1_234, 1_299, 1_300, 1_301, 2_299] {
            let mut rig = world(place, speed, &[]);
            let seen = start(&mut rig, ratio, speed, None);
            assert!(seen.waited <= 2_000 && seen.led > 0, "{place}: {seen:?}");
            assert!(seen.acceleration <= ACCELERATION * 1.001 && seen.back == 0.0, "{place}: {seen:?}");
            assert!(seen.apart.abs() <= 1, "{ratio} {speed} {place}: {seen:?}");
            run(&mut rig, speed, 1_000);
            assert!(rig.real("x.marker.error").abs() <= 1.0 && rig.int("x.in_sync") == 1);
            let first = rig.events.iter().find(|event| event.kind == crate::event::Kind::Mark).unwrap();
            let corrected = format!("{:?}", first.limit);
            assert!(corrected.contains("20") || corrected.contains("19."), "{corrected}");
        }
    }
}

/// At 10 inc per cycle and 1 : 2 a curve that ends by itself takes a distance of 1.5 * 2 * 10^2 / a: with a = 0.5 this
/// is 600, with 0.05 it is 6000, if the marks are at least that far away.
/// Proves: MACS-MARK-15, MACS-MARK-17
#[test]
fn acceleration_determines_number_of_marks() {
    for (acceleration, least, most) in [(500_000.0, 500, 2_000), (50_000.0, 5_500, 8_000), (10_000.0, 29_000, 33_000)] {
        let mut rig = world(1_234, 10, &[]);
        let request = Synchronize { mode: SyncMode::Marker, acceleration, ..couple(X, TO_BELT, 2, 1) };
        give(&mut rig, 10, Action::Synchronize(request));
        let mut led = 0;
        let mut before = rig.real("x.command.velocity");
        while rig.int("x.in_sync") == 0 && led < 100_000 {
            led += i64::from(rig.int("x.sync.waiting") == 0) * 10;
            run(&mut rig, 10, 1);
            let velocity = rig.real("x.command.velocity");
            assert!((velocity - before).abs() <= acceleration / 1e3 * 1.001);
            before = velocity;
        }
        assert!((least..=most).contains(&led), "{acceleration}: {led}");
    }
}

/// Returns the messages of the events that report a fallback from the smooth start.
fn fallbacks(rig: &Rig) -> Vec<String> {
    let told = rig.events.iter().filter(|event| event.code == Code::SMOOTH_START_FALLBACK);
    told.map(|event| crate::text::message(event, rig.machine.config())).collect()
}

/// A belt at rest, or a roll at rest without a mark so far: start 5 applies at once, with an event.
/// Proves: MACS-MARK-16
#[test]
fn without_a_speed_or_a_mark_it_is_start_five() {
    let mut rig = world(1_000, 10, &[]);
    run(&mut rig, 0, 1_000);
    let goal = rig.give(by_marks(2));
    run(&mut rig, 0, 51);
    assert!(rig.was_accepted(goal));
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
    assert_eq!(fallbacks(&rig), ["x: syncmstart 7 falls back to 5: the leader is slower than 1 inc in 50 ms"]);
    run(&mut rig, 10, 1_500);
    assert_eq!((rig.int("x.in_sync"), rig.real("x.marker.error").abs() < 1.0), (1, true));

    let mut config = config(0);
    config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 10 });
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 2_000, at: 300 }), ..Fixtures::default() });
    rig.enable();
    set(&mut rig, &[("syncmpulsm", 1_000), ("syncmpulss", 2_000), ("syncmstart", 1_007)]);
    run(&mut rig, 10, 100);
    rig.give(by_marks(2));
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
    run(&mut rig, 10, 1_500);
    assert_eq!((rig.int("x.in_sync"), rig.real("x.marker.error").abs() < 1.0), (1, true));
    let sentence = "x: syncmstart 1007 falls back to 1005: the axis rests, and no mark of it is known";
    assert_eq!(fallbacks(&rig), [sentence]);
}

/// A roll in motion whose drive gives no index pulse: 8 groups of 1000 inc at 10 inc per cycle pass in 800 cycles.
/// Proves: MACS-MARK-16
#[test]
fn fallback_after_eight_groups_is_an_event() {
    let mut config = config(0);
    config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 10 });
    let mut rig = Rig::of(config);
    rig.enable();
    set(&mut rig, &[("syncmpulsm", 1_000), ("syncmpulss", 2_000), ("syncmstart", 7)]);
    give(&mut rig, 10, Action::Move(at(X, 1_000.0)));
    run(&mut rig, 10, 100);
    give(&mut rig, 10, by_marks(2));
    run(&mut rig, 10, 790);
    assert_eq!((rig.int("x.sync.waiting") != 0, fallbacks(&rig).len()), (true, 0));
    run(&mut rig, 10, 20);
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
    let why = "within 8 groups of marks of the leader no curve was within the limits of the axis";
    assert_eq!(fallbacks(&rig), [format!("x: syncmstart 7 falls back to 5: {why}")]);
}

/// The belt becomes faster on the curve: at 5 % the curve is kept, and ends at the right position; at 20 % it is
/// aborted, without a jump, and marks correct the rest.
/// Proves: MACS-MARK-16
#[test]
fn a_master_that_changes_its_speed_ends_the_curve() {
    let mut rig = world(1_234, 20, &[]);
    let seen = start(&mut rig, 2, 20, Some((30, 21)));
    assert!(seen.apart.abs() <= 1 && fallbacks(&rig).is_empty(), "{seen:?}");
    for later in [24, 14] {
        let mut rig = world(1_234, 20, &[]);
        give(&mut rig, 20, by_marks(2));
        while rig.int("x.sync.waiting") != 0 {
            run(&mut rig, 20, 1);
        }
        run(&mut rig, 20, 30);
        assert_eq!(rig.int("x.in_sync"), 0);
        let mut before = rig.real("x.command.velocity") / 1e3;
        let mut steepest: f64 = 0.0;
        for _ in 0..3_000 {
            run(&mut rig, later, 1);
            let velocity = rig.real("x.command.velocity") / 1e3;
            steepest = steepest.max((velocity - before).abs());
            before = velocity;
        }
        // Half an increment in each cycle, plus the resolution of a count of the belt.
        assert!(steepest <= 2.51, "{steepest}");
        let why = "the velocity of the leader has changed by more than 10 % on the curve";
        assert_eq!(fallbacks(&rig), [format!("x: syncmstart 7 falls back to 5: {why}")]);
        assert_eq!(rig.int("x.in_sync"), 1);
        assert!(rig.real("x.marker.error").abs() < 2.0, "{}", rig.real("x.marker.error"));
    }
}

/// From another motion, whose own index pulses give the positions of the marks; and from another coupling to the same
/// belt.
/// Proves: MACS-MARK-15
#[test]
fn it_begins_from_any_motion() {
    for jog in [4_000.0, -3_000.0, 30_000.0] {
        let mut rig = world(1_234, 10, &[]);
        give(&mut rig, 10, Action::Move(at(X, jog)));
        run(&mut rig, 10, 500);
        let seen = start(&mut rig, 2, 10, None);
        assert!(seen.apart.abs() <= 1 && seen.acceleration <= ACCELERATION * 1.001, "{jog}: {seen:?}");
    }
    let mut rig = world(1_234, 10, &[]);
    give(&mut rig, 10, Action::Synchronize(Synchronize { mode: SyncMode::Position, ..couple(X, TO_BELT, 2, 1) }));
    run(&mut rig, 10, 500);
    let seen = start(&mut rig, 2, 10, None);
    assert!(seen.apart.abs() <= 1 && seen.acceleration <= ACCELERATION * 1.001, "{seen:?}");
}

/// A mark of the master half-way between two increments: the fraction of the pair is included in the curve; otherwise 1
/// inc of the roll would be missing.
/// Proves: MACS-MARK-15
#[test]
fn a_pair_between_two_increments_is_met() {
    let mut world = BeltAndRoll::new(500.5, &[("syncmstart", 7)]);
    world.rig.give(Action::Move(at(X, 3_000.0)));
    world.record_position();
    world.run(800, 10);
    world.couple();
    while world.rig.int("x.sync.waiting") != 0 || world.rig.int("x.in_sync") == 0 {
        world.cycle(10);
    }
    // Labels are at 300 and every 2000 after it, products at 500.5.
    let place = world.rig.int("x.command.position") as f64 + world.rig.real("x.command.fraction");
    let apart = (place - 300.0 - 2.0 * (world.belt as f64 - 500.5) + 1_000.0).rem_euclid(2_000.0) - 1_000.0;
    assert!(apart.abs() < 0.5, "{apart}");
}

/// The offset is in force once the curve has ended.
/// Proves: MACS-SYNC-13
#[test]
fn an_offset_comes_behind_the_curve() {
    for number in [7, 1_007] {
        let mut rig = world(1_234, 10, &[("syncposoffs", 40), ("syncmstart", number)]);
        let seen = start(&mut rig, 2, 10, None);
        assert!((seen.apart - 80).abs() <= 1, "{seen:?}");
        run(&mut rig, 10, 1_500);
        // Ahead by 40 inc of the belt, and by the lag of the drive, 20 inc.
        let apart = (rig.int("x.command.position") - 300 - 2 * rig.int("belt.position")).rem_euclid(2_000);
        assert!((apart - 100).abs() <= 1, "{apart}");
    }
}

/// The goal of a coupling that falls back, and of one whose curve has started, remains active until it is cancelled,
/// and ends once.
#[test]
fn its_goal_ends_once() {
    for stands in [true, false] {
        let mut rig = world(1_234, 10, &[]);
        let speed = if stands { 0 } else { 10 };
        run(&mut rig, speed, 1_000);
        let goal = give(&mut rig, speed, by_marks(2));
        run(&mut rig, speed, 500);
        assert_eq!((rig.done(goal).len(), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
        rig.give(Action::Cancel { goal });
        rig.run(100);
        assert_eq!((rig.done(goal).len(), rig.state("x")), (1, "STANDSTILL"));
    }
}

/// During the wait a cancel, a halt or an error ends it; a lost belt, too.
#[test]
fn the_wait_ends_as_any_wait_does() {
    type Way = fn(&mut Rig, u64);
    let ways: [Way; 4] = [
        |rig, _| assert!(rig.give(Action::Halt(AxisSet::one(X))) > 0),
        |rig, goal| assert!(rig.give(Action::Cancel { goal }) > 0),
        |rig, _| rig.plant.drive(0).unwrap().inject_fault(0x8611),
        |rig, _| rig.modify_inputs = |inputs| inputs.encoder.iter_mut().for_each(|encoder| encoder.valid = false),
    ];
    for (place, end) in ways.iter().enumerate() {
        let mut rig = world(300, 10, &[]);
        give(&mut rig, 10, Action::Move(at(X, 1.0)));
        let goal = give(&mut rig, 10, by_marks(2));
        run(&mut rig, 10, 3);
        assert_eq!(rig.int("x.sync.waiting"), goal as i64);
        end(&mut rig, goal);
        run(&mut rig, 10, 5);
        assert_eq!((rig.int("x.sync.waiting"), rig.done(goal).len()), (0, 1), "{place}");
        assert_ne!(rig.done(goal)[0].code, Code::NONE);
    }
}

/// Parameter changes during the wait do not affect the start, except a distance of 0: then it falls back at once.
/// Proves: MACS-MARK-14
#[test]
fn parameters_during_wait_do_not_change_start() {
    for (key, value, waits) in [("syncmstart", 4, true), ("syncmstart", 3, true), ("syncmpulsm", 0, false)] {
        let mut rig = world(1_234, 10, &[]);
        let goal = give(&mut rig, 10, by_marks(2));
        run(&mut rig, 10, 2);
        assert_eq!(rig.int("x.sync.waiting"), goal as i64);
        rig.plant.jump_encoder(0, 10);
        set(&mut rig, &[(key, value)]);
        run(&mut rig, 10, 2);
        assert_eq!(rig.int("x.sync.waiting") != 0, waits, "{key}");
        run(&mut rig, 10, 2_000);
        assert_eq!(rig.int("x.in_sync"), 1);
        if waits {
            // Only the lag of the drive was corrected.
            let apart = (rig.int("x.command.position") - 300 - 2 * rig.int("belt.position")).rem_euclid(2_000);
            assert!((apart - 20).abs() <= 1, "{key} {value}: {apart}");
        }
    }
}

/// With a filter, on a belt that shows 10 or 11 counts: the filter starts with the speed measured during the wait.
/// Proves: MACS-MARK-15
#[test]
fn a_filter_begins_with_the_speed_that_is_known() {
    let mut rig = world(1_234, 10, &[("syncvftime", -20_000)]);
    let goal = give(&mut rig, 10, by_marks(2));
    for cycle in 0..1_000 {
        run(&mut rig, 10 + cycle % 2, 1);
        if rig.int("x.sync.waiting") == 0 && rig.int("x.in_sync") == 1 {
            break;
        }
    }
    assert!(rig.done(goal).is_empty());
    let apart = (rig.int("x.command.position") - 300 - 2 * rig.int("belt.position") + 1_000).rem_euclid(2_000) - 1_000;
    assert!(apart.abs() <= 3, "{apart}");
}

/// A machine restored from any point of a recording gives the same results: during the wait, and on the curve.
#[test]
fn smooth_start_is_restored() {
    for cycles in [5, 80, 130] {
        let mut rig = world(1_000, 10, &[]);
        give(&mut rig, 10, by_marks(2));
        run(&mut rig, 10, cycles);
        rig.mirror();
        run(&mut rig, 10, 500);
        assert_eq!(rig.int("x.in_sync"), 1);
    }
}

/// The nearest mark is so near that a curve to it would start backwards: the next group of marks is used.
/// Proves: MACS-MARK-15
#[test]
fn an_axis_at_rest_never_starts_backwards() {
    let mut rig = world(2_416, 18, &[]);
    run(&mut rig, 18, 18);
    let seen = start(&mut rig, -2, 18, None);
    assert!(seen.back == 0.0 && seen.apart.abs() <= 1, "{seen:?}");
}

proptest! {
    #![proptest_config(super::rig::cases(24))]
    /// With any rest position of the roll and any speed of the belt: the curve ends with the marks together, within the
    /// limits, and never moves backwards.
    /// Proves: MACS-MARK-15
    #[test]
    fn marks_come_together_from_anywhere(place in 0_i64..4_000, speed in 3_i64..40, turned in any::<bool>(), up in any::<bool>(), old in 0_usize..300) {
        let (ratio, speed) = (if turned { -2 } else { 2 }, if up { speed } else { -speed });
        let mut rig = world(place, speed, &[]);
        run(&mut rig, speed, old);
        let seen = start(&mut rig, ratio, speed, None);
        prop_assert!(seen.apart.abs() <= 1, "{seen:?}");
        prop_assert!(seen.acceleration <= ACCELERATION * 1.001 && seen.back == 0.0 && seen.velocity <= 100.0, "{seen:?}");
        prop_assert!(seen.waited <= 2_000 + 60 * speed.abs(), "{seen:?}");
    }
}
