//! Velocity loop with the encoder of the motor, position loop with an encoder of the load.

mod faults;

use super::super::rig::{Rig, X, at, config, to};
use crate::axis::Wired;
use crate::code::Code;
use crate::command::{Action, SetPosition};
use crate::config::{ConfigError, MachineConfig};
use crate::drive::Interface;
use crate::encoder::Form;
use crate::object::AxisSet;
use crate::parameter::{Change, Row, Value, VelocityEncoder};
use crate::position::Length;
use crate::regulator::Law;
use crate::sim::{Amplifier, Coupling, Friction, Load, Model, Motor, MotorData, Reading, Stage};

/// Increments per revolution, 10000 per rad.
const TURN: i64 = 62_832;

/// 1 Nm on twice 2.5e-4 kg m^2; motor and load oscillate against each other with sqrt(50 (1/2.5e-4 + 1/2.5e-4)) = 632
/// rad/s, 101 Hz.
fn motor() -> MotorData {
    MotorData {
        inertia: 2.5e-4,
        friction: Friction { viscous: 1e-4, coulomb: 0.005, holding: 0.005 },
        load: Load { inertia: 2.5e-4, ..Load::default() },
        coupling: Some(Coupling { stiffness: 50.0, damping: 0.005, backlash: 0.0 }),
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: TURN as f64, noise: 0.0, seed: 1, at_load: true },
    }
}

/// x reads its position from an entry of encoders, at the load, and its velocity from its drive. ENCODER: the entry has
/// as many increments per revolution as the drive.
fn dual_config() -> MachineConfig {
    let mut config = config(0);
    let axis = &mut config.axes[1];
    (axis.interface, axis.law, axis.wired) = (Interface::Torque, Law::Proportional, Wired::Encoder(0));
    let p = &mut axis.parameters;
    (p.max_following_error, p.error_reaction, p.macs.encoder) = (20_000, 2, TURN / 4);
    (p.amplifier.max_effort, p.amplifier.proportional, p.amplifier.integral) = (Some(1000.0), 60, 1);
    (p.amplifier.limit, p.position_loop.kv) = (5_000, 10.0);
    p.amplifier.encoder = VelocityEncoder { number: 2, resolution: TURN, rpm: 0 };
    config
}

fn rig(config: MachineConfig, data: MotorData) -> Rig {
    Rig::with(config, [Model::Motor(Motor::new(data).unwrap()), Model::Ideal])
}

fn on(config: MachineConfig, data: MotorData) -> Rig {
    let mut rig = rig(config, data);
    rig.enable();
    rig
}

fn set(rig: &mut Rig, changes: &[(&str, i64)]) -> u64 {
    let change = |&(key, value): &(&str, i64)| Change {
        axis: X,
        row: Row::find(key).expect("a row").0,
        value: Value::Int(value),
    };
    rig.give(Action::SetParameters(changes.iter().map(change).collect()))
}

/// Returns the sum of the absolute changes of the effort over a number of cycles.
fn effort_changes(rig: &mut Rig, cycles: u64) -> f64 {
    let mut before = rig.real("x.output.effort");
    (0..cycles)
        .map(|_| {
            rig.run(1);
            let now = rig.real("x.output.effort");
            let change = (now - before).abs();
            before = now;
            change
        })
        .sum()
}

/// A soft coupling: with both loops on the load, the output of the velocity loop is delayed by the spring, and the axis
/// becomes unstable. With the encoder of the motor the same gains are stable, and the load is at its target.
///
/// Proves: MACS-AMP-06
#[test]
fn gains_that_shake_a_soft_axis_by_its_load_hold_it_by_its_motor() {
    let run = |number| {
        let mut config = dual_config();
        config.axes[1].parameters.amplifier.encoder.number = number;
        let mut rig = on(config, motor());
        rig.give(Action::Move(to(X, 20_000)));
        rig.run(3_000);
        rig
    };
    let mut dual = run(2);
    assert_eq!((dual.int("x.error"), dual.state("x")), (0, "STANDSTILL"));
    assert!((dual.int("x.actual.position") - 20_000).abs() <= 2, "{}", dual.int("x.actual.position"));
    assert!(effort_changes(&mut dual, 200) < 100.0);
    let mut one = run(-1);
    let shakes = one.int("x.enabled") == 0 || effort_changes(&mut one, 200) > 10_000.0;
    assert!(shakes, "{}", effort_changes(&mut one, 200));
}

