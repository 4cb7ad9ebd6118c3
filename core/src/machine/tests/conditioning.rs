//! Conditioning of a master before the gear: stored backward motion, filter, offset, and additional influences.

use super::direction::set;
use super::rig::{LINE, Rig, X, at, cases, config, couple, to};
use crate::command::{Action, Move, Synchronize};
use crate::object::{AxisSet, Leader};
use crate::position::Position;
use crate::sync::SyncMode;
use proptest::prelude::*;

pub(super) const TO_LINE: Leader = Leader::AxisCommand(LINE);
pub(super) const TO_BELT: Leader = Leader::Encoder(0);

/// Returns a rig in which x, with these parameters, follows this leader.
pub(super) fn on(leader: Leader, (numerator, denominator): (i64, i64), changes: &[(&str, i64)]) -> Rig {
    let mut rig = Rig::enabled();
    let given = set(&mut rig, changes);
    assert!(rig.was_accepted(given), "{}", rig.refusal(given));
    rig.give(Action::Synchronize(couple(X, leader, numerator, denominator)));
    rig
}

/// The master accelerates with a fifth of the limit of its slave.
pub(super) fn line_at(velocity: f64) -> Action {
    Action::Move(Move { acceleration: 200_000.0, ..at(LINE, velocity) })
}

pub(super) fn line_to(target: i64) -> Action {
    let gently = Move { velocity: 10_000.0, acceleration: 100_000.0, deceleration: 100_000.0, ..to(LINE, target) };
    Action::Move(gently)
}

pub(super) fn place(rig: &Rig, axis: u16) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(axis)).position
}

fn step_to(rig: &mut Rig, expected: i64) {
    rig.run(400);
    assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync"), rig.int("x.sync.error")), (expected, 1, 0));
}

/// In increments of the master; positive is ahead in the direction of the coupling. Back at 0 nothing remains.
/// Proves: MACS-SYNC-13
#[test]
fn an_offset_moves_the_slave_by_what_its_gear_makes_of_it() {
    for (ratio, sign) in [((1, 2), 1), ((-1, 2), -1)] {
        let mut rig = on(TO_LINE, ratio, &[("syncposoffs", 1_000)]);
        step_to(&mut rig, 500 * sign);
        set(&mut rig, &[("syncposoffs", -1_001)]);
        // -500.5, rounded down.
        step_to(&mut rig, if sign > 0 { -501 } else { 500 });
        rig.give(line_to(300));
        rig.run(200);
        set(&mut rig, &[("syncposoffs", 0)]);
        step_to(&mut rig, 150 * sign);
        assert_eq!(place(&rig, X), Position::whole(150 * sign));
    }
}

/// A mode without a position has no offset.
#[test]
fn coupled_by_velocity_there_is_no_offset() {
    let mut rig = Rig::enabled();
    set(&mut rig, &[("syncposoffs", 1_000)]);
    rig.give(Action::Synchronize(Synchronize { mode: SyncMode::Velocity, ..couple(X, TO_LINE, 1, 1) }));
    rig.run(200);
    assert_eq!(rig.int("x.command.position"), 0);
}

/// Distance 1000 and 500 ms: 2500 inc/s, 25000 inc/s^2. From a quarter of the distance on it takes d / v + 0.2 T, below
/// that 2 sqrt(d / a).
/// Proves: MACS-SYNC-14
#[test]
fn an_offset_is_worked_off_in_its_time() {
    for (offset, time) in [(1_000, 500.0), (500, 300.0), (250, 200.0), (100, 126.5), (4_000, 1_700.0)] {
        let mut rig = on(TO_LINE, (2, 1), &[("syncmpulsm", 1_000), ("syncofftime", 500)]);
        rig.give(line_at(10_000.0));
        rig.run(300);
        assert_eq!(rig.int("x.in_sync"), 1);
        set(&mut rig, &[("syncposoffs", offset)]);
        let (mut cycles, mut most) = (0, 0.0_f64);
        let reached = |rig: &Rig| place(rig, X).raw() == 2 * (place(rig, LINE) + Position::whole(offset)).raw();
        while !reached(&rig) {
            rig.run(1);
            assert_eq!((rig.int("x.in_sync"), rig.int("x.sync.error")), (1, 0));
            most = most.max(rig.real("x.command.velocity"));
            cycles += 1;
            assert!(cycles < 3_000, "{offset}");
        }
        assert!((f64::from(cycles) - time).abs() <= 4.0, "{offset}: {cycles}");
        let peak = f64::sqrt(offset as f64 * 25_000.0).min(2_500.0);
        assert!((most - 20_000.0 - 2.0 * peak).abs() < 60.0, "{offset}: {most}");
    }
}

