//! Loss of control of a loop that is closed in the core: no axis runs away.

use super::super::rig::{Rig, X, at, cases, config, to};
use crate::code::Code;
use crate::command::Action;
use crate::config::MachineConfig;
use crate::drive::{Inputs, Interface};
use crate::regulator::Law;
use crate::sim::{Amplifier, Friction, Load, Model, Motor, MotorData, Reading, Stage, VelocityLag};
use proptest::prelude::*;

const ALLOWED: i64 = 4_000;

fn looped(interface: Interface, law: Law, reaction: i64) -> MachineConfig {
    let mut config = config(0);
    let axis = &mut config.axes[1];
    (axis.interface, axis.law) = (interface, law);
    let p = &mut axis.parameters;
    (p.max_following_error, p.error_reaction) = (ALLOWED, reaction);
    p.amplifier.max_effort = Some(1000.0);
    p.pid.velocity = 1000;
    if interface == Interface::Voltage {
        let damping = p.pid;
        super::voltage::loops(p, 0);
        p.pid = damping;
    }
    config
}

fn motor(inertia: f64, friction: f64) -> MotorData {
    MotorData {
        inertia,
        friction: Friction { viscous: 1e-4, coulomb: friction, holding: friction },
        load: Load { inertia: 2.5e-4, ..Load::default() },
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 62_832.0, noise: 0.0, seed: 1, at_load: false },
    }
}

fn model(interface: Interface, data: MotorData) -> Model {
    match interface {
        Interface::Torque => Model::Motor(Motor::new(data).unwrap()),
        Interface::Voltage => {
            let of_winding = super::voltage::motor();
            let friction = Friction { viscous: 1e-3, ..data.friction };
            let data = MotorData { inertia: data.inertia, friction, ..of_winding };
            Model::Motor(Motor::new(data).unwrap())
        }
        _ => Model::Velocity(VelocityLag::new(5_000_000, 1_000_000).unwrap()),
    }
}

/// Motor and encoder have opposite directions: at the first disturbance the loop drives the axis away. The axis is
/// switched off before it is away by twice the allowed error, and coasts from there.
#[test]
fn a_sense_wired_the_wrong_way_ends_without_power() {
    for interface in [Interface::Velocity, Interface::Torque, Interface::Voltage] {
        for law in Law::ALL {
            let config = looped(interface, law, 2);
            let mut rig = Rig::with(config, [model(interface, motor(2.5e-4, 0.0)).wired(true), Model::Ideal]);
            rig.enable();
            rig.give(Action::Move(to(X, 10_000)));
            let mut furthest = 0;
            for _ in 0..5_000 {
                rig.run(1);
                if rig.int("x.enabled") == 1 {
                    furthest = furthest.max(rig.int("x.following_error").abs());
                }
            }
            let case = format!("{interface:?} {law:?}");
            assert_eq!(rig.int("x.enabled"), 0, "{case}");
            assert!(rig.int("x.error") == i64::from(Code::FOLLOWING_ERROR.0), "{case}");
            assert!(rig.events.iter().any(|event| event.code == Code::RUNAWAY), "{case}");
            assert!(furthest <= 2 * ALLOWED + 600, "{case}: {furthest}");
            assert_eq!((rig.real("x.output.velocity"), rig.real("x.output.effort")), (0.0, 0.0), "{case}");
        }
    }
}

/// Not enough torque for the commanded motion: the loop stops the axis, which is not a runaway.
#[test]
fn an_amplifier_that_saturates_stops_on_its_loop() {
    let mut config = looped(Interface::Torque, Law::Pid, 2);
    // 12.5 per mille of 1 Nm on 5e-4 kg m^2: 2.5e5 inc/s^2, against 5e5 of the goal: 400 inc are missing once both run
    // at 20000 inc/s.
    config.axes[1].parameters.amplifier.max_effort = Some(12.5);
    config.axes[1].parameters.amplifier.proportional = 5_000;
    config.axes[1].parameters.max_following_error = 300;
    let mut rig = Rig::with(config, [model(Interface::Torque, motor(2.5e-4, 0.0)), Model::Ideal]);
    rig.enable();
    rig.give(Action::Move(at(X, 20_000.0)));
    rig.run(5_000);
    assert_eq!((rig.int("x.error"), rig.state("x")), (i64::from(Code::FOLLOWING_ERROR.0), "ERROR_STOP"));
    assert_eq!(rig.int("x.enabled"), 1);
    assert!(rig.int("x.following_error").abs() <= 3, "{}", rig.int("x.following_error"));
    assert!(!rig.events.iter().any(|event| event.code == Code::RUNAWAY));
}

