//! Any commands in any order, with faults and slips between them.

use super::rig::{Rig, at, config, to};
use crate::code::Code;
use crate::command::{Action, Disengage, Length, Move, MoveMode, SyncMode, Synchronize};
use crate::event::Kind;
use crate::object::{AxisSet, Leader};
use proptest::prelude::*;

const AXES: [&str; 3] = ["line", "x", "y"];

#[derive(Clone, Debug)]
enum Happening {
    Command(Action),
    Cancel(usize),
    Cycles(u64),
    Fault(usize),
    Slip(usize, i64),
    Mirror,
}

fn axis() -> impl Strategy<Value = u16> {
    0_u16..3
}

fn axes() -> impl Strategy<Value = AxisSet> {
    prop::collection::vec(axis(), 1..4).prop_map(|axes| axes.into_iter().collect())
}

fn rate() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 2e4..1e6_f64]
}

fn positioning() -> impl Strategy<Value = Action> {
    let velocity = prop_oneof![Just(0.0), 100.0..100_000.0_f64];
    let modes = prop::sample::select(&[MoveMode::Absolute, MoveMode::Relative, MoveMode::Additive][..]);
    (axis(), modes, -60_000_i64..60_000, velocity, rate(), rate()).prop_map(
        |(axis, mode, target, velocity, acceleration, deceleration)| {
            Action::Move(Move { mode, velocity, acceleration, deceleration, ..to(axis, target) })
        },
    )
}

fn running() -> impl Strategy<Value = Action> {
    let velocity = prop_oneof![Just(0.0), -100_000.0..100_000.0_f64];
    (axis(), velocity, rate(), rate()).prop_map(|(axis, velocity, acceleration, deceleration)| {
        Action::Move(Move { acceleration, deceleration, ..at(axis, velocity) })
    })
}

fn coupling() -> impl Strategy<Value = Action> {
    let leader = (axis(), any::<bool>())
        .prop_map(|(axis, actual)| if actual { Leader::AxisActual(axis) } else { Leader::AxisCommand(axis) });
    let ways = (any::<bool>(), any::<bool>());
    (axis(), leader, -5_i64..5, 1_i64..4, ways, -500_i64..500).prop_map(
        |(axis, leader, numerator, denominator, (keeps, relates), offset)| {
            Action::Synchronize(Synchronize {
                axis,
                leader,
                mode: if relates { SyncMode::Position } else { SyncMode::Velocity },
                disengage: if keeps { Disengage::KeepVelocity } else { Disengage::Stop },
                numerator,
                denominator,
                offset: Length::whole(offset),
                velocity: 0.0,
                acceleration: 0.0,
            })
        },
    )
}

fn telling() -> impl Strategy<Value = Action> {
    let note = (prop::sample::select(&Code::NOTES[..]), any::<i64>());
    let refuse = Just(Action::Refuse("no axis is called `q`".into()));
    prop_oneof![note.prop_map(|(code, number)| Action::Note { code, number }), refuse]
}

fn happening() -> impl Strategy<Value = Happening> {
    let command = |strategy: BoxedStrategy<Action>| strategy.prop_map(Happening::Command);
    prop_oneof![
        4 => command(positioning().boxed()),
        3 => command(running().boxed()),
        3 => command(coupling().boxed()),
        2 => command(axes().prop_map(Action::Enable).boxed()),
        1 => command(axes().prop_map(Action::Disable).boxed()),
        2 => command(axes().prop_map(Action::Halt).boxed()),
        1 => command(axes().prop_map(Action::QuickStop).boxed()),
        3 => command(axes().prop_map(Action::ResetErrors).boxed()),
        1 => command(telling().boxed()),
        2 => (0_usize..4).prop_map(Happening::Cancel),
        8 => (0_u64..80).prop_map(Happening::Cycles),
        1 => (0_usize..2).prop_map(Happening::Fault),
        1 => Just(Happening::Mirror),
        1 => (0_usize..2, -3000_i64..3000).prop_map(|(drive, by)| Happening::Slip(drive, by)),
    ]
}

/// How many ends a command has once it was accepted: one for each axis that it names, or one.
fn ends(action: &Action) -> usize {
    match action {
        Action::Enable(axes)
        | Action::Disable(axes)
        | Action::Halt(axes)
        | Action::QuickStop(axes)
        | Action::ResetErrors(axes) => axes.len(),
        Action::Note { .. } => 0,
        _ => 1,
    }
}

