//! Effect of errors on an axis and on the others, the target window, and the contacts of the cell.

use super::rig::{LINE, Rig, X, Y, at, config, couple, to};
use crate::axis::Safety;
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod};
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::event::{Event, Kind};
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Row, Value};
use crate::vocabulary::{saia, saia::Register, wf};

const MS: i64 = 1_000_000;

fn errors(rig: &Rig) -> Vec<&Event> {
    rig.events.iter().filter(|event| event.kind == Kind::Error).collect()
}

fn code(code: Code) -> i64 {
    i64::from(code.0)
}

/// The command is checked after the errors of its cycle are known.
///
/// Proves: MACS-ERR-03
#[test]
fn an_enable_in_the_cycle_of_an_error_switches_nothing_on() {
    use crate::drive::inputs;
    for reaction in 0..6 {
        let mut config = config(0);
        config.axes[1].parameters.error_reaction = reaction;
        let mut rig = Rig::of(config);
        rig.enable();
        rig.plant.drive(0).unwrap().set_stuck_inputs(inputs::POSITIVE_LIMIT, inputs::POSITIVE_LIMIT);
        let enable = rig.give(Action::Enable(AxisSet::one(X)));
        assert_eq!((rig.state("x"), rig.int("x.error")), ("ERROR_STOP", 10_221), "{reaction}");
        let powerless = reaction < 2;
        for _ in 0..20 {
            assert_eq!(rig.outputs().drive[0].control == 0, powerless, "{reaction}");
            rig.run(1);
            assert_eq!(rig.state("x"), "ERROR_STOP", "{reaction}");
        }
        assert_eq!(rig.refusal(enable), "x: the axis stands in ERROR_STOP; reset_errors first", "{reaction}");
    }
}

/// Proves: MACS-ERR-05
#[test]
fn a_following_error_stops_all_axes_each_by_its_own_reaction_in_the_same_cycle() {
    // The axis with the error is before or after the other one.
    for (place, failed, other) in [(0, "x", "y"), (1, "y", "x")] {
        let mut config = config(0);
        for (axis, reaction) in [(1, 0), (2, 2)] {
            config.axes[axis].parameters.error_reaction = reaction;
            config.axes[axis].parameters.supervision.following_error_stops_all = 1;
        }
        let mut rig = Rig::of(config);
        rig.enable();
        let goals = [at(X, 50_000.0), at(Y, 50_000.0), at(LINE, 50_000.0)].map(|goal| rig.give(Action::Move(goal)));
        rig.run(100);
        rig.plant.drive(place).unwrap().jump(5_000);
        let cycle = rig.machine.next_cycle();
        rig.run(1);
        assert_eq!((rig.int(&format!("{failed}.error")), rig.int(&format!("{other}.error"))), (10_201, 10_224));
        assert!(errors(&rig).iter().all(|event| event.cycle == cycle));
        let sentence = crate::text::message(errors(&rig)[1], rig.machine.config());
        assert_eq!(sentence, format!("{other}: stopped, because {failed} has a following error"));
        assert_eq!(
            (rig.state("x"), rig.state("y"), rig.state("line")),
            ("ERROR_STOP", "ERROR_STOP", "CONTINUOUS_MOTION")
        );
        // x coasts, y stops under control.
        assert_eq!((rig.int("x.enabled"), rig.int("y.enabled")), (0, 1));
        assert_eq!(rig.outputs().drive[0].control, 0, "no voltage in the cycle of the error");
        assert!(rig.real("y.command.velocity") > 0.0);
        assert!(goals[..2].iter().all(|goal| rig.done(*goal).len() == 1));
        rig.run(60);
        assert_eq!(rig.real("y.command.velocity"), 0.0);
        let reset = rig.give(Action::ResetErrors(AxisSet::first(3)));
        rig.run(2);
        assert!(rig.done(reset).iter().all(|done| done.code.is_none()));
        assert_eq!((rig.state("x"), rig.state("y")), ("DISABLED", "STANDSTILL"));
    }
}