/// The reported current is zero, inverted, or stuck at the maximum: the loop drives the voltage to a limit, and the
/// reported current does not show it. The position loop detects it: the axis stops or loses its power before it is
/// behind by twice the allowed error, plus some coasting.
#[test]
fn wrongly_reported_current_causes_no_runaway() {
    type Tamper = (&'static str, fn(&mut Inputs));
    let tampers: [Tamper; 3] = [
        ("dead", |inputs| inputs.drive[0].effort = 0.0),
        ("reversed", |inputs| inputs.drive[0].effort = -inputs.drive[0].effort),
        ("full", |inputs| inputs.drive[0].effort = 250.0),
    ];
    for (what, tamper) in tampers {
        for mode in 0..4 {
            for when in [0, 300] {
                let mut config = looped(Interface::Voltage, Law::Pid, 2);
                super::voltage::loops(&mut config.axes[1].parameters, mode);
                let mut rig = Rig::with(config, [model(Interface::Voltage, motor(2.5e-4, 0.0)), Model::Ideal]);
                rig.enable();
                rig.give(Action::Move(at(X, 30_000.0)));
                rig.run(when);
                rig.modify_inputs = tamper;
                let case = format!("{what}, mode {mode}, after {when}");
                for _ in 0..3_000 {
                    rig.run(1);
                    let is_on = rig.int("x.enabled") == 1;
                    let error = rig.int("x.following_error").abs();
                    assert!(!is_on || error <= 2 * ALLOWED + 1_000, "{case}: {error} behind");
                    assert!(rig.real("x.output.effort").abs() <= 1000.0, "{case}");
                }
                if matches!(mode, 1 | 3) {
                    assert_eq!((rig.int("x.error"), rig.int("x.enabled")), (0, 1), "{case}: it needs no current");
                }
            }
        }
    }
}

/// A blocked shaft draws the current that ampmaxcur allows, for at most 100 ms, although its voltage is far from its
/// limit.
#[test]
fn a_blocked_axis_draws_its_largest_current_for_a_tenth_of_a_second() {
    for mode in [0, 2] {
        let mut config = looped(Interface::Voltage, Law::Pid, 0);
        let p = &mut config.axes[1].parameters;
        super::voltage::loops(p, mode);
        (p.amplifier.max_current, p.error_reaction, p.following_error_time) = (2_000, 0, 10_000_000_000);
        let mut rig = Rig::with(config, [model(Interface::Voltage, motor(2.5e-4, 0.0)), Model::Ideal]);
        rig.enable();
        rig.plant.drive(0).unwrap().jam(true);
        rig.give(Action::Move(at(X, 50_000.0)));
        let mut at_cap = 0;
        for _ in 0..2_000 {
            rig.run(1);
            at_cap += i32::from(rig.real("x.regulator.current_setpoint").abs() >= 1_900.0);
        }
        // 1.2 Ohm at 2 A are 2.4 of 48 V.
        assert!(rig.events.iter().any(|event| event.code == Code::ENCODER_STANDS), "mode {mode}");
        assert_eq!((rig.int("x.enabled"), rig.real("x.output.effort")), (0, 0.0), "mode {mode}");
        assert!((95..=110).contains(&at_cap), "mode {mode}: {at_cap} ms");
    }
}

/// A current that is always reported as 0: the setpoint is within ampmaxcur, and the voltage increases to its limit.
#[test]
fn a_dead_current_sensor_ends_at_the_largest_voltage() {
    let mut config = looped(Interface::Voltage, Law::Pid, 0);
    let p = &mut config.axes[1].parameters;
    super::voltage::loops(p, 0);
    (p.amplifier.integral, p.error_reaction) = (0, 0);
    let mut rig = Rig::with(config, [model(Interface::Voltage, motor(2.5e-4, 0.0)), Model::Ideal]);
    rig.enable();
    rig.plant.drive(0).unwrap().jam(true);
    rig.modify_inputs = |inputs| inputs.drive[0].effort = 0.0;
    rig.give(Action::Move(to(X, 300)));
    let mut most: f64 = 0.0;
    for _ in 0..3_000 {
        rig.run(1);
        most = most.max(rig.real("x.regulator.current_setpoint").abs());
    }
    assert!(most > 0.0 && most < 5_000.0, "{most} mA of 10 A");
    assert!(rig.events.iter().any(|event| event.code == Code::ENCODER_STANDS));
    assert_eq!((rig.int("x.enabled"), rig.real("x.output.effort")), (0, 0.0));
}

proptest! {
    #![proptest_config(cases(40))]

    /// With any fault of encoder, direction or torque in motion: within 100 ms after the following error exceeds its
    /// limit the axis is switched off, or is in its stop.
    #[test]
    fn no_axis_runs_away(
        interface in prop::sample::select(&[Interface::Velocity, Interface::Torque, Interface::Voltage][..]),
        law in prop::sample::select(&Law::ALL[..]),
        reaction in 0_i64..5,
        inertia in 1e-5..5e-3_f64,
        friction in 0.0..0.1_f64,
        velocity in -90_000.0..90_000.0_f64,
        fault in 0..4_u8,
        when in 100_u64..1_500,
    ) {
        let inverted = fault == 0;
        let config = looped(interface, law, reaction);
        let mut rig = Rig::with(config, [model(interface, motor(inertia, friction)).wired(inverted), Model::Ideal]);
        rig.enable();
        rig.give(Action::Move(at(X, velocity)));
        rig.run(when);
        match fault {
            1 => rig.plant.drive(0).unwrap().jam(true),
            // The reported current is zero.
            3 => rig.modify_inputs = |inputs| inputs.drive[0].effort = 0.0,
            2 => rig.plant.drive(0).unwrap().jump(if velocity > 0.0 { -9_000 } else { 9_000 }),
            _ => {}
        }
        let mut since = None;
        for cycle in 0..3_000_u64 {
            rig.run(1);
            let error = rig.int("x.following_error").abs();
            let is_on = rig.int("x.enabled") == 1 || rig.state("x") == "ERROR_STOP" && rig.real("x.output.effort") != 0.0;
            // A jump of the encoder shifts the start of a stop.
            let most = if fault == 2 { 9_000 + 2 * ALLOWED } else { 2 * ALLOWED };
            prop_assert!(!is_on || error <= most + 1_000, "cycle {}: {} behind", cycle, error);
            let begun = *since.get_or_insert(cycle);
            if !(is_on && error > ALLOWED) {
                since = None;
            } else {
                // A stop from 90000 inc/s takes 90 ms of ramp and 50 ms of waiting time.
                prop_assert!(cycle - begun <= 400, "cycle {}: {} behind for {} ms", cycle, error, cycle - begun);
            }
        }
    }
}
