//! Interface voltage: all loops in the core, with a power stage and the winding of a motor.

use super::super::rig::{Rig, X, at, config, to};
use super::MS;
use crate::code::Code;
use crate::command::{Action, Level, OutAn};
use crate::config::{ConfigError, MachineConfig};
use crate::drive::{Capabilities, Interface};
use crate::parameter::{AxisParameters, Value};
use crate::regulator::Law;
use crate::sim::{Amplifier, Friction, Load, Model, Motor, MotorData, Reading, Stage};

/// 48 V at 1.2 Ohm are 40 A, so 25 per mille of the torque at rest for each ampere; with 0.4 V s/rad it turns at 120
/// rad/s, which with 1000 inc per rad is 120,000 inc/s. 0.4 Nm/A on 5e-4 kg m^2.
pub(super) fn motor() -> MotorData {
    MotorData {
        inertia: 2.5e-4,
        friction: Friction { viscous: 1e-3, ..Friction::default() },
        load: Load { inertia: 2.5e-4, ..Load::default() },
        coupling: None,
        amplifier: Amplifier {
            stage: Stage::Winding {
                voltage: 48.0,
                resistance: 1.2,
                inductance: 3e-3,
                torque_constant: 0.4,
                back_emf: 0.4,
            },
            limit: 1.0,
            dead_time_ns: 0,
        },
        reading: Reading { counts_per_turn: 1000.0 * std::f64::consts::TAU, noise: 0.0, seed: 1, at_load: false },
    }
}

/// Gains of the current loop for Beta 0.3, Ts 1 ms, U 48 V and kc 3276.8 (10 A): w = 471.24 rad/s, CURKPROP = (2 w L -
/// R) / (U kc ku) = 1.6274 / 1.171875e-3, CURKINT = w^2 L Ts / 4 / (U kc ku) = 0.16655 / 1.171875e-3.
pub(super) fn loops(p: &mut AxisParameters, mode: i64) {
    p.amplifier.max_effort = Some(1000.0);
    (p.amplifier.torque_constant, p.amplifier.max_current, p.amplifier.mode) = (25.0, 10_000, mode);
    p.power_stage.full_current = Some(10.0);
    (p.power_stage.proportional, p.power_stage.integral, p.power_stage.limit) = (1_389, 142, 10_000);
    p.pid.velocity = if mode == 2 { 0 } else { 1000 };
    if mode == 2 {
        // 1 A at 200 inc, and at 10 inc of change per cycle.
        (p.pid.proportional, p.pid.derivative, p.pid.integral, p.pid.limit) = (30, 600, 1, 2_000);
    }
    if mode == 3 {
        // 120 rad/s at the full voltage.
        p.pid.velocity = 833;
        p.pid.integral = 1;
    }
}

fn voltage_config(law: Law, mode: i64) -> MachineConfig {
    let mut config = config(0);
    let axis = &mut config.axes[1];
    (axis.interface, axis.law) = (Interface::Voltage, law);
    axis.parameters.max_following_error = 5_000;
    loops(&mut axis.parameters, mode);
    config
}

fn rig(config: MachineConfig, data: MotorData) -> Rig {
    let mut rig = Rig::with(config, [Model::Motor(Motor::new(data).unwrap()), Model::Ideal]);
    rig.enable();
    rig
}

fn near(actual: f64, expected: f64, within: f64, what: &str) {
    assert!((actual - expected).abs() <= within, "{what}: {actual}, not {expected} within {within}");
}