#[test]
fn following_error_stops_other_axes_only_if_configured() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(Y, 50_000.0)));
    rig.plant.drive(0).unwrap().jump(5_000);
    rig.run(1);
    assert_eq!((rig.int("x.error"), rig.int("y.error"), rig.state("y")), (10_201, 0, "CONTINUOUS_MOTION"));
}

/// An axis that is off has no motion to stop.
#[test]
fn an_axis_that_is_off_is_not_concerned() {
    let mut config = config(0);
    config.axes[1].parameters.supervision.following_error_stops_all = 1;
    let mut rig = Rig::of(config);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(40);
    rig.plant.drive(0).unwrap().jump(5_000);
    rig.run(1);
    assert_eq!((rig.state("x"), rig.state("y"), rig.int("y.error")), ("ERROR_STOP", "DISABLED", 0));
}

/// Proves: MACS-ERR-03, MACS-ERR-04
#[test]
fn reported_error_is_repeated_while_it_persists() {
    let mut config = config(0);
    config.axes[1].parameters.error_reaction = 5;
    config.axes[1].parameters.supervision.following_error_stops_all = 1;
    // The simulated drive corrects its position, so it has to be pushed away repeatedly.
    let mut rig = Rig::of(config);
    rig.enable();
    let before = rig.machine.next_cycle();
    for _ in 0..2_500 {
        rig.plant.drive(0).unwrap().jump(2_000);
        rig.run(1);
    }
    let told = errors(&rig).into_iter().filter(|event| event.code == Code::FOLLOWING_ERROR);
    assert_eq!(told.map(|event| event.cycle - before).collect::<Vec<_>>(), [0, 1_000, 2_000]);
    assert_eq!((rig.int("x.error"), rig.state("x")), (10_201, "STANDSTILL"));
    // each axis has its own reaction, that of y is 2.
    assert_eq!((rig.int("y.error"), rig.state("y")), (10_224, "ERROR_STOP"));
}

/// O-25: 300 ms with two axes: 300/(2*20) = 7.5 -> 7, an error if detected more often; with one axis: 15.
///
/// Proves: MACS-O-25, MACS-ERR-07
#[test]
fn round_robin_looks_at_each_axis_in_turn_and_counts() {
    for (axes, tolerated) in [(2, 7), (1, 15)] {
        let mut config = config(0);
        config.axes.truncate(1 + axes);
        let parameters = &mut config.axes[1].parameters;
        parameters.following_error_time = 300 * MS;
        parameters.supervision.following_error_check = 1;
        let mut rig = Rig::of(config);
        rig.give(Action::Enable(AxisSet::one(X)));
        // x is the first in turn: it is checked every axes * 20 ms, from 0 on.
        let round = 20 * axes as u64;
        while rig.machine.next_cycle() < 10 * round + 1 {
            rig.run(1);
        }
        for _ in 0..(tolerated + 1) * round {
            assert_eq!(rig.int("x.error"), 0, "cycle {}", rig.machine.next_cycle());
            rig.plant.drive(0).unwrap().jump(2_000);
            rig.run(1);
        }
        assert_eq!(rig.int("x.error"), 10_201, "{axes} axes");
        assert_eq!(errors(&rig)[0].cycle, (10 + tolerated + 1) * round);
    }
}

/// O-26: with 500 lines the guide value of POSERR, which its row names, is a revolution of 2000 qc: this much is
/// tolerated, one more is an error.
///
/// Proves: MACS-O-26, MACS-ERR-06
#[test]
fn a_revolution_of_following_error_is_tolerated_and_no_more() {
    let row = |key| Row::find(key).unwrap_or_else(|| panic!("no row {key}")).1;
    assert!(row("poserr").description.contains("One revolution of the encoder, 4 ENCODER, is a good value."));
    for (slip, error) in [(2_000, 0), (-2_000, 0), (2_001, 10_201), (-2_001, 10_201)] {
        let mut config = config(0);
        let parameters = &mut config.axes[1].parameters;
        // 60 rpm are one revolution per second.
        let given = [("encoder", Value::Int(500)), ("velmax", Value::Real(60.0)), ("poserr", Value::Int(2_000))];
        for (key, value) in given {
            assert_eq!(row(key).assign(parameters, value), Ok(()), "{key}");
        }
        assert_eq!((parameters.max_velocity, parameters.homing_index_distance()), (2_000.0, 2_000));
        let mut rig = Rig::of(config);
        rig.enable();
        rig.plant.drive(0).unwrap().jump(slip);
        rig.run(1);
        assert_eq!((rig.int("x.following_error"), rig.int("x.error")), (-slip, error));
    }
}

