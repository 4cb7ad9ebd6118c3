//! A drive with a voltage reference: reference by an ao, enable by a do, ready by a di, position by an entry of
//! encoders.

use super::super::rig::{Rig, X, at, config, to};
use super::MS;
use crate::axis::{BrakeConfig, Wired};
use crate::code::Code;
use crate::command::{Action, Level, OutAn, OutputValue};
use crate::config::{AnalogProblem, ConfigError, IoConfig, IoKind, MachineConfig, VirtualInput};
use crate::drive::{AnalogWiring, Capabilities, Interface};
use crate::machine::Machine;
use crate::object::AxisSet;
use crate::parameter::Value;
use crate::regulator::Law;
use crate::sim::{
    Amplifier, Friction, Load, Mechanics, Model, Motor, MotorData, Reading, SignOutputs, SimBrake, Stage, VelocityLag,
};

/// x runs at 200 mm/s with 10 V: its drive takes 30 ms to be enabled.
fn analog_config(interface: Interface) -> MachineConfig {
    let entry = |name: &str, kind| IoConfig { name: name.into(), kind, latch: false };
    let mut config = config(0);
    config.encoders[0].form = crate::encoder::Form::Incremental(32);
    config.io = vec![
        entry("spare", IoKind::DigitalInput),
        entry("ready", IoKind::DigitalInput),
        entry("other", IoKind::AnalogOutput),
        entry("reference", IoKind::AnalogOutput),
        entry("lamp", IoKind::DigitalOutput),
        entry("direction", IoKind::DigitalOutput),
        entry("enable", IoKind::DigitalOutput),
    ];
    let axis = &mut config.axes[1];
    let full = if interface == Interface::Torque { 1000.0 } else { 200_000.0 };
    (axis.interface, axis.wired) = (interface, Wired::Encoder(0));
    axis.analog = Some(AnalogWiring { reference: 3, enable: 6, ready: Some(1), full, enable_ns: 30_000_000 });
    let p = &mut axis.parameters;
    p.max_following_error = 8_000;
    if interface == Interface::Torque {
        (p.amplifier.max_effort, p.amplifier.proportional, p.amplifier.integral) = (Some(1000.0), 60, 1);
        (p.amplifier.limit, p.position_loop.kv) = (5_000, 10.0);
    }
    config
}

fn lag() -> Model {
    Model::Velocity(VelocityLag::new(5_000_000, MS).unwrap())
}

/// 1 Nm on 5e-4 kg m^2, 10000 inc per rad.
fn motor() -> Model {
    let data = MotorData {
        inertia: 2.5e-4,
        friction: Friction { viscous: 1e-4, coulomb: 0.005, holding: 0.005 },
        load: Load { inertia: 2.5e-4, ..Load::default() },
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 1.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 62_832.0, noise: 0.0, seed: 1, at_load: false },
    };
    Model::Motor(Motor::new(data).unwrap())
}

fn rig(config: MachineConfig, model: Model) -> Rig {
    Rig::with(config, [model, Model::Ideal])
}

fn on(interface: Interface) -> Rig {
    let mut rig = rig(analog_config(interface), if interface == Interface::Torque { motor() } else { lag() });
    rig.give(Action::Enable(AxisSet::first(3)));
    rig.run(60);
    assert_eq!(rig.state("x"), "STANDSTILL");
    rig
}

