//! Limit switches: of the drive, of inputs, with both reactions, in the motion toward the switch and back.

use super::rig::{LINE, Rig, X, Y, at, cases, config, couple, to};
use crate::code::Code;
use crate::command::{Action, Move, MoveMode};
use crate::config::{IoConfig, IoKind};
use crate::drive::inputs;
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::parameter::{AxisParameters, Change, Row, Value};
use crate::sim::Fixtures;
use proptest::prelude::*;

/// Returns a rig with switches at -20 and 20 mm, and with this change of x.
fn rig_of(change: impl Fn(&mut AxisParameters)) -> Rig {
    let mut config = config(0);
    change(&mut config.axes[1].parameters);
    let mut rig = Rig::of(config);
    let fixtures = Fixtures { negative: Some(-20_000), positive: Some(20_000), ..Fixtures::default() };
    rig.plant.drive(0).unwrap().install_fixtures(fixtures);
    rig.enable();
    rig
}

fn error(rig: &Rig) -> i64 {
    rig.int("x.error")
}

fn code(code: Code) -> i64 {
    i64::from(code.0)
}

/// Moves x upwards into its switch with 50 mm/s. Returns the cycle in which the switch was first read.
fn run_into(rig: &mut Rig) -> u64 {
    let goal = rig.give(Action::Move(at(X, 50_000.0)));
    rig.run_until("x.limit.positive", 1);
    assert_eq!((rig.state("x"), error(rig)), ("ERROR_STOP", code(Code::HARDWARE_LIMIT_POSITIVE)));
    assert_eq!(rig.done(goal)[0].code, Code::HARDWARE_LIMIT_POSITIVE);
    rig.machine.next_cycle() - 1
}

/// Proves: MACS-LIM-07, MACS-LIM-08
#[test]
fn the_edge_stops_the_axis_in_its_cycle_with_the_largest_deceleration() {
    let mut rig = rig_of(|x| (x.supervision.endswmod, x.error_reaction) = (1, 0));
    let cycle = run_into(&mut rig);
    let event = rig.events.iter().find(|event| event.kind == Kind::Error).unwrap();
    assert_eq!((event.cycle, event.code), (cycle, Code::HARDWARE_LIMIT_POSITIVE));
    let sentence = crate::text::message(event, rig.machine.config());
    assert_eq!(sentence, "x: the positive limit switch was reached");
    // The stop started one cycle ago, with the last command: 50 mm/s at 1000 mm/s^2 are 50 ms and 1.25 mm.
    let start = rig.int("x.command.position");
    assert_eq!(rig.real("x.command.velocity"), 49_000.0);
    rig.run(49);
    assert_eq!(rig.real("x.command.velocity"), 0.0);
    // 1.25 mm in total less the 49.5 um of the first cycle.
    assert!((1_200..=1_201).contains(&(rig.int("x.command.position") - start)));
    rig.run(10);
    assert_eq!((rig.state("x"), rig.int("x.enabled")), ("ERROR_STOP", 1), "A-17: it stays in control");
}

/// Proves: MACS-LIM-08, MACS-ERR-02
#[test]
fn without_endswmod_the_error_reaction_decides_and_five_stops_too() {
    // Reaction; then power and brake in the cycle of the error, and at rest.
    for (reaction, at_once, at_rest) in [
        (0, (0, 0), (0, 0)),
        (1, (0, 1), (0, 1)),
        (2, (1, 0), (1, 0)),
        (3, (1, 0), (1, 1)),
        (4, (0, 0), (0, 0)),
        (5, (1, 0), (1, 0)),
    ] {
        let mut rig = rig_of(|x| x.error_reaction = reaction);
        run_into(&mut rig);
        assert_eq!((rig.int("x.enabled"), rig.int("x.brake")), at_once, "reaction {reaction}");
        rig.run(100);
        assert_eq!((rig.int("x.enabled"), rig.int("x.brake")), at_rest, "reaction {reaction}");
        assert_eq!((rig.state("x"), rig.real("x.command.velocity")), ("ERROR_STOP", 0.0), "reaction {reaction}");
    }
}