/// If it is once within its limit, it counts from 0 again.
///
/// Proves: MACS-ERR-07
#[test]
fn round_robin_count_restarts_after_a_good_check() {
    let mut config = config(0);
    config.axes.truncate(2);
    config.axes[1].parameters.following_error_time = 40 * MS;
    config.axes[1].parameters.supervision.following_error_check = 1;
    let mut rig = Rig::of(config);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(60);
    // Two of three checks detect it.
    for look in 0..30 {
        for _ in 0..20 {
            if look % 3 != 2 {
                rig.plant.drive(0).unwrap().jump(2_000);
            }
            rig.run(1);
        }
    }
    assert_eq!(rig.int("x.error"), 0);
}

/// A drive that settles in steps: the readings of the simulation after the command is at rest.
/// Proves: MACS-TGT-03
#[test]
fn with_testval_two_readings_have_to_be_near_to_each_other() {
    let mut config = config(0);
    let x = &mut config.axes[1].parameters;
    (x.in_position_window, x.in_position_time, x.supervision.testval) = (100, 5 * MS, 10);
    let mut rig = Rig::of(config);
    rig.enable();
    let goal = rig.give(Action::Move(to(X, 10_000)));
    rig.run_until("x.command.position", 10_000);
    // Within the window, alternating by 20 inc: two readings at an odd distance of 5 ms never differ by less than 10
    // inc.
    for cycle in 0..50 {
        let by = if cycle % 2 == 0 { 40 } else { 60 };
        rig.plant.drive(0).unwrap().jump(by);
        rig.run(1);
        assert!(rig.done(goal).is_empty(), "cycle {cycle}");
    }
    // From now on it stands still: a reading within 5 ms, and the one after it.
    let still = rig.machine.next_cycle();
    rig.run_until("x.state", 1);
    let waited = rig.machine.next_cycle() - still;
    assert!((5..=12).contains(&waited), "{waited}");
    assert_eq!(rig.done(goal)[0].code, Code::NONE);
}

/// The target is reached at the earliest testtim after the profile.
/// Proves: MACS-TGT-03, MACS-TGT-05
#[test]
fn two_readings_take_the_time_between_them() {
    for (time, cycles) in [(0, 0), (3, 3), (10, 10)] {
        let mut config = config(0);
        let x = &mut config.axes[1].parameters;
        (x.in_position_window, x.in_position_time, x.supervision.testval) = (1_000, time * MS, 1);
        let mut rig = Rig::of(config);
        rig.enable();
        rig.give(Action::Move(to(X, 10_000)));
        while rig.int("x.command.position") != 10_000 || rig.real("x.command.velocity") != 0.0 {
            rig.run(1);
        }
        // The ideal drive is one cycle behind, 0 at the end of a ramp: the first two readings may differ.
        let waited = rig.run_until("x.state", 1);
        assert!(waited >= cycles && waited <= 2 * cycles, "{time} ms: {waited}");
    }
}

/// Proves: MACS-TGT-06
#[test]
fn unreached_target_window_is_reported_once_and_goal_waits() {
    let mut config = config(0);
    let x = &mut config.axes[1].parameters;
    (x.in_position_window, x.supervision.in_position_timeout) = (10, 50 * MS);
    let mut rig = Rig::of(config);
    rig.enable();
    let goal = rig.give(Action::Move(to(X, 10_000)));
    while rig.int("x.command.position") < 9_900 {
        rig.run(1);
    }
    for _ in 0..300 {
        rig.plant.drive(0).unwrap().jump(30);
        rig.run(1);
    }
    let told: Vec<_> = rig.events.iter().filter(|event| event.code == Code::IN_POSITION_TIMEOUT).collect();
    assert_eq!(told.len(), 1);
    let sentence = crate::text::message(told[0], rig.machine.config());
    assert_eq!(sentence, "x: the goal waits for its target window: -0.03 mm from the target, 0.01 mm is allowed");
    assert!(rig.done(goal).is_empty());
    rig.run_until("x.state", 1);
    assert_eq!(rig.done(goal)[0].code, Code::NONE);
}

