//! Zeros of masters: DEFMORIGIN and SETMORIGIN, soft and hard, for axes, encoders and simulated masters.

use super::super::rig::{LINE, Rig, X, Y, config, couple, to};
use super::{follow, set};
use crate::command::{Action, MasterPosition, SetEncoderPosition, SetMasterPosition, SetPosition, Synchronize};
use crate::config::MachineConfig;
use crate::drive::Interface;
use crate::encoder::{Absolute, Form};
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::parameter::Value;
use crate::position::Length;

fn master(axis: u16, position: i64) -> Action {
    let position = MasterPosition::Increments(Length::whole(position));
    Action::SetMasterPosition(SetMasterPosition { axis, position })
}

fn encoder(position: i64) -> Action {
    Action::SetEncoderPosition(SetEncoderPosition { encoder: 0, position: Length::whole(position) })
}

fn origin(axis: u16, position: i64) -> Action {
    Action::SetPosition(SetPosition { axis, position: Length::whole(position) })
}

/// x and y may follow by MENCODERTYPE; x has this MENCCONTROL.
fn cell(kind: i64, control: i64) -> MachineConfig {
    let mut cell = config(0);
    for axis in [X, Y] {
        cell.axes[usize::from(axis)].parameters.encoder.mencodertype = kind;
    }
    cell.axes[usize::from(X)].parameters.encoder.menccontrol = control;
    cell
}

/// x reads the belt; y follows it.
fn shared(control: i64) -> Rig {
    let mut cell = cell(10, 0);
    let x = &mut cell.axes[usize::from(X)];
    (x.interface, x.wired) = (Interface::Velocity, crate::axis::Wired::Encoder(0));
    x.parameters.max_following_error = 20_000;
    (x.parameters.min_position, x.parameters.max_position) = (Some(-90_000), Some(90_000));
    cell.axes[usize::from(Y)].parameters.encoder.menccontrol = control;
    Rig::of(cell)
}

/// DEFMORIGIN at full speed: the slave sees no motion, its shown master position has the new value at once, and the
/// leading axis keeps its own position.
///
/// Proves: MACS-CMD-17, MACS-ENC-15
#[test]
fn new_master_zero_applies_to_its_follower_only() {
    for control in [0, 2] {
        let mut rig = Rig::of(cell(-1, control));
        rig.enable();
        follow(&mut rig);
        rig.mirror();
        rig.give(Action::Move(to(LINE, 50_000)));
        rig.run(300);
        let before = (rig.int("line.command.position"), rig.real("x.command.velocity"));
        let given = rig.give(master(X, 0));
        assert!(rig.was_accepted(given));
        assert_eq!(rig.real("x.master.position"), 0.0, "at once");
        let (way, velocity) = (rig.int("line.command.position") - before.0, rig.real("x.command.velocity"));
        assert!(way > 0 && velocity >= before.1 && rig.int("x.sync.error") == 0);
        rig.run_until("line.state", 1);
        rig.run(5);
        let shown = 50_000.0 - (before.0 + way) as f64;
        assert_eq!(rig.int("x.command.position"), 50_000);
        assert!((rig.real("x.master.position") - shown).abs() < 1.0);
        assert_eq!(rig.real("y.master.position"), 50_000.0, "of x alone");
        assert_eq!((rig.int("x.sync.master"), rig.int("line.command.position")), (50_000, 50_000));
    }
}

