//! Axes without a position loop.

use super::rig::{Rig, X, at, config, couple, to};
use crate::code::Code;
use crate::command::Action;
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::drive::{Interface, SpeedOutputs, Switching};
use crate::event::Kind;
use crate::machine::Machine;
use crate::object::{AxisSet, Leader};
use crate::position::Position;
use crate::sim::{Model, TwoSpeed, Valve};
use crate::vocabulary::Order;

const MS: u64 = 1_000_000;

fn open_config(delay: u32) -> MachineConfig {
    let mut config = config(delay);
    config.axes[1].interface = Interface::OpenLoop;
    config
}

/// 50 ms of acceleration, 100 ms of coasting: from 20 mm/s it coasts 2 mm.
fn motor() -> Model {
    Model::TwoSpeed(TwoSpeed::new(50_000_000, 100_000_000, MS).unwrap())
}

fn enabled() -> Rig {
    let mut rig = Rig::with(open_config(0), [motor(), Model::Ideal]);
    rig.enable();
    rig
}

fn speed(velocity: f64) -> Order {
    Order::Speed { velocity }
}

fn running(velocity: f64) -> Rig {
    let mut rig = enabled();
    rig.order(X, speed(velocity)).unwrap();
    rig.run(1_000);
    rig
}

/// No ramp: the speed is commanded in the cycle of the order, and the command position is the actual position.
///
/// Proves: WF-OLC-01, WF-OLC-11
#[test]
fn the_drive_runs_at_the_speed_and_the_command_is_where_it_is() {
    let mut rig = enabled();
    assert_eq!(rig.int("x.mode_of_operation"), 2);
    rig.order(X, speed(20_000.0)).unwrap();
    for _ in 0..2_000 {
        rig.run(1);
        assert_eq!((rig.real("x.output.velocity"), rig.real("x.command.velocity")), (20_000.0, 20_000.0));
        assert_eq!(rig.int("x.command.position"), rig.int("x.actual.position"));
        assert_eq!((rig.int("x.following_error"), rig.int("x.regulator.error"), rig.int("x.error")), (0, 0, 0));
    }
    assert_eq!((rig.state("x"), rig.real("x.actual.velocity")), ("CONTINUOUS_MOTION", 20_000.0));
    // 20 inc in each of 1999 cycles, less the lag of the motor: 20000 inc/s * 50 ms.
    assert_eq!(rig.int("x.actual.position"), 1_999 * 20 - 1_000);
    rig.order(X, speed(-5_000.0)).unwrap();
    rig.run(2_000);
    assert_eq!(rig.real("x.actual.velocity"), -5_000.0);
}

/// Proves: WF-OLC-09
#[test]
fn switched_off_it_coasts_and_stands_when_it_does() {
    let mut rig = running(20_000.0);
    let from = rig.int("x.actual.position");
    rig.order(X, speed(0.0)).unwrap();
    rig.run(1);
    assert_eq!(
        (rig.real("x.output.velocity"), rig.real("x.command.velocity"), rig.state("x")),
        (0.0, 0.0, "DISCRETE_MOTION")
    );
    let mut cycles = 1;
    while rig.state("x") != "STANDSTILL" {
        assert!(rig.real("x.actual.velocity") > 0.0, "it stands, and does not say so");
        assert_eq!(rig.int("x.command.position"), rig.int("x.actual.position"));
        rig.run(1);
        cycles += 1;
    }
    assert_eq!(rig.real("x.actual.velocity"), 0.0);
    // One more cycle at speed was already commanded. 2000 inc of coasting; friction holds the last half increment.
    let way = rig.int("x.actual.position") - from;
    assert!((2_019..=2_020).contains(&way), "{way}");
    // e^(-t / 100 ms) of 2000 inc is half an increment after 829 ms.
    assert!((829..=833).contains(&cycles), "{cycles}");
}

#[test]
fn halt_disable_and_quick_stop_switch_the_speed_off_in_their_cycle() {
    let x = AxisSet::one(X);
    let stops = [(Action::Halt(x), "STANDSTILL"), (Action::Disable(x), "DISABLED"), (Action::QuickStop(x), "STOPPING")];
    for (stop, end) in stops {
        let mut rig = running(20_000.0);
        let number = rig.give(stop);
        assert_eq!((rig.real("x.output.velocity"), rig.int("x.enabled")), (0.0, 1), "{end}");
        assert!(rig.done(number).is_empty(), "{end}: it coasts still");
        rig.run(500);
        // The drive stays enabled until the axis is at rest.
        assert_eq!((rig.done(number).len(), rig.int("x.enabled")), (0, 1), "{end}");
        rig.run(500);
        assert_eq!((rig.done(number).len(), rig.state("x")), (1, end));
        assert_eq!(rig.real("x.actual.velocity"), 0.0);
    }
}

