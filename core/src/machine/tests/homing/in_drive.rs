//! Homing that the drive executes itself.

use super::super::rig::{Rig, X, Y, couple, to};
use super::{FAR, assign, cell, home, place, rig_with, run_to_end, travel_range, zero};
use crate::code::Code;
use crate::command::Action;
use crate::drive::{MODE_CSP, MODE_HOMING, Mode, STATUS_HOMING_ATTAINED, STATUS_HOMING_ERROR, STATUS_TARGET_REACHED};
use crate::object::{AxisSet, Leader};
use crate::parameter::Value;
use crate::sim::Model;

const START: i64 = -12_000;

fn in_drive(delay: u32, offset: i64) -> Rig {
    let mut config = cell(delay);
    let p = &mut config.axes[usize::from(X)].parameters;
    assign(p, "homing.in_drive", Value::Int(1));
    assign(p, "homing.offset", Value::Int(offset));
    rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)))
}

#[test]
fn the_drive_finds_the_zero_and_its_counts_begin_there() {
    for delay in [0, 1, 5] {
        for (method, offset, expected) in
            [(3, 0, 4_300), (1, 0, -19_700), (19, 250, 5_250), (34, -7, -11_707), (35, 0, START)]
        {
            let mut rig = in_drive(delay, offset);
            let sequence = home(&mut rig, method);
            rig.run(1);
            assert_eq!((rig.int("x.homing.phase"), rig.state("x")), (5, "HOMING"));
            let output = rig.outputs().drive[0];
            let Mode::Homing(order) = output.mode else { panic!("{:?}", output.mode) };
            assert_eq!(i64::from(order.method), method);
            let done = run_to_end(&mut rig, sequence);
            assert_eq!((done.code, rig.int("x.homed")), (Code::NONE, 1), "{method}");
            // Counts start at the reference, which is at 0.
            let reference = expected - offset;
            assert_eq!(rig.int("x.actual.count") - rig.int("x.actual.position"), offset, "{method}");
            assert_eq!(zero(&rig, reference), expected, "{method}");
            rig.run(10);
            assert_eq!((rig.outputs().drive[0].mode, rig.int("x.error")), (Mode::Position, 0));
            let sequence = rig.give(Action::Move(to(X, 100)));
            assert!(rig.was_accepted(sequence));
            assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
            rig.run(10);
            assert_eq!(place(&rig, reference), expected + 100, "{method}");
        }
    }
}

#[test]
fn follower_sees_no_jump_by_homing_in_drive() {
    let mut rig = in_drive(0, 0);
    rig.give(Action::Synchronize(couple(Y, Leader::AxisActual(X), 1, 1)));
    rig.run(2);
    let sequence = home(&mut rig, 3);
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
    rig.run(2_000);
    // From the start to the index, independent of the counts.
    assert_eq!(rig.int("y.command.position"), 4_300 - START);
}

#[test]
fn what_the_drive_does_not_find_is_an_error() {
    let mut rig = in_drive(0, 0);
    rig.plant.drive(0).unwrap().set_stuck_inputs(4, 0);
    let sequence = home(&mut rig, 3);
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::HOMING_IN_DRIVE_FAILED);
    assert_eq!((rig.state("x"), rig.int("x.homed")), ("ERROR_STOP", 0));
}

#[test]
fn a_sequence_of_macs_is_none_of_a_drive() {
    let mut rig = in_drive(0, 0);
    let sequence = home(&mut rig, -1);
    let sentence = "x: homing.in_drive is true, and the drive has no home_type 0; methods of CiA 402 are allowed";
    assert_eq!(rig.refusal(sequence), sentence);
}

