//! Events that end homing early, and commands that are refused meanwhile.

use super::super::rig::{LINE, Rig, X, at, couple, to};
use super::{FAR, assign, cell, home, rig, rig_with, run_to_end, travel_range};
use crate::code::Code;
use crate::command::{Action, Command, Commands, Move, MoveMode, Source};
use crate::object::{AxisSet, Leader};
use crate::parameter::Value;
use crate::sim::Model;

/// Returns a rig with active homing, at speed.
fn under_way() -> (Rig, u64) {
    let mut rig = rig(travel_range(-12_000, (5_000, FAR)));
    let sequence = home(&mut rig, 3);
    rig.run(300);
    assert_eq!((rig.state("x"), rig.int("x.homing.phase"), rig.int("x.reference")), ("HOMING", 1, 5));
    assert_eq!(rig.real("x.command.velocity"), 10_000.0);
    (rig, sequence)
}

fn assert_over(rig: &Rig, sequence: u64, code: Code) {
    let done = rig.done(sequence);
    assert_eq!(done.len(), 1, "it ends once");
    assert_eq!((done[0].code, rig.int("x.homed"), rig.int("x.homing.phase")), (code, 0, 0));
}

#[test]
fn halt_ends_it_and_a_new_one_may_follow() {
    let (mut rig, sequence) = under_way();
    rig.give(Action::Halt(AxisSet::one(X)));
    assert_over(&rig, sequence, Code::HALTED);
    assert_eq!(rig.state("x"), "DISCRETE_MOTION");
    rig.run_until("x.state", 1);
    let again = home(&mut rig, 3);
    assert_eq!(run_to_end(&mut rig, again).code, Code::NONE);
    assert_eq!(rig.int("x.homed"), 1);
}

#[test]
fn quick_stop_disable_and_deactivation_end_it() {
    for (action, code, state) in [
        (Action::QuickStop(AxisSet::one(X)), Code::QUICK_STOP, "STOPPING"),
        (Action::Disable(AxisSet::one(X)), Code::DISABLED, "DISABLED"),
        (Action::Deactivate, Code::DISABLED, "DISABLED"),
    ] {
        let (mut rig, sequence) = under_way();
        let command = Command { sequence: 999, source: Source::Ros, action };
        rig.cycle(Commands { stop: &[command], ..Commands::default() });
        assert_over(&rig, sequence, code);
        rig.run(200);
        assert_eq!((rig.state("x"), rig.real("x.command.velocity")), (state, 0.0));
        assert_over(&rig, sequence, code);
    }
}

#[test]
fn cancel_stops_it_with_its_own_deceleration() {
    let (mut rig, sequence) = under_way();
    rig.give(Action::Cancel { goal: sequence });
    assert_eq!((rig.done(sequence).len(), rig.int("x.homing.phase")), (0, 0));
    // 10 inc per cycle at 0.1 inc/cycle^2.
    rig.run(99);
    assert!(rig.real("x.command.velocity") > 0.0);
    rig.run(2);
    assert_over(&rig, sequence, Code::CANCELLED);
    assert_eq!(rig.state("x"), "STANDSTILL");
}

/// Methods that search for a limit switch brake on it. A stop at that point is executed as a stop, without the error of
/// a motion into a limit; but a new goal does not lead further.
///
/// Proves: MACS-LIM-09
#[test]
fn a_stop_on_the_limit_switch_that_homing_seeks_only_stops() {
    for (action, state) in [
        (None, "STANDSTILL"),
        (Some(Action::Halt(AxisSet::one(X))), "STANDSTILL"),
        (Some(Action::QuickStop(AxisSet::one(X))), "STOPPING"),
        (Some(Action::Disable(AxisSet::one(X))), "DISABLED"),
    ] {
        let mut rig = rig(travel_range(15_000, (-FAR, -FAR)));
        let sequence = home(&mut rig, 2);
        rig.run_until("x.limit.positive", 1);
        rig.run(5);
        let velocity = rig.real("x.command.velocity");
        assert!((5_000.0..10_000.0).contains(&velocity), "it brakes on the switch: {velocity}");
        let cancels = action.is_none();
        rig.give(action.unwrap_or(Action::Cancel { goal: sequence }));
        if cancels {
            let on = rig.give(Action::Move(to(X, 9_000)));
            assert!(rig.refusal(on).contains("limit"), "{}", rig.refusal(on));
        }
        rig.run(200);
        assert_eq!((rig.state("x"), rig.int("x.error"), rig.int("x.homed")), (state, 0, 0));
        assert_eq!((rig.real("x.command.velocity"), rig.int("x.limit.positive")), (0.0, 1));
        if state == "STANDSTILL" {
            let on = rig.give(Action::Move(at(X, 1_000.0)));
            assert!(rig.refusal(on).contains("limit"), "{}", rig.refusal(on));
            let back = rig.give(Action::Move(to(X, 0)));
            assert!(rig.was_accepted(back));
        }
    }
}