/// Backlash between motor and load, and a pulling load: the position loop reads the load, which is at its target from
/// either side, at any motor position.
#[test]
fn a_play_leaves_no_error_at_the_load() {
    let mut data = motor();
    data.coupling = Some(Coupling { stiffness: 400.0, damping: 0.05, backlash: 0.02 });
    data.load.friction = Friction { viscous: 1e-3, coulomb: 0.05, holding: 0.05 };
    data.load.torque = -0.1;
    let mut rig = on(dual_config(), data);
    for target in [30_000, 20_000, 25_000] {
        rig.give(Action::Move(to(X, target)));
        rig.run(4_000);
        assert_eq!((rig.int("x.error"), rig.state("x")), (0, "STANDSTILL"));
        let load = rig.plant.drive(0).unwrap().load_place();
        assert!((load - target).abs() <= 3, "{load} of {target}");
    }
}

/// The motor has three counts per count of the load, as AMPENCRES defines; with AMPENCRES or only AMPENCRPM the ratio
/// is the same. The velocity loop reads the velocity in increments of the axis.
///
/// Proves: MACS-AMP-06
#[test]
fn ampencres_and_ampencrpm_define_the_encoder_ratio() {
    // 100000 inc/s are 1.5915 revolutions per second, 95.49 per minute.
    for (factor, resolution, rpm, within) in [(3, 3 * TURN, 0, 500.0), (3, 3 * TURN, 95, 800.0), (-1, TURN, 95, 800.0)]
    {
        let mut config = dual_config();
        config.axes[1].parameters.amplifier.encoder = VelocityEncoder { number: 2, resolution, rpm };
        config.axes[1].parameters.macs.posdrct = if factor < 0 { 21 } else { 1 };
        let mut rig = rig(config, motor());
        rig.plant.drive(0).unwrap().set_count_factor(factor);
        rig.enable();
        rig.give(Action::Move(at(X, 50_000.0)));
        rig.run(2_000);
        let seen = rig.real("x.regulator.velocity");
        assert!((seen - 50_000.0).abs() < within + 1_000.0, "{factor}: {seen}");
        // The lag is v/kv and a cycle, independent of the counts of the motor encoder.
        let behind = rig.int("x.regulator.error");
        assert!((behind - 5_000).abs() < 100, "{factor} {rpm}: {behind}");
        assert_eq!(rig.int("x.error"), 0);
    }
}

/// Leads, encoder of the motor, encoder of the load, each wired in either direction, and the user direction: the
/// matching digits of POSDRCT hold and move the axis; the tens digit is that of the motor. All other digits lose the
/// axis.
///
/// Proves: MACS-DIR-01, MACS-DIR-03, MACS-AMP-06
#[test]
fn the_tens_digit_is_the_sense_of_the_motor() {
    for (leads, motor_turned, load_turned) in (0..8).map(|bits| (bits & 1 == 1, bits & 2 == 2, bits & 4 == 4)) {
        let digit = |inverted: bool| 1 + i64::from(inverted);
        let fits = 10 * digit(leads != motor_turned) + digit(leads != load_turned);
        for posdrct in [11, 12, 21, 22, -11, -12, -21, -22] {
            let mut config = dual_config();
            config.axes[1].parameters.macs.posdrct = posdrct;
            config.axes[1].parameters.max_following_error = 6_000;
            let model = Model::Motor(Motor::new(motor()).unwrap()).wired(leads);
            let mut rig = Rig::with(config, [model, Model::Ideal]);
            rig.plant.drive(0).unwrap().set_count_factor(if motor_turned { -1 } else { 1 });
            rig.plant.count_encoder_by(0, if load_turned { -1 } else { 1 });
            rig.enable();
            rig.give(Action::Move(at(X, 20_000.0)));
            rig.run(1_500);
            let case = format!("{leads} {motor_turned} {load_turned}: {posdrct}");
            if posdrct.abs() == fits {
                assert_eq!((rig.int("x.error"), rig.state("x")), (0, "CONTINUOUS_MOTION"), "{case}");
                assert!((rig.real("x.regulator.velocity") - 20_000.0).abs() < 1_500.0, "{case}");
            } else {
                assert_eq!(rig.int("x.enabled"), 0, "{case}");
            }
        }
    }
}

/// The words of the drive and those of the load have 16 bits: both wrap around, and a new zero of the position does not
/// affect the velocity: the effort that holds the load is unchanged.
#[test]
fn overflow_and_new_zero_do_not_disturb_velocity_loop() {
    let mut config = dual_config();
    config.axes[1].wired = Wired::Drive(Form::Incremental(16));
    config.axes[1].parameters.encoder.encodertype = 10;
    let mut data = motor();
    data.load.torque = -0.2;
    let mut rig = on(config, data);
    rig.give(Action::Move(at(X, 50_000.0)));
    rig.run(300);
    for _ in 0..3_000 {
        rig.run(1);
        let (seen, effort) = (rig.real("x.regulator.velocity"), rig.real("x.output.effort"));
        assert!((seen - 50_000.0).abs() < 20_000.0 && effort.abs() < 700.0, "{seen} {effort}");
    }
    rig.give(Action::Halt(AxisSet::one(X)));
    rig.run(3_000);
    let held = rig.real("x.output.effort");
    assert!((held - 200.0).abs() < 10.0, "{held}");
    let zero = rig.give(Action::SetPosition(SetPosition { axis: X, position: Length::whole(1_000_000) }));
    assert!(rig.was_accepted(zero));
    for _ in 0..200 {
        rig.run(1);
        assert!((rig.real("x.output.effort") - held).abs() < 5.0, "{}", rig.real("x.output.effort"));
    }
    assert!((rig.int("x.actual.position") - 1_000_000).abs() <= 2);
    assert_eq!(rig.int("x.error"), 0);
}