#[test]
fn a_new_speed_takes_a_coasting_axis_over_and_a_halt_waits_no_more() {
    let mut rig = running(20_000.0);
    let halt = rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(100);
    assert_eq!(rig.state("x"), "DISCRETE_MOTION");
    rig.order(X, speed(10_000.0)).unwrap();
    rig.run(1);
    assert_eq!((rig.state("x"), rig.real("x.output.velocity")), ("CONTINUOUS_MOTION", 10_000.0));
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(2_000);
    assert_eq!((rig.done(halt).len(), rig.state("x")), (1, "STANDSTILL"));
}

#[test]
fn every_error_switches_the_speed_off_in_its_cycle() {
    for reaction in 0..6 {
        let mut config = open_config(0);
        config.axes[1].parameters.error_reaction = reaction;
        config.axes[1].parameters.max_position = Some(10_000);
        let mut rig = Rig::with(config, [motor(), Model::Ideal]);
        rig.enable();
        rig.order(X, speed(20_000.0)).unwrap();
        rig.run_until("x.error", i64::from(Code::SOFTWARE_LIMIT_POSITIVE.0));
        assert!((10_000..10_020).contains(&rig.int("x.actual.position")));
        assert_eq!((rig.real("x.output.velocity"), rig.state("x")), (0.0, "ERROR_STOP"));
        rig.run(1_500);
        assert_eq!((rig.real("x.actual.velocity"), rig.state("x")), (0.0, "ERROR_STOP"));
        assert_eq!(rig.int("x.enabled") == 1, matches!(reaction, 2 | 3 | 5), "reaction {reaction}");
        assert_eq!(rig.int("x.brake") == 1, matches!(reaction, 1 | 3), "reaction {reaction}");
    }
    let mut rig = running(20_000.0);
    rig.plant.drive(0).unwrap().inject_fault(0x8611);
    rig.run(1);
    assert_eq!((rig.real("x.output.velocity"), rig.state("x"), rig.int("x.enabled")), (0.0, "ERROR_STOP", 0));
}

#[test]
fn from_a_limit_only_the_way_back_is_open() {
    let mut config = open_config(0);
    (config.axes[1].parameters.min_position, config.axes[1].parameters.max_position) = (Some(-10), Some(10));
    let mut rig = Rig::with(config, [motor(), Model::Ideal]);
    rig.enable();
    rig.order(X, speed(20_000.0)).unwrap();
    rig.run(2_000);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(10);
    assert!(rig.int("x.actual.position") > 10);
    assert_eq!(rig.order(X, speed(1.0)).unwrap_err().code, Code::LIMIT_VIOLATION);
    assert_eq!(rig.order(X, speed(-20_000.0)), Ok(()));
    rig.run_until("x.error", i64::from(Code::SOFTWARE_LIMIT_NEGATIVE.0));
}

#[test]
fn goals_and_streams_need_a_position_loop() {
    let mut rig = enabled();
    let sentence = "x: the axis runs in open loop; only commands of `wf` move it";
    for action in [
        Action::Move(to(X, 100)),
        Action::Move(at(X, 100.0)),
        Action::Synchronize(couple(X, Leader::AxisCommand(0), 1, 1)),
    ] {
        let number = rig.give(action);
        assert_eq!(rig.refusal(number), sentence);
    }
    let limits = rig.machine.parameters(X).unwrap().default_goal_limits();
    for order in [
        Order::Position { target: Position::whole(100), limits, reference: Default::default() },
        Order::Velocity { velocity: 100.0, limits },
        Order::Gear { past: Position::ZERO },
    ] {
        assert_eq!(rig.order(X, order).unwrap_err().code, Code::OPEN_LOOP);
    }
    let told = rig.events.len();
    for _ in 0..500 {
        rig.stream(X, 100.0);
    }
    let said: Vec<_> = rig.events[told..].iter().filter(|event| event.kind == Kind::Warning).collect();
    assert_eq!(said.len(), 1, "a stream is refused once, not in each cycle");
    let sentence = sentence.replacen("x:", "x: streamed setpoints are not followed:", 1);
    assert_eq!(crate::text::message(said[0], rig.machine.config()), sentence);
    assert_eq!((rig.state("x"), rig.int("x.actual.position")), ("STANDSTILL", 0));
}

