//! Zero: which commands need it, when it is retained, which values move with it.

use super::super::rig::{LINE, Rig, X, at, couple, to};
use super::{FAR, assign, cell, home, homed_events, place, rig, rig_with, run_to_end, travel_range, zero};
use crate::code::Code;
use crate::command::{Action, SetPosition};
use crate::drive::{Edge, Latch};
use crate::event::{Kind, Number};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Layer, Value};
use crate::position::Length;
use crate::sim::{Fixtures, Model};
use crate::unit::MLONG;

const START: i64 = -12_000;

fn homed() -> Rig {
    let mut rig = rig(travel_range(START, (5_000, FAR)));
    let sequence = home(&mut rig, 3);
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
    rig
}

fn set_position(rig: &mut Rig, position: i64) -> u64 {
    rig.give(Action::SetPosition(SetPosition { axis: X, position: Length::whole(position) }))
}

/// Proves: MACS-O-67, MACS-HOME-09, MACS-CMD-01
#[test]
fn forced_homing_comes_before_every_motion() {
    let sentence = "x: homing is required and has not been done; home the axis first";
    let mut rig = rig(travel_range(START, (5_000, FAR)));
    let sequence = rig.set("home_force", Value::Int(1));
    assert!(rig.was_accepted(sequence));
    let moves = || {
        [
            Action::Move(to(X, 1_000)),
            Action::Move(at(X, 1_000.0)),
            Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)),
        ]
    };
    for action in moves() {
        let sequence = rig.give(action);
        assert_eq!(rig.refusal(sequence), sentence);
    }
    rig.stream(X, 1_000.0);
    rig.run(5);
    assert_eq!((rig.state("x"), rig.int("x.command.position")), ("STANDSTILL", 0));
    // An aborted homing does not count.
    home(&mut rig, 3);
    rig.run(100);
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run_until("x.state", 1);
    let sequence = rig.give(Action::Move(to(X, 1_000)));
    assert_eq!(rig.refusal(sequence), sentence);
    let sequence = home(&mut rig, 3);
    run_to_end(&mut rig, sequence);
    for action in moves() {
        let sequence = rig.give(action);
        assert!(rig.was_accepted(sequence));
    }
    let refused = rig.events.iter().filter(|event| event.kind == Kind::Refused && event.command != 0);
    assert!(refused.clone().count() == 4 && refused.into_iter().all(|event| event.code.0 == 6), "error 6 of MACS");
}

/// The value that a homed controller shows may be set: it is shown again, and has the effect of 1.
///
/// Proves: MACS-HOME-09
#[test]
fn compulsory_and_done_is_shown_as_it_was_set_and_acts_as_1() {
    let mut rig = rig(travel_range(START, (5_000, FAR)));
    let shown = |rig: &Rig| {
        let p = rig.machine.parameters(X).copied().unwrap();
        ["home_force", "homing.required"].map(|key| crate::parameter::Row::find(key).unwrap().1.value(&p))
    };
    let given = rig.set("home_force", Value::Int(255));
    assert!(rig.was_accepted(given));
    assert_eq!(shown(&rig), [Value::Int(255), Value::Int(1)]);
    let refused = rig.give(Action::Move(to(X, 1_000)));
    assert_eq!(rig.refusal(refused), "x: homing is required and has not been done; home the axis first");
    let sequence = home(&mut rig, 3);
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
    // Each name requests the same, so the zero is kept.
    for (key, value, force) in
        [("home_force", 1, 1), ("home_force", 255, 255), ("homing.required", 1, 1), ("home_force", 255, 255)]
    {
        rig.set(key, Value::Int(value));
        rig.run(2);
        assert_eq!((shown(&rig), rig.int("x.homed")), ([Value::Int(force), Value::Int(1)], 1), "{key} {value}");
    }
    rig.set("home_force", Value::Int(0));
    assert_eq!(shown(&rig), [Value::Int(0), Value::Int(0)]);
    let refused = rig.set("home_force", Value::Int(2));
    assert_eq!(rig.refusal(refused), "x: home_force is 2; 0 to 1, 255 is allowed");
}