/// An offset that changes during its motion continues from the present velocity, without a step and without loss.
/// Proves: MACS-SYNC-13, MACS-SYNC-14
#[test]
fn an_offset_may_change_on_its_way() {
    let mut rig = on(TO_LINE, (1, 1), &[("syncmpulsm", 1_000), ("syncofftime", 500), ("syncposoffs", 3_000)]);
    rig.run(600);
    let (mut before, mut at_once) = (rig.real("x.command.velocity"), 0.0_f64);
    assert!((before - 2_500.0).abs() < 1.0);
    set(&mut rig, &[("syncposoffs", -200)]);
    at_once = at_once.max((rig.real("x.command.velocity") - before).abs());
    before = rig.real("x.command.velocity");
    for _ in 0..2_500 {
        rig.run(1);
        let velocity = rig.real("x.command.velocity");
        at_once = at_once.max((velocity - before).abs());
        before = velocity;
    }
    // 25000 inc/s^2 are 25 inc/s per cycle.
    assert!(at_once < 25.1, "{at_once}");
    step_to(&mut rig, -200);
}

/// SYNCPOSOFFS is at most 1073741823 / SYNCFACTS.
/// Proves: MACS-SYNC-03
#[test]
fn an_offset_that_its_gear_cannot_hold_is_refused() {
    let mut rig = Rig::enabled();
    let refused = set(&mut rig, &[("syncfacts", 1_000), ("syncposoffs", -1_073_742)]);
    let sentence =
        "x: syncposoffs -1073742 is beyond its range; at most 1073741823 / syncfacts, either way, is allowed";
    assert!(rig.refusal(refused).contains(sentence), "{}", rig.refusal(refused));
    for offset in [1_073_741, -1_073_741] {
        let good = set(&mut rig, &[("syncfacts", 1_000), ("syncposoffs", offset)]);
        assert!(rig.was_accepted(good), "{offset}");
    }
    let refused = set(&mut rig, &[("syncfacts", 1_001)]);
    assert!(rig.refusal(refused).contains("syncposoffs"));
}

/// Backward increments of the master are stored, and the next forward increments reduce the store; then the slave moves
/// on.
/// Proves: MACS-SYNC-05
#[test]
fn backward_motion_is_stored() {
    for numerator in [1, -1] {
        let mut rig = on(TO_LINE, (numerator, 1), &[("synctype", 4)]);
        // If the gear reverses the direction, upwards is backwards for the master.
        let sign = numerator;
        let way = |up: i64| line_to(up * sign);
        rig.give(way(2_000));
        rig.run(1_000);
        for (target, x, stored) in [(-1_000, 2_000, 3_000), (500, 2_000, 1_500), (2_000, 2_000, 0), (3_500, 3_500, 0)] {
            rig.give(way(target));
            rig.run(1_000);
            assert_eq!(
                (rig.int("x.command.position"), rig.int("x.sync.buffer")),
                (x * sign * numerator, stored),
                "{target}"
            );
        }
    }
}