#[test]
fn invalid_speeds_change_nothing() {
    let mut rig = running(20_000.0);
    for (velocity, code) in [
        (f64::NAN, Code::BAD_NUMBER),
        (f64::INFINITY, Code::BAD_NUMBER),
        (100_000.1, Code::VELOCITY_TOO_HIGH),
        (-100_000.1, Code::VELOCITY_TOO_HIGH),
    ] {
        assert_eq!(rig.order(X, speed(velocity)).unwrap_err().code, code);
        rig.run(1);
        assert_eq!(rig.real("x.output.velocity"), 20_000.0);
    }
    assert_eq!(rig.order(2, speed(1.0)).unwrap_err().code, Code::CLOSED_LOOP, "y closes a loop");
    assert_eq!(rig.order(0, speed(1.0)).unwrap_err().code, Code::CLOSED_LOOP, "line has no drive");
    rig.give(Action::Disable(AxisSet::one(X)));
    assert_eq!(rig.order(X, speed(1.0)).unwrap_err().code, Code::NOT_ENABLED);
}

/// With any lock of the axis, and with homing required: speed 0 is always accepted.
///
/// Proves: WF-OST-10
#[test]
fn speed_zero_is_always_accepted() {
    let x = || AxisSet::one(X);
    for action in [Action::QuickStop(x()), Action::Abort, Action::Disable(x()), Action::Halt(x())] {
        let mut rig = running(20_000.0);
        rig.give(action);
        let state = rig.state("x");
        assert_eq!(rig.order(X, speed(0.0)), Ok(()));
        assert_eq!(rig.state("x"), state);
    }
    let mut rig = running(20_000.0);
    let (row, _) = crate::parameter::Row::find("homing.required").unwrap();
    let change = crate::parameter::Change { axis: X, row, value: crate::parameter::Value::Int(1) };
    rig.give(Action::SetParameters(Box::new([change])));
    assert_eq!(rig.order(X, speed(10_000.0)).unwrap_err().code, Code::HOMING_REQUIRED);
    assert_eq!(rig.order(X, speed(0.0)), Ok(()));
    rig.run(1);
    assert_eq!(rig.real("x.output.velocity"), 0.0);
}

/// An encoder that never shows rest must not block an axis forever: after 5 s the axis counts as at rest.
#[test]
fn after_five_seconds_a_coasting_axis_counts_as_at_rest() {
    let slow = Model::TwoSpeed(TwoSpeed::new(0, 10_000_000_000, MS).unwrap());
    let mut rig = Rig::with(open_config(0), [slow, Model::Ideal]);
    rig.enable();
    rig.order(X, speed(100_000.0)).unwrap();
    rig.run(10);
    let halt = rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(5_000);
    assert_eq!((rig.done(halt).len(), rig.state("x")), (0, "DISCRETE_MOTION"));
    rig.run(1);
    assert_eq!((rig.done(halt).len(), rig.state("x")), (1, "STANDSTILL"));
    assert!(rig.real("x.actual.velocity") > 50_000.0);
}

/// An order and a halt before the drive has received either: the axis does not count as at rest only because nothing
/// has arrived.
#[test]
fn a_halt_waits_for_what_is_on_its_way_to_the_drive() {
    let mut rig = Rig::with(open_config(3), [Model::Ideal; 2]);
    rig.enable();
    rig.order(X, speed(20_000.0)).unwrap();
    rig.run(1);
    let halt = rig.give(Action::Halt(AxisSet::one(X)));
    let end = rig.run_until("x.state", 1);
    assert_eq!((rig.int("x.actual.position"), rig.done(halt).len()), (20, 1));
    assert!(end >= 5, "{end}");
}

#[test]
fn a_restored_machine_runs_and_coasts_on() {
    let valve = Model::Valve(Valve::new(30_000_000, 20_500_000, MS).unwrap());
    let mut rig = Rig::with(open_config(1), [valve, Model::Ideal]);
    rig.enable();
    rig.order(X, speed(20_000.0)).unwrap();
    rig.run(100);
    rig.mirror();
    rig.run(100);
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(10);
    rig.mirror();
    rig.order(X, speed(-300.0)).unwrap();
    rig.run(100);
}