/// An axis that waits for its window is supervised as usual.
/// Proves: MACS-TGT-07
#[test]
fn the_wait_for_the_window_blocks_no_supervision() {
    let mut config = config(0);
    let x = &mut config.axes[1].parameters;
    (x.in_position_window, x.in_position_time) = (10, 1_000 * MS);
    let mut rig = Rig::of(config);
    rig.enable();
    let goal = rig.give(Action::Move(to(X, 10_000)));
    rig.run_until("x.command.position", 10_000);
    rig.run(20);
    rig.plant.drive(0).unwrap().jump(1_001);
    rig.run(1);
    assert_eq!((rig.int("x.error"), rig.done(goal)[0].code), (10_201, Code::FOLLOWING_ERROR));
}

/// Returns a cell with its contacts on inputs 1 and 2.
fn guarded() -> MachineConfig {
    let mut config = config(0);
    for name in ["start", "estop", "door"] {
        config.io.push(IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: false });
    }
    config.safety = Safety { estop: Some(1), interlock: Some(2) };
    config
}

fn closed() -> Rig {
    let mut rig = Rig::of(guarded());
    rig.plant.set_digital(1, true);
    rig.plant.set_digital(2, true);
    rig.enable();
    rig
}

#[test]
fn an_emergency_stop_stops_all_axes_and_takes_their_power() {
    let mut rig = closed();
    let goals = [at(X, 50_000.0), to(Y, 50_000), at(LINE, 50_000.0)].map(|goal| rig.give(Action::Move(goal)));
    rig.run(100);
    let before = rig.int("x.command.position");
    rig.plant.set_digital(1, false);
    rig.run(1);
    for axis in ["x", "y", "line"] {
        assert_eq!((rig.state(axis), rig.int(&format!("{axis}.error"))), ("ERROR_STOP", code(Code::EMERGENCY_STOP)));
    }
    assert!(goals.iter().all(|goal| rig.done(*goal)[0].code == Code::EMERGENCY_STOP));
    // The stop continues from the last command without a jump.
    assert!((48..=50).contains(&(rig.int("x.command.position") - before)));
    rig.run(51);
    for axis in ["x", "y"] {
        let shown = ["enabled", "brake"].map(|signal| rig.int(&format!("{axis}.{signal}")));
        assert_eq!(shown, [0, 1], "{axis}: off, and the brake closed");
    }
    assert_eq!(rig.outputs().drive[0].control, 0);
    // While it is open the error returns after each reset, and nothing is switched on.
    let reset = rig.give(Action::ResetErrors(AxisSet::first(3)));
    rig.run(2);
    assert_eq!((rig.done(reset)[0].code, rig.state("x")), (Code::EMERGENCY_STOP, "ERROR_STOP"));
    rig.plant.set_digital(1, true);
    rig.run(1);
    assert_eq!(rig.state("x"), "ERROR_STOP", "closing it resets nothing");
    rig.give(Action::ResetErrors(AxisSet::first(3)));
    rig.run(2);
    assert_eq!((rig.state("x"), rig.int("x.error"), rig.int("x.brake")), ("DISABLED", 0, 0));
    rig.enable();
}

#[test]
fn an_interlock_stops_all_axes_and_holds_them() {
    let mut rig = closed();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(100);
    rig.plant.set_digital(2, false);
    rig.run(60);
    assert_eq!((rig.state("x"), rig.int("x.error"), rig.int("x.enabled")), ("ERROR_STOP", code(Code::INTERLOCK), 1));
    // The emergency stop removes the power of an axis that is held.
    rig.plant.set_digital(1, false);
    rig.run(2);
    assert_eq!((rig.int("x.enabled"), rig.int("x.brake"), rig.int("x.error")), (0, 1, code(Code::INTERLOCK)));
}

