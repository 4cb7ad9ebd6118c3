//! Events for a loop in motion: a new reference, a brake, a stop by another axis, a reversed direction.

use super::super::rig::{Rig, X, Y, at, config, to};
use super::{lag, velocity_config};
use crate::code::Code;
use crate::command::Action;
use crate::config::{ConfigError, IoConfig, IoKind, MachineConfig};
use crate::drive::Interface;
use crate::object::AxisSet;
use crate::parameter::Value;
use crate::regulator::Law;
use crate::sim::{Amplifier, Friction, Load, Model, Motor, MotorData, Reading, Stage};

fn motor() -> Model {
    let data = MotorData {
        inertia: 5e-4,
        friction: Friction { viscous: 1e-3, ..Friction::default() },
        load: Load::default(),
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 62_832.0, noise: 0.0, seed: 1, at_load: false },
    };
    Model::Motor(Motor::new(data).unwrap())
}

fn torque_config() -> MachineConfig {
    let mut config = config(0);
    let axis = &mut config.axes[1];
    (axis.interface, axis.law) = (Interface::Torque, Law::Pid);
    axis.parameters.max_following_error = 4_000;
    axis.parameters.amplifier.max_effort = Some(1000.0);
    config
}

fn on(config: MachineConfig, model: Model) -> Rig {
    let mut rig = Rig::with(config, [model, Model::Ideal]);
    rig.enable();
    rig
}

/// A new max_velocity applies from the next motion: the active motion is not affected, and once the axis was at rest, 1
/// is twice the value.
#[test]
fn a_new_full_reference_waits_for_rest() {
    for is_torque in [false, true] {
        let (mut config, model) = if is_torque { (torque_config(), motor()) } else { (velocity_config(0), lag(2)) };
        config.axes[1].law = Law::Pid;
        let mut rig = on(config, model);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(3_000);
        let seen =
            |rig: &Rig| (rig.real("x.output.velocity"), rig.real("x.output.effort"), rig.int("x.regulator.error"));
        let before = seen(&rig);
        rig.set("max_velocity", Value::Real(200_000.0));
        for _ in 0..200 {
            rig.run(1);
            let now = seen(&rig);
            assert!((now.0 - before.0).abs() < 200.0 && (now.1 - before.1).abs() < 40.0, "{now:?} after {before:?}");
        }
        rig.give(Action::Halt(AxisSet::one(X)));
        rig.run(3_000);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(3_000);
        // A quarter of VELMAX instead of a half: 0.25 * 60000 / 30.
        assert!((rig.int("x.regulator.error") - 500).abs() <= 20, "{}", rig.int("x.regulator.error"));
    }
}

/// A brake that is closed under power holds the axis: the integral does not wind up against it, and nothing jumps when
/// it opens.
#[test]
fn a_closed_brake_winds_nothing_up() {
    let mut config = torque_config();
    config.io = vec![IoConfig { name: "hold".into(), kind: IoKind::DigitalOutput, latch: false }];
    let p = &mut config.axes[1].parameters;
    (p.outputs.brake, p.error_reaction, p.max_following_error) = (1, 3, 300);
    let mut rig = on(config, motor());
    // A distance that is too large for one cycle causes an error; the axis stops and the brake closes.
    rig.plant.drive(0).unwrap().jump(-301);
    rig.run(1_500);
    assert_eq!((rig.state("x"), rig.int("hold")), ("ERROR_STOP", 1));
    rig.plant.drive(0).unwrap().jam(true);
    rig.plant.drive(0).unwrap().jump(-5);
    let before = rig.real("x.output.effort");
    rig.run(60_000);
    assert_eq!(rig.real("x.output.effort"), before);
    rig.plant.drive(0).unwrap().jam(false);
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    let mut most: f64 = 0.0;
    for _ in 0..500 {
        rig.run(1);
        most = most.max(rig.real("x.output.effort").abs());
    }
    assert!(most < 200.0, "{most}");
}