/// Proves: MACS-LIM-05, MACS-LIM-09
#[test]
fn after_reset_motion_back_is_allowed_and_motion_into_switch_is_error_98() {
    let mut rig = rig_of(|x| x.supervision.endswmod = 1);
    run_into(&mut rig);
    rig.run(100);
    let here = rig.int("x.command.position");
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    assert_eq!((rig.state("x"), error(&rig)), ("STANDSTILL", 0), "the level alone is no error");
    let sentence = "x: the positive limit switch is actuated; only the way back is open";
    for wrong in [at(X, 1.0), to(X, here + 1), Move { mode: MoveMode::Relative, ..to(X, 1_000) }] {
        let refused = rig.give(Action::Move(wrong));
        assert_eq!(rig.refusal(refused), sentence);
        let refused = rig.events.iter().rev().find(|event| event.command == refused).unwrap();
        assert_eq!(refused.code, Code::LIMIT_VIOLATION);
    }
    assert_eq!((rig.state("x"), rig.int("x.command.position")), ("STANDSTILL", here));
    let back = rig.give(Action::Move(to(X, 0)));
    assert!(rig.was_accepted(back));
    rig.run_until("x.state", 1);
    assert_eq!((rig.done(back)[0].code, rig.int("x.command.position"), error(&rig)), (Code::NONE, 0, 0));
    let again = rig.give(Action::Move(to(X, 10_000)));
    assert!(rig.was_accepted(again), "off the switch both ways are open");
}

/// Proves: MACS-LIM-05, MACS-LIM-09
#[test]
fn an_axis_that_stands_on_its_switch_at_power_on_moves_only_away() {
    let mut rig = Rig::of(config(0));
    let drive = rig.plant.drive(0).unwrap();
    drive.install_fixtures(Fixtures { start: -21_000, negative: Some(-20_000), ..Fixtures::default() });
    rig.enable();
    assert_eq!((rig.int("x.limit.negative"), error(&rig), rig.state("x")), (1, 0, "STANDSTILL"));
    let wrong = rig.give(Action::Move(at(X, -1_000.0)));
    assert_eq!(rig.refusal(wrong), "x: the negative limit switch is actuated; only the way back is open");
    // Before it moves it is unknown whether a coupling leads into the switch: the axis is stopped then, with the same
    // code.
    let coupled = rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
    assert!(rig.was_accepted(coupled));
    rig.give(Action::Move(at(LINE, -20_000.0)));
    rig.run(20);
    assert_eq!((rig.state("x"), error(&rig)), ("ERROR_STOP", code(Code::LIMIT_VIOLATION)));
    assert!(rig.int("x.command.position") > -20, "it did not follow");
    rig.give(Action::Halt(AxisSet::one(LINE)));
    rig.run(100);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    let away = rig.give(Action::Move(at(X, 10_000.0)));
    assert!(rig.was_accepted(away));
    rig.run(300);
    assert_eq!((rig.int("x.limit.negative"), error(&rig)), (0, 0));
}

/// Proves: MACS-LIM-07
#[test]
fn an_assigned_input_is_a_limit_switch_by_its_sign() {
    // Input 2, inverted: a normally closed contact.
    let mut config = config(0);
    for name in ["start", "end_switch"] {
        config.io.push(IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: false });
    }
    config.axes[1].parameters.assigned.poslimitsw = -2;
    let mut rig = Rig::of(config);
    rig.plant.set_digital(1, true);
    rig.enable();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(100);
    assert_eq!((rig.int("x.limit.positive"), error(&rig)), (0, 0));
    rig.plant.set_digital(1, false);
    rig.run(1);
    assert_eq!((rig.int("x.limit.positive"), error(&rig)), (1, code(Code::HARDWARE_LIMIT_POSITIVE)));
}

