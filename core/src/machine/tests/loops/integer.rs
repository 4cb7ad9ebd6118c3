//! Integer PID of the positioning module as the loop of an axis: 12 bits of a 16-bit sum, max_velocity 100000 inc/s at
//! 2048.

use super::super::rig::{Rig, X, at, saia_verb, to};
use super::{lag, velocity_config};
use crate::code::Code;
use crate::command::Action;
use crate::config::{ConfigError, MachineConfig};
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value};
use crate::regulator::Law;
use crate::sim::{Model, Motor};
use crate::vocabulary::saia::{self, Command};

/// KProp, KInt, KDer; IL 32767, SampI 0.
fn integer_config(kprop: i32, kint: i32, kder: i32) -> MachineConfig {
    let mut config = velocity_config(0);
    config.axes[1].law = Law::Integer;
    let p = &mut config.axes[1].parameters.vocabularies.saia;
    (p.kprop, p.kint, p.kder, p.intl, p.sampi) = (kprop, kint, kder, 32_767, 0);
    config
}

fn enabled(model: Model, config: MachineConfig) -> Rig {
    let mut rig = Rig::with(config, [model, Model::Ideal]);
    rig.enable();
    rig
}

/// U = KProp e, whose top 12 bits of 2048 are the velocity: at 50000 inc/s, half of it, the code is 1024 and U 16384;
/// at KProp 16 e is 1024.
///
/// Proves: SAIA-PID-01, SAIA-EXT-06, SAIA-SW-01
#[test]
fn at_constant_speed_the_error_makes_the_velocity() {
    for (kprop, behind) in [(16, 1024), (64, 256)] {
        let mut rig = enabled(lag(2), integer_config(kprop, 0, 0));
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(4_000);
        // A step of the converter is 1/2048, 48.8 inc/s, and 16/kprop inc of error.
        assert!((rig.int("x.regulator.error") - behind).abs() <= 3, "{kprop}: {}", rig.int("x.regulator.error"));
        assert!((rig.real("x.regulator.output") - 0.5).abs() <= 2.0 / 2048.0);
        let code = rig.real("x.regulator.output") * 2048.0;
        assert_eq!(code, code.round(), "whole steps of the converter");
        assert_eq!(rig.int("x.error"), 0);
    }
}

/// The integral part removes the error, with three samples in most cycles of 1 ms.
///
/// Proves: SAIA-PID-01, SAIA-PID-02
#[test]
fn the_integral_part_takes_the_error_away() {
    let mut rig = enabled(Model::Ideal, integer_config(64, 1, 0));
    rig.give(Action::Move(at(X, 20_000.0)));
    rig.run(4_000);
    assert!(rig.int("x.regulator.error").abs() <= 25, "{}", rig.int("x.regulator.error"));
    let goal = rig.give(Action::Move(to(X, 5_000)));
    rig.run(6_000);
    assert_eq!(rig.done(goal).len(), 1);
}

/// Switched off and on again: no output, no history. Commands of the module move the axis with the same loop, and load
/// its registers.
///
/// Proves: SAIA-PID-05, SAIA-PID-06
#[test]
fn the_commands_of_the_module_run_on_its_regulator() {
    let mut rig = enabled(lag(2), integer_config(64, 0, 8));
    rig.plant.drive(0).unwrap().jump(-100);
    rig.run(1);
    assert!(rig.real("x.regulator.output") > 0.0);
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(200);
    assert_eq!((rig.real("x.regulator.output"), rig.real("x.output.velocity")), (0.0, 0.0));
    rig.give(saia_verb(&[Command::Initialise]));
    rig.give(saia_verb(&[Command::Start]));
    rig.run(500);
    assert_eq!((rig.int("x.enabled"), rig.int("x.saia.regulator_off")), (1, 0));
    rig.plant.drive(0).unwrap().jump(-100);
    rig.run(2);
    let code = rig.real("x.regulator.output") * 2048.0;
    assert!(code > 0.0);
    assert_eq!(rig.int("x.saia.output"), code as i64, "what drives it is what is shown");
}