/// At 50,000 inc/s, 50 rad/s, 1e-3 Nm s/rad take 0.05 Nm, 125 mA, and 0.4 * 50 + 1.2 * 0.125 = 20.15 V, 419.8 per
/// mille, in each of the four structures; a move ends at its target in each.
///
/// Proves: MACS-AMP-01, MACS-AMP-03
#[test]
fn each_of_the_four_structures_moves_the_axis() {
    for mode in 0..4 {
        let mut rig = rig(voltage_config(Law::Pid, mode), motor());
        assert_eq!(rig.int("x.mode_of_operation"), -1);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(3_000);
        let what = format!("mode {mode}");
        near(rig.real("x.output.effort"), 419.8, 10.0, &what);
        near(rig.real("x.regulator.effort"), 0.4198, 0.01, &what);
        near(rig.real("x.regulator.current"), 125.0, 100.0, &what);
        let setpoint = rig.real("x.regulator.current_setpoint");
        if matches!(mode, 0 | 2) {
            near(setpoint, 125.0, 150.0, &what);
        } else {
            assert_eq!(setpoint, 0.0, "{what}");
        }
        // Setpoint of the loop above the voltage: a velocity, a current of 1/80 of 10 A, or the voltage itself.
        let above = match mode {
            0 | 1 => 0.5,
            2 => 0.0125,
            _ => 0.4198,
        };
        near(rig.real("x.regulator.output"), above, 0.02, &what);
        let goal = rig.give(Action::Move(to(X, 20_000)));
        rig.run(6_000);
        assert_eq!((rig.state("x"), rig.done(goal).len()), ("STANDSTILL", 1), "{what}");
        near(rig.int("x.actual.position") as f64, 20_000.0, 3.0, &what);
    }
}

/// Mode 3 with only a proportional loop: the back EMF damps it. 41,980 inc/s of output at 16.667 1/s are 2519 inc
/// behind.
///
/// Proves: MACS-AMP-03
#[test]
fn a_proportional_loop_above_the_voltage_is_damped_by_the_back_emf() {
    let mut rig = rig(voltage_config(Law::Proportional, 3), motor());
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(2_000);
    near(rig.int("x.regulator.error") as f64, 41_980.0 * 60.0 / 1000.0, 2.0, "behind");
    rig.give(Action::Move(to(X, 0)));
    rig.run(4_000);
    assert_eq!(rig.state("x"), "STANDSTILL");
}

/// A blocked shaft: L i' = u - R i only. Discretised exactly, i' = a i + (1 - a) u / R with a = e^-0.4, the loop is
/// this recursion by its control law, and the axis is compared with it cycle by cycle: 2 A are commanded, and 2 A flow.
///
/// Proves: MACS-AMP-07, MACS-AMP-02
#[test]
fn a_step_of_the_current_is_the_computed_one() {
    let mut config = voltage_config(Law::Pid, 2);
    config.axes[1].parameters.error_reaction = 5;
    let mut rig = rig(config, motor());
    rig.plant.drive(0).unwrap().jam(true);
    let (decay, unit) = (libm::exp(-0.4), 48.0 * 3_276.8 / 134_217_728.0);
    let (proportional, integral) = (unit * 1_389.0, unit * 4.0 * 142.0);
    let (mut current, mut sum) = (0.0, 0.0);
    // At its target the output of the pid is 0.
    rig.give(Action::OutAn(OutAn { axis: X, value: 0.2, level: Level::Setpoint }));
    for cycle in 0..200 {
        let error = 2.0 - current;
        sum += error;
        let voltage: f64 = proportional * error + integral * sum;
        near(rig.real("x.actual.effort"), 25.0 * current, 1e-6, &format!("current of cycle {cycle}"));
        near(rig.real("x.output.effort"), voltage / 48.0 * 1000.0, 1e-6, &format!("voltage of cycle {cycle}"));
        assert_eq!(rig.real("x.regulator.current_setpoint"), 2_000.0);
        current = decay * current + (1.0 - decay) * voltage / 1.2;
        rig.run(1);
    }
    near(current, 2.0, 1e-9, "in the end");
    near(rig.real("x.regulator.current"), 2_000.0, 1e-3, "in the end");
}