/// While the axis only brakes there, no other motion may lead further into the switch: a superimposed motion could,
/// with the velocity that the stop reduces.
///
/// Proves: MACS-LIM-09
#[test]
fn nothing_is_superimposed_on_a_stop_on_the_limit_switch() {
    for (velocity, acceleration) in [(500.0, 50_000.0), (2_000.0, 20_000.0), (0.0, 1_000.0)] {
        let mut rig = rig(travel_range(15_000, (-FAR, -FAR)));
        let sequence = home(&mut rig, 2);
        rig.run_until("x.limit.positive", 1);
        rig.run(5);
        rig.give(Action::Cancel { goal: sequence });
        let more = Move { mode: MoveMode::Superimposed, velocity, acceleration, ..to(X, 20_000) };
        rig.give(Action::Move(more));
        rig.run(150);
        let place = rig.int("x.actual.position");
        rig.run(3_000);
        let gone = rig.int("x.actual.position") - place;
        assert!(gone <= 100, "{gone} inc on beyond the switch, {}", rig.state("x"));
    }
}

/// If the axis is stopped before it reaches the switch, homing does not cover the switch.
///
/// Proves: MACS-LIM-08
#[test]
fn a_stop_that_runs_into_a_limit_switch_is_an_error() {
    let mut rig = rig(travel_range(15_000, (-FAR, -FAR)));
    home(&mut rig, 2);
    while rig.int("x.actual.position") < 4_900 {
        rig.run(1);
    }
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run_until("x.limit.positive", 1);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", Code::HARDWARE_LIMIT_POSITIVE.0.into()));
}

#[test]
fn errors_end_it_in_the_same_cycle() {
    let (mut rig, sequence) = under_way();
    rig.plant.drive(0).unwrap().inject_fault(0x7305);
    rig.run(1);
    assert_over(&rig, sequence, Code::drive_fault(0x7305));
    let (mut rig, sequence) = under_way();
    rig.plant.drive(0).unwrap().disconnect();
    rig.run(1);
    assert_over(&rig, sequence, Code::DRIVE_LOST);
    let (mut rig, sequence) = under_way();
    rig.plant.drive(0).unwrap().jump(100_000);
    rig.run(1);
    let code = rig.done(sequence)[0].code;
    assert_eq!(rig.state("x"), "ERROR_STOP");
    assert_over(&rig, sequence, code);
}

/// The motion of a failed homing has no purpose, so the axis stops with any reaction.
#[test]
fn an_error_of_homing_stops_the_axis_whatever_the_reaction() {
    for reaction in 0..=5 {
        let mut rig = rig(travel_range(-12_000, (5_000, FAR)));
        rig.set("error_reaction", Value::Int(reaction));
        rig.plant.drive(0).unwrap().set_stuck_inputs(4, 0);
        let sequence = home(&mut rig, 3);
        while rig.done(sequence).is_empty() {
            rig.run(1);
        }
        // The positive limit switch is reached first.
        assert_over(&rig, sequence, Code::HOMING_AT_LIMIT);
        rig.run(300);
        assert_eq!(rig.int("x.error"), i64::from(Code::HOMING_AT_LIMIT.0), "{reaction}");
        assert_eq!(rig.real("x.command.velocity"), 0.0, "{reaction}");
        assert_eq!(rig.int("x.enabled"), i64::from(!matches!(reaction, 0 | 1 | 4)), "{reaction}");
        let place = rig.int("x.actual.position") - 12_000;
        assert!((20_000..20_700).contains(&place), "{reaction}: {place}");
    }
}

/// Returns the distance that the axis moves until its error for a switch that is stuck at `value`.
fn gone_without_a_switch(rig: &mut Rig, value: u32, method: i64) -> i64 {
    rig.plant.drive(0).unwrap().set_stuck_inputs(4, value);
    rig.run(1);
    let sequence = home(rig, method);
    while rig.done(sequence).is_empty() {
        rig.run(1);
    }
    assert_over(rig, sequence, Code::HOMING_SWITCH_MISSED);
    rig.int("x.actual.position").abs()
}

#[test]
fn a_switch_that_never_changes_ends_it_within_the_largest_way() {
    for (value, method) in [(0, 19), (4, 19), (0, 23), (4, 27), (0, -2), (4, -4)] {
        let fixtures = crate::sim::Fixtures { positive: None, negative: None, ..travel_range(0, (5_000, FAR)) };
        let mut rig = rig(fixtures);
        rig.set("homing.max_distance", Value::Int(3_000));
        let gone = gone_without_a_switch(&mut rig, value, method);
        assert!((3_001..=3_010).contains(&gone), "{method}, stuck at {value}: {gone}");
    }
}

/// A rotary axis without limits and without a maximum distance: two revolutions are enough to detect its switch.
#[test]
fn rotary_axis_searches_its_switch_for_two_revolutions() {
    for (value, method) in [(0, 19), (4, 19), (0, -2)] {
        let mut config = cell(0);
        let x = &mut config.axes[usize::from(X)];
        x.modulo = crate::modulo::Modulo::new(21_601, 3);
        x.parameters.homing.max_distance = None;
        let fixtures = crate::sim::Fixtures { positive: None, negative: None, ..travel_range(0, (5_000, FAR)) };
        let mut rig = rig_with(config, Model::Ideal, fixtures);
        // 7200 1/3 inc are rounded up to 7201.
        let gone = gone_without_a_switch(&mut rig, value, method);
        assert!((14_403..=14_412).contains(&gone), "{method}, stuck at {value}: {gone}");
    }
}