/// SETMORIGIN takes MU with a negative MENCODER: 55 MU are 2048 increments.
///
/// Proves: MACS-CMD-17, MACS-UNIT-09
#[test]
fn a_new_value_is_in_master_units() {
    for (mencoder, shown, increments) in [(-500, -11.0, -409.6), (500, -11.0, -11.0)] {
        let mut cell = cell(-1, 0);
        let p = &mut cell.axes[usize::from(X)].parameters;
        (p.macs.mencoder, p.sync_slave, p.sync_master) = (mencoder, 55, 2_048);
        let mut rig = Rig::of(cell);
        rig.enable();
        rig.give(Action::Move(to(LINE, 2_048)));
        rig.run_until("line.state", 1);
        rig.run(2);
        let position = MasterPosition::Shown(shown);
        let given = rig.give(Action::SetMasterPosition(SetMasterPosition { axis: X, position }));
        assert!(rig.was_accepted(given));
        assert!((rig.real("x.master.position") - shown).abs() < 1e-9);
        // With a positive MENCODER a master unit is an increment.
        let given = set(&mut rig, X, &[("mencoder", Value::Int(500))]);
        assert!(rig.was_accepted(given));
        assert!((rig.real("x.master.position") - increments).abs() < 1e-9, "{}", rig.real("x.master.position"));
        rig.give(master(X, -7));
        assert_eq!(rig.real("x.master.position"), -7.0);
    }
}

/// 1 MU of 2048 / 55 increments is not a multiple of 2^-32 increments, and is still shown as 1, also after whole
/// revolutions.
///
/// Proves: MACS-CMD-17, MACS-UNIT-09
#[test]
fn a_master_unit_is_shown_as_it_was_given() {
    for shown in [1.0, -1.0, 0.1, 44.7, 1e6, 123_456.789, 0.0] {
        let mut cell = cell(-1, 0);
        let p = &mut cell.axes[usize::from(X)].parameters;
        (p.macs.mencoder, p.sync_slave, p.sync_master) = (-500, 55, 2_048);
        let mut rig = Rig::of(cell);
        rig.enable();
        let position = MasterPosition::Shown(shown);
        rig.give(Action::SetMasterPosition(SetMasterPosition { axis: X, position }));
        assert_eq!(rig.real("x.master.position"), shown);
        rig.give(Action::Move(to(LINE, 2_048)));
        rig.run_until("line.state", 1);
        rig.run(2);
        assert!((rig.real("x.master.position") - (shown + 55.0)).abs() < 1e-9 * shown.abs().max(1.0));
        rig.give(Action::SetMasterPosition(SetMasterPosition { axis: X, position }));
        assert_eq!(rig.real("x.master.position"), shown, "set anew");
    }
}

/// Zero has no sign, also if a negative ratio inverts the master.
///
/// Proves: MACS-CMD-17
#[test]
fn zero_has_no_sign() {
    for (slave, master) in [(13, -7), (13, 7)] {
        let mut cell = cell(-1, 0);
        let p = &mut cell.axes[usize::from(X)].parameters;
        (p.macs.mencoder, p.sync_slave, p.sync_master) = (-500, slave, master);
        let mut rig = Rig::of(cell);
        rig.enable();
        for shown in [5.0, 0.0, -0.0] {
            let position = MasterPosition::Shown(shown);
            rig.give(Action::SetMasterPosition(SetMasterPosition { axis: X, position }));
            rig.give(Action::SetPosition(SetPosition { axis: LINE, position: Length::whole(0) }));
            rig.run(2);
            let words = ["x.master.position", "x.master.velocity"].map(|name| rig.real(name).to_bits());
            assert_eq!(words, [(shown + 0.0).to_bits(), 0], "{slave}:{master}, {shown}");
        }
    }
}

