//! Interface torque: position and velocity loop in the core, with a motor and its mechanics.

use super::super::rig::{Rig, X, at, config, to};
use super::MS;
use crate::code::Code;
use crate::command::Action;
use crate::config::{ConfigError, MachineConfig};
use crate::drive::{Capabilities, Interface};
use crate::object::AxisSet;
use crate::parameter::Value;
use crate::regulator::Law;
use crate::sim::{Amplifier, Friction, Load, Model, Motor, MotorData, Reading, Stage};

/// 1 Nm on 5e-4 kg m^2: 2000 rad/s^2 at the rated torque, 20000 inc/s^2 for each rad/s^2 of 10000 inc/rad.
pub(super) fn motor() -> MotorData {
    MotorData {
        inertia: 2.5e-4,
        friction: Friction::default(),
        load: Load { inertia: 2.5e-4, ..Load::default() },
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 62_832.0, noise: 0.0, seed: 1, at_load: false },
    }
}

/// x accepts efforts up to the rated torque: 2e7 inc/s^2, against 1e6 of max_acceleration.
pub(super) fn torque_config() -> MachineConfig {
    let mut config = config(0);
    let axis = &mut config.axes[1];
    axis.interface = Interface::Torque;
    axis.law = Law::Pid;
    axis.parameters.max_following_error = 4_000;
    axis.parameters.amplifier.max_effort = Some(1000.0);
    axis.parameters.pid.velocity = 1000;
    config
}

fn rig(config: MachineConfig, data: MotorData) -> Rig {
    let mut rig = Rig::with(config, [Model::Motor(Motor::new(data).unwrap()), Model::Ideal]);
    rig.enable();
    rig
}

/// The cascade moves the axis to its target, in torque mode, and the effort at constant speed equals the friction: 1e-3
/// Nm s/rad at 5 rad/s are 5 per mille of 1 Nm.
///
/// Proves: MACS-AMP-01, MACS-AMP-04
#[test]
fn a_move_lands_and_friction_is_what_is_left() {
    let mut data = motor();
    data.friction.viscous = 1e-3;
    let mut rig = rig(torque_config(), data);
    assert_eq!(rig.int("x.mode_of_operation"), 10);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(3_000);
    assert!((rig.real("x.output.effort") - 5.0).abs() < 2.0, "{}", rig.real("x.output.effort"));
    assert!((rig.real("x.regulator.velocity") - 50_000.0).abs() <= 1_000.0);
    assert!((rig.real("x.actual.effort") - rig.real("x.output.effort")).abs() < 2.0);
    let goal = rig.give(Action::Move(to(X, 20_000)));
    rig.run(5_000);
    assert_eq!((rig.state("x"), rig.done(goal).len()), ("STANDSTILL", 1));
    assert!((rig.int("x.actual.position") - 20_000).abs() <= 3);
}

/// The integral part of the velocity loop holds the torque of a hanging load: 0.2 Nm are 200 per mille.
#[test]
fn a_weight_is_held() {
    let mut data = motor();
    data.load.torque = -0.2;
    let mut rig = rig(torque_config(), data);
    rig.run(3_000);
    assert!((rig.real("x.output.effort") - 200.0).abs() < 1.0, "{}", rig.real("x.output.effort"));
    assert!(rig.int("x.regulator.error").abs() <= 3, "{}", rig.int("x.regulator.error"));
}

/// AMPMODE 2: the position loop gives the effort: KPROP 6000 at an error of 10 inc is the full effort, KDER damps.
///
/// Proves: MACS-AMP-01, MACS-AMP-03, MACS-REG-03
#[test]
fn without_a_velocity_loop_the_position_loop_makes_the_effort() {
    let mut config = torque_config();
    let p = &mut config.axes[1].parameters;
    (p.amplifier.mode, p.pid.velocity) = (2, 0);
    (p.pid.proportional, p.pid.derivative, p.pid.integral, p.pid.limit) = (300, 6_000, 1, 60_000);
    let mut rig = rig(config, motor());
    rig.run(10);
    rig.plant.drive(0).unwrap().jump(-10);
    rig.run(1);
    // The error of 10 and its change: (300 * 10 + 6000 * 10 + 10) / 60000 exceeds 1.
    assert_eq!((rig.real("x.regulator.output"), rig.real("x.output.effort")), (1.0, 1000.0));
    rig.run(2_000);
    rig.give(Action::Move(to(X, 30_000)));
    rig.run(4_000);
    assert_eq!(rig.state("x"), "STANDSTILL");
    assert!((rig.int("x.actual.position") - 30_000).abs() <= 3);
    // The velocity loop is not used.
    assert_eq!(rig.real("x.regulator.effort"), rig.real("x.regulator.output"));
}