#[test]
fn nothing_else_moves_an_axis_that_homes() {
    let (mut rig, _) = under_way();
    let under_way = "x: the axis is homing; wait for its end, or cancel it";
    for action in [
        Action::Move(to(X, 1)),
        Action::Move(at(X, 1_000.0)),
        Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)),
    ] {
        let sequence = rig.give(action);
        assert_eq!(rig.refusal(sequence), under_way);
    }
    let sequence = home(&mut rig, 3);
    assert_eq!(rig.refusal(sequence), under_way);
    let sequence = rig.give(Action::SetPosition(crate::command::SetPosition {
        axis: X,
        position: crate::position::Length::whole(0),
    }));
    assert_eq!(rig.refusal(sequence), "x: the axis is homing; wait for its end, or halt it first");
    rig.stream(X, 1_000.0);
    assert_eq!(rig.state("x"), "HOMING");
    assert!(rig.events.iter().any(|event| event.code == Code::HOMING_UNDER_WAY && event.command == 0));
}

/// Proves: MACS-HOME-04
#[test]
fn missing_requirement_of_homing_is_refused_with_message() {
    let cases: [(&str, Value, i64, &str); 4] = [
        (
            "homing.velocity",
            Value::Real(0.0),
            3,
            "homing.velocity is 0; give one above 0, or below 0 for the other direction",
        ),
        ("home_vel", Value::Int(0), -1, "homing.velocity is 0; give one above 0, or below 0 for the other direction"),
        (
            "i_refswitch",
            Value::Int(0),
            -1,
            "i_refswitch is 0, and home_type 0 needs a reference switch; n or -n, the n-th digital input, is allowed",
        ),
        ("revers", Value::Int(2), 3, "velocity -10 mm/s leads backwards, which revers forbids; 0 or more is allowed"),
    ];
    for (key, value, method, sentence) in cases {
        let mut config = cell(0);
        assign(&mut config.axes[usize::from(X)].parameters, key, value);
        let mut rig = rig_with(config, Model::Ideal, travel_range(0, (5_000, FAR)));
        let sequence = home(&mut rig, method);
        assert_eq!(rig.refusal(sequence), format!("x: {sentence}"));
        assert_eq!((rig.state("x"), rig.int("x.homed")), ("STANDSTILL", 0));
    }
    // If all motion is forward, homing is allowed.
    let mut config = cell(0);
    assign(&mut config.axes[usize::from(X)].parameters, "revers", Value::Int(2));
    let mut rig = rig_with(config, Model::Ideal, travel_range(0, (5_000, 7_000)));
    let sequence = home(&mut rig, -4);
    assert!(rig.was_accepted(sequence));
    let mut rig = Rig::enabled();
    let sequence = home(&mut rig, 0);
    assert!(rig.refusal(sequence).contains("scheme cia402 has no homing method 0; 1 to 14, "));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(10);
    let sequence = home(&mut rig, 3);
    assert_eq!(rig.refusal(sequence), "x: the axis is not enabled; enable it first");
    let line = crate::command::HomeAxis { axis: LINE, method: crate::command::HomingMethod::Cia402(3) };
    let sequence = rig.give(Action::HomeAxis(line));
    assert_eq!(
        rig.refusal(sequence),
        "line: the axis is virtual, without switches and index for homing method 3; 35 and 37 are allowed"
    );
}

/// A second machine that continues in the middle gives the same results.
#[test]
fn the_state_of_homing_can_be_restored() {
    let mut rig = rig_with(cell(2), Model::Ideal, travel_range(-12_000, (4_000, 7_000)));
    let sequence = home(&mut rig, 10);
    rig.run(500);
    rig.mirror();
    assert_eq!(run_to_end(&mut rig, sequence).code, Code::NONE);
}

/// Limits are not active during homing: a stop that starts exactly at a limit still has its ramp.
#[test]
fn a_stop_of_homing_on_a_software_limit_has_its_ramp() {
    for ahead in [0, 10] {
        let place = 1_000;
        let mut cell = cell(0);
        let p = &mut cell.axes[usize::from(X)].parameters;
        (p.min_position, p.max_position) = (Some(-50_000), Some(place + ahead));
        let mut rig = rig_with(cell, Model::Ideal, travel_range(-10_000, (5_000, FAR)));
        home(&mut rig, 19);
        rig.run_until("x.command.position", place);
        let before = rig.real("x.command.velocity");
        assert_eq!((before, rig.real("x.command.fraction")), (10_000.0, 0.0));
        rig.give(Action::QuickStop([X].into_iter().collect()));
        let mut last = before;
        while last != 0.0 {
            let now = rig.real("x.command.velocity");
            // 1e6 inc/s^2.
            assert!((now - last).abs() < 1_001.0, "{ahead}: {last} to {now}");
            last = now;
            rig.run(1);
        }
        assert_eq!(rig.state("x"), "STOPPING");
    }
}