/// A leading encoder: a hard zero changes its value for all users, whose limits keep their machine positions; a soft
/// zero only changes the value that one axis shows.
///
/// Proves: MACS-CMD-17, MACS-ENC-11, MACS-ENC-12
#[test]
fn a_soft_zero_of_the_master_is_of_one_axis_and_a_hard_one_of_the_encoder() {
    for (control, by) in [(0, 1_000 - 25_000), (2, 0)] {
        let mut rig = shared(control);
        rig.enable();
        rig.give(Action::Synchronize(Synchronize { leader: None, ..couple(Y, Leader::AxisCommand(X), 1, 1) }));
        rig.give(Action::Move(to(X, 25_000)));
        rig.run(2_000);
        let seen = |rig: &Rig| ["x.actual.position", "x.command.position", "belt.position"].map(|name| rig.int(name));
        assert_eq!((seen(&rig), rig.real("y.master.position")), ([25_000; 3], 25_000.0));
        rig.mirror();
        let given = rig.give(master(Y, 1_000));
        assert!(rig.was_accepted(given));
        assert_eq!(rig.real("y.master.position"), 1_000.0, "at once");
        rig.run(2);
        assert_eq!(seen(&rig), [25_000 + by; 3], "menccontrol {control}");
        assert_eq!(rig.machine.parameters(X).unwrap().max_position, Some(90_000 + by));
        rig.run(50);
        assert_eq!((rig.int("y.command.position"), rig.real("y.master.position")), (25_000, 1_000.0), "nothing moved");
        rig.give(Action::Move(to(X, 26_000 + by)));
        rig.run(1_000);
        assert_eq!((rig.int("y.command.position"), rig.real("y.master.position")), (26_000, 2_000.0));
        assert_eq!((rig.int("x.error"), rig.int("y.error"), rig.int("belt.count")), (0, 0, 26_000));
    }
}

/// A hard zero of the master would shift the coordinate of an axis in motion that reads the encoder.
///
/// Proves: MACS-ENC-11
#[test]
fn a_hard_zero_of_the_master_waits_for_the_users() {
    let mut rig = shared(0);
    rig.enable();
    rig.give(Action::Move(to(X, 50_000)));
    rig.run(50);
    let refused = rig.give(master(Y, 0));
    assert_eq!(rig.refusal(refused), "x: the axis moves (DISCRETE_MOTION); wait for its end, or halt it first");
    let refused = rig.give(encoder(0));
    assert_eq!(rig.refusal(refused), "x: the axis moves (DISCRETE_MOTION); wait for its end, or halt it first");
    // The same in one cycle with the start, and after it.
    let mut rig = shared(0);
    rig.enable();
    let refused = rig.give_all(vec![Action::Move(to(X, 1_000)), master(Y, 77)]);
    assert_eq!(rig.refusal(refused), "x: the axis moves (DISCRETE_MOTION); wait for its end, or halt it first");
    // Before the start: only y gets its new zero, and this is reported.
    let mut rig = shared(0);
    rig.enable();
    rig.give_all(vec![master(Y, 77), Action::Move(to(X, 1_000))]);
    rig.run(1);
    assert_eq!((rig.real("y.master.position"), rig.int("belt.position")), (77.0, 0));
    assert!(rig.events.iter().any(|event| event.code == crate::code::Code::ENCODER_NOT_SHARED));
}

/// set_position of the encoder itself: its value in this cycle, for all users, at any position.
///
/// Proves: MACS-ENC-12
#[test]
fn an_encoder_has_its_new_value_in_the_cycle() {
    let mut rig = shared(0);
    rig.enable();
    rig.give(Action::Synchronize(couple(Y, Leader::Encoder(0), 2, 1)));
    rig.give(Action::Move(to(X, 300)));
    rig.run(500);
    let given = rig.give(encoder(-20));
    assert!(rig.was_accepted(given));
    let seen = ["belt.position", "x.actual.position", "x.command.position", "belt.count", "y.command.position"];
    assert_eq!(seen.map(|name| rig.int(name)), [-20, -20, -20, 300, 600]);
    assert_eq!(rig.real("y.master.position"), -20.0);
    rig.run(50);
    assert_eq!(seen.map(|name| rig.int(name)), [-20, -20, -20, 300, 600], "nothing moves");
    assert_eq!(rig.machine.parameters(X).unwrap().min_position, Some(-90_320));
    // Turned by hand while its user is off.
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(40);
    rig.plant.slip_encoder(0, 5);
    let given = rig.give(encoder(1_000));
    assert!(rig.was_accepted(given));
    assert_eq!((rig.int("belt.position"), rig.int("x.actual.position")), (1_000, 1_000), "what it has read counts");
    for wrong in [1 << 62, -(1 << 62), (1 << 62) - 1] {
        let refused = rig.give(encoder(wrong));
        assert!(rig.refusal(refused).contains("is outside +-2^62 increments"), "the limits of x go with it");
    }
    let nobody = Action::SetEncoderPosition(SetEncoderPosition { encoder: 1, position: Length::whole(0) });
    let refused = rig.give(nobody);
    rig.refusal(refused);
    rig.plant.cut_encoder(0);
    rig.run(1);
    for zero in [encoder(0), master(Y, 0)] {
        let refused = rig.give(zero);
        assert!(
            ["belt: the encoder gives no valid value", "y: what the axis follows is lost"]
                .contains(&rig.refusal(refused).as_str())
        );
    }
}

