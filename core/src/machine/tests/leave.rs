//! Leaving a coupling at a position of the leader or of the axis (MC_GearOut, MC_CamOut).

use super::direction::set;
use super::rig::{LINE, Rig, X, Y, at, cam, cases, config, couple, parameters, to};
use crate::code::Code;
use crate::command::{Action, DisengageAt, Engage, GearOut, Move, MoveMode, Phase, PhaseShift, PhaseSide, Synchronize};
use crate::config::{IoConfig, IoKind, MachineConfig, SumConfig, TableConfig};
use crate::drive::Inputs;
use crate::modulo::Modulo;
use crate::object::{AxisSet, Leader};
use crate::position::{Length, Position};
use crate::request::GearOutRequest;
use crate::sync::{CamStart, Disengage, SyncMode};
use crate::table::{CamSetting, Form, Table};
use proptest::prelude::*;
use std::sync::Arc;

const TO_LINE: Leader = Leader::AxisCommand(LINE);
const MODES: [&str; 4] = ["velocity", "position", "marker", "cam"];

fn cell() -> MachineConfig {
    let mut config = config(0);
    let input = |name: &str| IoConfig { name: name.into(), kind: IoKind::DigitalInput, latch: true };
    config.io = vec![input("product"), input("label")];
    // Half the travel of its master, without end.
    let table = Table::new(Form::Xy, &[0, 4_096], &[0, 2_048]).expect("points");
    let table = Arc::new(table.with_cam(CamSetting::default()));
    config.tables = vec![TableConfig { name: "feed".into(), table }];
    config
}

fn rig() -> Rig {
    let mut rig = Rig::of(cell());
    rig.enable();
    let given = set(&mut rig, &[("syncmtypm", 12), ("syncmtyps", 22), ("syncmpulsm", 1_000), ("syncmpulss", 500)]);
    assert!(rig.was_accepted(given));
    rig
}

/// Returns a coupling with half the travel of the line, in one of the modes.
fn half(mode: &str) -> Synchronize {
    let gear = couple(X, TO_LINE, 1, 2);
    match mode {
        "velocity" => Synchronize { mode: SyncMode::Velocity, ..gear },
        "marker" => Synchronize { mode: SyncMode::Marker, ..gear },
        "cam" => Synchronize { cam: Some(cam(0, CamStart::Relative)), ..couple(X, TO_LINE, 0, 0) },
        _ => gear,
    }
}

fn out(at: DisengageAt, disengage: Option<Disengage>) -> Action {
    Action::GearOut(GearOut { axis: X, at, disengage })
}

fn place(rig: &Rig, axis: u16) -> Position {
    rig.machine.state.leads.get(Leader::AxisCommand(axis)).position
}

fn code(rig: &Rig, goal: u64) -> Option<Code> {
    let done = rig.done(goal);
    assert!(done.len() <= 1, "ended once");
    done.first().map(|event| event.code)
}