/// A negative factor of the master selects the forward direction (SYNCFACTM -1).
/// Proves: MACS-SYNC-05
#[test]
fn inverted_master_moves_backwards_when_counting_up() {
    let mut rig = on(TO_LINE, (1, -1), &[("synctype", 4)]);
    rig.give(line_to(1_000));
    rig.run(1_000);
    assert_eq!((rig.int("x.command.position"), rig.int("x.sync.buffer")), (0, 1_000));
    rig.give(line_to(-500));
    rig.run(1_000);
    assert_eq!((rig.int("x.command.position"), rig.int("x.sync.buffer")), (500, 0));
}

/// A change of SYNCTYPE applies from the next synchronize.
#[test]
fn synctype_applies_from_next_synchronize() {
    let mut rig = on(TO_LINE, (1, 1), &[("synctype", 0)]);
    set(&mut rig, &[("synctype", 4)]);
    rig.give(line_to(-500));
    rig.run(500);
    assert_eq!(rig.int("x.command.position"), -500);
}

/// mencoder 500: tau 19.5 ms. From rest to v: after n ms the velocity is v (1 - (1 - 1/19.5)^n).
/// Proves: MACS-SYNC-07, MACS-SYNC-08
#[test]
fn coupled_by_velocity_it_follows_the_filtered_master() {
    let mut rig = Rig::enabled();
    rig.give(Action::Synchronize(Synchronize { mode: SyncMode::Velocity, ..couple(X, TO_BELT, 3, 1) }));
    rig.run(1);
    let share: f64 = 1.0 - 1.0 / 19.5;
    for n in 1..=100_i32 {
        rig.plant.jump_encoder(0, 5);
        rig.run(1);
        let expected = 3.0 * 5_000.0 * (1.0 - libm::pow(share, f64::from(n)));
        assert!((rig.real("x.command.velocity") - expected).abs() < 0.01, "{n}: {}", rig.real("x.command.velocity"));
    }
    // Without counts of mencoder there is no filter.
    rig.plant.jump_encoder(0, 5);
    set(&mut rig, &[("mencoder", 0)]);
    rig.plant.jump_encoder(0, 5);
    rig.run(1);
    assert_eq!(rig.real("x.command.velocity"), 15_000.0);
}

/// Positive values do not filter positions.
/// Proves: MACS-SYNC-08
#[test]
fn a_positive_time_filters_no_position() {
    let mut rig = on(TO_BELT, (1, 1), &[("syncvftime", 50_000)]);
    rig.plant.jump_encoder(0, 1);
    rig.run(1);
    assert_eq!((rig.int("x.command.position"), rig.real("x.sync.filter_error")), (1, 0.0));
}

/// The filter error is part of the sync error, is reduced by a tenth of tau, and nothing of it remains.
/// Proves: MACS-SYNC-09, MACS-SYNC-16
#[test]
fn a_filtered_position_arrives_in_the_end() {
    let mut rig = on(TO_LINE, (355, 113), &[("syncvftime", -20_000), ("syncaccuracy", -1_000)]);
    rig.give(line_to(5_000));
    let mut most = 0.0_f64;
    for _ in 0..700 {
        rig.run(1);
        let lacked = rig.real("x.sync.filter_error");
        most = most.max(lacked);
        let exact = (place(&rig, LINE).to_f64() * 355.0 / 113.0 - place(&rig, X).to_f64()).floor();
        assert!((rig.int("x.sync.error") as f64 - exact).abs() <= 1.0);
        assert!((lacked * 355.0 / 113.0 - exact).abs() <= 2.0);
    }
    // At 10 inc per ms the filter error is about 20 ms of it during acceleration, at most 190 inc.
    assert!((50.0..190.0).contains(&most), "{most}");
    rig.run(5_000);
    assert_eq!((place(&rig, X).raw(), rig.real("x.sync.filter_error")), ((5_000_i128 << 32) * 355 / 113, 0.0));
}