/// Proves: MACS-ENC-10, MACS-CMD-17
#[test]
fn the_zero_of_an_absolute_master_stands() {
    let mut cell = cell(10, 2);
    cell.encoders[0].form = Form::Absolute(Absolute::single_turn(4_096));
    let mut rig = Rig::of(cell);
    rig.plant.jump_encoder(0, 55);
    rig.enable();
    assert_eq!(rig.real("x.master.position"), 55.0);
    for zero in [master(X, 0), encoder(0)] {
        let refused = rig.give(zero);
        let sentence = "belt: the encoder is absolute, so that its zero stands: no set_position of it as a master";
        assert_eq!(rig.refusal(refused), sentence);
    }
    assert_eq!((rig.real("x.master.position"), rig.int("belt.position")), (55.0, 55));
}

/// Without a master there is nothing to set, and a value that is not a number is refused.
#[test]
fn a_zero_of_no_master_is_refused() {
    let mut rig = Rig::of(cell(0, 0));
    rig.enable();
    let refused = rig.give(master(X, 0));
    assert!(rig.refusal(refused).starts_with("x: no master is named, and mencodertype 0 names none"));
    let mut rig = Rig::of(cell(-1, 0));
    rig.enable();
    for position in [MasterPosition::Shown(f64::NAN), MasterPosition::Shown(1e30), MasterPosition::Shown(f64::INFINITY)]
    {
        let refused = rig.give(Action::SetMasterPosition(SetMasterPosition { axis: X, position }));
        assert!(rig.refusal(refused).starts_with("x: "));
    }
    assert_eq!(rig.real("x.master.position"), 0.0);
}

/// A new master: a hard change takes over its value; a soft change keeps the shown value and adds the changes of the
/// new master. The slave sees neither.
///
/// Proves: MACS-ENC-11
#[test]
fn a_soft_change_of_the_master_keeps_its_position() {
    for (control, after) in [(0, 400), (1, 3_000)] {
        let mut rig = Rig::of(cell(-1, control));
        rig.enable();
        for _ in 0..400 {
            rig.plant.jump_encoder(0, 1);
            rig.run(1);
        }
        rig.give(Action::Move(to(LINE, 3_000)));
        rig.run_until("line.state", 1);
        rig.run(2);
        assert_eq!(rig.real("x.master.position"), 3_000.0, "the first one is as it is");
        // By name, in motion.
        rig.give(Action::Synchronize(couple(X, Leader::Encoder(0), 1, 1)));
        rig.run(3);
        assert_eq!(rig.real("x.master.position"), after as f64, "menccontrol {control}");
        rig.plant.jump_encoder(0, 9);
        rig.run(50);
        assert_eq!((rig.real("x.master.position"), rig.int("x.command.position")), (after as f64 + 9.0, 9));
        // By MENCODERTYPE, while the axis is off.
        rig.give(Action::Disable(AxisSet::one(X)));
        rig.run(40);
        let back = if control == 1 { after + 9 } else { 3_000 };
        assert_eq!(rig.real("x.master.position"), back as f64);
        let given = set(&mut rig, X, &[("mencodertype", Value::Int(10))]);
        assert!(rig.was_accepted(given));
        let shown = if control == 1 { after + 9 } else { 409 };
        assert_eq!(rig.real("x.master.position"), shown as f64);
    }
}