/// AMPMAXCUR 1 A: with a current loop the commanded current never exceeds it, nor does the actual current, except for
/// its overshoot; without a current loop the start of the same move draws more.
///
/// Proves: MACS-AMP-08
#[test]
fn the_current_is_capped_where_there_is_a_current_loop() {
    for mode in 0..4 {
        let mut config = voltage_config(Law::Pid, mode);
        config.axes[1].parameters.amplifier.max_current = 1_000;
        // A goal without rates uses half of it: 2000 rad/s^2 are 1 Nm, 2.5 A.
        config.axes[1].parameters.max_acceleration = 4_000_000.0;
        config.axes[1].parameters.max_following_error = 60_000;
        let mut rig = rig(config, motor());
        rig.give(Action::Move(to(X, 50_000)));
        let (mut asked, mut flowing) = (0.0_f64, 0.0_f64);
        for _ in 0..2_000 {
            rig.run(1);
            asked = asked.max(rig.real("x.regulator.current_setpoint").abs());
            flowing = flowing.max(rig.real("x.regulator.current").abs());
        }
        if matches!(mode, 0 | 2) {
            assert_eq!(asked, 1_000.0, "mode {mode}");
            // The current lags while the back EMF rises: 800 rad/s^2 are 320 V/s, against 666 V/(A s) of the integral
            // part.
            assert!((500.0..1_100.0).contains(&flowing), "mode {mode}: {flowing} mA");
        } else {
            assert!(flowing > 1_400.0, "mode {mode}: {flowing} mA");
        }
    }
}

/// OUTAN gives the setpoint of the loop below the position loop: half of max_velocity, 5 A of a blocked shaft, half of
/// the voltage; level effort is the voltage in each case.
///
/// Proves: MACS-AMP-02
#[test]
fn outan_is_the_setpoint_of_the_loop_below_the_position_loop() {
    for mode in 0..4 {
        let open = |value, level, held| {
            let mut config = voltage_config(Law::Pid, mode);
            config.axes[1].parameters.error_reaction = 5;
            let mut rig = rig(config, motor());
            rig.plant.drive(0).unwrap().jam(held);
            rig.give(Action::OutAn(OutAn { axis: X, value, level }));
            rig.run(400);
            rig
        };
        let what = format!("mode {mode}");
        match mode {
            0 | 1 => near(open(0.5, Level::Setpoint, false).real("x.actual.velocity"), 50_000.0, 2_000.0, &what),
            2 => near(open(0.5, Level::Setpoint, true).real("x.regulator.current"), 5_000.0, 5.0, &what),
            _ => near(open(0.5, Level::Setpoint, false).real("x.output.effort"), 500.0, 0.0, &what),
        }
        let direct = open(0.25, Level::Effort, false);
        assert_eq!(
            (direct.real("x.output.effort"), direct.real("x.regulator.current_setpoint")),
            (250.0, 0.0),
            "{what}"
        );
        // 12 V are 30 rad/s, less 1e-3 Nm s/rad: i = 1e-3 w / 0.4, 12 = 1.2 i + 0.4 w.
        near(direct.real("x.actual.velocity"), 12_000.0 / 0.403, 1_000.0, &what);
    }
}

/// Gains of the current loop apply at once and without a bump: in their cycle the voltage equals that of a machine
/// without the change, and it differs from the next cycle.
///
/// Proves: MACS-AMP-07
#[test]
fn gains_of_the_current_loop_change_without_a_bump() {
    for (key, value) in [("curkprop", 3_000), ("curkint", 300), ("curkilim", 1), ("curkilim", 0)] {
        let run = |change: bool| {
            let mut rig = rig(voltage_config(Law::Pid, 0), motor());
            rig.give(Action::Move(to(X, 30_000)));
            rig.run(31);
            if change {
                rig.set(key, Value::Int(value));
            } else {
                rig.run(1);
            }
            let voltages = (0..40).map(|_| {
                let voltage = rig.real("x.output.effort");
                rig.run(1);
                voltage
            });
            voltages.collect::<Vec<_>>()
        };
        let (plain, changed) = (run(false), run(true));
        near(changed[0], plain[0], 1e-9, key);
        assert_ne!(changed, plain, "{key}");
    }
}