#[test]
fn with_an_open_contact_nothing_is_switched_on_or_begins() {
    let mut rig = Rig::of(guarded());
    rig.run(3);
    assert_eq!((rig.state("x"), rig.int("x.error")), ("DISABLED", 0), "what is off and stands has no error");
    let enable = rig.give(Action::Enable(AxisSet::one(X)));
    assert_eq!(rig.refusal(enable), "x: the emergency stop is open");
    let run = rig.give(Action::Move(at(LINE, 1_000.0)));
    assert_eq!(rig.refusal(run), "line: the emergency stop is open");
    rig.plant.set_digital(1, true);
    rig.run(1);
    let enable = rig.give(Action::Enable(AxisSet::one(X)));
    assert_eq!(rig.refusal(enable), "x: the interlock is open");
    rig.plant.set_digital(2, true);
    rig.run(1);
    rig.enable();
}

/// Every command that starts a motion, on an axis that needs no enable.
#[test]
fn with_an_open_contact_every_word_that_moves_is_refused() {
    let fast = [(Register::Veloc, 50_000), (Register::Accel, 1_000_000), (Register::DestP, 1_000)];
    let command = |name| saia::Command::find(name).unwrap();
    let commands = ["axinit", "fldda", "fstart"].map(command).into_iter().collect();
    let start = saia::Request { axis: LINE, commands, ..saia::Request::default() };
    let start = fast.into_iter().fold(start, |start, (register, value)| start.with(register, Value::Int(value)));
    let jog = wf::Request { axis: LINE, mode: Some(wf::Mode::Jog), jog: Some(wf::Jog::Plus), ..Default::default() };
    let words = [
        Action::Move(at(LINE, 1_000.0)),
        Action::Move(to(LINE, 1_000)),
        Action::Synchronize(couple(LINE, Leader::AxisCommand(Y), 1, 1)),
        Action::HomeAxis(HomeAxis { axis: LINE, method: HomingMethod::Cia402(35) }),
        Action::vocabulary(start),
        Action::vocabulary(jog),
    ];
    for (contact, sentence) in [(1, "line: the emergency stop is open"), (2, "line: the interlock is open")] {
        for word in &words {
            let mut rig = closed();
            let (row, _) = Row::find("wf.fixed_speed_1").unwrap();
            rig.give(Action::SetParameters([Change { axis: LINE, row, value: Value::Real(50.0) }].into()));
            rig.plant.set_digital(contact, false);
            rig.run(1);
            let answer = rig.give(word.clone());
            assert_eq!(rig.refusal(answer), sentence, "{word:?}");
            rig.plant.set_digital(contact, true);
            rig.run(50);
            assert_eq!((rig.state("line"), rig.int("line.command.position")), ("STANDSTILL", 0), "{word:?}");
            let answer = rig.give(word.clone());
            assert!(!rig.events.iter().any(|event| event.command == answer && event.kind == Kind::Refused), "{word:?}");
        }
    }
}

/// A virtual axis at rest has no error from an open contact: its selector is reset, and closing the contact starts
/// nothing.
#[test]
fn with_an_open_contact_no_reference_is_selected() {
    let change = |key: &str, value| {
        let (row, _) = Row::find(key).unwrap();
        Action::SetParameters([Change { axis: LINE, row, value: Value::Int(value) }].into())
    };
    let mut rig = closed();
    rig.give(change("amc.reference_select", 1));
    rig.run(5);
    assert_eq!((rig.int("line.amc.select"), rig.state("line")), (1, "STANDSTILL"));
    rig.plant.set_digital(2, false);
    rig.run(2);
    assert_eq!((rig.int("line.amc.select"), rig.state("line"), rig.int("line.error")), (0, "STANDSTILL", 0));
    rig.give(change("amc.position_reference", 5_000));
    let select = rig.give(change("amc.reference_select", 1));
    assert_eq!(rig.refusal(select), "line: the interlock is open");
    rig.plant.set_digital(2, true);
    rig.run(100);
    assert_eq!((rig.int("line.command.position"), rig.state("line")), (0, "STANDSTILL"));
    let select = rig.give(change("amc.reference_select", 1));
    assert!(rig.done(select).is_empty());
    rig.run(500);
    assert_eq!(rig.int("line.command.position"), 5_000);
}

