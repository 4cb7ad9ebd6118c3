//! Master selected by MENCODERTYPE, for couplings that name no leader.

use super::rig::{LINE, Rig, X, Y, config, couple, to};
use crate::code::Code;
use crate::command::{Action, SetPosition, Synchronize};
use crate::config::{IoConfig, IoKind};
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use crate::position::Length;

fn set(rig: &mut Rig, axis: u16, values: &[(&str, Value)]) -> u64 {
    let change = |&(key, value): &(&str, Value)| Change { axis, row: Row::find(key).unwrap().0, value };
    rig.give(Action::SetParameters(values.iter().map(change).collect()))
}

/// Returns a rig in which x has this MENCODERTYPE before it is switched on.
fn rig(kind: i64) -> Rig {
    let mut cell = config(0);
    cell.io = vec![IoConfig { name: "stop".into(), kind: IoKind::DigitalInput, latch: false }];
    cell.global.parameters.i_break = 1;
    cell.axes[usize::from(X)].parameters.encoder.mencodertype = kind;
    let mut rig = Rig::of(cell);
    rig.enable();
    rig
}

fn follow(rig: &mut Rig) -> u64 {
    let request = couple(X, Leader::AxisCommand(Y), 1, 1);
    rig.give(Action::Synchronize(Synchronize { leader: None, ..request }))
}

/// Axis 1 is `line`. A new zero of the master is not a motion.
///
/// Proves: MACS-ENC-15
#[test]
fn a_negative_number_is_the_command_of_that_axis() {
    let mut rig = rig(-1);
    let sequence = follow(&mut rig);
    assert!(rig.was_accepted(sequence));
    rig.give(Action::Move(to(LINE, 3_000)));
    rig.run_until("line.state", 1);
    rig.run(5);
    assert_eq!((rig.int("x.command.position"), rig.real("x.master.position")), (3_000, 3_000.0));
    rig.give(Action::SetPosition(SetPosition { axis: LINE, position: Length::whole(-7) }));
    rig.run(5);
    assert_eq!(
        (rig.int("x.command.position"), rig.int("x.sync.error"), rig.int("line.command.position")),
        (3_000, 0, -7)
    );
    assert_eq!(rig.real("x.master.position"), 3_000.0, "the linked master counts on");
    rig.give(Action::Move(to(LINE, 93)));
    rig.run_until("line.state", 1);
    rig.run(5);
    assert_eq!((rig.int("x.command.position"), rig.real("x.master.position")), (3_100, 3_100.0));
}

/// Proves: MACS-ENC-14
#[test]
fn a_terminal_is_an_entry_of_encoders() {
    let mut rig = rig(10);
    let sequence = follow(&mut rig);
    assert!(rig.was_accepted(sequence));
    assert_eq!(rig.machine.state.axes[usize::from(X)].leader(), Some(Leader::Encoder(0)));
}

/// The default names no master. A named leader is still followed.
///
/// Proves: MACS-ENC-14
#[test]
fn unused_mencodertype_is_refused_with_allowed_values() {
    for kind in [0, 1, 2, 5] {
        let mut rig = rig(kind);
        let sequence = follow(&mut rig);
        let sentence = format!(
            "x: no master is named, and mencodertype {kind} names none that the cell has; name one, or set it to -n (axis n), 10, \
             20, 30 (an entry of encoders) or 6 (a simulated one)"
        );
        assert_eq!(rig.refusal(sequence), sentence);
        let sequence = rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(LINE), 1, 1)));
        assert!(rig.was_accepted(sequence));
    }
}

/// A number beyond the axes or encoders of the cell, and the axis itself, which is axis 2: refused when it is set, and
/// when a machine is created with saved values.
///
/// Proves: MACS-ENC-14
#[test]
fn numbers_that_name_what_is_not_there_are_refused_when_they_are_set() {
    let none = "names an axis that the cell does not have: -1 is the first one";
    let terminal = "names an entry of section encoders that the cell does not have: 10 is the first one";
    let mut rig = rig(0);
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(50);
    for (kind, why) in [
        (-2, "names the axis itself; another one is allowed"),
        (-4, none),
        (-999, none),
        (20, terminal),
        (30, terminal),
    ] {
        let refused = set(&mut rig, X, &[("mencodertype", Value::Int(kind))]);
        assert_eq!(rig.refusal(refused), format!("x: mencodertype {kind} {why}"));
        let mut cell = config(0);
        let x = &mut cell.axes[usize::from(X)];
        x.saved = Some(x.parameters);
        assert!(crate::machine::Machine::new(cell.clone()).is_ok());
        let saved = cell.axes[usize::from(X)].saved.as_mut().unwrap();
        saved.encoder.mencodertype = kind;
        let error = crate::machine::Machine::new(cell).unwrap_err();
        assert_eq!(error.to_string(), format!("x: mencodertype {why}"));
    }
    for kind in [-3, 10, 6] {
        let accepted = set(&mut rig, X, &[("mencodertype", Value::Int(kind))]);
        assert!(rig.was_accepted(accepted), "{kind}");
    }
}