/// Proves: MACS-HOME-09
#[test]
fn a_change_of_what_the_zero_depends_on_asks_for_it_again() {
    for (key, value, keeps) in [
        ("encoder", Value::Int(1_000), false),
        ("posdrct", Value::Int(-1), false),
        ("home_type", Value::Int(1), false),
        ("home_offset", Value::Int(5), false),
        ("homing.velocity", Value::Real(5_000.0), false),
        ("homing.required", Value::Int(1), false),
        ("homing.max_time", Value::Int(1_000_000_000), true),
        ("max_velocity", Value::Real(50_000.0), true),
        // The value in force under another name, in parts of 100; the tens digit is that of the other loop.
        ("home_vel", Value::Int(10), true),
        ("homezerovel", Value::Int(1), true),
        ("home_ramp", Value::Int(10), true),
        ("posdrct", Value::Int(11), true),
        ("home_vel", Value::Int(9), false),
        ("homezerovel", Value::Int(9), false),
        ("velocity_override", Value::Real(50.0), true),
        ("max_position", Value::Int(9_000), true),
    ] {
        let mut rig = homed();
        rig.give(Action::Disable(AxisSet::one(X)));
        rig.run(20);
        assert_eq!(rig.int("x.homed"), 1);
        let sequence = rig.set(key, value);
        assert!(rig.was_accepted(sequence), "{key}");
        rig.run(2);
        assert_eq!(rig.int("x.homed"), i64::from(keeps), "{key}");
        let told = rig.events.iter().filter(|event| event.code == Code::HOMING_LOST).count();
        assert_eq!(told, usize::from(!keeps), "{key}");
    }
}

#[test]
fn set_position_disable_and_errors_keep_it_and_power_does_not() {
    let mut rig = homed();
    set_position(&mut rig, 5_000);
    assert_eq!(rig.int("x.homed"), 1);
    rig.plant.drive(0).unwrap().inject_fault(0x7305);
    rig.run(2);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(20);
    assert_eq!((rig.int("x.homed"), rig.int("x.error")), (1, 0));
    rig.give(Action::Disable(AxisSet::first(3)));
    rig.run(20);
    assert_eq!(rig.int("x.homed"), 1);
    let sequence = rig.give(Action::PowerCycle);
    assert!(rig.was_accepted(sequence));
    assert_eq!(rig.int("x.homed"), 0);
}

/// No method at all is a valid choice.
#[test]
fn without_a_method_the_zero_is_where_it_was_switched_on() {
    let mut rig = rig(travel_range(START, (5_000, FAR)));
    let sequence = rig
        .give(Action::HomeAxis(crate::command::HomeAxis { axis: X, method: crate::command::HomingMethod::Configured }));
    assert_eq!(rig.refusal(sequence), "x: homing.method is 0: give the axis a method, or name one in the command");
    let sequence = rig.give(Action::Move(to(X, 1_000)));
    assert!(rig.was_accepted(sequence));
}

/// Proves: MACS-HOME-07
#[test]
fn an_offset_moves_the_zero_and_only_a_sequence_of_macs_goes_there() {
    for offset in [-700, 450] {
        // The index left of the edge is at 4300, the edge at 5000.
        for (method, reference) in [(3, 4_300), (19, 5_000), (35, START), (-1, 4_300), (-2, 5_000)] {
            let mut rig = rig(travel_range(START, (5_000, FAR)));
            rig.set("homing.offset", Value::Int(offset));
            let sequence = home(&mut rig, method);
            let mut moved = false;
            while rig.done(sequence).is_empty() {
                rig.run(1);
                moved |= rig.int("x.homing.phase") == 4;
            }
            assert_eq!(zero(&rig, START), reference + offset, "{method}");
            assert_eq!(moved, method < 0, "{method}");
            // The actual position follows the command one cycle later.
            rig.run(1);
            if method < 0 {
                assert_eq!((rig.int("x.command.position"), place(&rig, START)), (0, reference + offset), "{method}");
            }
        }
    }
}

