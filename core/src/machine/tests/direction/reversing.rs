//! REVERS: an axis that must not move backwards does not do so, and reports the reason.

use super::super::rig::{Rig, X, at, cases, config, couple, to};
use super::set;
use crate::code::Code;
use crate::command::{Action, BufferMode, Move, MoveMode, Synchronize};
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use crate::sync::Disengage;
use proptest::prelude::*;

fn ruled(rule: i64, posdrct: i64) -> Rig {
    let mut config = config(0);
    let p = &mut config.axes[1].parameters;
    (p.macs.revers, p.macs.posdrct) = (rule, posdrct);
    let mut rig = Rig::of(config);
    rig.enable();
    rig
}

/// The master accelerates slowly: 10 mm/s with 100 mm/s^2, a fifth of the acceleration with which its slave catches up.
fn slow(target: i64) -> Move {
    Move { velocity: 10_000.0, acceleration: 100_000.0, deceleration: 100_000.0, ..to(0, target) }
}

/// POSA and POSR to a target behind the axis, CVEL below 0 and jogs are refused with a message, and nothing moves. Rule
/// 1 without a master equals rule 2. The direction is that of the user.
///
/// Proves: MACS-DIR-06
#[test]
fn backward_motion_is_refused() {
    for (rule, posdrct) in [(2, 1), (2, -1), (1, 1)] {
        let mut rig = ruled(rule, posdrct);
        let ahead = rig.give(Action::Move(to(X, 10_000)));
        rig.run(1_000);
        assert_eq!(rig.done(ahead).len(), 1);
        let relative = |by| Move { mode: MoveMode::Relative, ..to(X, by) };
        for (request, sentence) in [
            (to(X, 9_999), "the way to 9.999 mm leads backwards, which revers forbids"),
            (relative(-1), "the way to 9.999 mm leads backwards"),
            (at(X, -1.0), "velocity -0.001 mm/s leads backwards, which revers forbids; 0 or more is allowed"),
        ] {
            let refused = rig.give(Action::Move(request));
            assert!(rig.refusal(refused).contains(sentence), "{}", rig.refusal(refused));
        }
        rig.stream(X, -20_000.0);
        rig.run(50);
        assert_eq!((rig.int("x.command.position"), rig.state("x")), (10_000, "STANDSTILL"));
        let good = rig.give(Action::Move(to(X, 10_001)));
        rig.run(100);
        assert_eq!(rig.done(good)[0].code, Code::NONE);
    }
}

/// In motion these are refused: a target ahead that is too near for a stop, which would require a move back; a goal
/// that waits for one further ahead; a superimposed distance.
///
/// Proves: MACS-DIR-06
#[test]
fn motion_that_would_reverse_later_is_refused() {
    let mut rig = ruled(2, 1);
    rig.give(Action::Move(to(X, 50_000)));
    rig.run(300);
    let now = rig.int("x.command.position");
    let near = rig.give(Action::Move(to(X, now + 10)));
    assert!(rig.refusal(near).contains("leads backwards"));
    let buffered = |request| Action::Move(Move { buffer_mode: BufferMode::Buffered, ..request });
    let waits = rig.give(buffered(to(X, 49_999)));
    assert!(rig.refusal(waits).contains("leads backwards"));
    let runs = rig.give(buffered(at(X, -5.0)));
    assert!(rig.refusal(runs).contains("leads backwards"));
    let over = rig.give(Action::Move(Move { mode: MoveMode::Superimposed, ..to(X, -100) }));
    assert!(rig.refusal(over).contains("leads backwards"));
    let good = rig.give(buffered(to(X, 60_000)));
    rig.run(3_000);
    assert_eq!((rig.done(good).len(), rig.int("x.command.position")), (1, 60_000));
}

/// REVERS can only be changed while the axis is off, so it interrupts no motion.
#[test]
fn the_rule_changes_while_the_axis_is_off() {
    let mut rig = Rig::enabled();
    let refused = set(&mut rig, &[("revers", 2)]);
    assert!(rig.refusal(refused).contains("revers"), "{}", rig.refusal(refused));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(10);
    let good = set(&mut rig, &[("revers", 2)]);
    assert!(rig.was_accepted(good));
}

