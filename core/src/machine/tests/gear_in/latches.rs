//! Gears that wait for a latch (freeze start).

use super::*;
use crate::drive::{Edge, Latch};
use crate::object::Object;

const MARK: Object = Object::Io(0);

fn latch(rig: &mut Rig, object: Object, edge: Edge, age_ns: u32) {
    assert!(rig.plant.add_latch(Latch { object, edge, age_ns: Some(age_ns), position: None }));
}

fn on_event(numerator: i64, denominator: i64) -> Action {
    geared(numerator, denominator, Engage::OnEvent(MARK))
}

/// Other edges, other objects and latches in the cycle of the command do not count; of several latches the first
/// counts.
#[test]
fn the_first_rising_latch_behind_the_command_engages() {
    let mut rig = rig();
    rig.give(line(90_000, 20.0));
    rig.run(100);
    latch(&mut rig, MARK, Edge::Rising, 0);
    let goal = rig.give(on_event(1, 1));
    assert!(rig.was_accepted(goal));
    latch(&mut rig, MARK, Edge::Falling, 10);
    latch(&mut rig, Object::Io(1), Edge::Rising, 10);
    rig.run(5);
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (goal as i64, "STANDSTILL"));
    latch(&mut rig, MARK, Edge::Rising, 250_000);
    latch(&mut rig, MARK, Edge::Rising, 750_000);
    latch(&mut rig, MARK, Edge::Rising, 500_000);
    rig.run(1);
    assert_eq!((rig.int("x.sync.waiting"), rig.state("x")), (0, "SYNCHRONIZED_MOTION"));
    // 15 of the 20 inc of that cycle count.
    let origin = place(&rig, LINE) - Position::whole(15);
    rig.run(200);
    assert_eq!((place(&rig, X), rig.int("x.in_sync")), (place(&rig, LINE) - origin, 1));
    // Another latch does not engage it again.
    latch(&mut rig, MARK, Edge::Rising, 250_000);
    rig.run(50);
    assert_eq!((place(&rig, X), rig.done(goal).len()), (place(&rig, LINE) - origin, 0));
}

/// With the same ratio it continues; with another ratio it catches up what one cycle cannot provide, without a warning.
#[test]
fn another_ratio_at_a_latch_is_no_loss_of_synchronism() {
    for (numerator, cycles) in [(1, 1), (20, 400), (-5, 400)] {
        let mut rig = rig();
        rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 5)));
        rig.give(line(90_000, 15.0));
        rig.run(300);
        let goal = rig.give(on_event(numerator, 5));
        rig.run(5);
        latch(&mut rig, MARK, Edge::Rising, 400_000);
        rig.run(1);
        assert_eq!((rig.int("x.sync.waiting"), rig.int("x.in_sync")), (0, i64::from(numerator == 1)));
        watch(&mut rig, cycles, |_| {});
        assert_eq!((rig.int("x.in_sync"), warnings(&rig), rig.done(goal).len()), (1, 0, 0), "{numerator}");
    }
}

/// A position captured by the encoder itself counts, independent of the age.
#[test]
fn a_captured_position_of_the_leader_is_where_it_counts_from() {
    let mut rig = rig();
    let engage = Engage::OnEvent(Object::Encoder(0));
    rig.give(Action::Synchronize(Synchronize { engage, ..couple(X, Leader::Encoder(0), 1, 3) }));
    for k in 0..200 {
        rig.plant.jump_encoder(0, 30);
        if k == 10 {
            let position = Some(rig.int("belt.position") + 7);
            let latch = Latch { object: Object::Encoder(0), edge: Edge::Rising, age_ns: Some(5), position };
            assert!(rig.plant.add_latch(latch));
        }
        rig.run(1);
    }
    let captured = 10 * 30 + 7;
    let way = i128::from(rig.int("belt.position") - captured) << 32;
    assert_eq!((place(&rig, X).raw(), rig.int("x.in_sync")), (way.div_euclid(3), 1));
}