#[test]
fn a_restored_machine_goes_on_with_both_encoders() {
    let mut config = dual_config();
    (config.axes[1].parameters.amplifier.estimator, config.axes[1].parameters.amplifier.bandwidth) = (2, 200.0);
    let mut rig = on(config, motor());
    rig.give(Action::Move(to(X, 30_000)));
    rig.run(151);
    rig.mirror();
    rig.plant.drive(0).unwrap().jump(40);
    rig.run(3_000);
    assert!(rig.int("x.regulator.error").abs() <= 3, "{}", rig.int("x.regulator.error"));
}

/// The encoder changes while the axis is off, in one set, and earlier travel is not counted with the new encoder.
#[test]
fn an_encoder_is_chosen_while_the_axis_is_off() {
    let mut config = dual_config();
    config.axes[1].parameters.amplifier.encoder = VelocityEncoder { number: -1, resolution: -1, rpm: 0 };
    config.axes[1].parameters.amplifier.proportional = 20;
    let mut rig = on(config, motor());
    for keys in [&[("ampencno", 2), ("ampencres", TURN)][..], &[("ampencrpm", 95)], &[("ampencres", 5)]] {
        let refused = set(&mut rig, keys);
        assert!(rig.refusal(refused).contains("only while x is disabled"), "{}", rig.refusal(refused));
    }
    rig.give(Action::Move(to(X, 30_000)));
    rig.run(2_000);
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(500);
    let chosen = set(&mut rig, &[("posdrct", 21), ("ampencno", 2), ("ampencres", TURN)]);
    assert!(rig.was_accepted(chosen));
    rig.plant.drive(0).unwrap().set_count_factor(-1);
    rig.give(Action::Enable(AxisSet::one(X)));
    rig.run(1_000);
    assert_eq!((rig.int("x.error"), rig.state("x")), (0, "STANDSTILL"));
}

#[test]
fn what_it_cannot_be_is_refused_by_its_name() {
    let refused = |change: &dyn Fn(&mut MachineConfig), key: &'static str, code| {
        let mut config = dual_config();
        change(&mut config);
        assert_eq!(config.check(), Err(ConfigError::NotImplemented { axis: "x".into(), key, code }));
    };
    assert_eq!(dual_config().check(), Ok(()));
    for number in [1, 3, 4] {
        refused(&|c| c.axes[1].parameters.amplifier.encoder.number = number, "ampencno", Code::VELOCITY_ENCODER_OTHER);
    }
    refused(&|c| c.axes[1].parameters.amplifier.encoder.resolution = -1, "ampencres", Code::VELOCITY_ENCODER_TURN);
    // The position from the drive, too: one encoder for both loops has one direction.
    let one = |c: &mut MachineConfig| {
        c.axes[1].wired = Wired::Drive(Form::Incremental(64));
        c.axes[1].parameters.macs.posdrct = 12;
    };
    refused(&one, "posdrct", Code::NO_VELOCITY_LOOP);
    // Without a separate velocity encoder both loops have one encoder, and one direction.
    let turned = |c: &mut MachineConfig| {
        (c.axes[1].parameters.amplifier.encoder.number, c.axes[1].parameters.macs.posdrct) = (-1, 21);
    };
    refused(&turned, "posdrct", Code::NO_VELOCITY_LOOP);
    let mut config = dual_config();
    config.axes[1].parameters.amplifier.encoder.number = -1;
    let mut rig = Rig::of(config);
    for (keys, sentence) in [
        (
            &[("ampencno", 1)][..],
            "x: ampencno 1 names no encoder that its velocity loop reads: -1, that of the position loop, and the number of the axis \
             itself, the encoder of its drive, are allowed",
        ),
        (
            &[("ampencno", 2), ("ampencres", -1)],
            "x: ampencres -1 gives no turn of the encoder that ampencno names; 1 to 1073741823 increments are allowed",
        ),
        (&[("ampencno", 0)], "x: ampencno is 0; 1 to 1073741823 is allowed"),
    ] {
        let refused = set(&mut rig, keys);
        assert_eq!(rig.refusal(refused), sentence);
    }
}
