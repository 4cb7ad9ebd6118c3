//! Homing together with switches, encoders, parameters, waiting goals.

use super::super::rig::{X, to};
use super::{FAR, assign, cell, home, place, rig, rig_with, run_to_end, travel_range, zero};
use crate::code::Code;
use crate::command::{Action, BufferMode, Move};
use crate::parameter::Value;
use crate::sim::Model;

const START: i64 = -12_000;

/// The zero of a sequence of MACS is beyond the end of travel: the limit switch ends the motion to it.
#[test]
fn a_limit_switch_on_the_way_to_the_zero_ends_homing() {
    for (offset, end) in [(30_000, 20_000), (-30_000, -20_000)] {
        let mut rig = rig(travel_range(START, (5_000, 7_000)));
        rig.set("homing.offset", Value::Int(offset));
        let sequence = home(&mut rig, -2);
        assert_eq!(run_to_end(&mut rig, sequence).code, Code::HOMING_AT_LIMIT);
        rig.run(500);
        assert_eq!((rig.state("x"), rig.int("x.homed")), ("ERROR_STOP", 0));
        // 10 inc per cycle, stopped with 1 inc/cycle^2.
        let beyond = (place(&rig, START) - end) * offset.signum();
        assert!((0..100).contains(&beyond), "{beyond}");
    }
}

/// If revers forbids the motion back to it, the zero is still valid: the axis stops after it.
#[test]
fn axis_that_must_not_reverse_stops_after_its_zero() {
    let mut config = cell(0);
    assign(&mut config.axes[usize::from(X)].parameters, "revers", Value::Int(2));
    let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, 7_000)));
    let sequence = home(&mut rig, -4);
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
    rig.run(2);
    assert_eq!((rig.int("x.homed"), zero(&rig, START)), (1, 7_000));
    assert!((1..10).contains(&rig.int("x.actual.position")), "{}", rig.int("x.actual.position"));
}

/// Counts that start again during homing: detected switches and index do not belong to them.
#[test]
fn a_new_epoch_ends_homing() {
    let mut rig = rig(travel_range(START, (5_000, FAR)));
    let sequence = home(&mut rig, 3);
    rig.run(300);
    rig.plant.drive(0).unwrap().restart_counts();
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::HOMING_LOST);
    assert_eq!((rig.state("x"), rig.int("x.homed")), ("ERROR_STOP", 0));
}

/// The zero that is being searched would not match the new parameters.
#[test]
fn what_the_zero_depends_on_does_not_change_while_it_is_sought() {
    let mut rig = rig(travel_range(START, (5_000, FAR)));
    let sequence = home(&mut rig, 3);
    rig.run(100);
    let refused = rig.set("homing.offset", Value::Int(77));
    assert_eq!(rig.refusal(refused), "x: the axis is homing; wait for its end, or cancel it");
    let taken = rig.set("velocity_override", Value::Real(50.0));
    assert!(rig.was_accepted(taken));
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
    assert_eq!((rig.int("x.homed"), zero(&rig, START)), (1, 4_300));
}

/// Another input for a switch would cause an edge without a motion.
///
/// Proves: MACS-HOME-04
#[test]
fn the_switches_stay_where_they_are_while_it_homes() {
    let mut rig = rig(travel_range(START, (5_000, FAR)));
    rig.plant.set_digital(0, false);
    let sequence = home(&mut rig, 19);
    rig.run(100);
    for (key, value) in
        [("i_refswitch", -1), ("i_refswitch", 0), ("i_poslimitsw", 1), ("i_neglimitsw", -1), ("wf.md15", 0)]
    {
        let refused = rig.set(key, Value::Int(value));
        assert_eq!(rig.refusal(refused), "x: the axis is homing; wait for its end, or cancel it", "{key}");
    }
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
    assert_eq!((rig.int("x.homed"), zero(&rig, START)), (1, 5_000));
    let taken = rig.set("i_refswitch", Value::Int(-1));
    assert!(rig.was_accepted(taken));
    rig.run(2);
    assert_eq!(rig.int("x.homed"), 1, "A-15: it does not ask for homing");
}

/// Homing that waits for its target window reports this.
#[test]
fn long_wait_for_target_window_is_reported() {
    let mut config = cell(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    assign(p, "in_position_window", Value::Int(5));
    p.in_position_time = 10_000_000_000;
    p.supervision.in_position_timeout = 100_000_000;
    let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)));
    home(&mut rig, 34);
    rig.run(5_000);
    assert_eq!(rig.state("x"), "HOMING");
    assert_eq!(rig.events.iter().filter(|event| event.code == Code::IN_POSITION_TIMEOUT).count(), 1);
}

/// The zero is lost while a goal waits: with homing required the goal does not start.
#[test]
fn a_goal_that_waits_needs_the_zero_when_it_begins() {
    let mut config = cell(0);
    assign(&mut config.axes[usize::from(X)].parameters, "homing.required", Value::Int(1));
    let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)));
    let sequence = home(&mut rig, 35);
    run_to_end(&mut rig, sequence);
    rig.give(Action::Move(to(X, 5_000)));
    let waits = rig.give(Action::Move(Move { buffer_mode: BufferMode::Buffered, ..to(X, 9_000) }));
    assert!(rig.was_accepted(waits));
    rig.run(20);
    rig.plant.drive(0).unwrap().restart_counts();
    rig.run(1_000);
    assert_eq!(rig.done(waits).iter().map(|done| done.code).collect::<Vec<_>>(), [Code::HOMING_REQUIRED]);
    assert_eq!((rig.int("x.homed"), rig.state("x"), rig.int("x.command.position")), (0, "STANDSTILL", 5_000));
}