/// 50 of 200 mm/s are 2.5 V, with any control law, from its feed-forward or its error, and a move ends at its target.
///
/// Proves: WF-CLC-04, MACS-CAN-01
#[test]
fn a_quarter_of_what_10_v_are_is_2_5_v() {
    for law in [Law::Proportional, Law::Pid] {
        let mut config = analog_config(Interface::Velocity);
        let axis = &mut config.axes[1];
        // FFVEL: 1000 VELMAX / (speed at 10 V) gives the command velocity; here the output is a velocity.
        (axis.law, axis.parameters.pid.velocity) = (law, 1000);
        let mut rig = rig(config, lag());
        rig.enable();
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(1_000);
        let volts = rig.real("reference");
        assert!((volts - 2.5).abs() < 0.01, "{volts}");
        assert_eq!(volts, rig.outputs().analog[1]);
        assert_eq!((rig.real("other"), rig.int("lamp")), (0.0, 0));
        let goal = rig.give(Action::Move(to(X, -20_000)));
        let lowest = (0..2_000).map(|_| {
            rig.run(1);
            rig.real("reference")
        });
        let lowest = lowest.fold(0.0, f64::min);
        assert!((-2.7..=-2.4).contains(&lowest), "half of max_velocity back: {lowest}");
        rig.run(1_000);
        assert_eq!((rig.state("x"), rig.done(goal).len()), ("STANDSTILL", 1), "{law:?}");
        let place = rig.int("x.actual.position");
        assert!((place + 20_000).abs() <= 2, "{place}");
    }
}

/// Shutdown in the cycle of the command, switched on in the next; the third sets its enable, and 30 ms later it is on.
/// If it is off, neither is set.
#[test]
fn analog_drive_is_enabled_by_output_after_its_delay() {
    let mut rig = rig(analog_config(Interface::Velocity), lag());
    rig.run(3);
    assert_eq!((rig.int("enable"), rig.real("reference"), rig.state("x")), (0, 0.0, "DISABLED"));
    rig.give(Action::Enable(AxisSet::one(X)));
    let until_enable = rig.run_until("enable", 1);
    assert_eq!(until_enable, 2);
    rig.run(30);
    assert_eq!(rig.state("x"), "DISABLED");
    rig.run(1);
    assert_eq!((rig.state("x"), rig.int("x.mode_of_operation")), ("STANDSTILL", 9));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(3);
    assert_eq!((rig.int("enable"), rig.real("reference"), rig.state("x")), (0, 0.0, "DISABLED"));
}

/// Its contact opens in motion: in the same cycle both reference and enable are removed. The simulated drive is ready
/// again without its enable; after a reset it can be enabled again.
#[test]
fn not_ready_takes_reference_and_enable_in_the_same_cycle() {
    let mut rig = on(Interface::Velocity);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(300);
    rig.modify_inputs = |inputs| inputs.set_digital(1, false);
    rig.run(1);
    assert_eq!(rig.int("x.error"), i64::from(Code::drive_fault(0x1000).0));
    assert_eq!((rig.real("reference"), rig.int("enable"), rig.state("x")), (0.0, 0, "ERROR_STOP"));
    // The reset waits for 5 s.
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(5_100);
    assert_eq!((rig.state("x"), rig.int("enable")), ("ERROR_STOP", 0));
    rig.modify_inputs = |_| {};
    rig.run(300);
    assert_eq!(rig.state("x"), "ERROR_STOP");
    rig.give(Action::ResetErrors(AxisSet::one(X)));
    rig.run(10);
    assert_eq!(rig.state("x"), "DISABLED");
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(60);
    assert_eq!(rig.state("x"), "STANDSTILL");
}

/// A fault of the simulated drive is visible only at its contact, whether it is on or off.
#[test]
fn a_fault_of_the_amplifier_opens_its_contact() {
    for is_on in [true, false] {
        let mut rig = on(Interface::Velocity);
        if !is_on {
            rig.give(Action::Disable(AxisSet::one(X)));
            rig.run(10);
        }
        assert_eq!(rig.int("ready"), 1);
        rig.plant.drive(0).unwrap().inject_fault(0x2310);
        rig.run(1);
        assert_eq!((rig.int("ready"), rig.int("enable")), (0, 0));
        rig.run(5);
        assert_eq!(rig.int("ready"), 1);
        if is_on {
            assert_eq!(rig.int("x.error"), i64::from(Code::drive_fault(0x1000).0));
            rig.give(Action::ResetErrors(AxisSet::one(X)));
            rig.run(10);
        }
        rig.give(Action::Enable(AxisSet::one(X)));
        rig.run(60);
        // If the axis is off, the fault has to be reset first, too.
        assert_eq!(rig.state("x"), if is_on { "STANDSTILL" } else { "ERROR_STOP" });
    }
}