/// HOME_OFFSET has the direction of the counts. DIR-02: HOME_VEL has the direction of the units.
/// Proves: MACS-DIR-02
#[test]
fn inverted_units_keep_the_places_of_switches_and_offset() {
    // By the standard: left of the edge at 5000, and the sequence of MACS moves in the direction of its velocity.
    for (method, velocity, reference) in [(3, 10.0, 4_300), (1, 10.0, -19_700), (-1, -10.0, 4_300), (-2, -10.0, 5_000)]
    {
        let mut config = cell(0);
        let p = &mut config.axes[usize::from(X)].parameters;
        assign(p, "posdrct", Value::Int(-1));
        assign(p, "homing.velocity", Value::Real(velocity * 1_000.0));
        assign(p, "home_offset", Value::Int(450));
        assert_eq!(p.homing.offset, -450);
        let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)));
        let sequence = home(&mut rig, method);
        assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE, "{method}");
        // Positions have the opposite direction of the travel range.
        let zero = place(&rig, START) + rig.int("x.actual.position");
        assert_eq!(zero, reference + 450, "{method}");
    }
}

/// Proves: MACS-LIM-01, MACS-CMD-16
#[test]
fn limits_keep_machine_position_after_set_position_and_are_restored_by_homing() {
    let mut rig = homed();
    rig.set("min_position", Value::Int(-10_000));
    rig.set("max_position", Value::Int(1_000));
    let here = rig.int("x.command.position");
    set_position(&mut rig, here + 7_000);
    let limits = |rig: &Rig| {
        let p = rig.machine.parameters(X).copied().unwrap();
        (p.min_position, p.max_position)
    };
    assert_eq!(limits(&rig), (Some(-3_000), Some(8_000)));
    let told = rig.events.iter().rev().take(2).all(|event| event.kind == Kind::Parameter);
    assert!(told, "ROS hears of it");
    let sequence = rig.give(Action::Move(to(X, 8_001)));
    assert!(rig.refusal(sequence).contains("max_position"));
    let sequence = rig.give(Action::Move(to(X, 7_900)));
    assert!(rig.was_accepted(sequence));
    rig.run_until("x.state", 1);
    // Saved limits do not move with the coordinate.
    rig.give(Action::SaveParameters(AxisSet::one(X)));
    assert_eq!(rig.machine.parameter_image().user[usize::from(X)].max_position, Some(1_000));
    rig.give(Action::ResetParameters { axes: AxisSet::one(X), layer: Layer::User });
    assert_eq!(limits(&rig), (Some(-3_000), Some(8_000)));
    let sequence = home(&mut rig, 3);
    run_to_end(&mut rig, sequence);
    assert_eq!(limits(&rig), (Some(-10_000), Some(1_000)));
}

/// POSLIMIT and NEGLIMIT at the ends of their range guard the same machine positions after DEFORIGIN, whether they were
/// on or off. They can be switched off and on again there, and the saved values are the given ones.
///
/// Proves: MACS-LIM-01, MACS-LIM-02
#[test]
fn limits_at_the_end_of_their_range_keep_their_places() {
    let on = |rig: &mut Rig, value: i64| {
        rig.set("swposlimact", Value::Int(value));
        rig.set("swneglimact", Value::Int(value));
    };
    for (was_on, turned, by) in
        [(1, 1, 1_000), (0, 1, 1_000), (1, 1, -1_000), (0, 1, -1_000), (0, -1, 1_000), (1, -1, -7)]
    {
        let mut config = cell(0);
        let p = &mut config.axes[usize::from(X)].parameters;
        assign(p, "posdrct", Value::Int(turned));
        let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)));
        rig.set("poslimit", Value::Int(MLONG));
        rig.set("neglimit", Value::Int(-MLONG));
        on(&mut rig, was_on);
        let here = rig.int("x.command.position");
        set_position(&mut rig, here + by);
        let limits = |rig: &Rig| {
            let p = rig.machine.parameters(X).copied().unwrap();
            (p.min_position, p.max_position)
        };
        let guarded = (Some(by - MLONG), Some(by + MLONG));
        on(&mut rig, 1);
        assert_eq!(limits(&rig), guarded, "{was_on} {turned} {by}");
        // A new value of one limit does not move the other.
        rig.set("in_position_window", Value::Int(3));
        on(&mut rig, 0);
        set_position(&mut rig, here + by);
        on(&mut rig, 1);
        assert_eq!(limits(&rig), guarded, "{was_on} {turned} {by}: off and on");
        rig.give(Action::SaveParameters(AxisSet::one(X)));
        let saved = rig.machine.parameter_image().user[usize::from(X)];
        assert_eq!((saved.min_position, saved.max_position), (Some(-MLONG), Some(MLONG)));
        assert_eq!((saved.macs.neglimit, saved.macs.poslimit), (-MLONG, MLONG));
        assert!(saved.is_sound() && rig.machine.parameters(X).unwrap().is_sound());
        // They are off when the zero is found: they have their given values.
        on(&mut rig, 0);
        set_position(&mut rig, here);
        let p = rig.machine.parameters(X).copied().unwrap();
        assert_eq!((p.macs.neglimit, p.macs.poslimit), (-MLONG, MLONG));
    }
}