/// 2 A at 250 per mille per ampere are half of max_effort: no output exceeds it, in either mode; a weight that needs
/// more causes a following error.
///
/// Proves: MACS-AMP-08
#[test]
fn the_current_is_capped_where_it_is_known() {
    let mut config = torque_config();
    config.axes[1].parameters.amplifier.torque_constant = 250.0;
    let mut rig = rig(config, motor());
    let mut most: f64 = 0.0;
    rig.give(Action::Move(to(X, 50_000)));
    rig.set("velkprop", Value::Int(30_000));
    for _ in 0..500 {
        rig.run(1);
        most = most.max(rig.real("x.output.effort").abs());
    }
    assert_eq!(most, 500.0);
    rig.set("ampmaxcur", Value::Int(1000));
    most = 0.0;
    rig.give(Action::Move(to(X, 0)));
    for _ in 0..500 {
        rig.run(1);
        most = most.max(rig.real("x.output.effort").abs());
    }
    assert_eq!(most, 250.0);
}

/// A weight of 0.5 Nm at 250 per mille per ampere is 2 A: (2000 mA)^2 / 1000 = 4000, which exceeds I2TLIMIT 3900. 90 %
/// of the limit, 3510, are reached at -1000 ln(1 - 3510/4000) = 2100 ms, and 3900 at 3689 ms. Switched off, the motor
/// cools, and nothing is reported again.
///
/// Proves: MACS-I2T-01, MACS-I2T-02, MACS-I2T-03, MACS-I2T-04
#[test]
fn persistent_current_causes_warning_then_error_99() {
    let mut config = torque_config();
    let p = &mut config.axes[1].parameters;
    p.error_reaction = 0;
    (p.amplifier.torque_constant, p.amplifier.max_current) = (250.0, 60_000);
    (p.amplifier.heat_time, p.amplifier.heat_limit) = (1000, 3_900);
    let mut data = motor();
    data.load.torque = -0.5;
    let mut rig = rig(config, data);
    rig.run(1_900);
    let told = |rig: &Rig, code: Code| rig.events.iter().filter(|event| event.code == code).count();
    assert_eq!((told(&rig, Code::I2T_NEAR), rig.int("x.error")), (0, 0));
    assert!((rig.real("x.regulator.current") - 2_000.0).abs() < 10.0, "{}", rig.real("x.regulator.current"));
    rig.run(400);
    assert_eq!((told(&rig, Code::I2T_NEAR), rig.int("x.error")), (1, 0));
    rig.run(1_200);
    assert_eq!(rig.int("x.error"), 0);
    rig.run(400);
    assert_eq!((rig.int("x.error"), rig.state("x"), rig.real("x.output.effort")), (99, "ERROR_STOP", 0.0));
    assert_eq!((told(&rig, Code::I2T_NEAR), told(&rig, Code::I2T_LIMIT)), (1, 1));
    rig.run(3_000);
    assert!(rig.real("x.regulator.i2t") < 300.0, "{}", rig.real("x.regulator.i2t"));
}

/// CURFTIME filters the displayed value, and does not affect the loops.
///
/// Proves: MACS-I2T-05
#[test]
fn current_filter_affects_display_only() {
    let run = |time| {
        let mut config = torque_config();
        let p = &mut config.axes[1].parameters.amplifier;
        (p.torque_constant, p.max_current, p.current_time) = (250.0, 60_000, time);
        let mut rig = rig(config, motor());
        rig.give(Action::Move(to(X, 30_000)));
        let mut seen = Vec::new();
        for _ in 0..400 {
            rig.run(1);
            seen.push((rig.real("x.output.effort"), rig.real("x.regulator.current")));
        }
        seen
    };
    let (plain, filtered) = (run(0), run(100));
    assert!(plain.iter().zip(&filtered).all(|(one, other)| one.0 == other.0));
    let most = |seen: &[(f64, f64)]| seen.iter().fold(0.0_f64, |most, (_, current)| most.max(current.abs()));
    assert!(most(&filtered) < most(&plain) / 2.0);
}