/// At 20 mm/s the line moves 20 inc in each cycle, and x 10 inc. The position is 13 inc after the line position of some
/// cycle: the coupling is left in the next cycle, at 10 inc per cycle, and x stops with its default of 0.5 m/s^2, half
/// an inc/cycle^2, in 10^2 / 2 / 0.5 = 100 inc.
#[test]
fn each_mode_is_left_in_the_cycle_in_which_the_place_is_passed() {
    for mode in MODES {
        for way in [1_i64, -1] {
            for by_axis in [false, true] {
                for disengage in [Disengage::Stop, Disengage::KeepVelocity] {
                    let what = format!("{mode} {way} {by_axis} {disengage:?}");
                    let mut rig = rig();
                    rig.mirror();
                    rig.give(Action::Move(at(LINE, 20_000.0 * way as f64)));
                    rig.run(50);
                    let goal = rig.give(Action::Synchronize(half(mode)));
                    rig.run(200);
                    assert_eq!(rig.int("x.in_sync"), i64::from(mode != "marker"), "{what}");
                    let of = if by_axis { X } else { LINE };
                    let ahead = place(&rig, of).nearest() + way * if by_axis { 1_007 } else { 2_013 };
                    let leave = if by_axis { DisengageAt::Axis(ahead) } else { DisengageAt::Leader(ahead) };
                    let given = rig.give(out(leave, Some(disengage)));
                    assert!(rig.was_accepted(given));
                    rig.run(1);
                    assert_eq!((rig.int("x.sync.leaving"), rig.int("x.sync.waiting")), (given as i64, 0), "{what}");
                    let is_past = |rig: &Rig| (place(rig, of) - Position::whole(ahead)).to_f64() * way as f64 >= 0.0;
                    let mut cycles = 0;
                    while !is_past(&rig) {
                        assert_eq!((rig.state("x"), code(&rig, given)), ("SYNCHRONIZED_MOTION", None), "{what}");
                        let before = rig.real("x.command.velocity");
                        assert!((before - 10_000.0 * way as f64).abs() < 1.0, "{what}: {before}");
                        rig.run(1);
                        cycles += 1;
                    }
                    assert!((99..102).contains(&cycles), "{what}: {cycles}");
                    // It was left in this cycle, with the motion of the coupling.
                    let left = place(&rig, X);
                    assert_eq!((rig.int("x.sync.leaving"), code(&rig, given)), (0, Some(Code::NONE)), "{what}");
                    assert_eq!(rig.done(given)[0].position, left);
                    let velocity = rig.real("x.command.velocity");
                    assert!((velocity - 10_000.0 * way as f64).abs() < 1.0, "{what}: {velocity}");
                    if disengage == Disengage::KeepVelocity {
                        assert_eq!((rig.state("x"), code(&rig, goal)), ("CONTINUOUS_MOTION", Some(Code::GEARED_OUT)));
                        rig.give(Action::Move(at(LINE, 0.0)));
                        rig.run(500);
                        let way_on = (place(&rig, X) - left).to_f64() * way as f64;
                        assert!((way_on - 5_010.0).abs() < 1.0, "{what}: {way_on}");
                        assert_eq!(rig.real("x.command.velocity"), velocity);
                        continue;
                    }
                    assert_eq!((rig.state("x"), code(&rig, goal)), ("DISCRETE_MOTION", None), "{what}");
                    let mut before = velocity;
                    while rig.state("x") != "STANDSTILL" {
                        rig.run(1);
                        let now = rig.real("x.command.velocity");
                        assert!((now - before).abs() <= 500.0 + 1e-6, "{what}: {before} to {now}");
                        before = now;
                    }
                    assert_eq!(code(&rig, goal), Some(Code::GEARED_OUT), "{what}");
                    let stopped = (place(&rig, X) - left).to_f64() * way as f64;
                    assert!((stopped - 100.0).abs() <= 1.0, "{what}: {stopped}");
                    let done = rig.done(goal)[0];
                    let sentence = crate::text::message(&done, rig.machine.config());
                    assert_eq!(sentence, "x: gear_out has uncoupled the axis");
                }
            }
        }
    }
}

#[test]
fn now_is_the_cycle_of_the_command_and_the_goal_says_how() {
    for disengage in [Disengage::Stop, Disengage::KeepVelocity] {
        let mut rig = rig();
        rig.give(Action::Move(at(LINE, 20_000.0)));
        let goal = rig.give(Action::Synchronize(Synchronize { disengage, ..half("position") }));
        rig.run(300);
        let given = rig.give(out(DisengageAt::Now, None));
        assert!(rig.was_accepted(given));
        assert_eq!((code(&rig, given), rig.int("x.sync.leaving")), (Some(Code::NONE), 0));
        let ends = disengage == Disengage::KeepVelocity;
        assert_eq!(rig.state("x"), if ends { "CONTINUOUS_MOTION" } else { "DISCRETE_MOTION" });
        assert_eq!(code(&rig, goal), ends.then_some(Code::GEARED_OUT));
        rig.run(100);
        assert_eq!(code(&rig, goal), Some(Code::GEARED_OUT));
        assert_eq!(rig.real("x.command.velocity"), if ends { 10_000.0 } else { 0.0 });
    }
}