/// The supply of the amplifier is missing, and no fault code is reported.
#[test]
fn an_amplifier_without_supply_is_not_ready_and_does_not_move() {
    let mut rig = on(Interface::Velocity);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(300);
    rig.plant.drive(0).unwrap().disconnect();
    rig.run(1);
    assert_eq!((rig.int("ready"), rig.int("enable"), rig.state("x")), (0, 0, "ERROR_STOP"));
    rig.run(50);
    let place = rig.int("x.actual.position");
    rig.run(200);
    assert_eq!(rig.int("x.actual.position"), place);
}

/// A broken wire, and two amplifiers in one chain of contacts.
#[test]
fn a_contact_that_is_stuck_or_shared_is_open() {
    let mut rig = on(Interface::Velocity);
    rig.plant.set_digital(1, false);
    rig.run(1);
    assert_eq!((rig.int("ready"), rig.int("enable"), rig.state("x")), (0, 0, "ERROR_STOP"));
    rig.run(100);
    assert_eq!(rig.int("ready"), 0);
    let mut config = analog_config(Interface::Velocity);
    config.io.push(IoConfig { name: "y_reference".into(), kind: IoKind::AnalogOutput, latch: false });
    config.io.push(IoConfig { name: "y_enable".into(), kind: IoKind::DigitalOutput, latch: false });
    let wiring = config.axes[1].analog.unwrap();
    config.axes[2].analog = Some(AnalogWiring { reference: 7, enable: 8, ..wiring });
    (config.axes[2].interface, config.axes[2].wired) = (Interface::Velocity, Wired::Encoder(0));
    for faulty in [0, 1] {
        let mut rig = Rig::with(config.clone(), [lag(), lag()]);
        rig.give(Action::Enable(AxisSet::first(3)));
        rig.run(60);
        assert_eq!((rig.int("ready"), rig.int("enable"), rig.int("y_enable")), (1, 1, 1));
        rig.plant.drive(faulty).unwrap().inject_fault(0x2310);
        rig.run(1);
        assert_eq!((rig.int("ready"), rig.int("enable"), rig.int("y_enable")), (0, 0, 0), "{faulty}");
    }
}

/// A weight on a torque-controlled drive whose contact opens: the brake closes in that cycle, and the weight falls only
/// while the brake closes.
#[test]
fn a_hanging_load_is_caught_by_its_brake() {
    let mut config = analog_config(Interface::Torque);
    config.io.push(IoConfig { name: "brake".into(), kind: IoKind::DigitalOutput, latch: false });
    config.axes[1].brake =
        Some(BrakeConfig { output: 7, closes_with_one: false, release_ns: 20_000_000, engage_ns: 20_000_000 });
    let mut rig = rig(config, motor());
    let brake = SimBrake { output: 3, closes_with_one: false, opens_ns: 10_000_000, closes_ns: 10_000_000 };
    // 1 rad/s^2 per 10000.
    rig.plant.attach_mechanics(0, &Mechanics { load: -200_000.0, brake: Some(brake), ..Mechanics::default() });
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(500);
    assert_eq!((rig.state("x"), rig.int("brake")), ("STANDSTILL", 1));
    assert!(rig.real("reference") > 0.05, "it holds the weight: {}", rig.real("reference"));
    let place = rig.int("x.actual.position");
    rig.plant.drive(0).unwrap().inject_fault(0x2310);
    rig.run(1);
    assert_eq!((rig.int("brake"), rig.int("enable"), rig.real("reference")), (0, 0, 0.0));
    rig.run(1_000);
    // 20 rad/s^2 for the 10 ms of the brake are 1 mrad, 10 inc.
    let fallen = place - rig.int("x.actual.position");
    assert!((0..=20).contains(&fallen), "{fallen}");
}