/// The axis takes over the motion of its drive, and brakes it.
#[test]
fn a_stop_takes_the_axis_from_its_drive() {
    for (action, code) in [
        (Action::Halt(AxisSet::one(X)), Code::HALTED),
        (Action::QuickStop(AxisSet::one(X)), Code::QUICK_STOP),
        (Action::Disable(AxisSet::one(X)), Code::DISABLED),
    ] {
        let mut rig = in_drive(0, 0);
        let sequence = home(&mut rig, 3);
        rig.run(300);
        assert_eq!(rig.real("x.actual.velocity"), 10_000.0);
        rig.give(action);
        assert_eq!(rig.done(sequence)[0].code, code);
        assert_eq!(rig.outputs().drive[0].mode, Mode::Position);
        let mut before = rig.real("x.actual.velocity");
        for _ in 0..300 {
            rig.run(1);
            let now = rig.real("x.actual.velocity");
            // Maximum deceleration 1e6 inc/s^2: 1000 inc/s per cycle, plus the rounding to whole increments.
            assert!((before - now).abs() <= 2_000.0, "{before} {now}");
            before = now;
        }
        assert_eq!((before, rig.int("x.homed"), rig.int("x.error")), (0.0, 0, 0));
    }
}

/// A new raw coordinate without a command: the zero is lost.
#[test]
fn a_new_epoch_drops_the_zero() {
    let mut rig = in_drive(0, 0);
    let sequence = home(&mut rig, 3);
    run_to_end(&mut rig, sequence);
    assert_eq!(rig.int("x.homed"), 1);
    let here = rig.int("x.actual.position");
    rig.plant.drive(0).unwrap().restart_counts();
    rig.run(2);
    assert_eq!((rig.int("x.homed"), rig.int("x.actual.position"), rig.int("x.error")), (0, here, 0));
    assert!(rig.events.iter().any(|event| event.code == Code::HOMING_LOST));
}

/// With any delay and velocity, the motion of the drive itself causes no following error, nor does the takeover by the
/// axis.
#[test]
fn what_the_drive_does_by_itself_is_no_following_error() {
    for stops in [false, true] {
        let mut config = cell(6);
        let p = &mut config.axes[usize::from(X)].parameters;
        assign(p, "homing.in_drive", Value::Int(1));
        assign(p, "homing.velocity", Value::Real(100_000.0));
        assign(p, "max_following_error", Value::Int(100));
        let mut rig = rig_with(config, Model::Ideal, travel_range(START, (15_000, FAR)));
        let sequence = home(&mut rig, 3);
        rig.run(100);
        assert_eq!(rig.real("x.actual.velocity"), 100_000.0);
        if stops {
            rig.give(Action::Halt(AxisSet::one(X)));
        }
        for _ in 0..2_000 {
            assert!(rig.int("x.following_error").abs() <= 1, "{}", rig.int("x.following_error"));
            rig.run(1);
        }
        assert_eq!((rig.int("x.error"), rig.int("x.homed")), (0, i64::from(!stops)));
        assert_eq!(rig.done(sequence)[0].code, if stops { Code::HALTED } else { Code::NONE });
    }
}

/// A drive that does not enter its mode 6, and one that leaves it.
#[test]
fn a_drive_that_is_not_in_its_mode_is_an_error_in_time() {
    let mut rig = in_drive(0, 0);
    rig.modify_inputs = |inputs| inputs.drive[0].mode = MODE_CSP;
    let sequence = home(&mut rig, 3);
    rig.run(5_000);
    assert_eq!((rig.done(sequence).len(), rig.state("x"), rig.real("x.actual.velocity")), (0, "HOMING", 0.0));
    rig.run(1);
    assert_eq!(rig.done(sequence)[0].code, Code::HOMING_IN_DRIVE_TIMEOUT);
    assert_eq!((rig.state("x"), rig.int("x.homed"), rig.outputs().drive[0].mode), ("ERROR_STOP", 0, Mode::Position));
    let mut rig = in_drive(0, 0);
    let sequence = home(&mut rig, 3);
    rig.run(300);
    rig.modify_inputs = |inputs| inputs.drive[0].mode = MODE_CSP;
    rig.run(1);
    assert_eq!(rig.done(sequence)[0].code, Code::HOMING_IN_DRIVE_TIMEOUT);
}