/// A leader at rest at the position need not move; one at rest next to it, or moving away from it, is waited for.
#[test]
fn a_leader_that_stands_at_the_place_is_there() {
    let mut rig = rig();
    rig.give(Action::Move(to(LINE, 1_000)));
    rig.run_until("line.state", 1);
    let goal = rig.give(Action::Synchronize(half("position")));
    rig.run(2);
    let beside = rig.give(out(DisengageAt::Leader(1_001), None));
    rig.run(50);
    assert_eq!(rig.int("x.sync.leaving"), beside as i64);
    rig.give(Action::Move(to(LINE, 900)));
    rig.run_until("line.state", 1);
    assert_eq!((code(&rig, goal), rig.state("x")), (None, "SYNCHRONIZED_MOTION"));
    let there = rig.give(out(DisengageAt::Leader(900), None));
    assert_eq!((code(&rig, beside), code(&rig, there)), (Some(Code::REPLACED), Some(Code::NONE)));
    assert_eq!((code(&rig, goal), rig.state("x")), (Some(Code::GEARED_OUT), "STANDSTILL"));
}

/// Leaders other than an axis: counts of an encoder, of which some skip the position, a sum that moves backwards, an
/// actual position.
#[test]
fn every_kind_of_leader_reaches_the_leaving_position() {
    let mut config = cell();
    let (add, subtract) = (vec![TO_LINE], vec![Leader::Encoder(0)]);
    config.masters = vec![SumConfig { name: "sum".into(), add, subtract }];
    for (leader, place) in [(Leader::Encoder(0), 501), (Leader::Sum(0), -399), (Leader::AxisActual(Y), 0)] {
        let mut rig = Rig::of(config.clone());
        rig.enable();
        let goal = rig.give(Action::Synchronize(couple(X, leader, 1, 4)));
        // An axis at rest at 0 has reached position 0.
        let given = rig.give(out(DisengageAt::Leader(place), None));
        if place == 0 {
            assert_eq!((code(&rig, given), code(&rig, goal)), (Some(Code::NONE), Some(Code::GEARED_OUT)));
            continue;
        }
        let mut way = 0;
        while code(&rig, given).is_none() {
            assert!(way < place.abs() && rig.state("x") == "SYNCHRONIZED_MOTION", "{leader:?}: {way}");
            rig.plant.jump_encoder(0, 7);
            way += 7;
            rig.run(1);
        }
        assert!((place.abs()..place.abs() + 7).contains(&way), "{leader:?}: {way}");
    }
}

/// A new zero of the leader is not a motion, and the position refers to the new coordinate.
#[test]
fn a_new_zero_of_the_leader_passes_no_place() {
    let mut rig = rig();
    let goal = rig.give(Action::Synchronize(half("position")));
    rig.run(2);
    rig.give(out(DisengageAt::Leader(500), None));
    rig.run(2);
    let zero = crate::command::SetPosition { axis: LINE, position: Length::whole(700) };
    let zero = rig.give(Action::SetPosition(zero));
    assert!(rig.was_accepted(zero));
    rig.run(20);
    assert_eq!((rig.int("line.command.position"), code(&rig, goal)), (700, None));
    rig.give(Action::Move(to(LINE, 499)));
    rig.run_until("line.state", 1);
    rig.run(100);
    assert_eq!(code(&rig, goal), Some(Code::GEARED_OUT));
}