/// Above 50 inc tau decreases by 1 ms per ms, down to 5 ms; below a fifth of that it increases as slowly.
/// Proves: MACS-SYNC-11
#[test]
fn tau_of_the_filter_in_force_is_a_signal() {
    let mut rig = on(TO_LINE, (1, 1), &[("syncvftime", -20_000), ("syncvflimit", 50)]);
    rig.give(line_at(10_000.0));
    let (mut tau, mut least): (f64, f64) = (20_000.0, 20_000.0);
    for cycle in 0..1_500 {
        rig.run(1);
        let lacked = rig.real("x.sync.filter_error").abs();
        if lacked > 50.0 {
            tau = (tau - 1_000.0).max(5_000.0);
        } else if lacked < 10.0 {
            tau = (tau + 1_000.0).min(20_000.0);
        }
        let shown = rig.real("x.sync.filter_tau");
        assert!((shown - tau).abs() < 1e-6, "{cycle}: {shown}, not {tau}");
        least = least.min(tau);
    }
    assert_eq!((least, tau), (5_000.0, 20_000.0));
    set(&mut rig, &[("syncvftime", -30_000)]);
    rig.run(2);
    assert_eq!(rig.real("x.sync.filter_tau"), 30_000.0);
    set(&mut rig, &[("syncvftime", 0)]);
    rig.run(2);
    assert_eq!(rig.real("x.sync.filter_tau"), 0.0);
}

/// If the filter is switched off in motion, its error is removed within the limits of the axis.
#[test]
fn switched_off_filter_leaves_no_error() {
    let mut rig = on(TO_LINE, (1, 1), &[("syncvftime", -200_000)]);
    rig.give(line_at(10_000.0));
    rig.run(300);
    let owed = rig.real("x.sync.filter_error");
    assert!(owed > 500.0, "{owed}");
    set(&mut rig, &[("syncvftime", 0)]);
    let mut before = rig.real("x.command.velocity");
    for _ in 0..300 {
        rig.run(1);
        let velocity = rig.real("x.command.velocity");
        assert!((velocity - before).abs() <= 1_000.0 * (1.0 + 1e-9));
        before = velocity;
    }
    assert_eq!((place(&rig, X), rig.int("x.in_sync")), (place(&rig, LINE), 1));
}

/// VCMD 10 inc per ms and 1200 / 1000 of it: 12 inc ahead, while the master runs.
/// Proves: MACS-SYNC-15, MACS-SYNC-17, MACS-O-41
#[test]
fn the_slave_is_led_ahead_by_a_share_of_its_velocity() {
    let mut rig = on(TO_LINE, (1, 1), &[("syncffvel", 1_200)]);
    rig.give(line_at(10_000.0));
    rig.run(300);
    assert_eq!(place(&rig, X), place(&rig, LINE) + Position::whole(12));
    assert_eq!((rig.real("x.command.velocity").round(), rig.int("x.in_sync")), (10_000.0, 1));
    rig.give(line_to(20_000));
    rig.run(3_000);
    assert_eq!(rig.int("x.command.position"), 20_000);
}

/// 50 % of 20 mm/s: 10 to 30 mm/s, and no more than 25 or 40 mm/s of the goal.
/// Proves: MACS-SYNC-12, MACS-O-39
#[test]
fn while_it_catches_up_its_velocity_stays_in_the_band() {
    for (most, expected) in [(25_000.0, 25_000.0), (40_000.0, 30_000.0)] {
        for (offset, expected) in [(2_000, expected), (-2_000, 10_000.0)] {
            let mut rig = Rig::enabled();
            set(&mut rig, &[("syncvelrel", 50)]);
            rig.give(Action::Synchronize(Synchronize { velocity: most, ..couple(X, TO_LINE, 1, 1) }));
            rig.give(line_at(20_000.0));
            rig.run(500);
            assert_eq!((rig.int("x.in_sync"), place(&rig, X)), (1, place(&rig, LINE)));
            set(&mut rig, &[("syncposoffs", offset)]);
            rig.run(60);
            assert!((rig.real("x.command.velocity") - expected).abs() < 1e-3, "{}", rig.real("x.command.velocity"));
            rig.run(1_000);
            assert_eq!(place(&rig, X), place(&rig, LINE) + Position::whole(offset));
        }
    }
}