#[test]
fn a_contact_that_opens_while_a_drive_switches_on_keeps_it_off() {
    let mut rig = closed();
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(5);
    let enable = rig.give(Action::Enable(AxisSet::one(X)));
    rig.plant.set_digital(1, false);
    rig.run(1);
    assert_eq!((rig.state("x"), rig.outputs().drive[0].control), ("ERROR_STOP", 0));
    assert_eq!(rig.done(enable)[0].code, Code::EMERGENCY_STOP);
}

/// The first error is kept, with the state of the axis before its reaction.
/// Proves: MACS-ERR-04
#[test]
fn the_first_error_is_kept_with_how_the_axis_stood() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(200);
    let before = rig.int("x.command.position");
    rig.plant.drive(0).unwrap().jump(-3_000);
    let cycle = rig.machine.next_cycle();
    rig.run(1);
    let fault = *rig.machine.fault(X).unwrap();
    assert_eq!((fault.code, fault.cycle), (Code::FOLLOWING_ERROR, cycle));
    assert_eq!((fault.command.floor(), fault.velocity), (before + 50, 50_000.0));
    assert_eq!((fault.actual, fault.following_error), (before - 3_000, 3_000));
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(3);
    assert_eq!(rig.int("x.error"), 10_201, "the drive's own fault is not the first");
    let told = rig.events.iter().filter(|event| event.kind == Kind::Error).map(|event| event.code);
    assert_eq!(told.collect::<Vec<_>>(), [Code::FOLLOWING_ERROR, Code::drive_fault(0x8611)], "and is told, once");
    assert_eq!(rig.int("x.fault.code"), 10_201);
    assert_eq!((rig.int("x.fault.cycle"), rig.int("x.fault.command")), (cycle as i64, before + 50));
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(10);
    assert_eq!((rig.int("x.error"), rig.int("x.fault.code")), (0, 10_201), "it is kept until the next one");
}

/// A drive that has stopped by itself (error_reaction 4) may hold under power: an emergency stop removes the power.
#[test]
fn an_emergency_stop_takes_the_power_of_a_drive_that_stops_by_itself() {
    let mut config = guarded();
    config.axes[usize::from(X)].parameters.error_reaction = 4;
    let mut rig = Rig::of(config);
    rig.plant.set_digital(1, true);
    rig.plant.set_digital(2, true);
    rig.enable();
    rig.plant.drive(0).unwrap().jump(100_000);
    rig.run(2_000);
    assert_eq!((rig.state("x"), rig.int("x.output.control")), ("ERROR_STOP", 2));
    rig.plant.set_digital(1, false);
    rig.run(2);
    assert_eq!((rig.state("x"), rig.int("x.output.control")), ("ERROR_STOP", 0));
    rig.run(50);
    let of_x = rig.events.iter().filter(|event| event.kind == Kind::Error && event.source == Object::Axis(X));
    let told: Vec<_> = of_x.map(|event| event.code).collect();
    assert_eq!(told, [Code::FOLLOWING_ERROR, Code::EMERGENCY_STOP], "it takes the power, and says so once");
}

/// A contact that opens while the axis brakes for another error removes the power at rest, and is reported in its
/// cycle, once.
#[test]
fn emergency_stop_during_another_stop_is_reported_once() {
    let mut rig = closed();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(200);
    rig.plant.drive(0).unwrap().jump(-3_000);
    rig.run(10);
    let told = |rig: &Rig| {
        let of_x = rig.events.iter().filter(|event| event.kind == Kind::Error && event.source == Object::Axis(X));
        of_x.map(|event| event.code).collect::<Vec<_>>()
    };
    assert_eq!(told(&rig), [Code::FOLLOWING_ERROR]);
    rig.plant.set_digital(1, false);
    rig.run(1);
    assert_eq!(told(&rig), [Code::FOLLOWING_ERROR, Code::EMERGENCY_STOP]);
    assert!(rig.real("x.command.velocity") > 0.0, "it still brakes");
    rig.run(100);
    assert_eq!((rig.int("x.output.control"), told(&rig).len()), (0, 2));
}