/// Any other end of the coupling ends the wait, with its own code; a refused goal does not.
#[test]
fn other_end_of_coupling_ends_the_wait() {
    fn jump(inputs: &mut Inputs) {
        inputs.drive[0].online = false;
    }
    let set = AxisSet::one(X);
    let cases: [(&str, Option<Action>, Code); 7] = [
        ("halt", Some(Action::Halt(set)), Code::HALTED),
        ("stop", Some(Action::QuickStop(set)), Code::QUICK_STOP),
        ("disable", Some(Action::Disable(set)), Code::DISABLED),
        ("move", Some(Action::Move(to(X, 0))), Code::REPLACED),
        ("goal", Some(Action::Synchronize(half("velocity"))), Code::REPLACED),
        ("cancel", None, Code::NOT_REACHED),
        ("error", None, Code::DRIVE_LOST),
    ];
    for (what, action, ends_with) in cases {
        let mut rig = rig();
        rig.mirror();
        rig.give(Action::Move(at(LINE, 20_000.0)));
        let goal = rig.give(Action::Synchronize(half("position")));
        rig.run(200);
        let given = rig.give(out(DisengageAt::Leader(100_000), None));
        let refused = rig.give(Action::Synchronize(couple(X, TO_LINE, 0, 1)));
        assert!(rig.answer(refused).is_err());
        rig.run(2);
        assert_eq!((rig.int("x.sync.leaving"), code(&rig, goal)), (given as i64, None), "{what}");
        match (what, action) {
            ("cancel", _) => _ = rig.give(Action::Cancel { goal }),
            ("error", _) => {
                rig.modify_inputs = jump;
                rig.run(20);
            }
            (_, action) => _ = rig.give(action.expect("an action")),
        }
        assert_eq!((rig.int("x.sync.leaving"), code(&rig, given)), (0, Some(ends_with)), "{what}");
        // The wait is removed: a later coupling is not left there.
        rig.modify_inputs = |_| {};
        if what == "goal" {
            rig.run_to("line.command.position", 110_000.0);
            assert_eq!(rig.state("x"), "SYNCHRONIZED_MOTION");
        }
    }
}

/// The cam ends before the position is reached.
#[test]
fn the_end_of_a_cam_drops_it_as_well() {
    let mut config = cell();
    let setting = CamSetting { is_cyclic: false, ..CamSetting::default() };
    let table = Table::new(Form::Xy, &[0, 1_000, 2_000], &[0, 250, 250]).expect("points").with_cam(setting);
    config.tables[0].table = Arc::new(table);
    let mut rig = Rig::of(config);
    rig.enable();
    let goal = rig.give(Action::Synchronize(half("cam")));
    rig.run(2);
    let given = rig.give(out(DisengageAt::Leader(3_000), None));
    rig.give(Action::Move(to(LINE, 4_000)));
    rig.run_until("line.state", 1);
    assert_eq!((code(&rig, goal), code(&rig, given)), (Some(Code::NONE), Some(Code::NOT_REACHED)));
}

#[test]
fn an_axis_that_no_goal_couples_refuses_it() {
    let mut rig = rig();
    let sentence = "x: no goal of synchronize couples the axis: there is nothing to leave";
    let refused = |rig: &mut Rig| {
        let given = rig.give(out(DisengageAt::Now, None));
        assert_eq!(rig.refusal(given), sentence);
    };
    refused(&mut rig);
    rig.give(Action::Move(at(X, 1_000.0)));
    refused(&mut rig);
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run_until("x.state", 1);
    // The axis waits to engage.
    let engage = Engage::AtPosition { position: 5_000, turn: None };
    rig.give(Action::Synchronize(Synchronize { engage, ..half("velocity") }));
    refused(&mut rig);
    // The axis is stopping already.
    rig.give(Action::Move(at(LINE, 20_000.0)));
    let goal = rig.give(Action::Synchronize(half("velocity")));
    rig.run(100);
    rig.give(Action::Cancel { goal });
    refused(&mut rig);
}