/// While commands of the module run, its regulator is sampled once for each of its samples: held 100 inc away, 20 ms
/// are 58.6 samples of 341 us, in each of which KInt 1 adds 100 to U, and the output is a sixteenth of that.
///
/// Proves: SAIA-PID-02, SAIA-SW-01
#[test]
fn commands_of_the_module_sample_its_regulator_once() {
    let mut rig = enabled(Model::Ideal, integer_config(0, 1, 0));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(200);
    rig.give(saia_verb(&[Command::Initialise]));
    rig.give(saia_verb(&[Command::Start]));
    rig.run(500);
    rig.plant.drive(0).unwrap().jam(true);
    rig.plant.drive(0).unwrap().jump(-100);
    let before = rig.real("x.regulator.output") * 2048.0;
    rig.run(20);
    let code = rig.real("x.regulator.output") * 2048.0 - before;
    assert!((350.0..=380.0).contains(&code), "{code}");
}

#[test]
fn a_register_out_of_range_closes_no_loop() {
    let mut config = integer_config(40_000, 0, 0);
    let expected = ConfigError::NotImplemented { axis: "x".into(), key: "saia.kprop", code: Code::GAIN_RANGE };
    assert_eq!(config.check(), Err(expected));
    config.axes[1].parameters.vocabularies.saia.kprop = 64;
    let mut rig = enabled(Model::Ideal, config);
    let row = Row::find("saia.kder").expect("a row").0;
    let refused = rig.give(Action::SetParameters(Box::new([Change { axis: X, row, value: Value::Int(-1) }])));
    let sentence = rig.refusal(refused);
    assert!(sentence.starts_with("x: saia.kder -1 is beyond the register of the integer PID"), "{sentence}");
}

/// A verb that would write a register out of range writes nothing while the regulator closes the loop, and a verb that
/// only reads does not affect the loop.
#[test]
fn a_verb_neither_breaks_nor_bumps_the_loop() {
    let mut rig = enabled(lag(2), integer_config(64, 1, 64));
    rig.give(Action::Move(at(X, 20_000.0)));
    rig.run(3_000);
    let before = rig.real("x.output.velocity");
    rig.give(saia_verb(&[Command::ReadIntegral]));
    for cycle in 0..200 {
        rig.run(1);
        assert!((rig.real("x.output.velocity") - before).abs() < 3_000.0, "cycle {cycle}");
    }
    let request = saia::Request { axis: X, ..Default::default() }.with(saia::Register::IntL, Value::Int(-5));
    let refused = rig.give(Action::vocabulary(request));
    let sentence = rig.refusal(refused);
    assert!(sentence.starts_with("x: saia.intl -5 is beyond the register"), "{sentence}");
    rig.run(100);
    assert!((rig.real("x.output.velocity") - before).abs() < 3_000.0);
}

/// An axis that is damped only by the derivative part: AMPMODE 2, a torque of up to 2e7 inc/s^2 without friction. An
/// independent model of the law, with whole counts of the encoder and the 12 bits of the converter, is within 2 inc 1.8
/// s after a step of 50 inc, for each of these cycle times. With an error that is constant during a cycle, it
/// oscillates by thousands of inc at 1 ms and 2 ms.
///
/// Proves: SAIA-PID-01, SAIA-PID-02
#[test]
fn the_derivative_part_damps_at_every_cycle_length() {
    for cycle_ns in [341_333, 500_000, 1_000_000, 2_000_000] {
        for sampi in [0, 1] {
            let mut config = super::torque::torque_config();
            config.cycle_ns = cycle_ns;
            config.axes[1].law = Law::Integer;
            let p = &mut config.axes[1].parameters;
            p.amplifier.mode = 2;
            p.max_following_error = 100_000;
            let registers = &mut p.vocabularies.saia;
            (registers.kprop, registers.kder, registers.intl, registers.sampi) = (32, 1_000, 32_767, sampi);
            let motor = Model::Motor(Motor::new(super::torque::motor()).unwrap());
            let mut rig = enabled(motor, config);
            rig.run(100);
            rig.plant.drive(0).unwrap().jump(-50);
            rig.run(1_800_000_000 / cycle_ns);
            for _ in 0..200_000_000 / cycle_ns {
                rig.run(1);
                let error = rig.int("x.regulator.error");
                assert!(error.abs() <= 4, "{cycle_ns} ns, SampI {sampi}: {error} inc");
            }
            assert_eq!(rig.int("x.error"), 0);
        }
    }
}
