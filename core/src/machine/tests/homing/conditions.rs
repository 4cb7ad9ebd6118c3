//! Homing under other conditions of the axis: override, shape of the ramps, inverted counts, contacts of the cell.

use super::super::rig::{Rig, X, at, couple, to};
use super::{FAR, assign, cell, home, place, rig, rig_with, run_to_end, travel_range, zero};
use crate::axis::Safety;
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod, SetPosition};
use crate::config::{IoConfig, IoKind};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::Value;
use crate::position::Length;
use crate::sim::Model;

const START: i64 = -12_000;

/// An override of 0 holds homing in any phase, and it continues later; the zero is that of an undisturbed homing.
#[test]
fn an_override_of_0_holds_it_and_later_it_goes_on() {
    for (method, expected) in [(3, 4_300), (8, 6_300), (-1, 4_300), (-4, 7_000), (1, -19_700)] {
        for phase in 1..=4 {
            let switch = if method == 3 || method == -1 { (5_000, FAR) } else { (5_000, 7_000) };
            let mut rig = rig(travel_range(START, switch));
            rig.set("homing.offset", Value::Int(-250));
            let sequence = home(&mut rig, method);
            let mut waited = 0;
            while rig.int("x.homing.phase") != phase && rig.state("x") == "HOMING" && waited < 20_000 {
                rig.run(1);
                waited += 1;
            }
            if rig.state("x") != "HOMING" {
                continue;
            }
            rig.run(3);
            rig.set("velocity_override", Value::Real(0.0));
            rig.run(400);
            let what = format!("method {method}, phase {phase}");
            if rig.state("x") == "HOMING" {
                let before = place(&rig, START);
                rig.run(100);
                assert_eq!((place(&rig, START), rig.done(sequence).len()), (before, 0), "{what}");
            }
            rig.set("velocity_override", Value::Real(0.3));
            rig.run(300);
            rig.set("velocity_override", Value::Real(100.0));
            assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE, "{what}");
            assert_eq!((rig.int("x.homed"), zero(&rig, START)), (1, expected - 250), "{what}");
        }
    }
}

/// With any shape of the ramps the positions are the same.
#[test]
fn the_shape_of_the_ramps_does_not_move_the_zero() {
    let expected =
        [(1, -19_700), (2, 18_300), (7, 4_300), (8, 6_300), (9, 6_300), (10, 8_300), (14, 4_300), (23, 5_000)];
    for (method, zero_at) in expected.into_iter().chain([(-1, 4_300), (-2, 5_000), (-3, 8_300), (-4, 7_000)]) {
        for shape in [1, 2] {
            for start in [START, 4_990, 6_001] {
                let mut config = cell(0);
                let p = &mut config.axes[usize::from(X)].parameters;
                assign(p, "profile", Value::Int(shape));
                assign(p, "max_jerk", Value::Real(3e6));
                let mut rig = rig_with(config, Model::Ideal, travel_range(start, (5_000, 7_000)));
                let sequence = home(&mut rig, method);
                let what = format!("method {method}, profile {shape}, from {start}");
                assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE, "{what}");
                assert_eq!((zero(&rig, start), rig.int("x.homed")), (zero_at, 1), "{what}");
            }
        }
    }
}

/// Inverted counts with homing in the drive: its switches keep their sides.
#[test]
fn a_drive_homes_in_inverted_units() {
    for (method, reference) in [(3, 4_300), (1, -19_700), (19, 5_000), (33, -13_700)] {
        let mut config = cell(3);
        let p = &mut config.axes[usize::from(X)].parameters;
        assign(p, "posdrct", Value::Int(-1));
        assign(p, "homing.in_drive", Value::Int(1));
        assign(p, "home_offset", Value::Int(450));
        let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)));
        let sequence = home(&mut rig, method);
        assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE, "{method}");
        rig.run(10);
        // Its counts are 0 at the reference, and positions have the opposite direction.
        let zero = reference + rig.int("x.actual.count") + rig.int("x.actual.position");
        assert_eq!((zero, rig.int("x.error")), (reference + 450, 0), "{method}");
    }
}

fn guarded(in_drive: bool) -> Rig {
    let mut config = cell(0);
    for name in ["estop", "door"] {
        config.io.push(IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: false });
    }
    config.safety = Safety { estop: Some(1), interlock: Some(2) };
    let p = &mut config.axes[usize::from(X)].parameters;
    assign(p, "homing.in_drive", Value::Int(in_drive.into()));
    assign(p, "homing.required", Value::Int(1));
    let mut rig = Rig::with(config, [Model::Ideal, Model::Ideal]);
    rig.plant.drive(0).unwrap().install_fixtures(travel_range(START, (5_000, FAR)));
    rig.plant.set_digital(1, true);
    rig.plant.set_digital(2, true);
    rig.enable();
    rig
}

