//! A machine with inverted units and mirrored commands makes the mirrored motion, and gives its drives the same
//! commands.
//!
//! The results are equal bit for bit, except with profile jerk: its plans add their ramps in the order up, down,
//! independent of the direction, so that the last bit of a fraction may be rounded differently.

use super::super::rig::{Rig, X, at, cases, couple, to};
use super::{closed_here, servo, turned};
use crate::command::{Action, BufferMode, Move, MoveMode, Synchronize};
use crate::event::{Event, Number};
use crate::object::{AxisSet, Leader};
use crate::parameter::{Change, Row, Value};
use crate::position::Length;
use crate::sim::Model;
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum RandomCommand {
    Move(Move),
    Override(f64),
    Halt,
    Disable,
    Enable,
    Slip(i64),
    Stream(f64),
    /// A coupling to the line.
    Couple(i64),
    MoveLine(i64),
}

fn random_command() -> impl Strategy<Value = RandomCommand> {
    use MoveMode::{Absolute, Additive, Relative, Superimposed};
    let mode = prop::sample::select(vec![Absolute, Relative, Additive, Superimposed]);
    let buffer = prop::sample::select(vec![
        BufferMode::Aborting,
        BufferMode::Buffered,
        BufferMode::BlendingLow,
        BufferMode::BlendingNext,
        BufferMode::BlendingHigh,
    ]);
    let rates = (prop_oneof![Just(0.0), 1e3..1e5_f64], prop_oneof![Just(0.0), 1e5..1e6_f64]);
    let moves = (mode, -40_000_i64..40_000, rates, buffer).prop_map(|(mode, target, (velocity, rate), buffer_mode)| {
        RandomCommand::Move(Move { mode, velocity, acceleration: rate, buffer_mode, ..to(X, target) })
    });
    let runs = (-90_000.0..90_000.0_f64).prop_map(|velocity| RandomCommand::Move(at(X, velocity)));
    prop_oneof![
        6 => moves,
        2 => runs,
        1 => (0.0..100.0_f64).prop_map(RandomCommand::Override),
        1 => Just(RandomCommand::Halt),
        1 => Just(RandomCommand::Disable),
        2 => Just(RandomCommand::Enable),
        1 => (-300_i64..300).prop_map(RandomCommand::Slip),
        1 => (-90_000.0..90_000.0_f64).prop_map(RandomCommand::Stream),
        2 => (-3_i64..4).prop_map(RandomCommand::Couple),
        2 => (-20_000_i64..20_000).prop_map(RandomCommand::MoveLine),
    ]
}

/// Returns the same event for a machine whose x counts in the opposite direction.
fn mirrored(deed: &RandomCommand) -> RandomCommand {
    match deed {
        RandomCommand::Move(request) => {
            let target = Length { nearest: -request.target.nearest, rest: -request.target.rest };
            let velocity = if request.mode == MoveMode::Velocity { 0.0 - request.velocity } else { request.velocity };
            RandomCommand::Move(Move { target, velocity, ..*request })
        }
        RandomCommand::Stream(velocity) => RandomCommand::Stream(0.0 - velocity),
        RandomCommand::Couple(numerator) => RandomCommand::Couple(-numerator),
        other => other.clone(),
    }
}

fn does(rig: &mut Rig, deed: &RandomCommand) {
    let x = AxisSet::one(X);
    let action = match deed {
        RandomCommand::Move(request) => Action::Move(*request),
        RandomCommand::Override(share) => {
            let (row, _) = Row::find("velocity_override").unwrap();
            Action::SetParameters([Change { axis: X, row, value: Value::Real(*share) }].into())
        }
        RandomCommand::Halt => Action::Halt(x),
        RandomCommand::Disable => Action::Disable(x),
        RandomCommand::Enable => Action::Enable(x),
        // A slip of the drive is the same in both machines.
        RandomCommand::Slip(by) => return rig.plant.drive(0).unwrap().jump(*by),
        RandomCommand::Stream(velocity) => {
            return rig.stream(X, *velocity);
        }
        RandomCommand::Couple(numerator) => {
            let request = couple(X, Leader::AxisCommand(0), *numerator, 1);
            Action::Synchronize(Synchronize { velocity: 50_000.0, ..request })
        }
        RandomCommand::MoveLine(target) => Action::Move(to(0, *target)),
    };
    rig.give(action);
}