/// A drive that must home and is still in mode 8 follows its setpoint with oscillation: a command that followed the
/// drive would move it away.
#[test]
fn command_stays_until_the_drive_is_in_mode_homing() {
    let mut rig = in_drive(0, 0);
    rig.modify_inputs = |inputs| {
        inputs.drive[0].mode = MODE_CSP;
        inputs.drive[0].count += (inputs.cycle % 7) as i64;
    };
    rig.run(1);
    let asked = rig.outputs().drive[0].position;
    home(&mut rig, 3);
    for cycle in 0..300 {
        rig.run(1);
        assert_eq!((rig.outputs().drive[0].position, rig.state("x")), (asked, "HOMING"), "{cycle}");
    }
}

/// The drive has its zero and reports mode 6 for 300 ms more: the axis is homed after that, and moves only in the mode
/// of the axis.
#[test]
fn axis_is_homed_once_the_drive_is_back_in_its_mode() {
    let mut rig = in_drive(0, 0);
    let sequence = home(&mut rig, 35);
    while !matches!(rig.outputs().drive[0].mode, Mode::Homing(_)) {
        rig.run(1);
    }
    while matches!(rig.outputs().drive[0].mode, Mode::Homing(_)) {
        rig.run(1);
    }
    rig.modify_inputs = |inputs| inputs.drive[0].mode = MODE_HOMING;
    rig.run(300);
    assert_eq!((rig.done(sequence).len(), rig.state("x"), rig.int("x.homed")), (0, "HOMING", 0));
    assert_eq!(rig.outputs().drive[0].mode, Mode::Position);
    rig.modify_inputs = |_| {};
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
    assert_eq!((rig.int("x.homed"), rig.int("x.error")), (1, 0));
}

/// Bits 10 and 12 of the first homing remain long after bit 4 was set for the second one: the axis is moved meanwhile,
/// and is not homed.
#[test]
fn second_homing_does_not_end_by_status_bits_of_the_first() {
    let mut rig = in_drive(0, 0);
    let first = home(&mut rig, 3);
    assert_eq!(run_to_end(&mut rig, first).code, Code::NONE);
    let away = rig.give(Action::Move(to(X, -9_000)));
    assert_eq!(run_to_end(&mut rig, away).code, Code::NONE);
    rig.modify_inputs = |inputs| inputs.drive[0].status |= STATUS_HOMING_ATTAINED | STATUS_TARGET_REACHED;
    let second = home(&mut rig, 3);
    rig.run(300);
    assert_eq!((rig.done(second).len(), rig.state("x"), rig.real("x.actual.velocity")), (0, "HOMING", 10_000.0));
    assert!(matches!(rig.outputs().drive[0].mode, Mode::Homing(_)));
    rig.modify_inputs = |_| {};
    assert_eq!(run_to_end(&mut rig, second).code, Code::NONE);
    rig.run(10);
    assert_eq!((rig.int("x.actual.count"), rig.int("x.actual.position"), rig.int("x.homed")), (0, 0, 1));
}

/// A drive that does not report a start within 5 s is an error once it is at rest; while it moves it stays in mode 6.
#[test]
fn a_drive_that_shows_no_begin_is_an_error_where_it_stands() {
    let mut rig = in_drive(0, 0);
    rig.plant.drive(0).unwrap().set_stuck_inputs(4, 0);
    rig.modify_inputs = |inputs| {
        inputs.drive[0].status |= STATUS_HOMING_ATTAINED | STATUS_TARGET_REACHED;
        inputs.drive[0].status &= !STATUS_HOMING_ERROR;
    };
    // 32,000 inc to the limit switch take 6.4 s.
    let slow = rig.set("homing.velocity", Value::Real(5_000.0));
    assert!(rig.was_accepted(slow));
    let sequence = home(&mut rig, 3);
    rig.run(6_000);
    assert_eq!((rig.done(sequence).len(), rig.state("x"), rig.real("x.actual.velocity")), (0, "HOMING", 5_000.0));
    assert!(matches!(rig.outputs().drive[0].mode, Mode::Homing(_)));
    rig.run(500);
    assert_eq!(rig.done(sequence)[0].code, Code::HOMING_NOT_BEGUN);
    assert_eq!((rig.state("x"), rig.int("x.homed")), ("ERROR_STOP", 0));
}