/// Each stop of the operator ends at 0 V, and a disabled axis has no enable.
#[test]
fn stops_of_the_operator_end_at_0_v() {
    for stop in [Action::Halt, Action::QuickStop, Action::Disable] {
        let mut rig = on(Interface::Velocity);
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(400);
        let disables = matches!(stop(AxisSet::one(X)), Action::Disable(_));
        rig.give(stop(AxisSet::one(X)));
        rig.run(1_500);
        assert!(rig.real("reference").abs() < 0.01);
        assert_eq!(rig.int("enable"), i64::from(!disables));
        let place = rig.int("x.actual.position");
        rig.run(100);
        assert_eq!(rig.int("x.actual.position"), place);
    }
}

/// Error reaction 4: the drive stops by itself, with 0 V and its enable, which is removed once it is at rest: 0 V do
/// not hold the axis at standstill.
#[test]
fn a_drive_that_stops_by_itself_brakes_at_0_v() {
    let mut config = analog_config(Interface::Velocity);
    let p = &mut config.axes[1].parameters;
    // 50 mm/s are 3 mm behind.
    (p.error_reaction, p.max_following_error) = (4, 2_000);
    let mut rig = rig(config, lag());
    rig.enable();
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run_until("x.error", i64::from(Code::FOLLOWING_ERROR.0));
    assert_eq!((rig.real("reference"), rig.int("enable")), (0.0, 1));
    let place = rig.int("x.actual.position");
    rig.run(200);
    assert_eq!((rig.real("reference"), rig.int("enable")), (0.0, 0), "an amplifier creeps at 0 V");
    // 33 mm/s of the 5 ms of its lag.
    assert!((rig.int("x.actual.position") - place).abs() < 300);
}

/// The output of O_BRAKE closes when the power is removed.
#[test]
fn the_output_of_a_brake_closes_where_the_power_goes_behind_a_stop_of_the_drive() {
    let mut config = analog_config(Interface::Velocity);
    let p = &mut config.axes[1].parameters;
    (p.error_reaction, p.max_following_error, p.outputs.brake) = (4, 2_000, 2);
    let mut rig = rig(config, lag());
    rig.enable();
    assert_eq!(rig.int("direction"), 0, "output 2 is the brake, and open");
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run_until("x.error", i64::from(Code::FOLLOWING_ERROR.0));
    rig.run_until("enable", 0);
    assert_eq!(rig.int("direction"), 1);
}

/// Motor and encoder have opposite directions, or the encoder is dead: the axis is switched off before it is far away.
#[test]
fn reversed_wiring_or_dead_encoder_removes_enable() {
    for interface in [Interface::Velocity, Interface::Torque] {
        for factor in [-1, 0] {
            let mut rig = on(interface);
            rig.plant.count_encoder_by(0, factor);
            rig.give(Action::Move(to(X, 30_000)));
            rig.run(3_000);
            assert_ne!(rig.int("x.error"), 0, "{interface:?} {factor}");
            assert_eq!((rig.real("reference"), rig.int("enable")), (0.0, 0), "{interface:?} {factor}");
        }
    }
}

/// The line of its encoder is cut in motion.
#[test]
fn a_lost_encoder_takes_its_enable() {
    let mut rig = on(Interface::Velocity);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(300);
    rig.modify_inputs = |inputs| inputs.encoder[0].valid = false;
    rig.run(2_000);
    assert_ne!(rig.int("x.error"), 0);
    assert_eq!((rig.real("reference"), rig.int("enable")), (0.0, 0));
}