#[test]
fn an_edge_at_rest_is_an_error_and_one_on_the_way_back_is_not() {
    let mut rig = rig_of(|_| ());
    rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
    rig.run(1);
    assert_eq!((rig.state("x"), error(&rig)), ("ERROR_STOP", code(Code::HARDWARE_LIMIT_POSITIVE)));
    rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, 0);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.give(Action::Move(at(X, -10_000.0)));
    rig.run(50);
    rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
    rig.run(1);
    assert_eq!((rig.state("x"), error(&rig)), ("CONTINUOUS_MOTION", 0));
    let told = rig.events.iter().filter(|event| event.kind == Kind::Limit).count();
    assert_eq!(told, 1, "it is told");
}

#[test]
fn both_switches_at_once_stop_any_motion_and_leave_no_way() {
    let mut rig = rig_of(|_| ());
    rig.give(Action::Move(at(X, -10_000.0)));
    rig.run(50);
    let both = inputs::POSITIVE_LIMIT | inputs::NEGATIVE_LIMIT;
    rig.plant.drive(0).unwrap().set_stuck_inputs(both, both);
    rig.run(1);
    assert_eq!((rig.state("x"), error(&rig)), ("ERROR_STOP", code(Code::BOTH_LIMIT_SWITCHES)));
    rig.run(100);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    for velocity in [-1.0, 1.0] {
        let refused = rig.give(Action::Move(at(X, velocity)));
        assert_eq!(rig.refusal(refused), "x: both limit switches are actuated; neither way is open");
    }
}

/// Proves: MACS-LIM-07, MACS-LIM-08
#[test]
fn in_inverted_units_the_positive_switch_still_bounds_rising_counts() {
    let mut rig = rig_of(|x| {
        x.macs.posdrct = -1;
        x.supervision.endswmod = 1;
    });
    // Downwards in units is upwards in counts.
    rig.give(Action::Move(at(X, -50_000.0)));
    rig.run_until("x.limit.positive", 1);
    assert_eq!((rig.state("x"), error(&rig)), ("ERROR_STOP", code(Code::HARDWARE_LIMIT_POSITIVE)));
    rig.run(100);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    let (further, back) = (Action::Move(at(X, -1.0)), Action::Move(at(X, 1_000.0)));
    let further = rig.give(further);
    assert_eq!(rig.refusal(further), "x: the positive limit switch is actuated; only the way back is open");
    let back = rig.give(back);
    assert!(rig.was_accepted(back));
}

/// Proves: MACS-LIM-06
#[test]
fn pushed_off_its_switch_by_hand_both_ways_are_open() {
    let mut rig = rig_of(|x| x.error_reaction = 0);
    run_into(&mut rig);
    rig.run(5);
    rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, 0);
    rig.run(2);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.enable();
    let further = rig.give(Action::Move(Move { mode: MoveMode::Relative, ..to(X, 1_000) }));
    assert!(rig.was_accepted(further));
}

#[test]
fn endswmod_and_the_inputs_are_read_in_the_cycle_of_the_edge() {
    let set = |rig: &mut Rig, key, value| {
        let row = Row::find(key).map(|(row, _)| row).expect(key);
        let changes = [Change { axis: X, row, value: Value::Int(value) }];
        let sequence = rig.give(Action::SetParameters(changes.into()));
        assert!(rig.was_accepted(sequence), "{key}");
    };
    let mut rig = rig_of(|x| x.error_reaction = 0);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(100);
    set(&mut rig, "endswmod", 1);
    rig.run_until("x.limit.positive", 1);
    assert_eq!((error(&rig), rig.int("x.enabled")), (code(Code::HARDWARE_LIMIT_POSITIVE), 1));
    for (key, signal) in [
        ("i_poslimitsw", "x.limit.positive"),
        ("i_neglimitsw", "x.limit.negative"),
        ("i_refswitch", "x.reference_switch"),
    ] {
        let mut config = config(0);
        config.io.push(IoConfig { name: "start".into(), kind: IoKind::DigitalInput, latch: false });
        let mut rig = Rig::of(config);
        rig.plant.set_digital(0, true);
        rig.run(2);
        assert_eq!(rig.int(signal), 0);
        set(&mut rig, key, 1);
        rig.run(1);
        assert_eq!(rig.int(signal), 1, "{key}");
    }
}