/// A drive that finds nothing, on a travel range without end.
#[test]
fn drive_is_stopped_after_maximum_homing_distance() {
    let mut rig = in_drive(0, 0);
    let fixtures = crate::sim::Fixtures { positive: None, negative: None, ..travel_range(0, (5_000, FAR)) };
    rig.plant.drive(0).unwrap().install_fixtures(fixtures);
    rig.plant.drive(0).unwrap().set_stuck_inputs(4, 0);
    let before = rig.int("x.actual.position");
    let refused = rig.set("homing.max_distance", Value::Int(3_000));
    assert!(rig.was_accepted(refused));
    let sequence = home(&mut rig, 3);
    while rig.done(sequence).is_empty() {
        rig.run(1);
    }
    let gone = rig.int("x.actual.position") - before;
    assert_eq!(rig.done(sequence)[0].code, Code::HOMING_SWITCH_MISSED);
    assert!((3_001..=3_010).contains(&gone), "{gone}");
    rig.run(300);
    assert_eq!((rig.state("x"), rig.real("x.actual.velocity"), rig.int("x.homed")), ("ERROR_STOP", 0.0, 0));
}

/// Returns a rig that homes at 200 inc/s, without a switch that ends its motion.
fn slow(in_drive: bool) -> Rig {
    let mut config = cell(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    assign(p, "homing.in_drive", Value::Int(in_drive.into()));
    assign(p, "homing.velocity", Value::Real(200.0));
    assign(p, "homing.max_distance", Value::Int(1_000_000));
    let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)));
    let fixtures = crate::sim::Fixtures { positive: None, negative: None, ..travel_range(START, (5_000, FAR)) };
    rig.plant.drive(0).unwrap().install_fixtures(fixtures);
    rig.plant.drive(0).unwrap().set_stuck_inputs(4, 0);
    rig
}

/// 2 s are 2000 cycles. The limit applies to the active homing, in the drive or in the core; the axis is braked and has
/// an error.
#[test]
fn homing_that_lasts_longer_than_max_time_ends_in_an_error() {
    for in_drive in [true, false] {
        let mut rig = slow(in_drive);
        let sequence = home(&mut rig, 3);
        rig.run(999);
        rig.set("homing.max_time", Value::Int(2_000_000_000));
        rig.run(1_000);
        assert_eq!((rig.done(sequence).len(), rig.state("x")), (0, "HOMING"), "{in_drive}");
        rig.run(1);
        let done = rig.done(sequence)[0];
        assert_eq!((done.code, rig.state("x")), (Code::HOMING_TOO_LONG, "ERROR_STOP"), "{in_drive}");
        let sentence = crate::text::message(&done, rig.machine.config());
        assert_eq!(sentence, "x: homing has lasted for longer than homing.max_time 2000 ms");
        rig.run(300);
        assert_eq!((rig.real("x.actual.velocity"), rig.int("x.homed")), (0.0, 0), "{in_drive}");
    }
}

/// Without a limit homing continues, and is reported after 60 s and 120 s. A search of the core is limited by its
/// distance.
#[test]
fn long_homing_in_drive_is_reported_each_minute() {
    for in_drive in [true, false] {
        let mut rig = slow(in_drive);
        let sequence = home(&mut rig, 3);
        rig.run(if in_drive { 121_000 } else { 61_000 });
        assert_eq!((rig.done(sequence).len(), rig.state("x"), rig.int("x.error")), (0, "HOMING", 0), "{in_drive}");
        let told = rig.events.iter().filter(|event| event.code == Code::HOMING_LASTS);
        let told: Vec<_> = told.map(|event| crate::text::message(event, rig.machine.config())).collect();
        let minutes: &[&str] = if in_drive { &["60000 ms", "120000 ms"] } else { &[] };
        let expected: Vec<_> = minutes
            .iter()
            .map(|time| format!("x: homing in the drive has lasted for {time} and goes on; homing.max_time limits it"))
            .collect();
        assert_eq!(told, expected);
    }
}
