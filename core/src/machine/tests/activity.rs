use super::rig::{LINE, Rig, X, Y, at, cases, config, couple, parameters, to};
use crate::code::Code;
use crate::command::{
    Action, Command, Commands, Move, MoveMode, OutputValue, Probe, ProbeEdge, Setpoint, Setpoints, Source,
};
use crate::config::{IoConfig, IoKind};
use crate::drive::{Interface, control};
use crate::event::Kind;
use crate::object::{AxisSet, Leader, Object};
use crate::parameter::{Change, Row, Value};
use crate::vocabulary::{self, Order, saia, wf};
use proptest::prelude::*;

const REFUSED: &str = "machine: the machine is inactive; activate it first";

fn all() -> AxisSet {
    AxisSet::first(3)
}

/// Returns an inactive rig with all drives off.
fn inactive() -> Rig {
    let mut rig = Rig::new();
    let first = rig.give(Action::Deactivate);
    rig.run(5);
    assert_eq!(rig.done(first).len(), 1);
    rig
}

fn search(axis: u16) -> Probe {
    let Move { target, velocity, acceleration, deceleration, jerk, .. } = to(axis, 100);
    let (source, edge, distance) = (Object::Axis(axis), ProbeEdge::Rising, target);
    Probe { axis, relative: true, target, velocity, acceleration, deceleration, jerk, source, edge, distance }
}

fn saia(axis: u16, commands: &[saia::Command]) -> Action {
    let commands = saia::Commands::from_iter(commands.iter().copied());
    Action::vocabulary(saia::Request { axis, commands, ..Default::default() })
}

fn wf(axis: u16) -> Action {
    Action::vocabulary(wf::Request { axis, mode: Some(wf::Mode::Mdi), enable: Some(true), ..Default::default() })
}

/// Returns every command that could switch an axis on or move it.
fn moving_commands(axis: u16) -> Vec<Action> {
    use saia::Command::{Initialise, LoadDestination, Start};
    vec![
        Action::Enable(all()),
        Action::Move(to(axis, 1_000)),
        Action::Move(at(axis, 1_000.0)),
        Action::Probe(search(axis)),
        Action::Synchronize(couple(axis, Leader::Encoder(0), 1, 1)),
        saia(axis, &[Initialise]),
        saia(axis, &[LoadDestination, Start]),
        wf(axis),
    ]
}

fn setpoints() -> Setpoints {
    Setpoints { source: Source::Ros, axes: vec![Some(Setpoint { velocity: 1_000.0, duration: None }); 3] }
}

#[test]
fn new_machine_is_active_and_reports_its_state() {
    let mut rig = Rig::new();
    rig.run(1);
    assert!(rig.machine.is_active());
    assert_eq!(rig.int("machine.state"), 1);
    rig.give(Action::Deactivate);
    assert_eq!(rig.int("machine.state"), 0);
    rig.give(Action::Activate);
    assert_eq!(rig.int("machine.state"), 1);
    rig.enable();
    rig.plant.drive(0).unwrap().inject_fault(0x2310);
    rig.run(3);
    rig.give(Action::Deactivate);
    assert_eq!(rig.int("machine.state"), 2, "an error shows whether it is active or not");
}

#[test]
fn nothing_is_switched_on_and_nothing_moves_while_it_is_inactive() {
    for interface in [Interface::Position, Interface::OpenLoop] {
        let mut config = config(0);
        config.axes[usize::from(X)].interface = interface;
        let mut rig = Rig::of(config);
        rig.give(Action::Deactivate);
        rig.run(5);
        let before = ["line.command.position", "x.actual.position", "y.actual.position"].map(|name| rig.int(name));
        for axis in [LINE, X, Y] {
            for door in moving_commands(axis) {
                let sequence = rig.give(door.clone());
                assert_eq!(rig.refusal(sequence), REFUSED, "{door:?}");
                rig.run(20);
            }
            // Orders of a vocabulary, and the reference selector, which moves the axis by parameters.
            let limits = parameters().default_goal_limits();
            for order in [Order::SwitchOn, Order::Velocity { velocity: 100.0, limits }] {
                if axis != LINE || order != Order::SwitchOn {
                    assert!(rig.order(axis, order).is_err(), "{order:?}");
                }
            }
            let change = |key, value| Change { axis, row: Row::find(key).unwrap().0, value };
            let velocity = change("amc.speed_reference", Value::Real(10_000.0));
            rig.give(Action::SetParameters([velocity, change("amc.reference_select", Value::Int(1))].into()));
            rig.run(50);
        }
        let stream = setpoints();
        for _ in 1..50 {
            rig.cycle(Commands { stream: Some(&stream), ..Commands::default() });
            assert!(rig.outputs().drive.iter().all(|drive| drive.control == control::DISABLE_VOLTAGE));
        }
        let after = ["line.command.position", "x.actual.position", "y.actual.position"].map(|name| rig.int(name));
        assert_eq!(before, after);
        assert_eq!((rig.int("x.enabled"), rig.int("y.enabled")), (0, 0));
    }
}