/// A contact that opens ends homing in its cycle, in the drive or in the core, with the maximum deceleration; there is
/// no zero then.
///
/// Proves: MACS-HOME-09
#[test]
fn open_contact_ends_homing() {
    for (in_drive, contact, code, on) in [
        (false, 1, Code::EMERGENCY_STOP, 0),
        (false, 2, Code::INTERLOCK, 1),
        (true, 1, Code::EMERGENCY_STOP, 0),
        (true, 2, Code::INTERLOCK, 1),
    ] {
        let mut rig = guarded(in_drive);
        let sequence = home(&mut rig, 3);
        rig.run(400);
        assert_eq!(rig.real("x.actual.velocity"), 10_000.0);
        let before = place(&rig, START);
        rig.plant.set_digital(contact, false);
        rig.run(1);
        assert_eq!((rig.done(sequence)[0].code, rig.state("x")), (code, "ERROR_STOP"), "{in_drive}");
        rig.run(40);
        // 10000 inc/s with 1e6 inc/s^2: 50 inc, plus the travel of one or two cycles.
        let gone = place(&rig, START) - before;
        assert!((40..=80).contains(&gone), "{in_drive}: {gone}");
        assert_eq!((rig.int("x.enabled"), rig.int("x.homed"), rig.int("x.homing.phase")), (on, 0, 0));
        // While the contact is open homing does not start, and after that the axis still has no zero.
        let refused = home(&mut rig, 3);
        assert!(!rig.refusal(refused).is_empty());
        rig.plant.set_digital(contact, true);
        rig.give(Action::ResetErrors(AxisSet::first(3)));
        rig.run(5);
        rig.enable();
        let refused = rig.give(Action::Move(super::super::rig::to(X, 10)));
        assert!(rig.refusal(refused).contains("hom"), "{}", rig.refusal(refused));
        let sequence = home(&mut rig, 3);
        assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
        assert_eq!(rig.int("x.homed"), 1);
    }
}

/// A command that requires an axis at rest reports the present state.
#[test]
fn refusal_reports_present_state_of_moving_axis() {
    let moving: [(Action, &str); 3] = [
        (Action::Move(at(X, 1_000.0)), "the axis runs at a velocity (CONTINUOUS_MOTION); halt it first"),
        (
            Action::Synchronize(couple(X, Leader::AxisCommand(0), 1, 1)),
            "the axis is coupled (SYNCHRONIZED_MOTION); halt it first",
        ),
        (Action::Move(to(X, 9_000)), "the axis moves (DISCRETE_MOTION); wait for its end, or halt it first"),
    ];
    for (action, sentence) in moving {
        let mut rig = rig(travel_range(START, (5_000, 7_000)));
        rig.give(action);
        rig.run(20);
        let refused = home(&mut rig, 3);
        assert_eq!(rig.refusal(refused), format!("x: {sentence}"));
        rig.give(Action::QuickStop(AxisSet::one(X)));
        let zero = Action::SetPosition(SetPosition { axis: X, position: Length::whole(0) });
        let refused = rig.give(zero);
        if rig.state("x") == "STOPPING" && rig.real("x.command.velocity") != 0.0 {
            assert_eq!(rig.refusal(refused), "x: the axis is not at rest; wait until it stands");
        }
    }
}

/// Each scheme has its own numbers.
#[test]
fn unknown_method_is_refused_with_allowed_methods() {
    let mut rig = rig(travel_range(START, (5_000, 7_000)));
    for (method, sentence) in [
        (HomingMethod::Macs(4), "scheme macs has no homing method 4; 0 to 3, its home_type, are allowed"),
        (
            HomingMethod::Cia402(15),
            "scheme cia402 has no homing method 15; 1 to 14, 17 to 30, 33, 34, 35 and 37 are allowed",
        ),
    ] {
        let refused = rig.give(Action::HomeAxis(HomeAxis { axis: X, method }));
        assert_eq!(rig.refusal(refused), format!("x: {sentence}"));
    }
}

/// The drive reports no digital inputs: a method that searches for a switch is refused without an input for it; a
/// method with the index, or in the drive, is not.
#[test]
fn homing_by_a_switch_that_is_not_read_is_refused() {
    let told = |name: &str, key: &str, method: i64| {
        format!(
            "x: homing method {method} needs the {name}, and the digital inputs of the drive (60FDh) are not read; give the drive `eds` or an \
             entry of io, or assign an input with {key}"
        )
    };
    let rig_of = |assigned: &[(&str, i64)], in_drive: i64| {
        let mut config = cell(0);
        config.global.without_inputs = vec![Object::Axis(X)];
        let p = &mut config.axes[usize::from(X)].parameters;
        assign(p, "i_refswitch", Value::Int(0));
        assign(p, "homing.in_drive", Value::Int(in_drive));
        assigned.iter().for_each(|(key, input)| assign(p, key, Value::Int(*input)));
        rig_with(config, Model::Ideal, travel_range(START, (5_000, 7_000)))
    };
    for (method, name, key) in [
        (1, "negative limit switch", "i_neglimitsw"),
        (18, "positive limit switch", "i_poslimitsw"),
        (7, "reference switch", "i_refswitch"),
    ] {
        let mut rig = rig_of(&[], 0);
        let sequence = home(&mut rig, method);
        assert_eq!(rig.refusal(sequence), told(name, key, method));
        assert_eq!(rig.state("x"), "STANDSTILL");
        for mut rig in [rig_of(&[(key, 1)], 0), rig_of(&[], 1)] {
            let sequence = home(&mut rig, method);
            assert!(rig.was_accepted(sequence), "{method}");
        }
    }
    for method in [33, 35] {
        let mut rig = rig_of(&[], 0);
        let sequence = home(&mut rig, method);
        assert!(rig.was_accepted(sequence), "{method}");
    }
}