#[test]
fn unused_request_field_is_refused_by_name() {
    let config = cell();
    let refused = |request: GearOutRequest| config.resolve_gear_out(&request).expect_err("refused").to_string();
    let x = || GearOutRequest { axis: "x".into(), ..GearOutRequest::default() };
    assert!(refused(GearOutRequest { axis: "z".into(), ..x() }).starts_with("no axis is called `z`"));
    assert_eq!(refused(GearOutRequest { at: 3, ..x() }), "at is 3; 0 NOW, 1 MASTER_POSITION, 2 POSITION are allowed");
    assert_eq!(
        refused(GearOutRequest { disengage: 3, ..x() }),
        "disengage is 3; 0 STOP, 1 KEEP_VELOCITY, 2 AS_GOAL are allowed"
    );
    assert_eq!(
        refused(GearOutRequest { increments: 7, ..x() }),
        "increments is 7; 0 is allowed with at NOW, which waits for no place"
    );
    for at in [1, 2] {
        for far in [1_i64 << 62, -(1 << 62), i64::MIN, i64::MAX] {
            let sentence = refused(GearOutRequest { at, increments: far, ..x() });
            assert_eq!(sentence, format!("increments is {far}; within +-2^62 is allowed"));
        }
    }
    let most = GearOutRequest { at: 2, increments: (1 << 62) - 1, disengage: 2, ..x() };
    let GearOut { axis, at, disengage } = config.resolve_gear_out(&most).expect("legal");
    assert_eq!((axis, at, disengage), (X, DisengageAt::Axis((1 << 62) - 1), None));
}

/// A coupling that waits for its event continues to wait while the previous one is left: out at one position, in at the
/// next one.
#[test]
fn out_at_one_place_and_in_at_the_next() {
    let mut rig = rig();
    rig.give(Action::Move(at(LINE, 20_000.0)));
    let first = rig.give(Action::Synchronize(half("position")));
    rig.run(200);
    let engage = Engage::AtPosition { position: 20_000, turn: None };
    let second = rig.give(Action::Synchronize(Synchronize { engage, ..half("velocity") }));
    let leave = rig.give(out(DisengageAt::Leader(10_000), None));
    rig.run_to("line.command.position", 12_000.0);
    assert_eq!((code(&rig, first), code(&rig, leave)), (Some(Code::GEARED_OUT), Some(Code::NONE)));
    assert_eq!((rig.state("x"), rig.int("x.sync.waiting")), ("STANDSTILL", second as i64));
    rig.run_to("line.command.position", 22_000.0);
    assert_eq!((rig.state("x"), code(&rig, second)), ("SYNCHRONIZED_MOTION", None));
    assert!((rig.real("x.command.velocity") - 10_000.0).abs() < 1e-3);
}

/// A phase shift during the leaving causes no step either, and ends.
#[test]
fn a_shift_under_way_ends_with_the_coupling() {
    let shift = PhaseShift { shift: Length::whole(5_000), velocity: 5_000.0, acceleration: 100_000.0 };
    let by_phase = Action::Phase(Phase { axis: X, side: PhaseSide::Slave(shift) });
    let superimposed = Move { mode: MoveMode::Superimposed, velocity: 5_000.0, ..to(X, 5_000) };
    for (action, disengage) in [
        (by_phase.clone(), Disengage::Stop),
        (by_phase, Disengage::KeepVelocity),
        (Action::Move(superimposed), Disengage::Stop),
    ] {
        let mut rig = rig();
        rig.give(Action::Move(at(LINE, 20_000.0)));
        rig.give(Action::Synchronize(half("position")));
        rig.run(300);
        let shifted = rig.give(action);
        rig.run(200);
        assert!((rig.real("x.command.velocity") - 15_000.0).abs() < 1.0);
        rig.give(out(DisengageAt::Now, Some(disengage)));
        assert_eq!(code(&rig, shifted), Some(Code::NOT_REACHED));
        let mut before = rig.real("x.command.velocity");
        for _ in 0..100 {
            rig.run(1);
            let now = rig.real("x.command.velocity");
            assert!((now - before).abs() <= 1_000.0 + 1e-6, "{before} to {now}");
            before = now;
        }
        assert_eq!(before, if disengage == Disengage::Stop { 0.0 } else { rig.real("x.command.velocity") });
        assert!(disengage == Disengage::Stop || before > 9_000.0);
    }
}