/// If an error of x also stops y, the loop of y is stepped once in that cycle: its integral grows by one error.
#[test]
fn an_axis_that_is_stopped_with_another_steps_its_loop_once() {
    let mut config = velocity_config(0);
    for axis in [1, 2] {
        (config.axes[axis].interface, config.axes[axis].law) = (Interface::Velocity, Law::Pid);
        let p = &mut config.axes[axis].parameters;
        (p.pid.integral, p.pid.limit, p.max_following_error) = (1, 65_000, 20_000);
        p.supervision.following_error_stops_all = 1;
    }
    let mut rig = Rig::with(config, [lag(2), lag(2)]);
    rig.enable();
    rig.give(Action::Move(at(Y, 20_000.0)));
    // During acceleration its error is not yet compensated by the integral.
    rig.run(30);
    rig.plant.drive(0).unwrap().jump(-30_000);
    let before = rig.real("y.regulator.sum");
    rig.run(1);
    assert_eq!(rig.state("y"), "ERROR_STOP");
    let grown = rig.real("y.regulator.sum") - before;
    assert!(rig.int("y.regulator.error") > 20, "{}", rig.int("y.regulator.error"));
    assert!((grown - rig.int("y.regulator.error") as f64).abs() <= 1.0, "{grown} of {}", rig.int("y.regulator.error"));
}

/// Gains of an integral part that was 0: nothing has been accumulated in the meantime.
#[test]
fn an_integral_part_that_is_switched_on_moves_nothing() {
    let mut config = velocity_config(0);
    config.axes[1].law = Law::Pid;
    let mut rig = on(config, Model::Ideal);
    rig.give(Action::Move(to(X, 50_000)));
    rig.run(4_000);
    assert_eq!((rig.int("x.regulator.error"), rig.real("x.regulator.sum")), (0, 0.0));
    rig.set("kint", Value::Int(6));
    rig.run(300);
    assert_eq!((rig.int("x.actual.position"), rig.real("x.output.velocity")), (50_000, 0.0));
}

/// Motor and encoder are both inverted: commanded and reported values have the same direction, that of the user.
#[test]
fn the_effort_that_is_told_has_the_sense_of_the_one_that_is_asked_for() {
    for (posdrct, inverted) in [(1, false), (-1, false), (2, true), (-2, true)] {
        let mut config = torque_config();
        config.axes[1].parameters.macs.posdrct = posdrct;
        config.axes[1].parameters.pid.velocity = 1000;
        let mut rig = on(config, motor().wired(inverted));
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(30);
        assert!(rig.real("x.regulator.velocity") > 0.0, "{posdrct}");
        let asked = rig.real("x.regulator.effort");
        assert!(
            asked > 0.0 && rig.real("x.actual.effort") > 0.0,
            "{posdrct}: {asked}, told {}",
            rig.real("x.actual.effort")
        );
        rig.run(2_000);
        assert_eq!((rig.int("x.error"), rig.state("x")), (0, "CONTINUOUS_MOTION"), "{posdrct}");
    }
}

#[test]
fn loop_without_damping_or_with_simulated_encoder_is_refused() {
    let refused = |change: &dyn Fn(&mut MachineConfig), key: &'static str, code| {
        let mut config = torque_config();
        change(&mut config);
        assert_eq!(config.check(), Err(ConfigError::NotImplemented { axis: "x".into(), key, code }));
    };
    refused(&|c| c.axes[1].parameters.amplifier.mode = 2, "kder", Code::NO_DAMPING);
    refused(
        &|c| (c.axes[1].law, c.axes[1].parameters.amplifier.mode) = (Law::Integer, 2),
        "saia.kder",
        Code::NO_DAMPING,
    );
    refused(&|c| c.axes[1].parameters.encoder.encodertype = 9, "encodertype", Code::SIMULATED_EFFORT);
}

/// An encoder fails near the target: the following error is within its limit, and the drive would run forever. The axis
/// is switched off after a commanded distance of 2000 inc, or after full effort for 100 ms.
#[test]
fn an_encoder_that_counts_nothing_ends_without_power() {
    for (is_torque, cycles) in [(false, 400), (true, 600)] {
        let (mut config, model) = if is_torque { (torque_config(), motor()) } else { (velocity_config(0), lag(2)) };
        config.axes[1].parameters.max_following_error = 2_000;
        config.axes[1].parameters.error_reaction = 2;
        let mut rig = on(config, model);
        rig.run(50);
        rig.plant.drive(0).unwrap().jam(true);
        rig.plant.drive(0).unwrap().jump(-500);
        rig.run(cycles);
        assert_eq!((rig.int("x.error"), rig.int("x.enabled")), (i64::from(Code::ENCODER_STANDS.0), 0), "{is_torque}");
    }
}