#[test]
fn deactivation_stops_with_the_maximum_deceleration_switches_off_and_is_done_once() {
    let mut rig = Rig::enabled();
    let goals = [LINE, X].map(|axis| rig.give(Action::Move(at(axis, 50_000.0))));
    rig.run(200);
    assert_eq!(rig.real("x.command.velocity"), 50_000.0);
    let enable = rig.give(Action::Enable(all()));
    assert_eq!(rig.done(enable).len(), 3);
    let deactivation = rig.give(Action::Deactivate);
    // 50 mm/s stop in 50 ms at 1 m/s^2; one more cycle passes until the drive reports that it is off.
    let mut before = rig.real("x.command.velocity");
    for _ in 0..49 {
        rig.run(1);
        let now = rig.real("x.command.velocity");
        assert!(now < before && before - now <= 1_000.000_001, "{before} to {now}");
        assert!(rig.done(deactivation).is_empty());
        assert_eq!(rig.int("x.enabled"), 1, "it stops under control");
        before = now;
    }
    rig.run(5);
    let done = rig.done(deactivation);
    assert_eq!((done.len(), done[0].code, done[0].source), (1, Code::NONE, Object::Machine));
    assert_eq!((rig.state("x"), rig.state("y"), rig.state("line")), ("DISABLED", "DISABLED", "STANDSTILL"));
    for goal in goals {
        assert_eq!(rig.done(goal)[0].code, Code::DISABLED);
    }
    // Inputs are still read.
    rig.plant.drive(0).unwrap().jump(777);
    let was = rig.int("x.actual.position");
    rig.run(2);
    assert_ne!(rig.int("x.actual.position"), was);

    rig.give(Action::Activate);
    rig.enable();
    let goal = rig.give(Action::Move(to(X, 0)));
    assert!(rig.was_accepted(goal));
}

#[test]
fn deactivation_ends_when_the_drive_reports_off() {
    let mut rig = Rig::of(config(5));
    rig.enable();
    let deactivation = rig.give(Action::Deactivate);
    // The drive reports in cycle k + 1 + 5 what was commanded in cycle k.
    rig.run(5);
    assert_eq!((rig.state("x"), rig.done(deactivation).len()), ("DISABLED", 0));
    rig.run(1);
    assert_eq!(rig.done(deactivation).len(), 1);
}

#[test]
fn deactivation_overrides_earlier_commands_of_its_cycle() {
    let mut rig = Rig::new();
    rig.run(3);
    let last = rig.give_all(vec![Action::Enable(all()), Action::Deactivate]);
    rig.run(20);
    assert_eq!(rig.done(last).len(), 1);
    let ends: Vec<Code> = rig.done(last - 1).iter().map(|event| event.code).collect();
    assert_eq!(ends, [Code::NONE, Code::DISABLED, Code::DISABLED], "a virtual axis is always on");
    assert_eq!((rig.int("x.enabled"), rig.int("y.enabled")), (0, 0));

    let last = rig.give_all(vec![Action::Activate, Action::Enable(all())]);
    assert!(rig.was_accepted(last));
    rig.run(20);
    assert_eq!(rig.int("x.enabled"), 1);
}

#[test]
fn activation_and_a_second_deactivation_end_the_wait_of_the_first() {
    let mut rig = Rig::enabled();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(100);
    let first = rig.give(Action::Deactivate);
    let second = rig.give(Action::Deactivate);
    let activation = rig.give(Action::Activate);
    assert_eq!(rig.done(first)[0].code, Code::REPLACED);
    assert_eq!(rig.done(second)[0].code, Code::REPLACED);
    assert!(rig.was_accepted(activation));
    rig.run(200);
    assert_eq!(rig.state("x"), "DISABLED", "what had begun goes on");
}