/// Each estimator closes the loop, and measures a constant velocity.
///
/// Proves: MACS-AMP-06
#[test]
fn the_velocity_is_found_by_any_estimator() {
    for (place, within) in [(0, 1_001.0), (1, 300.0), (2, 200.0), (3, 300.0)] {
        let mut config = torque_config();
        let p = &mut config.axes[1].parameters.amplifier;
        (p.estimator, p.bandwidth, p.acceleration) = (place, 150.0, 3e5);
        let mut rig = rig(config, motor());
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(2_000);
        let found = rig.real("x.regulator.velocity");
        assert!((found - 50_000.0).abs() <= within, "{place}: {found}");
        assert!(rig.int("x.regulator.error").abs() < 100, "{place}: {}", rig.int("x.regulator.error"));
        let refused = rig.set("velocity_loop.bandwidth", Value::Real(50.0));
        let sentence = rig.refusal(refused);
        assert!(sentence.starts_with("x: velocity_loop.bandwidth"), "{sentence}");
    }
}

#[test]
fn off_there_is_no_effort_and_on_again_no_past() {
    let mut data = motor();
    data.load.torque = -0.2;
    let mut rig = rig(torque_config(), data);
    rig.run(1_000);
    assert!(rig.real("x.output.effort") > 100.0);
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(500);
    assert_eq!((rig.state("x"), rig.real("x.output.effort"), rig.real("x.regulator.effort")), ("DISABLED", 0.0, 0.0));
}

#[test]
fn a_restored_machine_goes_on_with_all_loops() {
    let mut config = torque_config();
    let p = &mut config.axes[1].parameters.amplifier;
    (p.estimator, p.torque_constant, p.heat_time, p.heat_limit) = (3, 250.0, 500, 1_000_000);
    let mut rig = rig(config, motor());
    rig.give(Action::Move(to(X, 30_000)));
    rig.run(151);
    rig.set("velkprop", Value::Int(300));
    rig.run(3);
    rig.mirror();
    rig.run(2_000);
    assert!(rig.int("x.regulator.error").abs() <= 3);
}

#[test]
fn what_the_loops_cannot_do_is_refused_by_its_name() {
    let refused = |change: &dyn Fn(&mut MachineConfig), key: &'static str, code| {
        let mut config = torque_config();
        change(&mut config);
        assert_eq!(config.check(), Err(ConfigError::NotImplemented { axis: "x".into(), key, code }));
    };
    refused(&|c| c.axes[1].parameters.amplifier.max_effort = None, "max_effort", Code::EFFORT_MISSING);
    refused(&|c| c.axes[1].parameters.amplifier.mode = 1, "ampmode", Code::NO_POWER_STAGE);
    refused(&|c| c.axes[1].parameters.amplifier.mode = 3, "ampmode", Code::NO_POWER_STAGE);
    refused(
        &|c| (c.axes[1].law, c.axes[1].parameters.amplifier.mode) = (Law::Proportional, 2),
        "ampmode",
        Code::NO_DAMPING,
    );
    refused(&|c| c.axes[1].parameters.amplifier.heat_time = 5, "i2tftime", Code::CURRENT_UNKNOWN);
    refused(
        &|c| (c.axes[1].parameters.amplifier.estimator, c.axes[1].parameters.amplifier.acceleration) = (3, 1e15),
        "velocity_loop.acceleration",
        Code::ESTIMATOR_RANGE,
    );
    let mut config = torque_config();
    config.axes[1].drive = Some(Capabilities { torque: false, ..Capabilities::all(0) });
    let expected = ConfigError::NotOffered { axis: "x".into(), interface: Interface::Torque };
    assert_eq!(config.check(), Err(expected));
    assert_eq!(torque_config().check(), Ok(()));
    assert_eq!(MachineConfig { cycle_ns: MS / 8, ..torque_config() }.check(), Ok(()));
}