/// 10 V are 1000 per mille of the torque: the commanded effort divided by 100.
#[test]
fn a_torque_is_parts_of_full_effort() {
    let mut config = analog_config(Interface::Torque);
    config.axes[1].parameters.amplifier.max_effort = Some(500.0);
    let mut rig = rig(config, motor());
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(60);
    rig.give(Action::Move(to(X, 50_000)));
    let mut most: f64 = 0.0;
    for _ in 0..200 {
        rig.run(1);
        assert_eq!(rig.real("reference"), 10.0 * rig.real("x.output.effort") / 1000.0);
        most = most.max(rig.real("reference"));
    }
    // Half of max_acceleration is 50 rad/s^2: 0.025 Nm, plus 0.005 of friction, of 1 Nm at 10 V.
    assert!((0.2..=0.4).contains(&most), "{most}");
    rig.run(3_000);
    assert_eq!(rig.state("x"), "STANDSTILL");
    assert!((rig.int("x.actual.position") - 50_000).abs() <= 3);
}

/// REVERS 20: the second output shows the sign, and 0 to 10 V the amount of the velocity.
///
/// Proves: MACS-DIR-08
#[test]
fn a_unipolar_drive_has_no_volts_below_zero() {
    let mut config = analog_config(Interface::Velocity);
    config.axes[1].parameters.macs.revers = 20;
    let mut rig = rig(config, lag());
    rig.plant.attach_mechanics(0, &Mechanics { sign: Some(SignOutputs::Direction(1)), ..Mechanics::default() });
    rig.enable();
    rig.give(Action::Move(at(X, -50_000.0)));
    rig.run(600);
    let volts = rig.real("reference");
    assert!((volts - 2.5).abs() < 0.05, "{volts}");
    assert_eq!(rig.int("direction"), 1);
    assert!(rig.real("x.actual.velocity") < -49_000.0);
}

#[test]
fn more_than_10_v_and_words_that_no_voltage_brings_are_refused() {
    let mut rig = on(Interface::Velocity);
    let answer = rig.set("max_velocity", Value::Real(200_001.0));
    assert_eq!(
        rig.refusal(answer),
        "x: max_velocity 200.001 mm/s exceeds 200 mm/s, which is what its drive does at 10 V"
    );
    let answer = rig.set("max_velocity", Value::Real(200_000.0));
    assert!(rig.was_accepted(answer));
    let mut rig = self::rig(analog_config(Interface::Torque), motor());
    for (key, value, says) in [
        ("max_effort", Value::Real(1000.5), "max_effort 1000.5 exceeds 1000, which is what its drive does at 10 V"),
        (
            "torque_constant",
            Value::Real(0.5),
            "torque_constant 0.5 asks for what no drive that is given a voltage tells",
        ),
    ] {
        let answer = rig.set(key, value);
        assert!(rig.refusal(answer).contains(says), "{}", rig.refusal(answer));
    }
}

/// A torque-controlled drive coasts when it has to stop, so OUTAN is refused for it; a velocity-controlled drive
/// brakes.
#[test]
fn out_an_needs_a_drive_that_stops_by_itself() {
    for (interface, refuses) in [(Interface::Torque, true), (Interface::Velocity, false)] {
        let mut rig = on(interface);
        let answer = rig.give(Action::OutAn(OutAn { axis: X, value: 0.2, level: Level::Setpoint }));
        assert_eq!(rig.answer(answer).err().map(|event| event.code), refuses.then_some(Code::ANALOG_COASTS));
        rig.run(200);
        let volts = if refuses { 0.0 } else { 1.0 };
        assert!((rig.real("reference") - volts).abs() < 0.05);
        rig.give(Action::Halt(AxisSet::one(X)));
        rig.run(1);
        assert!(rig.real("reference").abs() < 0.05);
        rig.run(200);
        assert_eq!(rig.int("enable"), i64::from(refuses));
    }
}

