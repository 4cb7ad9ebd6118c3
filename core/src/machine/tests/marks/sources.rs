//! Sources of marks: inputs with a condition, index pulses and the virtual master; couplings that are refused.

use super::super::rig::{LINE, to};
use super::*;
use crate::command::{Move, MoveMode, Phase, PhaseShift, PhaseSide};
use crate::encoder::PulseCheck;
use crate::parameter::{Change, MACHINE, Row};
use crate::position::Length;
use crate::sim::{Fixtures, Index};

/// Marks count while the third input is high (300), or low (-300).
/// Proves: MACS-MARK-05
#[test]
fn a_condition_lets_marks_count() {
    for (condition, counts) in [(312, false), (-312, true)] {
        let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6), ("syncmtypm", condition)]);
        world.couple();
        world.run(1_000, 10);
        assert_eq!(world.rig.int("x.in_sync") == 1, counts, "{condition}");
        if !counts {
            world.rig.plant.set_digital(2, true);
            world.run(500, 10);
            assert_eq!(world.rig.int("x.in_sync"), 1);
        }
    }
}

/// Index pulses of belt and drive.
/// Proves: MACS-MARK-05, MACS-MARK-06, MACS-CMD-20
#[test]
fn index_pulses_are_marks() {
    let mut config = config(0);
    config.encoders[0].check = Some(PulseCheck { every: 1_000, tolerance: 10 });
    let mut rig = Rig::of(config);
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 2_000, at: 300 }), ..Fixtures::default() });
    rig.enable();
    set(&mut rig, &[("syncmpulsm", 1_000), ("syncmpulss", 2_000), ("syncmstart", 5)]);
    let goal = rig.give(by_marks());
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    for _ in 0..1_500 {
        rig.plant.jump_encoder(0, 10);
        rig.run(1);
    }
    assert_eq!((rig.int("x.in_sync"), rig.real("x.marker.error").abs() < 1.0), (1, true));
    // IPOS and MIPOS: the last index of each.
    let (x, belt) = (rig.int("x.marker.position"), rig.int("x.marker.master"));
    assert_eq!((x.rem_euclid(2_000), belt % 1_000, belt), (300, 0, rig.int("belt.position") / 1_000 * 1_000));
    assert!((0..2_000).contains(&(rig.int("x.actual.position") - x)), "{x}");
    // Position 0 of the belt is 300 at x, as seen one cycle later.
    let way = rig.int("x.actual.position") - rig.int("belt.position") * 2;
    assert!((way - 300).abs() <= 1, "{way}");
}

/// An encoder without index pulses, and a drive without them, give no marks: a coupling that waits for them would wait
/// forever.
/// Proves: MACS-MARK-05
#[test]
fn an_index_pulse_of_what_has_none_is_refused() {
    let input = |name: &str| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: true };
    let coupled = |types: [i64; 2], without: &[Object]| {
        let mut config = MachineConfig { io: vec![input("product"), input("label")], ..config(0) };
        config.global.without_index = without.to_vec();
        let mut rig = Rig::of(config);
        rig.enable();
        set(&mut rig, &[("syncmtypm", types[0]), ("syncmtyps", types[1])]);
        set(&mut rig, &[("syncmpulsm", 1_000), ("syncmpulss", 2_000)]);
        let goal = rig.give(by_marks());
        rig.answer(goal).err().map(|_| rig.refusal(goal))
    };
    let (belt, drive) = (Object::Encoder(0), Object::Axis(X));
    for (types, without, key) in [([0, 22], belt, "syncmtypm"), ([12, 0], drive, "syncmtyps")] {
        let refused = coupled(types, &[without]).unwrap_or_default();
        assert!(refused.starts_with(&format!("x: {key} 0 asks for an index pulse that there is not")), "{refused}");
        assert_eq!(coupled(types, &[]), None);
        assert_eq!(coupled([12, 22], &[without]), None);
    }
}