/// The band also applies to an offset with a time: 2000 inc in 50 ms would be faster.
/// Proves: MACS-SYNC-12, MACS-SYNC-14
#[test]
fn the_band_holds_for_an_offset_with_its_time() {
    let mut rig = on(TO_LINE, (1, 1), &[("syncvelrel", 25), ("syncmpulsm", 2_000), ("syncofftime", 50)]);
    rig.give(line_at(20_000.0));
    rig.run(500);
    set(&mut rig, &[("syncposoffs", 2_000)]);
    for _ in 0..300 {
        rig.run(1);
        assert!(rig.real("x.command.velocity") <= 25_000.0 + 1e-3);
    }
    rig.run(400);
    assert_eq!(place(&rig, X), place(&rig, LINE) + Position::whole(2_000));
}

/// Returns a rig with x 1000 inc ahead of its master, which has moved back (revers 2); syncofftime is 500 ms for 1000
/// inc.
pub(super) fn held_back_by_reversing_rule() -> Rig {
    let mut config = config(0);
    let p = &mut config.axes[1].parameters;
    (p.macs.revers, p.sync.mark_distance, p.sync.offset_time, p.sync_accuracy) = (2, 1_000, 500, -10);
    let mut rig = Rig::of(config);
    rig.enable();
    rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 1)));
    rig.give(line_to(3_000));
    rig.run(800);
    rig.give(line_to(2_000));
    rig.run(800);
    assert_eq!((rig.int("x.command.position"), rig.int("x.sync.error")), (3_000, -1_000));
    rig
}

/// revers 2: the master moves back by 1000 inc and returns. Without a time the slave waits for it; with a time it moves
/// on at once, and removes its error in 500 ms at the same time.
/// Proves: MACS-DIR-07, MACS-SYNC-14
#[test]
fn error_of_reversing_rule_is_removed_in_offset_time() {
    let mut rig = held_back_by_reversing_rule();
    assert_eq!(rig.int("x.in_sync"), 0);
    let warnings = rig.events.iter().filter(|event| event.kind == crate::event::Kind::Warning).count();
    assert_eq!(warnings, 1, "once, not in each cycle");
    rig.give(line_at(10_000.0));
    rig.run(60);
    // It moves long before the master has returned, slower by up to 2.5 mm/s.
    assert!(rig.int("line.command.position") < 3_100 && rig.int("x.command.position") > 3_200);
    let mut slowest = f64::INFINITY;
    for _ in 0..300 {
        rig.run(1);
        slowest = slowest.min(rig.real("x.command.velocity"));
    }
    assert!((slowest - 7_500.0).abs() < 30.0, "{slowest}");
    rig.run(500);
    assert_eq!((place(&rig, X), rig.int("x.in_sync"), rig.int("x.sync.error")), (place(&rig, LINE), 1, 0));
}

/// Uncoupled and coupled again, the slave starts with the present positions of both.
#[test]
fn each_coupling_starts_without_stored_motion() {
    let mut rig = on(TO_LINE, (1, 1), &[("synctype", 4), ("syncvftime", -50_000)]);
    rig.give(line_to(-1_000));
    rig.run(500);
    assert_eq!(rig.int("x.sync.buffer"), 1_000);
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(50);
    assert_eq!((rig.int("x.sync.buffer"), rig.real("x.sync.filter_error")), (0, 0.0));
    rig.give(Action::Synchronize(couple(X, TO_LINE, 1, 1)));
    rig.give(line_to(0));
    rig.run(6_000);
    assert_eq!(rig.int("x.command.position"), 1_000);
}