#[test]
fn it_changes_while_the_axis_is_disabled_and_only_to_what_there_is() {
    let mut rig = rig(0);
    let refused = set(&mut rig, X, &[("mencodertype", Value::Int(-1))]);
    assert!(rig.refusal(refused).contains("mencodertype"), "enabled");
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(50);
    for (kind, part) in [(7, "is no type of encoder"), (102_005, "names a node of a bus")] {
        let refused = set(&mut rig, X, &[("mencodertype", Value::Int(kind))]);
        assert!(rig.refusal(refused).contains(part), "{}", rig.refusal(refused));
    }
    let accepted = set(&mut rig, X, &[("mencodertype", Value::Int(-1))]);
    assert!(rig.was_accepted(accepted));
}

/// The simulated master runs exactly, with or without followers; a follower moves by its change, geared. An abort stops
/// it permanently.
///
/// Proves: MACS-ENC-14, MACS-ENC-16
#[test]
fn the_simulated_master_runs_with_its_velocity_until_an_abort() {
    let by_input = |rig: &mut Rig| rig.plant.set_digital(0, true);
    stops_by(Code::INTERRUPTED, by_input);
}

/// The abort of the program stops it, too; a quick stop is not an abort.
///
/// Proves: MACS-ENC-16, MACS-ERR-09
#[test]
fn an_abort_stops_the_simulated_master_and_a_quick_stop_does_not() {
    stops_by(Code::ABORTED, |rig| {
        rig.give(Action::Abort);
    });
    let mut rig = rig(6);
    set(&mut rig, X, &[("master_simulation_velocity", Value::Real(1_000.0))]);
    rig.give(Action::QuickStop(AxisSet::first(3)));
    rig.run(10);
    assert_eq!((rig.state("x"), rig.real("x.master.velocity")), ("STOPPING", 1_000.0));
    // An axis that is off also gets the event.
    rig.give(Action::Disable(AxisSet::first(3)));
    rig.run(100);
    rig.give(Action::Abort);
    rig.run(2);
    assert_eq!((rig.int("x.enabled"), rig.real("x.master.velocity")), (0, 0.0));
}

fn stops_by(code: Code, abort: impl Fn(&mut Rig)) {
    let mut rig = rig(6);
    let velocity = |value| [("master_simulation_velocity", Value::Real(value))];
    let accepted = set(&mut rig, X, &velocity(-2_500.0));
    assert!(rig.was_accepted(accepted));
    rig.run(99);
    // 2.5 inc per cycle, in the cycle of the command, too.
    assert_eq!((rig.real("x.master.position"), rig.real("x.master.velocity")), (-250.0, -2_500.0));
    set(&mut rig, X, &velocity(0.0));
    let request = couple(X, Leader::AxisCommand(Y), 2, 1);
    let sequence = rig.give(Action::Synchronize(Synchronize { leader: None, ..request }));
    assert!(rig.was_accepted(sequence));
    set(&mut rig, X, &velocity(1_000.0));
    rig.run(2_000);
    let position = rig.real("x.master.position");
    assert_eq!((rig.int("x.in_sync"), rig.int("x.command.position") as f64), (1, 2.0 * (position + 250.0)));
    assert_eq!(rig.int("x.sync.error"), 0);
    abort(&mut rig);
    rig.run(2);
    let position = rig.real("x.master.position");
    rig.run(500);
    assert_eq!((rig.real("x.master.velocity"), rig.real("x.master.position")), (0.0, position));
    assert_eq!(rig.done(sequence)[0].code, code);
    assert_eq!(rig.machine.parameters(X).unwrap().encoder.master_velocity, 0.0);
    assert_eq!(rig.machine.parameters(Y).unwrap().encoder.master_velocity, 0.0);
}

mod zero;
