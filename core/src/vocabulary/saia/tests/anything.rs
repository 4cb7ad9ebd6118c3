//! Any requests in any order: nothing panics, nothing moves without a start, and a saved state continues like the
//! original.

use super::super::{Command, Commands, Register, Request};
use super::rig::{Rig, V, X};
use crate::command::Action;
use crate::object::AxisSet;
use crate::parameter::Value;
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Happening {
    Verb(Box<Request>),
    Cycles(u64),
    Slip(i64),
    Index,
    Mirror,
    Enable,
    Disable,
    Reset,
    Policy(i64),
}

fn register() -> impl Strategy<Value = (Register, Value)> {
    let sensible = |register: Register| match register {
        Register::McFac => prop_oneof![Just(1.0), 0.01..100.0_f64, 0.0..9e18_f64].prop_map(Value::Real).boxed(),
        Register::Mcw => {
            let word =
                (prop::sample::select(vec![0x1A, 0x1B, 0x1C]), 0..32_i64).prop_map(|(low, high)| low | high << 8);
            prop_oneof![4 => word, 1 => any::<i32>().prop_map(i64::from)].prop_map(Value::Int).boxed()
        }
        Register::PosEr => prop_oneof![Just(30_000_i64), 0..40_000_i64].prop_map(Value::Int).boxed(),
        Register::Accel => (0..5_000_000_i64).prop_map(Value::Int).boxed(),
        _ => {
            let wild = any::<i32>().prop_map(i64::from);
            prop_oneof![6 => -60_000..60_000_i64, 1 => wild].prop_map(Value::Int).boxed()
        }
    };
    prop::sample::select(Register::ALL.to_vec())
        .prop_flat_map(move |(register, _)| sensible(register).prop_map(move |value| (register, value)))
}

fn verb(commands: impl Strategy<Value = Vec<Command>>) -> impl Strategy<Value = Request> {
    (prop::sample::select(vec![X, X, X, V]), prop::collection::vec(register(), 0..4), commands).prop_map(
        |(axis, set, commands)| {
            let request = Request { axis, commands: Commands::from_iter(commands), ..Request::default() };
            set.into_iter().fold(request, |request, (register, value)| request.with(register, value))
        },
    )
}

fn commands() -> impl Strategy<Value = Vec<Command>> {
    let all: Vec<Command> = Command::ALL.iter().map(|(command, _)| *command).collect();
    let any = prop::collection::vec(prop::sample::select(all), 0..6);
    let usual = prop::sample::select(vec![
        vec![Command::LoadDestination, Command::Start],
        vec![Command::LoadVelocity, Command::Start],
        vec![Command::SelectMode, Command::Start],
        vec![Command::LoadAcceleration, Command::LoadVelocity, Command::Start],
        vec![Command::Stop],
        vec![Command::Initialise],
    ]);
    prop_oneof![any, usual]
}

fn happening() -> impl Strategy<Value = Happening> {
    prop_oneof![
        8 => verb(commands()).prop_map(|request| Happening::Verb(Box::new(request))),
        6 => (0..60_u64).prop_map(Happening::Cycles),
        1 => (-40_000..40_000_i64).prop_map(Happening::Slip),
        1 => Just(Happening::Index),
        1 => Just(Happening::Mirror),
        1 => Just(Happening::Enable),
        1 => Just(Happening::Disable),
        1 => Just(Happening::Reset),
        1 => (0..3_i64).prop_map(Happening::Policy),
    ]
}

fn do_it(rig: &mut Rig, happening: Happening) {
    match happening {
        Happening::Verb(request) => rig.give_or_nothing(*request),
        Happening::Cycles(count) => rig.run(count),
        Happening::Slip(by) => rig.plant.drive(0).unwrap().jump(by),
        Happening::Index => rig.latch(300_000),
        Happening::Mirror => rig.mirror(),
        Happening::Enable => drop(rig.ask([Action::Enable(AxisSet::one(X))])),
        Happening::Disable => drop(rig.ask([Action::Disable(AxisSet::one(X))])),
        Happening::Reset => drop(rig.ask([Action::ResetErrors(AxisSet::first(2))])),
        Happening::Policy(policy) => drop(rig.try_parameter("saia.command_error", Value::Int(policy))),
    }
}

/// A request without a start.
fn harmless() -> impl Strategy<Value = Happening> {
    let starts = [Command::Start, Command::StepForward, Command::StepBackward, Command::Forward, Command::Backward];
    let quiet: Vec<Command> =
        Command::ALL.iter().map(|(command, _)| *command).filter(|command| !starts.contains(command)).collect();
    let verb = verb(prop::collection::vec(prop::sample::select(quiet), 0..8))
        .prop_map(|request| Happening::Verb(Box::new(request)));
    prop_oneof![
        6 => verb,
        3 => (0..40_u64).prop_map(Happening::Cycles),
        1 => Just(Happening::Index),
        1 => Just(Happening::Enable),
        1 => Just(Happening::Disable),
        1 => (0..2_i64).prop_map(Happening::Policy),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_verbs_are_answered_once_and_a_saved_state_goes_on_the_same(
        happenings in prop::collection::vec(happening(), 1..60)
    ) {
        let mut rig = Rig::saia();
        rig.run(5);
        for happening in happenings {
            do_it(&mut rig, happening);
        }
        rig.mirror();
        rig.run(50);
    }

    #[test]
    fn nothing_moves_without_a_start(happenings in prop::collection::vec(harmless(), 1..40)) {
        let mut rig = Rig::saia();
        rig.run(5);
        for happening in happenings {
            do_it(&mut rig, happening);
            prop_assert_eq!(rig.real("x.command.velocity"), 0.0);
            prop_assert_eq!((rig.int("x.command.position"), rig.int("v.command.position")), (0, 0));
        }
    }
}