fn wired() -> MachineConfig {
    let io = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    let mut config = open_config(0);
    let ones = (0..70).map(|n| io(&format!("q{n}"), IoKind::DigitalOutput));
    config.io = ones
        .chain([io("in", IoKind::DigitalInput), io("a0", IoKind::AnalogOutput), io("a1", IoKind::AnalogOutput)])
        .collect();
    config.axes[1].open_loop = SpeedOutputs { forward: Some(3), backward: Some(64), output: Some(69), dac: Some(72) };
    config
}

/// Until the vocabulary sets an output, every output is off, including outputs that are not wired.
///
/// Proves: WF-DAC-01
#[test]
fn outputs_of_an_axis_that_was_not_started_are_off() {
    let mut rig = Rig::with(wired(), [motor(), Model::Ideal]);
    rig.enable();
    rig.order(X, speed(20_000.0)).unwrap();
    rig.run(10);
    assert_eq!((rig.outputs().digital.as_slice(), rig.outputs().analog.as_slice()), (&[0, 0][..], &[0.0, 0.0][..]));
    for name in ["q3", "q64", "q69", "a1"] {
        assert_eq!(rig.real(name), 0.0);
    }
}

/// Each signal is written to its own output, and only while the axis may run: Q and the voltage end with the speed, the
/// direction remains while the axis coasts to its target, and an error clears all of them.
///
/// Proves: WF-OLC-09, WF-OLC-10, WF-DAC-01
#[test]
fn outputs_end_with_their_signals() {
    let mut rig = Rig::with(wired(), [motor(), Model::Ideal]);
    rig.enable();
    let shows = |rig: &mut Rig, asked: Switching| {
        let axis = &rig.machine.state.axes[1];
        let (wiring, allowed) = (axis.speed_outputs().unwrap_or_default(), axis.allowed(asked));
        let mut outputs = rig.outputs().clone();
        let Machine { state, signals, .. } = &mut rig.machine;
        signals.publish_switching(&mut state.board, wiring, allowed, &mut outputs);
        for (name, place) in [("q3", 3), ("q64", 64), ("q69", 69)] {
            assert_eq!(rig.int(name) == 1, outputs.digital(place), "{name}");
        }
        assert_eq!(rig.real("a1"), outputs.analog[1]);
        let others = outputs.digital[0] & !(1 << 3) | outputs.digital[1] & !(1 | 1 << 5);
        assert_eq!((others, outputs.analog[0]), (0, 0.0), "outputs of nobody");
        [rig.real("q3"), rig.real("q64"), rig.real("q69"), rig.real("a1")]
    };
    let all = Switching { forward: true, backward: true, output: true, dac: -4.5 };
    assert_eq!(shows(&mut rig, all), [0.0; 4], "nothing was ordered yet");
    rig.order(X, speed(20_000.0)).unwrap();
    assert_eq!(shows(&mut rig, all), [1.0, 1.0, 1.0, -4.5]);
    assert_eq!(shows(&mut rig, Switching { backward: false, dac: f64::NAN, ..all }), [1.0, 0.0, 1.0, 0.0]);
    assert_eq!(shows(&mut rig, Switching { forward: false, output: false, ..all }), [0.0, 1.0, 0.0, -4.5]);
    rig.run(10);
    rig.order(X, speed(0.0)).unwrap();
    assert_eq!(shows(&mut rig, all), [1.0, 1.0, 0.0, 0.0]);
    rig.order(X, speed(20_000.0)).unwrap();
    rig.plant.drive(0).unwrap().inject_fault(1);
    rig.run(1);
    assert_eq!(shows(&mut rig, all), [0.0; 4]);
}

#[test]
fn outputs_must_be_of_their_kind() {
    let refused = |wiring: SpeedOutputs| {
        let mut config = wired();
        config.axes[1].open_loop = wiring;
        config.check().unwrap_err().to_string()
    };
    let none = SpeedOutputs::default();
    assert_eq!(
        refused(SpeedOutputs { forward: Some(70), ..none }),
        "x: forward is wired to entry 70 of io, which is no do"
    );
    assert_eq!(refused(SpeedOutputs { dac: Some(0), ..none }), "x: dac is wired to entry 0 of io, which is no ao");
    assert_eq!(
        refused(SpeedOutputs { output: Some(99), ..none }),
        "x: output is wired to entry 99 of io, which is no do"
    );
}