/// Reference and enable belong to the axis: no other function or client may set them.
#[test]
fn outputs_of_analog_drive_are_reserved() {
    let mut rig = on(Interface::Velocity);
    for index in [3, 6] {
        let answer = rig.give(Action::SetOutputs([OutputValue { index, value: 1.0 }].into()));
        assert_eq!(rig.answer(answer).unwrap_err().code, Code::OUTPUT_TAKEN);
    }
    assert_eq!(rig.real("reference"), 0.0);
}

/// In motion, and while it is being enabled: a restored machine gives the same results.
#[test]
fn a_restored_machine_goes_on_alike() {
    let mut rig = rig(analog_config(Interface::Velocity), lag());
    rig.give(Action::Enable(AxisSet::first(3)));
    rig.run(20);
    rig.mirror();
    rig.run(40);
    rig.give(Action::Move(to(X, 30_000)));
    rig.run(200);
    rig.mirror();
    rig.run(2_000);
    assert_eq!(rig.state("x"), "STANDSTILL");
}

#[test]
fn what_a_cell_cannot_have_is_refused() {
    let refused = |change: fn(&mut MachineConfig)| {
        let mut config = analog_config(Interface::Velocity);
        change(&mut config);
        Machine::new(config).map(drop).unwrap_err()
    };
    fn wired(config: &mut MachineConfig) -> &mut AnalogWiring {
        config.axes[1].analog.as_mut().unwrap()
    }
    for (key, change) in [
        ("reference", (|config| wired(config).reference = 6) as fn(&mut MachineConfig)),
        ("reference", |config| wired(config).reference = 99),
        ("enable", |config| wired(config).enable = 2),
        ("ready", |config| wired(config).ready = Some(4)),
    ] {
        let problem = refused(change);
        assert!(matches!(problem, ConfigError::Output { key: named, .. } if named == key), "{problem}");
    }
    for change in [
        (|config| wired(config).full = 0.0) as fn(&mut MachineConfig),
        |config| wired(config).full = f64::NAN,
        |config| wired(config).full = f64::INFINITY,
        |config| wired(config).enable_ns = 4_000_000_001,
    ] {
        let problem = refused(change);
        assert!(matches!(problem, ConfigError::Analog { .. }), "{problem}");
    }
    let problem = refused(|config| {
        let mut other = config.axes[1].clone();
        other.name = "z".into();
        config.axes.push(other);
    });
    assert!(matches!(problem, ConfigError::OutputTwice { key: "reference", .. }), "{problem}");
    let problem = |change| match refused(change) {
        ConfigError::Analog { problem, .. } => Some(problem),
        _ => None,
    };
    assert_eq!(problem(|config| config.axes[1].drive = None), Some(AnalogProblem::Drives));
    let voltage = problem(|config| {
        config.axes[1].interface = Interface::OpenLoop;
        config.axes[1].drive = Some(Capabilities::all(0));
    });
    assert_eq!(voltage, Some(AnalogProblem::Interface(Interface::OpenLoop)));
    let read_back = problem(|config| config.global.virtual_inputs = vec![VirtualInput { input: 1, output: 6 }]);
    assert_eq!(read_back, Some(AnalogProblem::Ready));
    let problem = refused(|config| config.axes[1].second = Some(Capabilities::all(0)));
    assert!(matches!(problem, ConfigError::Analog { .. } | ConfigError::Gantry { .. }), "{problem}");
    let problem = refused(|config| config.axes[1].wired = Wired::default());
    assert!(
        matches!(problem, ConfigError::NotImplemented { key: "encodertype", code: Code::ANALOG_SILENT, .. }),
        "{problem}"
    );
    let problem = refused(|config| config.axes[1].parameters.max_velocity = 200_000.5);
    assert!(
        matches!(problem, ConfigError::NotImplemented { key: "max_velocity", code: Code::ANALOG_FULL, .. }),
        "{problem}"
    );
}