/// Returns the content of an event without positions and velocities.
fn event_content(event: &Event) -> (u64, u32, String, bool) {
    let has_number = event.asked != Number::None;
    (event.command, event.code.0, format!("{:?}", event.kind), has_number)
}

fn same(one: &mut Rig, other: &mut Rig) -> Result<(), TestCaseError> {
    prop_assert_eq!(one.outputs().drive.clone(), other.outputs().drive.clone());
    let raw = |rig: &Rig| {
        // Integer part and fraction are exact in units of 2^-32.
        let fraction = (rig.real("x.command.fraction") * (1_u64 << 32) as f64) as i128;
        (i128::from(rig.int("x.command.position")) << 32) + fraction
    };
    prop_assert_eq!(raw(one), -raw(other));
    for name in ["x.actual.position", "x.following_error", "x.regulator.error"] {
        prop_assert_eq!(one.int(name), -other.int(name), "{}", name);
    }
    for name in
        ["x.state", "x.in_position", "x.enabled", "x.error", "x.actual.count", "x.reference", "line.command.position"]
    {
        prop_assert_eq!(one.int(name), other.int(name), "{}", name);
    }
    for name in ["x.command.velocity", "x.command.acceleration", "x.actual.velocity", "x.regulator.output"] {
        prop_assert_eq!(one.real(name), 0.0 - other.real(name), "{}", name);
    }
    let gists = |rig: &mut Rig| rig.events.drain(..).map(|event| event_content(&event)).collect::<Vec<_>>();
    let (mine, others) = (gists(one), gists(other));
    prop_assert_eq!(mine, others);
    Ok(())
}

proptest! {
    #![proptest_config(cases(100))]

    /// Proves: MACS-DIR-02, MACS-DIR-03
    #[test]
    fn inverted_units_are_the_mirror_image_to_the_last_bit(
        shape in 0_i64..2,
        here in any::<bool>(),
        deeds in prop::collection::vec((random_command(), 0_u64..150), 1..20),
    ) {
        let rig = |sign: i64| {
            // For a loop that is closed in the core the wiring is inverted as well.
            let mut config = if here { closed_here(2 * sign) } else { turned(sign) };
            let p = &mut config.axes[1].parameters;
            (p.max_jerk, p.profile, p.in_position_window) = (Some(2e7), shape, 3);
            let mut rig = Rig::with(config, [if here { servo(true) } else { Model::Ideal }, Model::Ideal]);
            rig.enable();
            rig
        };
        let (mut one, mut other) = (rig(1), rig(-1));
        same(&mut one, &mut other)?;
        for (deed, cycles) in &deeds {
            does(&mut one, deed);
            does(&mut other, &mirrored(deed));
            same(&mut one, &mut other)?;
            for _ in 0..*cycles {
                one.run(1);
                other.run(1);
                same(&mut one, &mut other)?;
            }
        }
    }
}

/// Proves: MACS-DIR-02
#[test]
fn inverted_units_are_the_mirror_image_with_limited_jerk() {
    let rig = |posdrct| {
        let mut config = turned(posdrct);
        (config.axes[1].parameters.max_jerk, config.axes[1].parameters.profile) = (Some(2e7), 2);
        let mut rig = Rig::of(config);
        rig.enable();
        rig
    };
    let (mut one, mut other) = (rig(1), rig(-1));
    let deeds = [
        (RandomCommand::Move(to(X, 12_345)), 100),
        (RandomCommand::Move(at(X, 43_314.466)), 76),
        (RandomCommand::Halt, 103),
        (RandomCommand::Move(to(X, -7_001)), 70),
        (RandomCommand::Move(to(X, 333)), 1_000),
    ];
    for (deed, cycles) in deeds {
        does(&mut one, &deed);
        does(&mut other, &mirrored(&deed));
        for _ in 0..cycles {
            one.run(1);
            other.run(1);
            let position = |rig: &Rig| rig.int("x.command.position") as f64 + rig.real("x.command.fraction");
            assert!((position(&one) + position(&other)).abs() < 1e-6);
            assert!((one.real("x.output.velocity") - other.real("x.output.velocity")).abs() < 1e-6);
            assert!((one.int("x.output.position") - other.int("x.output.position")).abs() <= 1);
        }
    }
    assert_eq!((one.int("x.output.position"), other.int("x.output.position")), (333, 333));
}