/// The virtual master gives a mark every vmencres, at which the index of the drive occurs.
/// Proves: MACS-VM-06, MACS-MARK-05
#[test]
fn the_virtual_master_has_marks() {
    let mut rig = Rig::new();
    rig.plant
        .drive(0)
        .unwrap()
        .install_fixtures(Fixtures { index: Some(Index { every: 2_000, at: 300 }), ..Fixtures::default() });
    rig.enable();
    set(&mut rig, &[("syncmpulsm", 1_000), ("syncmpulss", 2_000), ("syncmstart", 5)]);
    let of_machine = |key, value| {
        let (row, _) = Row::find(key).expect("a row");
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    let starts =
        [("vmencres", 1_000), ("pulsacc", 20_000), ("pulsvel", 10_000)].map(|(key, value)| of_machine(key, value));
    let given = rig.give(Action::SetParameters(starts.into()));
    assert!(rig.was_accepted(given), "{}", rig.refusal(given));
    let line = Synchronize { mode: SyncMode::Marker, ..couple(X, Leader::Virtual, 2, 1) };
    let goal = rig.give(Action::Synchronize(line));
    assert!(rig.was_accepted(goal), "{}", rig.refusal(goal));
    rig.run(3_000);
    assert_eq!((rig.int("x.in_sync"), rig.real("x.marker.error").abs() < 1.0), (1, true));
    let way = rig.int("x.actual.position") - rig.int("machine.vmaster.position") * 2;
    assert!((way - 300).rem_euclid(2_000).min((300 - way).rem_euclid(2_000)) <= 1, "{way}");
}

/// The virtual master is not an encoder with an input of its own, and an index without counts gives no mark; an
/// assigned input does.
/// Proves: MACS-MARK-05, MACS-VM-07
#[test]
fn a_virtual_master_without_marks_is_refused() {
    let of_machine = |key, value| {
        let (row, _) = Row::find(key).expect("a row");
        Change { axis: MACHINE, row, value: Value::Int(value) }
    };
    let input = "x: syncmtypm names digital input 0, which the cell does not have, or which has not latch: true";
    let index = "x: syncmtypm 0 asks for an index pulse that there is not";
    for (master_type, distance, marker, sentence) in [
        (2, 500, 0, Some(input)),
        (3, 500, 12, Some(input)),
        (0, 0, 0, Some(index)),
        (0, 0, 1, Some(index)),
        (0, 0, 12, None),
        (0, 500, 0, None),
        (12, 0, 0, None),
    ] {
        let mut rig = marked(&[("syncmtypm", master_type)]);
        let given = rig.give(Action::SetParameters(
            [("vmencres", distance), ("vmencmtyp", marker)].map(|(key, value)| of_machine(key, value)).into(),
        ));
        assert!(rig.was_accepted(given));
        let line = Synchronize { mode: SyncMode::Marker, ..couple(X, Leader::Virtual, 2, 1) };
        let goal = rig.give(Action::Synchronize(line));
        let refused = rig.answer(goal).err().map(|_| rig.refusal(goal));
        match sentence {
            Some(sentence) => assert!(refused.as_ref().is_some_and(|said| said.starts_with(sentence)), "{refused:?}"),
            None => assert_eq!(refused, None, "{master_type} {distance} {marker}"),
        }
    }
}

/// Sources that cannot give marks, and unknown starts, are refused by name.
/// Proves: MACS-MARK-14
#[test]
fn source_without_marks_is_refused() {
    for (changes, sentence) in [
        (
            ("syncmtypm", 42),
            "x: syncmtypm names digital input 4, which the cell does not have, or which has not latch: true",
        ),
        (
            ("syncmtyps", 33),
            "x: syncmtyps names digital input 3, which the cell does not have, or which has not latch: true",
        ),
        (("syncmtypm", 512), "x: syncmtypm names digital input 5, which the cell"),
        (("syncmtypm", 1), "x: syncmtypm 1 asks for an index pulse that there is not"),
        (("syncmstart", 2_000), "x: syncmstart 2000 does not exist in mode MARKER; 0 to 7 and 1000 to 1007 do"),
    ] {
        let mut rig = marked(&[changes]);
        let goal = rig.give(by_marks());
        assert!(rig.refusal(goal).starts_with(sentence), "{}", rig.refusal(goal));
        assert_eq!(rig.state("x"), "STANDSTILL");
    }
    let mut rig = marked(&[("syncmtypm", 0)]);
    let line = Synchronize { mode: SyncMode::Marker, ..couple(X, Leader::AxisCommand(LINE), 1, 1) };
    let goal = rig.give(Action::Synchronize(line));
    assert!(rig.refusal(goal).contains("syncmtypm 0 asks for an index pulse"), "{}", rig.refusal(goal));
    let mut large = marked(&[("syncfacts", 2_147_484)]);
    let given = Synchronize { mode: SyncMode::Marker, ..couple(X, TO_BELT, 0, 0) };
    let goal = large.give(Action::Synchronize(given));
    let sentence = "x: syncmpulsm 1000 inc is too far for marks; at most 999 inc is allowed";
    assert!(large.refusal(goal).starts_with(sentence), "{}", large.refusal(goal));
    let refused = set(&mut rig, &[("syncmfpar", 64)]);
    assert!(rig.refusal(refused).contains("syncmfpar 64 asks with 64"), "{}", rig.refusal(refused));
}

/// Shifts that marks would correct away are refused: a superimposed move and a phase shift.
#[test]
fn nothing_else_shifts_an_axis_on_marks() {
    let mut world = BeltAndRoll::new(500.0, &[("syncmstart", 6)]);
    world.couple();
    let over = Move { mode: MoveMode::Superimposed, ..to(X, 100) };
    let shift = PhaseShift { shift: Length::whole(5), velocity: 0.0, acceleration: 0.0 };
    for action in [Action::Move(over), Action::Phase(Phase { axis: X, side: PhaseSide::Slave(shift) })] {
        let goal = world.rig.give(action);
        assert!(
            world.rig.refusal(goal).contains("coupled by marks, which would take that back"),
            "{}",
            world.rig.refusal(goal)
        );
    }
    let mut rig = marked(&[("syncmpulsm", 0), ("syncmstart", 3)]);
    let goal = rig.give(by_marks());
    assert_eq!(rig.refusal(goal), "x: syncmstart 3 goes by the distance of the marks, and syncmpulsm is 0");
}