#[test]
fn a_restored_machine_goes_on_with_all_loops() {
    for mode in 0..4 {
        let mut config = voltage_config(Law::Pid, mode);
        let p = &mut config.axes[1].parameters.amplifier;
        (p.heat_time, p.heat_limit) = (500, 1_000_000);
        let mut rig = rig(config, motor());
        rig.give(Action::Move(to(X, 30_000)));
        rig.run(151);
        rig.set("curkprop", Value::Int(1_000));
        rig.run(3);
        rig.mirror();
        rig.run(2_000);
        assert_eq!(rig.int("x.error"), 0, "mode {mode}");
    }
}

/// Without torque_constant no current is monitored, and the axis may skip cycles between its samples: `Rig` compares it
/// with a machine that never skips.
#[test]
fn without_a_current_loop_no_current_need_be_known() {
    for mode in [1, 3] {
        let mut config = voltage_config(Law::Pid, mode);
        let p = &mut config.axes[1].parameters;
        (p.amplifier.torque_constant, p.amplifier.max_current, p.power_stage.full_current) = (0.0, 2_000, None);
        let mut rig = rig(config, motor());
        rig.give(Action::Move(to(X, 30_000)));
        rig.run(3_000);
        assert_eq!((rig.state("x"), rig.int("x.error")), ("STANDSTILL", 0), "mode {mode}");
        assert_eq!(rig.real("x.regulator.current"), 0.0);
    }
}

/// Switched off there is no voltage and no setpoint; switched on again the loop has no history.
#[test]
fn off_there_is_no_voltage() {
    let mut data = motor();
    data.load.torque = -0.2;
    let mut rig = rig(voltage_config(Law::Pid, 0), data);
    rig.run(2_000);
    // 0.2 Nm are 0.5 A, 0.6 V, 12.5 per mille.
    near(rig.real("x.output.effort"), 12.5, 0.5, "held");
    near(rig.real("x.regulator.current_setpoint"), 500.0, 20.0, "held");
    rig.give(Action::Disable(crate::object::AxisSet::one(X)));
    rig.run(500);
    let shown = ["x.output.effort", "x.regulator.effort", "x.regulator.current_setpoint"].map(|name| rig.real(name));
    assert_eq!((rig.state("x"), shown), ("DISABLED", [0.0; 3]));
}

/// 2 A of a weight are 4000 of A^2/1000, which exceeds a limit of 3900.
///
/// Proves: MACS-I2T-03
#[test]
fn motor_i2t_is_supervised() {
    let mut config = voltage_config(Law::Pid, 0);
    let p = &mut config.axes[1].parameters;
    p.error_reaction = 0;
    (p.amplifier.heat_time, p.amplifier.heat_limit) = (100, 3_900);
    let mut data = motor();
    data.load.torque = -0.8;
    let mut rig = rig(config, data);
    rig.run(3_000);
    assert_eq!((rig.int("x.error"), rig.state("x"), rig.real("x.output.effort")), (99, "ERROR_STOP", 0.0));
}

/// AMPCOMMTYPE 0 (no commutation) and 1 (brushes) are motors with one voltage; the others need Hall sensors, phases or
/// a second output. The mode and the motor can only be changed while the axis is off.
///
/// Proves: MACS-AMP-09
#[test]
fn a_motor_that_would_be_commutated_is_refused() {
    for kind in 0..=6 {
        let mut config = voltage_config(Law::Pid, 0);
        config.axes[1].parameters.power_stage.commutation = kind;
        let wrong = ConfigError::NotImplemented { axis: "x".into(), key: "ampcommtype", code: Code::COMMUTATION };
        assert_eq!(config.check(), if kind < 2 { Ok(()) } else { Err(wrong) }, "{kind}");
    }
    let mut rig = Rig::with(voltage_config(Law::Pid, 0), [Model::Motor(Motor::new(motor()).unwrap()), Model::Ideal]);
    for kind in 2..=6 {
        let refused = rig.set("ampcommtype", Value::Int(kind));
        assert_eq!(
            rig.refusal(refused),
            format!(
                "x: ampcommtype {kind} asks for a motor that is commutated here: there are no inputs for halls, no phases of a stepper and \
                 no second output; 0 and 1 (brushes) are allowed"
            )
        );
    }
    let refused = rig.set("ampcommtype", Value::Int(7));
    assert!(rig.refusal(refused).contains("0 to 6"), "the range of the source");
    let taken = rig.set("ampcommtype", Value::Int(1));
    assert!(rig.answer(taken).is_ok());
    rig.enable();
    for (key, value) in [("ampcommtype", 0), ("ampmode", 1)] {
        let refused = rig.set(key, Value::Int(value));
        assert_eq!(rig.refusal(refused), format!("x: {key} becomes {value} only while x is disabled"));
    }
}