#[test]
fn what_waits_for_a_latch_ends_as_any_wait_does() {
    let mut rig = rig();
    let first = rig.give(on_event(1, 1));
    let second = rig.give(on_event(1, 2));
    assert_eq!(rig.done(first)[0].code, Code::REPLACED);
    rig.give(Action::Cancel { goal: second });
    assert_eq!(rig.done(second)[0].code, Code::CANCELLED);
    latch(&mut rig, MARK, Edge::Rising, 0);
    rig.run(2);
    assert_eq!(rig.state("x"), "STANDSTILL");
    // A drive that cannot latch.
    let mut config = config(0);
    if let Some(drive) = &mut config.axes[usize::from(Y)].drive {
        drive.latches = false;
    }
    let mut rig = Rig::of(config);
    rig.enable();
    let none = rig.give(geared(1, 1, Engage::OnEvent(Object::Axis(Y))));
    assert_eq!(rig.answer(none).expect_err("refused").code, Code::LATCH_NOT_OFFERED);
}

/// In mode VELOCITY it starts at the latch, and has no position to reach.
#[test]
fn by_velocity_a_latch_begins_it() {
    let mut rig = rig();
    rig.give(line(90_000, 20.0));
    rig.run(100);
    let engage = Engage::OnEvent(MARK);
    rig.give(Action::Synchronize(Synchronize { engage, mode: SyncMode::Velocity, ..couple(X, TO_LINE, -1, 2) }));
    latch(&mut rig, MARK, Edge::Rising, 300_000);
    rig.run(1);
    assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
    rig.run(100);
    assert_eq!((rig.real("x.command.velocity"), rig.int("x.sync.error")), (-10_000.0, 0));
}

proptest! {
    #![proptest_config(cases(48))]

    /// For any age of the latch, ratio and velocity of the line: after the latch the slave is at its former position +
    /// ratio * (leader now - leader at the latch), to 2^-32 inc. From a gear of the same leader it continues from the
    /// gear position at the latch.
    ///
    /// Proves: AMC-EVT-05
    #[test]
    fn nothing_between_latch_and_cycle_is_lost(
        age in 0_u32..1_000_000,
        (numerator, denominator) in (prop::sample::select(vec![1_i64, -2, 113, -355]), prop::sample::select(vec![7_i64, 997, 113])),
        speed in 1.0..15.0_f64,
        before in prop::option::of((-3_i64..4).prop_filter("a ratio", |part| *part != 0)),
        stands in -5_000_i64..5_000,
    ) {
        let ratio = |raw: i128, (numerator, denominator): (i64, i64)| {
            (raw * i128::from(numerator)).div_euclid(i128::from(denominator))
        };
        let denominator = denominator.max(numerator.abs() / 3 + 1);
        let mut rig = rig();
        rig.give(Action::Move(to(X, stands)));
        rig.run(500);
        let origin = place(&rig, LINE);
        if let Some(part) = before {
            rig.give(Action::Synchronize(couple(X, TO_LINE, part, 5)));
        }
        rig.give(line(1_000_000, speed));
        rig.run(300);
        let goal = rig.give(on_event(numerator, denominator));
        prop_assert_eq!(rig.answer(goal), Ok(()));
        rig.run(7);
        let was = place(&rig, LINE);
        latch(&mut rig, MARK, Edge::Rising, age);
        rig.run(1);
        let past = ((place(&rig, LINE) - was).raw() * i128::from(age)).div_euclid(1_000_000);
        let at = place(&rig, LINE).raw() - past;
        rig.mirror();
        rig.run(1_500);
        prop_assert_eq!(rig.int("x.in_sync"), 1);
        let from = (i128::from(stands) << 32) + before.map_or(0, |part| ratio(at - origin.raw(), (part, 5)));
        let way = ratio(place(&rig, LINE).raw() - at, (numerator, denominator));
        // A previous gear hands over its remainder, rounded to one unit.
        let off = place(&rig, X).raw() - from - way;
        prop_assert!(off == 0 || before.is_some() && (0..=1).contains(&off), "{}", off);
    }
}
