//! Gradual removal of offsets, and of the error from the reversing rule: rates, their changes, and their start.

use super::conditioning::{TO_BELT, TO_LINE, held_back_by_reversing_rule, line_at, on, place};
use super::direction::set;
use super::rig::{LINE, Rig, X};
use crate::position::Position;

/// A counted leader at rest has no steps of a count: an offset starts with max_acceleration, 1000 inc/s per cycle, with
/// and without a time (which would need 15.6 times as much), and so does the error of a filter that is switched off.
/// Proves: MACS-SYNC-13, MACS-SYNC-14
#[test]
fn an_offset_behind_a_counted_leader_that_stands_keeps_the_acceleration() {
    let run = |rig: &mut Rig, changes: &[(&str, i64)], most: f64| {
        let mut before = rig.real("x.command.velocity");
        let given = set(rig, changes);
        assert!(rig.was_accepted(given));
        for cycle in 0..300 {
            let velocity = rig.real("x.command.velocity");
            assert!((velocity - before).abs() <= most * (1.0 + 1e-9), "{changes:?} {cycle}: {before} {velocity}");
            before = velocity;
            rig.run(1);
        }
    };
    for (offset, time) in [(1_000, 0), (-1_000, 0), (1_000, 20), (-1_000, 20)] {
        let mut rig = on(TO_BELT, (1, 1), &[("syncmpulsm", 1_000), ("syncofftime", time)]);
        rig.run(20);
        run(&mut rig, &[("syncposoffs", offset)], 1_000.0);
        assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync")), (offset, 1));
    }
    let mut rig = on(TO_BELT, (1, 1), &[("syncvftime", -200_000)]);
    for _ in 0..100 {
        rig.plant.jump_encoder(0, 10);
        rig.run(1);
    }
    rig.run(1_500);
    // Coupled at 10 inc per cycle, which decrease by a 200th per cycle once the belt is at rest; of the sum a 2000th is
    // removed per cycle (MACS-SYNC-09): 1042.54 inc remain, and with the filter 522 inc/s end.
    let error = rig.real("x.sync.filter_error");
    assert!((error + 1_042.537).abs() < 0.01, "{error}");
    run(&mut rig, &[("syncvftime", 0)], 1_000.0 + 525.0);
    assert_eq!((rig.int("x.command.position"), rig.int("x.sync.error")), (1_000, 0));
}

/// 4000 inc at 2500 inc/s, and after 300 ms and 625 inc other rates. With 1000 ms they are 1250 inc/s and 6250 inc/s^2:
/// 200 ms and 375 inc of deceleration, 2875 inc at 1250 inc/s, and 200 ms to rest give 2700 ms. With marks 2000 inc
/// apart they are 5000 inc/s and 50000 inc/s^2: 50 ms and 187.5 inc of acceleration, 2937.5 inc at 5000 inc/s, and 100
/// ms give 737.5 ms. Without a time the axis catches up with default_acceleration, half a count/cycle^2: up to 41.1 in
/// 77.2 cycles, and 82.2 to rest.
/// Proves: MACS-SYNC-14
#[test]
fn the_time_of_an_offset_under_way_acts_at_once() {
    for (change, step, cycles) in [
        (("syncofftime", 1_000), 6.25, 2_695..=2_705),
        (("syncmpulsm", 2_000), 50.0, 732..=743),
        (("syncofftime", 0), 1_000.0, 157..=162),
    ] {
        let mut rig = on(TO_LINE, (1, 1), &[("syncmpulsm", 1_000), ("syncofftime", 500)]);
        rig.run(10);
        set(&mut rig, &[("syncposoffs", 4_000)]);
        rig.run(299);
        let mut before = rig.real("x.command.velocity");
        assert!((before - 2_500.0).abs() < 1e-3, "{before}");
        set(&mut rig, &[change]);
        let mut count = 1;
        loop {
            let velocity = rig.real("x.command.velocity");
            assert!((velocity - before).abs() <= step + 1e-3, "{change:?} {count}: {before} {velocity}");
            before = velocity;
            if place(&rig, X) == Position::whole(4_000) {
                break;
            }
            rig.run(1);
            count += 1;
            assert!(count < 5_000, "{change:?}");
        }
        assert!(cycles.contains(&count), "{change:?}: {count}");
    }
}

/// It is removed with the full trapezoid: 25000 inc/s^2, which is 25 inc/s per cycle, up to 2500 inc/s in the 100th
/// cycle, and at rest after 500 cycles.
/// Proves: MACS-DIR-07, MACS-SYNC-14
#[test]
fn error_of_reversing_rule_starts_with_its_ramp() {
    let mut rig = held_back_by_reversing_rule();
    rig.give(line_at(10_000.0));
    for cycle in 1..=600 {
        let slower = rig.real("line.command.velocity") - rig.real("x.command.velocity");
        let expected = (25.0 * f64::from(cycle)).min(2_500.0).min(25.0 * f64::from(500 - cycle)).max(0.0);
        assert!((slower - expected).abs() <= 76.0, "{cycle}: {slower}, {expected} expected");
        rig.run(1);
    }
    assert_eq!((place(&rig, X), rig.int("x.in_sync")), (place(&rig, LINE), 1));
}

/// A master at 1000 inc/s is slower than the trapezoid: once the trapezoid has that velocity, the slave stands still
/// until the trapezoid decelerates.
/// Proves: MACS-DIR-06, MACS-DIR-07
#[test]
fn a_slave_stands_where_its_master_is_slower_than_the_trapezoid() {
    let mut rig = held_back_by_reversing_rule();
    rig.give(line_at(1_000.0));
    let mut before = 0.0;
    for cycle in 1..=1_200 {
        let velocity = rig.real("x.command.velocity");
        assert!((0.0..=1_000.0 + 1e-6).contains(&velocity), "{cycle}: {velocity}");
        assert!((velocity - before).abs() <= 200.0 + 25.0 + 1.0, "{cycle}: {before} {velocity}");
        assert!(!(60..=900).contains(&cycle) || velocity == 0.0, "{cycle}: {velocity}");
        before = velocity;
        rig.run(1);
    }
    assert_eq!((place(&rig, X), rig.int("x.in_sync")), (place(&rig, LINE), 1));
}

/// The same for the error from the reversing rule: from 2500 inc/s to 1250 in 200 cycles.
/// Proves: MACS-DIR-07, MACS-SYNC-14
#[test]
fn new_offset_time_applies_at_once_to_error_of_reversing_rule() {
    let mut rig = held_back_by_reversing_rule();
    rig.give(line_at(10_000.0));
    rig.run(200);
    let slower = |rig: &Rig| rig.real("line.command.velocity") - rig.real("x.command.velocity");
    assert!((slower(&rig) - 2_500.0).abs() < 1e-3, "{}", slower(&rig));
    set(&mut rig, &[("syncofftime", 1_000)]);
    rig.run(99);
    assert!((slower(&rig) - 1_875.0).abs() <= 7.0, "{}", slower(&rig));
    rig.run(110);
    assert!((slower(&rig) - 1_250.0).abs() <= 1e-3, "{}", slower(&rig));
    // Without a time the slave waits for the rest, 237 inc.
    set(&mut rig, &[("syncofftime", 0)]);
    rig.run(120);
    assert_eq!((place(&rig, X), rig.int("x.in_sync")), (place(&rig, LINE), 1));
}