/// Change of ratio after a filter, on a belt that shows 10 or 11 counts per cycle: the filter keeps its error, so the
/// velocity step of the slave is only that of the ratios, and at rest no belt travel is lost.
/// Proves: MACS-SYNC-09, MACS-SYNC-02
#[test]
fn a_filter_goes_on_through_a_change_of_the_ratio() {
    let mut rig = on(TO_BELT, (2, 1), &[("syncvftime", -20_000)]);
    let run = |rig: &mut Rig, cycles: u32, halves: i64| {
        let mut most: f64 = 0.0;
        for cycle in 0..cycles {
            let before = rig.real("x.command.velocity");
            rig.plant.jump_encoder(0, halves / 2 + i64::from(cycle % 2) * (halves % 2));
            rig.run(1);
            most = most.max((rig.real("x.command.velocity") - before).abs());
        }
        most
    };
    run(&mut rig, 3_000, 21);
    rig.plant.jump_encoder(0, 10);
    rig.give(Action::Synchronize(couple(X, TO_BELT, 3, 1)));
    // From 21 to 31.5 inc per cycle, half an increment in each; in addition the filter passes a twentieth of a count,
    // three times.
    let most = run(&mut rig, 1_000, 21);
    assert!(most <= 650.1, "{most}");
    run(&mut rig, 9_000, 0);
    assert_eq!((rig.int("x.in_sync"), rig.int("x.sync.error")), (1, 0));
    let belt = rig.int("belt.position");
    let led = rig.int("x.command.position");
    // In the cycle of the command the previous gear is still active; in steady motion the filter error is 0.
    let first = 21 * 1_500 + 10;
    let expected = 2 * first + 3 * (belt - first);
    assert!((expected - 1..=expected).contains(&led), "{led} of {expected}");
}

proptest! {
    #![proptest_config(cases(24))]
    /// With any changes during motion, the slave is at rest where its gear requires, to 2^-32 inc: nothing of the
    /// master or of an offset is lost, and no command exceeds the limits.
    /// Proves: MACS-SYNC-02, MACS-SYNC-09, MACS-SYNC-13
    #[test]
    fn nothing_is_lost_whatever_is_changed(
        ratio in prop_oneof![Just((355, 113)), Just((-7, 3)), Just((1, 1009)), Just((104_729, 99_991))],
        steps in prop::collection::vec((
            prop_oneof![
                (-20_000_i64..20_000).prop_map(|value| ("syncposoffs", value)),
                prop_oneof![Just(0), Just(300), Just(50)].prop_map(|value| ("syncofftime", value)),
                prop_oneof![Just(0), -30_000_i64..30_000].prop_map(|value| ("syncvftime", value)),
                prop_oneof![Just(0), 1_i64..5_000].prop_map(|value| ("syncvflimit", value)),
                prop_oneof![Just(0), 0_i64..3_000].prop_map(|value| ("syncffvel", value)),
            ],
            -15_000_i64..15_000,
            1_u64..400,
        ), 1..12),
    ) {
        let mut rig = on(TO_LINE, ratio, &[]);
        for (change, target, cycles) in steps {
            let given = set(&mut rig, &[change]);
            prop_assert!(rig.was_accepted(given));
            rig.give(Action::Move(Move { velocity: 20_000.0, acceleration: 200_000.0, deceleration: 200_000.0, ..to(LINE, target) }));
            let mut before = rig.real("x.command.velocity");
            for _ in 0..cycles {
                rig.run(1);
                let velocity = rig.real("x.command.velocity");
                prop_assert!(velocity.abs() <= 100_000.0 * (1.0 + 1e-9), "{}", velocity);
                prop_assert!((velocity - before).abs() <= 1_000.0 * (1.0 + 1e-9), "{} {}", before, velocity);
                before = velocity;
            }
        }
        let offset = set(&mut rig, &[("syncposoffs", 1_234)]);
        prop_assert!(rig.was_accepted(offset));
        rig.run(9_000);
        let (numerator, denominator) = ratio;
        let led = (place(&rig, LINE) + Position::whole(1_234)).raw() * i128::from(numerator);
        prop_assert_eq!(place(&rig, X).raw(), led.div_euclid(i128::from(denominator)));
        prop_assert_eq!((rig.int("x.in_sync"), rig.int("x.sync.error")), (1, 0));
    }
}