#[test]
fn the_other_axes_go_on() {
    let mut rig = rig_of(|_| ());
    rig.give(Action::Move(at(Y, 10_000.0)));
    run_into(&mut rig);
    rig.run(20);
    assert_eq!((rig.state("y"), rig.int("y.error")), ("CONTINUOUS_MOTION", 0));
}

proptest! {
    #![proptest_config(cases(60))]

    /// With any source of motion: from the cycle of the edge, the axis moves into the switch by at most its stopping
    /// distance.
    ///
    /// Proves: MACS-LIM-08, MACS-LIM-09
    #[test]
    fn no_motion_continues_into_a_switch(
        velocity in 1_000.0..100_000.0_f64, rate in 10_000.0..1_000_000.0_f64, kind in 0..4_u8, halt_at in 0_u64..400,
    ) {
        let mut rig = rig_of(|x| x.supervision.endswmod = 1);
        let fast = Move { acceleration: rate, deceleration: rate, velocity, ..to(X, 60_000) };
        match kind {
            0 => { rig.give(Action::Move(fast)); }
            1 => { rig.give(Action::Move(Move { acceleration: rate, ..at(X, velocity) })); }
            2 => {
                rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
                rig.give(Action::Move(Move { acceleration: rate, ..at(LINE, velocity) }));
            }
            _ => {}
        }
        // The distance of a stop from the maximum velocity, plus the cycle of the edge and the cycles of the drive.
        let most = 20_000.0 + 100_000.0 * 100_000.0 / 2e6 + 3.0 * 100.0;
        for cycle in 0..3_000 {
            if kind == 3 {
                rig.stream(X, velocity);
            } else {
                rig.run(1);
            }
            if cycle == halt_at && kind < 2 && rig.state("x") != "ERROR_STOP" {
                rig.give(Action::Halt(AxisSet::one(X)));
                rig.give(Action::Move(fast));
            }
            prop_assert!((rig.int("x.actual.position") as f64) < most, "{}", rig.int("x.actual.position"));
            if rig.int("x.limit.positive") == 1 {
                prop_assert_eq!(rig.state("x"), "ERROR_STOP");
            }
        }
    }
}

/// A switch that is reached while an error stops the axis is reported in addition; with both switches active no
/// direction is free.
///
/// Proves: MACS-LIM-09
#[test]
fn second_limit_switch_is_reported() {
    for rests in [false, true] {
        let mut rig = rig_of(|x| x.supervision.endswmod = 1);
        run_into(&mut rig);
        rig.run(if rests { 100 } else { 10 });
        rig.events.clear();
        rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::NEGATIVE_LIMIT, inputs::NEGATIVE_LIMIT);
        rig.run(10);
        let told: Vec<Code> =
            rig.events.iter().filter(|event| event.kind == Kind::Error).map(|event| event.code).collect();
        assert_eq!((told, error(&rig)), (vec![Code::BOTH_LIMIT_SWITCHES], code(Code::HARDWARE_LIMIT_POSITIVE)));
        rig.run(100);
        rig.give(Action::ResetErrors(AxisSet::one(X)));
        rig.run(2);
        assert_eq!(rig.state("x"), "STANDSTILL");
        for velocity in [10_000.0, -10_000.0] {
            let refused = rig.give(Action::Move(at(X, velocity)));
            assert_eq!(rig.refusal(refused), "x: both limit switches are actuated; neither way is open");
        }
    }
}