/// AMPPWMFREQ: 10000 to 50000 Hz by the table. The simulated stage has no setting, so only 24000 is accepted; other
/// multiples of 8000 are refused with their own reason, and so are all other values.
///
/// Proves: MACS-AMP-10
#[test]
fn another_frequency_of_the_power_stage_is_refused() {
    let mut rig = rig(voltage_config(Law::Pid, 0), motor());
    let taken = rig.set("amppwmfreq", Value::Int(24_000));
    assert!(rig.answer(taken).is_ok());
    for hertz in [10_000, 16_000, 23_999, 32_000, 40_000, 48_000, 50_000] {
        let refused = rig.set("amppwmfreq", Value::Int(hertz));
        let missing = "a power stage whose frequency is set here does not exist yet; only 24000 is allowed";
        assert_eq!(rig.refusal(refused), format!("x: amppwmfreq is {hertz}: {missing}"));
    }
    for hertz in [9_999, 50_001] {
        let refused = rig.set("amppwmfreq", Value::Int(hertz));
        let sentence = rig.refusal(refused);
        assert!(sentence.contains("10000 to 50000"), "{sentence}");
    }
}

#[test]
fn what_the_loops_cannot_do_is_refused_by_its_name() {
    let refused = |change: &dyn Fn(&mut MachineConfig), key: &'static str, code| {
        let mut config = voltage_config(Law::Pid, 0);
        change(&mut config);
        assert_eq!(config.check(), Err(ConfigError::NotImplemented { axis: "x".into(), key, code }));
    };
    refused(&|c| c.axes[1].parameters.amplifier.max_effort = None, "max_effort", Code::EFFORT_MISSING);
    for mode in [0, 2] {
        let with = |c: &mut MachineConfig| loops(&mut c.axes[1].parameters, mode);
        refused(
            &|c| {
                with(c);
                c.axes[1].parameters.power_stage.full_current = None;
            },
            "full_current",
            Code::CURRENT_LOOP,
        );
        refused(
            &|c| {
                with(c);
                c.axes[1].parameters.amplifier.torque_constant = 0.0;
            },
            "torque_constant",
            Code::CURRENT_LOOP,
        );
    }
    let damping = |law, mode| {
        let mut config = voltage_config(law, mode);
        config.axes[1].parameters.pid.derivative = 0;
        config.check().is_ok()
    };
    assert_eq!(
        Law::ALL.map(|law| (0..4).map(|mode| damping(law, mode)).collect::<Vec<_>>()),
        [[true, true, false, true], [true, true, false, true], [true, true, false, true]]
    );
    refused(&|c| c.axes[1].parameters.encoder.encodertype = 9, "encodertype", Code::SIMULATED_EFFORT);
    let mut config = voltage_config(Law::Pid, 0);
    config.axes[1].drive = Some(Capabilities { voltage: false, ..Capabilities::all(0) });
    let expected = ConfigError::NotOffered { axis: "x".into(), interface: Interface::Voltage };
    assert_eq!(config.check(), Err(expected));
    assert_eq!(MachineConfig { cycle_ns: MS / 8, ..voltage_config(Law::Pid, 0) }.check(), Ok(()));
}