/// A slave that must not reverse stands while its master reverses. Its lead is its sync error, and it moves on when the
/// master has returned. With rule 1 it follows backwards.
///
/// Proves: MACS-DIR-06
#[test]
fn a_slave_stands_while_its_master_reverses() {
    for (rule, lowest, error) in [(0, 5_000, 0), (1, 5_000, 0), (2, 10_000, -5_000)] {
        let mut rig = ruled(rule, 1);
        let accuracy = set(&mut rig, &[("syncaccuracy", -10)]);
        assert!(rig.was_accepted(accuracy));
        rig.give(Action::Synchronize(couple(X, Leader::AxisCommand(0), 1, 1)));
        rig.give(Action::Move(slow(10_000)));
        rig.run(2_000);
        rig.give(Action::Move(slow(5_000)));
        for _ in 0..1_000 {
            rig.run(1);
            assert!(rule < 2 || rig.real("x.command.velocity") >= 0.0);
        }
        assert_eq!((rig.int("x.command.position"), rig.int("x.sync.error")), (lowest, error), "rule {rule}");
        let warned =
            rig.events.iter().any(|event| event.kind == Kind::Warning && event.code == Code::REVERSE_FORBIDDEN);
        assert_eq!(warned, rule == 2);
        rig.give(Action::Move(slow(20_000)));
        let mut moved_early = false;
        for _ in 0..3_000 {
            rig.run(1);
            moved_early |= rig.int("line.command.position") < 9_800 && rig.int("x.command.position") > 10_000;
        }
        assert!(!moved_early, "it waits until the master is where it was");
        assert_eq!((rig.int("x.command.position"), rig.int("x.sync.error")), (20_000, 0));
        assert_eq!((rig.int("x.in_sync"), rig.state("x")), (1, "SYNCHRONIZED_MOTION"));
    }
}

/// A backward offset is not executed backwards: the slave waits for the master.
///
/// Proves: MACS-DIR-06
#[test]
fn a_slave_that_is_ahead_waits() {
    for rule in [1, 2] {
        let mut rig = ruled(rule, 1);
        let request = couple(X, Leader::AxisCommand(0), 1, 1);
        rig.give(Action::Synchronize(Synchronize { offset: crate::position::Length::whole(-3_000), ..request }));
        rig.run(500);
        assert_eq!(rig.int("x.command.position"), 0);
        rig.give(Action::Move(slow(10_000)));
        rig.run(2_000);
        assert_eq!((rig.int("x.command.position"), rig.int("x.in_sync")), (7_000, 1));
    }
}

/// Rule 1, coupled backwards: the end of the coupling decelerates the slave like any other stop, with the same limit.
#[test]
fn a_slave_that_runs_backwards_is_stopped_without_a_jump() {
    for keeps in [Disengage::Stop, Disengage::KeepVelocity] {
        let mut rig = ruled(1, 1);
        rig.give(Action::Move(at(0, -20_000.0)));
        let request = couple(X, Leader::AxisCommand(0), 1, 1);
        let goal = rig.give(Action::Synchronize(Synchronize { disengage: keeps, ..request }));
        rig.run(1_000);
        let mut before = rig.real("x.command.velocity");
        assert_eq!(before, -20_000.0);
        rig.give(Action::Cancel { goal });
        for _ in 0..500 {
            rig.run(1);
            let now = rig.real("x.command.velocity");
            assert!((now - before).abs() <= 1_001.0, "{before} -> {now}");
            before = now;
        }
        assert_eq!((before, rig.state("x")), (0.0, "STANDSTILL"));
    }
}