/// Software limits without a known zero stop nothing.
#[test]
fn software_limits_do_not_hold_while_it_homes() {
    let mut config = cell(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    assign(p, "min_position", Value::Int(-100));
    assign(p, "max_position", Value::Int(100));
    let mut rig = rig_with(config, Model::Ideal, travel_range(START, (5_000, FAR)));
    let sequence = home(&mut rig, 19);
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
    assert_eq!(zero(&rig, START), 5_000);
    let sequence = rig.give(Action::Move(to(X, 200)));
    assert!(rig.refusal(sequence).contains("max_position"));
}

/// Followers of the axis see its motion, but not its new coordinate.
#[test]
fn a_follower_does_not_jump_with_the_zero() {
    let mut rig = rig(travel_range(START, (5_000, FAR)));
    rig.give(Action::Synchronize(couple(super::super::rig::Y, Leader::AxisCommand(X), 1, 1)));
    rig.run(5);
    let sequence = home(&mut rig, 3);
    let mut fastest = 0.0_f64;
    while rig.done(sequence).is_empty() {
        rig.run(1);
        fastest = fastest.max(rig.real("y.command.velocity").abs());
    }
    assert!(fastest <= 10_500.0, "{fastest}");
    assert_eq!(rig.state("y"), "SYNCHRONIZED_MOTION");
}

/// The input that i_refswitch names latches: the edge is at the latched position, at any velocity.
#[test]
fn a_latched_edge_is_exact_at_any_velocity() {
    let mut config = cell(0);
    let p = &mut config.axes[usize::from(X)].parameters;
    // 10 inc per cycle in the last approach, too.
    assign(p, "homing.index_velocity", Value::Real(10_000.0));
    let mut rig = rig_with(config, Model::Ideal, Fixtures { home: None, ..travel_range(0, (0, 0)) });
    let sequence = home(&mut rig, 20);
    let mut steps = 0;
    let mut latched = None;
    while rig.done(sequence).is_empty() {
        // The switch is actuated from 3000 on.
        let now = rig.int("x.actual.position");
        let next = now + (rig.real("x.command.velocity") / 1_000.0) as i64;
        if now < 3_000 && next >= 3_000 && rig.int("x.homing.phase") == 1 {
            let age_ns = ((next - 3_000) * 1_000_000 / (next - now).max(1)) as u32;
            let latch = Latch { object: Object::Io(0), edge: Edge::Rising, age_ns: Some(age_ns), position: None };
            assert!(rig.plant.add_latch(latch));
            latched = Some((next - 3_000, rig.real("x.command.velocity")));
        }
        rig.plant.set_digital(0, next >= 3_000);
        rig.run(1);
        steps += 1;
        assert!(steps < 20_000);
    }
    assert_eq!(rig.done(sequence)[0].code, Code::NONE);
    assert_eq!(latched.map(|(_, velocity)| velocity), Some(10_000.0), "at speed");
    assert_eq!(zero(&rig, 0), 3_000, "{latched:?}");
    assert_eq!(homed_events(&rig), [Number::Position(3_000)]);
}

/// HOME_TYPE 3 across a switch that is shorter than the braking distance: its far edge is passed at speed, and latched.
#[test]
fn a_latched_far_edge_is_exact_while_the_axis_still_brakes() {
    let (from, to) = (4_000, 4_011);
    let mut rig = rig_with(cell(0), Model::Ideal, Fixtures { home: None, ..travel_range(0, (0, 0)) });
    let sequence = home(&mut rig, -4);
    let mut passed_at = None;
    while rig.done(sequence).is_empty() {
        // The ideal drive reaches the present command in the next cycle.
        let (now, next) = (rig.int("x.actual.position"), rig.int("x.command.position"));
        if passed_at.is_none() && now <= to && next > to {
            let age_ns = ((next - to) * 1_000_000 / (next - now)) as u32;
            let latch = Latch { object: Object::Io(0), edge: Edge::Falling, age_ns: Some(age_ns), position: None };
            assert!(rig.plant.add_latch(latch));
            passed_at = Some(rig.real("x.command.velocity"));
        }
        rig.plant.set_digital(0, passed_at.is_none() && next >= from);
        rig.run(1);
    }
    assert_eq!(rig.done(sequence)[0].code, Code::NONE);
    assert!(passed_at.is_some_and(|velocity| velocity > 9_000.0), "some inc a cycle: {passed_at:?}");
    assert_eq!((zero(&rig, 0), homed_events(&rig)), (to, vec![Number::Position(to)]));
}

/// As the rows state: i_refswitch, i_poslimitsw, i_neglimitsw, homing.required act in the cycle in which they are set.
#[test]
fn assigned_inputs_are_read_in_the_next_cycle() {
    for (key, signal) in [
        ("i_refswitch", "x.reference_switch"),
        ("i_poslimitsw", "x.limit.positive"),
        ("i_neglimitsw", "x.limit.negative"),
    ] {
        let mut rig = rig(Fixtures::default());
        rig.plant.set_digital(0, true);
        for (value, expected) in [(0, 0), (1, 1), (-1, 0), (1, 1)] {
            rig.set(key, Value::Int(value));
            rig.run(1);
            assert_eq!(rig.int(signal), expected, "{key} {value}");
        }
        rig.plant.set_digital(0, false);
        rig.set(key, Value::Int(-1));
        rig.run(1);
        assert_eq!(rig.int(signal), 1, "{key}");
    }
}

/// Proves: MACS-O-17, MACS-HOME-01, MACS-HOME-02, MACS-HOME-06
#[test]
fn homing_rates_are_shares_of_the_maximum() {
    let mut p = crate::parameter::AxisParameters::new(1.0, 1.0);
    for (key, value) in [
        ("velmax", Value::Real(1_000.0)),
        ("rampmin", Value::Int(1_000_000_000)),
        ("home_vel", Value::Int(10)),
        ("home_ramp", Value::Int(20)),
        ("homezerovel", Value::Int(4)),
    ] {
        assign(&mut p, key, value);
    }
    // O-17: 100 RPM at 500 lines, 3.33333 qc/ms.
    let near = |value: f64, expected: f64| (value - expected).abs() <= expected * 1e-9;
    assert!(near(p.homing_velocity(), 10_000.0 / 3.0), "{}", p.homing_velocity());
    assert!(near(p.homing_index_velocity(), 4_000.0 / 3.0), "{}", p.homing_index_velocity());
    // 33333.3 qc/s in 1 s, with 20 of 100 in 5 s.
    assert!(near(p.homing_acceleration(), 100_000.0 / 15.0), "{}", p.homing_acceleration());
    // Never above DFLTACC, and the slow speed never above HOME_VEL.
    assign(&mut p, "dfltacc", Value::Int(10));
    assign(&mut p, "homezerovel", Value::Int(400));
    assert!(near(p.homing_acceleration(), 100_000.0 / 30.0), "{}", p.homing_acceleration());
    assert!(near(p.homing_index_velocity(), 10_000.0 / 3.0), "{}", p.homing_index_velocity());
    // The native values are the same, and absolute once they are given.
    assign(&mut p, "homing.velocity", Value::Real(-500.0));
    assign(&mut p, "velmax", Value::Real(2_000.0));
    assert_eq!((p.homing_velocity(), p.home_vel()), (-500.0, -1));
    assert_eq!(p.homezerovel(), 400);
    assign(&mut p, "home_vel", Value::Int(101));
    assert!(p.check().is_err(), "not above velres");
}