/// Command position and velocity of the axes that are on and not coupled to anything, by name.
fn motions(rig: &Rig) -> [Option<(f64, f64)>; 3] {
    AXES.map(|name| {
        let free = rig.int(&format!("{name}.enabled")) == 1 && rig.state(name) != "SYNCHRONIZED_MOTION";
        let whole = rig.int(&format!("{name}.command.position")) as f64;
        let position = whole + rig.real(&format!("{name}.command.fraction"));
        free.then(|| (position, rig.real(&format!("{name}.command.velocity"))))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn every_command_is_answered_once_and_ends_once_and_no_free_axis_ever_jumps(
        reaction in 0_i64..6,
        delay in 0_u32..5,
        happenings in prop::collection::vec((happening(), any::<bool>()), 1..40),
    ) {
        let mut config = config(delay);
        config.axes.iter_mut().for_each(|axis| axis.parameters.error_reaction = reaction);
        let mut rig = Rig::of(config);
        rig.give(Action::Enable(AxisSet::first(3)));
        rig.run(60);
        let (mut given, mut goals, mut waiting) = (Vec::new(), Vec::new(), Vec::new());
        let mut before = motions(&rig);
        for (happening, together) in happenings {
            match happening {
                Happening::Command(action) => waiting.push(action),
                Happening::Cancel(back) => {
                    waiting.extend(goals.iter().rev().nth(back).map(|&goal| Action::Cancel { goal }));
                }
                Happening::Fault(drive) => rig.plant.drive(drive).unwrap().inject_fault(0x8611),
                Happening::Mirror => rig.mirror(),
                Happening::Slip(drive, by) => rig.plant.drive(drive).unwrap().jump(by),
                Happening::Cycles(count) => {
                    for _ in 0..count {
                        rig.run(1);
                        let now = motions(&rig);
                        for (name, (now, before)) in AXES.iter().zip(now.iter().zip(&before)) {
                            let (Some(now), Some(before)) = (now, before) else { continue };
                            // 1e6 inc/s^2 in a cycle; where a stop ends, it may end between two increments.
                            let change = (now.1 - before.1).abs();
                            prop_assert!(change <= 1_001.0, "{} changes its velocity by {}", name, change);
                            let way = (now.0 - before.0) - 0.5 * (now.1 + before.1) * 0.001;
                            prop_assert!(way.abs() <= 1.6, "{} jumps by {}", name, way);
                        }
                        before = now;
                    }
                    continue;
                }
            }
            if together && waiting.len() < 30 {
                continue;
            }
            let first = given.len() as u64 + 2;
            for (number, action) in (first..).zip(&waiting) {
                if matches!(action, Action::Move(_) | Action::Synchronize(_)) {
                    goals.push(number);
                }
                given.push((number, action.clone()));
            }
            rig.give_all(std::mem::take(&mut waiting));
            before = motions(&rig);
        }
        rig.run(6_000);
        rig.give(Action::Halt(AxisSet::first(3)));
        rig.run(6_000);
        for (number, action) in &given {
            let of = |kind| rig.events.iter().filter(|event| event.command == *number && event.kind == kind).count();
            let (accepted, refused, noted) = (of(Kind::Accepted), of(Kind::Refused), of(Kind::Warning));
            prop_assert_eq!(accepted + refused + noted, 1, "answers of {:?}", action);
            prop_assert_eq!(noted == 1, matches!(action, Action::Note { .. }), "a warning answers notes only");
            let expected = if refused == 1 { 0 } else { ends(action) };
            prop_assert_eq!(rig.done(*number).len(), expected, "ends of {:?}", action);
        }
        for name in AXES {
            let state = rig.state(name);
            prop_assert!(["STANDSTILL", "DISABLED", "ERROR_STOP", "STOPPING"].contains(&state), "{} {}", name, state);
            let on = rig.int(&format!("{name}.enabled")) == 1;
            prop_assert!(on || state != "STANDSTILL", "{} stands, and is off", name);
            if state == "STANDSTILL" {
                prop_assert_eq!(rig.real(&format!("{name}.command.fraction")), 0.0, "{}", name);
            }
        }
    }
}