/// In a chain the next axis keeps its gear ratio to an axis that leaves its coupling.
#[test]
fn follower_keeps_gear_while_its_leader_leaves_a_coupling() {
    let mut rig = rig();
    rig.give(Action::Move(at(LINE, 20_000.0)));
    rig.give(Action::Synchronize(half("position")));
    rig.give(Action::Synchronize(couple(Y, Leader::AxisCommand(X), 3, 2)));
    rig.run(300);
    assert_eq!(rig.int("y.in_sync"), 1);
    let offset = place(&rig, Y).to_f64() - place(&rig, X).to_f64() * 1.5;
    rig.give(out(DisengageAt::Axis(place(&rig, X).nearest() + 1_000), None));
    let off = |rig: &Rig| place(rig, Y).to_f64() - place(rig, X).to_f64() * 1.5 - offset;
    while rig.state("x") != "STANDSTILL" {
        assert!(off(&rig).abs() < 1e-6, "{}", off(&rig));
        rig.run(1);
    }
    // At rest it is on a whole increment.
    assert!(off(&rig).abs() < 1.5 + 0.75, "{}", off(&rig));
    rig.run(50);
    assert!(off(&rig).abs() < 1e-6, "{}", off(&rig));
    assert_eq!((rig.state("x"), rig.state("y")), ("STANDSTILL", "SYNCHRONIZED_MOTION"));
}

proptest! {
    #![proptest_config(cases(60))]

    /// For any position, in either direction, with or without a revolution of the leader or of the axis: the coupling
    /// is left in the first cycle that reaches the position, and no velocity step of the command exceeds the
    /// deceleration.
    #[test]
    fn it_is_left_in_the_first_cycle_at_the_place(
        by_axis in any::<bool>(), turn in prop::option::of(1_000_i64..5_000), ahead in 40_i64..6_000, up in any::<bool>(),
        velocity in 1_000.0..40_000.0_f64, keeps in any::<bool>(), mode in 0_usize..4, share in 0.05..0.95_f64,
    ) {
        let mut config = cell();
        let of = if by_axis { X } else { LINE };
        let turns = turn.and_then(|turn| Modulo::new(turn, 1));
        config.axes[usize::from(of)].modulo = turns;
        let mut rig = Rig::of(config);
        rig.enable();
        let given = set(&mut rig, &[("syncmtypm", 12), ("syncmtyps", 22), ("syncmpulsm", 1_000), ("syncmpulss", 500)]);
        prop_assert!(rig.was_accepted(given));
        let way = if up { 1.0 } else { -1.0 };
        rig.give(Action::Move(at(LINE, velocity * way)));
        let goal = rig.give(Action::Synchronize(half(MODES[mode])));
        rig.run(100 + (200.0 * share) as u64);
        let start = place(&rig, of);
        // The first position ahead that is displayed as the requested one.
        let ahead = turn.map_or(ahead, |turn| ahead.rem_euclid(turn).max(40).min(turn - 1));
        let target = start.nearest() + ahead * way as i64;
        let shown = turn.map_or(target, |turn| target.rem_euclid(turn));
        let leave = if by_axis { DisengageAt::Axis(shown) } else { DisengageAt::Leader(shown) };
        let disengage = if keeps { Disengage::KeepVelocity } else { Disengage::Stop };
        let given = rig.give(out(leave, Some(disengage)));
        prop_assert!(rig.was_accepted(given));
        let most = parameters().max_acceleration / 1e3 + 1e-6;
        let mut before = rig.real("x.command.velocity");
        for _ in 0..200_000 {
            let is_past = (place(&rig, of) - Position::whole(target)).to_f64() * way >= 0.0;
            prop_assert_eq!(code(&rig, given).is_some(), is_past);
            if is_past {
                break;
            }
            rig.run(1);
            let now = rig.real("x.command.velocity");
            prop_assert!((now - before).abs() <= most, "{} to {}", before, now);
            before = now;
        }
        for _ in 0..100 {
            rig.run(1);
            let now = rig.real("x.command.velocity");
            prop_assert!((now - before).abs() <= most, "{} to {}, out", before, now);
            prop_assert!(!keeps || (now - before).abs() < 1e-6);
            before = now;
        }
        prop_assert_eq!(code(&rig, goal), Some(Code::GEARED_OUT));
        prop_assert_eq!(rig.state("x"), if keeps { "CONTINUOUS_MOTION" } else { "STANDSTILL" });
    }
}