/// `fstart` of SAIA switches its axis on itself.
#[test]
fn axis_enabled_by_vocabulary_stays_off_after_next_activation() {
    use saia::Command::{Initialise, LoadAcceleration, LoadDestination, LoadVelocity, Start};
    let start = || {
        let commands = [LoadAcceleration, LoadVelocity, LoadDestination, Start];
        let Action::Vocabulary(vocabulary::Request::Saia(request)) = saia(X, &commands) else {
            unreachable!("it is one")
        };
        let request = request.with(saia::Register::DestP, Value::Int(50_000));
        let request = request.with(saia::Register::Veloc, Value::Int(20_000));
        Action::vocabulary(request.with(saia::Register::Accel, Value::Int(200_000)))
    };
    // Given with the deactivation, while the drive switches on, and in motion.
    for cycles in [0, 2, 300] {
        let mut rig = Rig::new();
        rig.run(3);
        rig.give(saia(X, &[Initialise]));
        if cycles > 0 {
            rig.give(start());
            rig.run(cycles);
            assert!(cycles < 300 || rig.int("x.enabled") == 1);
            rig.give(Action::Deactivate);
        } else {
            rig.give_all(vec![start(), Action::Deactivate]);
        }
        rig.run(300);
        assert_eq!((rig.int("x.enabled"), rig.outputs().drive[0].control), (0, control::DISABLE_VOLTAGE));
        rig.give(Action::Activate);
        rig.run(300);
        assert_eq!((rig.int("x.enabled"), rig.outputs().drive[0].control), (0, control::DISABLE_VOLTAGE));
    }
}

#[test]
fn power_cycle_and_restore_keep_the_active_state() {
    let mut rig = inactive();
    rig.mirror();
    rig.give(Action::PowerCycle);
    rig.run(3);
    assert!(!rig.machine.is_active());
    let sequence = rig.give(Action::Enable(all()));
    assert_eq!(rig.refusal(sequence), REFUSED);
    rig.give(Action::Activate);
    rig.enable();
}

#[test]
fn a_stale_setpoint_does_not_move_anything_after_activation() {
    let mut rig = inactive();
    let stream = setpoints();
    rig.cycle(Commands { stream: Some(&stream), ..Commands::default() });
    let activate = [Command { sequence: 900, source: Source::Cli, action: Action::Activate }];
    rig.cycle(Commands::queue(&activate));
    for _ in 0..50 {
        rig.cycle(Commands::default());
    }
    assert_eq!(rig.real("line.command.velocity"), 0.0);
}

/// An output may move something that is not an axis. A refused verb switches no output.
#[test]
fn an_inactive_machine_switches_no_outputs() {
    let mut config = config(0);
    let entry = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    config.io = vec![entry("lamp", IoKind::DigitalOutput), entry("speed", IoKind::AnalogOutput)];
    let mut rig = Rig::of(config);
    let both = Action::SetOutputs([(0, 1.0), (1, 2.5)].map(|(index, value)| OutputValue { index, value }).into());
    rig.give(Action::Deactivate);
    let refused = rig.give(both.clone());
    assert_eq!(rig.refusal(refused), REFUSED);
    assert_eq!((rig.int("lamp"), rig.real("speed")), (0, 0.0));
    let given = rig.give_all(vec![Action::Activate, both]);
    assert!(rig.was_accepted(given));
    rig.give(Action::Deactivate);
    rig.run(5);
    assert_eq!((rig.int("lamp"), rig.real("speed")), (1, 2.5), "what was set for good stays");
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn no_drive_gets_voltage_between_a_done_deactivation_and_the_next_activation(
        given in prop::collection::vec((0_usize..8, 0_u16..3, 1_u64..60), 0..20),
        mode in prop::sample::select(vec![MoveMode::Velocity, MoveMode::Relative]),
    ) {
        let mut rig = Rig::enabled();
        rig.give(Action::Move(Move { mode, ..at(Y, 80_000.0) }));
        rig.run(77);
        let deactivation = rig.give(Action::Deactivate);
        for (door, axis, cycles) in given {
            let sequence = rig.give(moving_commands(axis)[door].clone());
            prop_assert_eq!(rig.refusal(sequence), REFUSED);
            for _ in 0..cycles {
                rig.run(1);
                let off = rig.outputs().drive.iter().all(|drive| drive.control == control::DISABLE_VOLTAGE);
                prop_assert!(off || rig.done(deactivation).is_empty());
            }
        }
        rig.run(300);
        prop_assert_eq!(rig.done(deactivation).len(), 1);
        prop_assert!(rig.events.iter().all(|event| event.kind != Kind::Error));
    }
}