#[derive(Clone, Debug)]
enum RandomCommand {
    Move(Move),
    Set(&'static str, Value),
    Halt,
    Couple(i64, i64),
    Line(Move),
    Stream(f64),
}

fn random_command() -> impl Strategy<Value = RandomCommand> {
    use MoveMode::{Absolute, Relative, Superimposed, Velocity};
    let mode = prop::sample::select(vec![Absolute, Relative, Relative, Superimposed, Velocity]);
    let rates = (-1e5..1e5_f64, prop_oneof![Just(0.0), 1e5..1e6_f64], prop_oneof![Just(0.0), 5e5..2e7_f64]);
    let buffer = prop::sample::select(vec![
        BufferMode::Aborting,
        BufferMode::Aborting,
        BufferMode::Buffered,
        BufferMode::BlendingNext,
    ]);
    let moves =
        (mode, -5_000_i64..40_000, rates, buffer).prop_map(|(mode, target, (velocity, rate, jerk), buffer_mode)| {
            let velocity = if mode == Velocity { velocity } else { velocity.abs() };
            Move { mode, velocity, acceleration: rate, deceleration: rate, jerk, buffer_mode, ..to(X, target) }
        });
    let line = prop_oneof![
        (-40_000_i64..40_000).prop_map(|target| to(0, target)),
        (-90_000.0..90_000.0_f64).prop_map(|velocity| at(0, velocity))
    ];
    prop_oneof![
        6 => moves.prop_map(RandomCommand::Move),
        2 => (0.0..100.0_f64).prop_map(|share| RandomCommand::Set("velocity_override", Value::Real(share))),
        1 => (0_i64..3).prop_map(|shape| RandomCommand::Set("profile", Value::Int(shape))),
        1 => (2e6..2e7_f64).prop_map(|jerk| RandomCommand::Set("max_jerk", Value::Real(jerk))),
        2 => Just(RandomCommand::Halt),
        2 => (-2_i64..4, -5_000_i64..5_000).prop_map(|(ratio, offset)| RandomCommand::Couple(ratio, offset)),
        3 => line.prop_map(RandomCommand::Line),
        1 => (-9e4..9e4_f64).prop_map(RandomCommand::Stream),
    ]
}

proptest! {
    #![proptest_config(cases(150))]

    /// Proves: MACS-DIR-06
    #[test]
    fn axis_never_moves_backwards_with_any_commands(
        rule in 1_i64..3,
        posdrct in prop::sample::select(vec![1_i64, -1]),
        deeds in prop::collection::vec((random_command(), prop_oneof![0_u64..20, 0_u64..300]), 1..25),
    ) {
        let mut config = config(0);
        let p = &mut config.axes[1].parameters;
        (p.macs.revers, p.macs.posdrct, p.max_jerk, p.profile) = (rule, posdrct, Some(2e7), 2);
        let mut rig = Rig::of(config);
        rig.enable();
        let (mut before, mut speed) = (rig.int("x.command.position"), 0.0_f64);
        for (deed, cycles) in deeds {
            let was_coupled_before = rig.state("x") == "SYNCHRONIZED_MOTION";
            match deed {
                RandomCommand::Stream(velocity) => {
                    rig.stream(X, velocity);
                }
                RandomCommand::Move(request) | RandomCommand::Line(request) => drop(rig.give(Action::Move(request))),
                RandomCommand::Set(key, value) => {
                    let (row, _) = Row::find(key).unwrap();
                    rig.give(Action::SetParameters([Change { axis: X, row, value }].into()));
                }
                RandomCommand::Halt => drop(rig.give(Action::Halt(AxisSet::one(X)))),
                RandomCommand::Couple(ratio, offset) => {
                    let request = couple(X, Leader::AxisCommand(0), ratio, 1);
                    let offset = crate::position::Length::whole(offset);
                    rig.give(Action::Synchronize(Synchronize { offset, ..request }));
                }
            }
            // The end of the coupling came after the motion of this cycle.
            let mut was_coupled = was_coupled_before;
            for cycle in 0..=cycles {
                if cycle > 0 {
                    rig.run(1);
                }
                let (now, velocity) = (rig.int("x.command.position"), rig.real("x.command.velocity"));
                let coupled = rig.state("x") == "SYNCHRONIZED_MOTION";
                // Coupled to its master the axis may move backwards, and decelerate from there.
                let excused = rule == 1 && (coupled || was_coupled || speed < 0.0);
                prop_assert!(excused || (now >= before && velocity >= 0.0), "{} -> {} at {}", before, now, velocity);
                prop_assert!((velocity - speed).abs() <= 1_001.0, "{} -> {}", speed, velocity);
                (before, speed, was_coupled) = (now, velocity, coupled);
            }
            if ["ERROR_STOP", "STOPPING"].contains(&rig.state("x")) && speed == 0.0 {
                rig.give(Action::ResetErrors(AxisSet::one(X)));
                rig.run(5);
            }
        }
        rig.give(Action::Halt(AxisSet::first(2)));
        rig.run(6_000);
        prop_assert!(["STANDSTILL", "ERROR_STOP"].contains(&rig.state("x")), "{}", rig.state("x"));
        prop_assert_eq!(rig.real("x.command.fraction"), 0.0);
    }
}