/// The simulated master may be set, too; it continues from there.
///
/// Proves: MACS-ENC-16, MACS-CMD-17
#[test]
fn the_simulated_master_runs_on_from_its_new_value() {
    let mut rig = Rig::of(cell(6, 0));
    set(&mut rig, X, &[("master_simulation_velocity", Value::Real(2_000.0))]);
    rig.run(99);
    assert_eq!(rig.real("x.master.position"), 200.0);
    let given = rig.give(master(X, -50));
    assert!(rig.was_accepted(given));
    assert_eq!(rig.real("x.master.position"), -50.0);
    rig.run(10);
    assert_eq!(rig.real("x.master.position"), -30.0);
}

/// The leading axis is homed, gets a new position, is inverted: its followers see no jump, whether they follow the
/// command or the actual position.
///
/// Proves: MACS-ENC-15
#[test]
fn shown_master_position_continues_after_new_leader_zero() {
    for leader in [Leader::AxisCommand(X), Leader::AxisActual(X)] {
        let mut rig = Rig::of(cell(0, 0));
        rig.enable();
        rig.give(Action::Synchronize(couple(Y, leader, 1, 1)));
        rig.give(Action::Move(to(X, 700)));
        rig.run(200);
        assert_eq!(rig.real("y.master.position"), 700.0);
        rig.mirror();
        rig.give(origin(X, -5_000));
        assert_eq!((rig.real("y.master.position"), rig.int("y.sync.master")), (700.0, -5_000), "{leader:?}");
        rig.run(5);
        rig.give(Action::Disable(AxisSet::one(X)));
        rig.run(40);
        let given = set(&mut rig, X, &[("posdrct", Value::Int(-1))]);
        assert!(rig.was_accepted(given));
        assert_eq!((rig.real("y.master.position"), rig.int("x.actual.position")), (700.0, 5_000), "{leader:?}");
        rig.run(5);
        assert_eq!((rig.real("y.master.position"), rig.int("y.command.position")), (700.0, 700));
        let broken = rig.events.iter().filter(|event| event.kind == Kind::Error).count();
        assert_eq!(broken, 0);
    }
}

/// A command that names an encoder that does not exist is answered, also if the machine has no encoder.
#[test]
fn a_new_value_of_an_encoder_that_is_not_there_is_refused() {
    for encoders in [0, 1] {
        let mut cell = config(0);
        cell.encoders.truncate(encoders);
        let mut rig = Rig::of(cell);
        rig.run(2);
        let position = Length::whole(5);
        let sequence = rig.give(Action::SetEncoderPosition(SetEncoderPosition { encoder: 1, position }));
        rig.run(2);
        let answers = rig.events.iter().filter(|event| event.command == sequence).count();
        assert_eq!((answers, rig.refusal(sequence).is_empty()), (1, false), "{encoders}");
    }
}

/// A new value of an encoder moves none of its users outside the position range.
///
/// Proves: MACS-ENC-12
#[test]
fn a_new_value_of_an_encoder_keeps_all_positions_legal() {
    const MOST: i64 = crate::position::Position::LIMIT - 1;
    let mut cell = cell(10, 0);
    let x = &mut cell.axes[usize::from(X)];
    (x.interface, x.wired) = (Interface::Velocity, crate::axis::Wired::Encoder(0));
    // The zeros of x are soft.
    x.parameters.encoder.enccontrol = 2;
    let mut rig = Rig::of(cell);
    rig.run(5);
    rig.give(origin(X, MOST));
    rig.run(2);
    assert_eq!((rig.int("x.actual.position"), rig.int("belt.position")), (MOST, 0));
    let sequence = rig.give(encoder(1_000));
    rig.run(2);
    assert_eq!((rig.int("x.actual.position"), rig.int("belt.position")), (MOST, 0), "{}", rig.refusal(sequence));
    let back = rig.give(encoder(-1_000));
    rig.run(2);
    assert!(rig.was_accepted(back));
    assert_eq!((rig.int("x.actual.position"), rig.int("belt.position")), (MOST - 1_000, -1_000));
}
