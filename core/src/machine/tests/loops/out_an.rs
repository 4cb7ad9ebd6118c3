//! OUTAN: the loops below an open position loop.

use super::super::rig::{Rig, X, Y, config, to};
use super::lag;
use crate::axis::Safety;
use crate::code::Code;
use crate::command::{Action, HomeAxis, HomingMethod, Level, OutAn};
use crate::config::{IoConfig, IoKind, MachineConfig};
use crate::drive::{Interface, control};
use crate::object::{AxisSet, Object};
use crate::parameter::{Change, Row, Value};
use crate::regulator::Law;
use crate::sim::{Amplifier, Friction, Load, Model, Motor, MotorData, Reading, Stage};

/// Maximum velocity of x: 100,000 inc/s.
const FULL: f64 = 100_000.0;

fn velocity_config(law: Law) -> MachineConfig {
    let mut config = config(0);
    let axis = &mut config.axes[1];
    (axis.interface, axis.law) = (Interface::Velocity, law);
    axis.parameters.max_following_error = 20_000;
    config
}

/// 1000 per mille are 1 Nm on 5e-4 kg m^2: 2e7 inc/s^2. Friction of 1e-3 Nm s/rad: at 1000 rad/s, 1e7 inc/s, it takes
/// all of the torque.
fn torque_config(mode: i64) -> MachineConfig {
    let mut config = velocity_config(Law::Pid);
    let axis = &mut config.axes[1];
    axis.interface = Interface::Torque;
    axis.parameters.amplifier.max_effort = Some(1000.0);
    (axis.parameters.amplifier.mode, axis.parameters.pid.derivative) = (mode, 100);
    config
}

fn motor() -> Model {
    let data = MotorData {
        inertia: 2.5e-4,
        friction: Friction { viscous: 1e-3, ..Friction::default() },
        load: Load { inertia: 2.5e-4, ..Load::default() },
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 62_832.0, noise: 0.0, seed: 1, at_load: false },
    };
    Model::Motor(Motor::new(data).expect("a motor"))
}

fn rig(config: MachineConfig, model: Model) -> Rig {
    let mut rig = Rig::with(config, [model, Model::Ideal]);
    rig.enable();
    rig
}

fn ask(axis: u16, value: f64, level: Level) -> Action {
    Action::OutAn(OutAn { axis, value, level })
}

fn open(rig: &mut Rig, value: f64) -> u64 {
    rig.give(ask(X, value, Level::Setpoint))
}

fn refusal(rig: &Rig, sequence: u64) -> Option<Code> {
    rig.answer(sequence).err().map(|event| event.code)
}

/// Returns how often x reported the end of a command.
fn done(rig: &Rig, sequence: u64) -> usize {
    rig.done(sequence).iter().filter(|event| event.source == Object::Axis(X)).count()
}

/// A quarter of the full reference is commanded from this cycle, for any gains of the loop; the command is the actual
/// position.
///
/// Proves: MACS-AMP-02, MACS-CMD-28
#[test]
fn a_drive_of_velocities_runs_at_its_part_of_the_full_reference() {
    for law in Law::ALL {
        let mut rig = rig(velocity_config(law), lag(5));
        open(&mut rig, 0.25);
        assert_eq!((rig.real("x.output.velocity"), rig.real("x.regulator.output")), (0.25 * FULL, 0.25), "{law:?}");
        for _ in 0..500 {
            rig.run(1);
            assert_eq!((rig.state("x"), rig.int("x.following_error")), ("CONTINUOUS_MOTION", 0));
            assert_eq!(rig.int("x.command.position"), rig.int("x.actual.position"));
            assert_eq!(rig.real("x.output.velocity"), 0.25 * FULL);
        }
        assert!((rig.real("x.actual.velocity") - 0.25 * FULL).abs() < 1.0);
        open(&mut rig, -1.0);
        assert_eq!(rig.real("x.output.velocity"), -FULL);
        open(&mut rig, 0.0);
        rig.run(100);
        assert_eq!((rig.real("x.actual.velocity"), rig.int("x.enabled")), (0.0, 1), "it may stand as well");
    }
}

/// Mode 0: the value is a velocity, and the velocity loop controls it: 0.1 is 10,000 inc/s. Mode 2: it is the effort.
/// Level effort bypasses the velocity loop, for any gains.
///
/// Proves: MACS-AMP-02
#[test]
fn a_drive_of_efforts_has_the_loops_of_its_mode() {
    let mut with_loop = rig(torque_config(0), motor());
    open(&mut with_loop, 0.1);
    with_loop.run(500);
    assert!((with_loop.real("x.actual.velocity") - 10_000.0).abs() < 100.0, "{}", with_loop.real("x.actual.velocity"));
    for (mode, level) in [(2, Level::Setpoint), (2, Level::Effort), (0, Level::Effort)] {
        let mut rig = rig(torque_config(mode), motor());
        rig.give(ask(X, 0.005, level));
        assert_eq!((rig.real("x.output.effort"), rig.real("x.regulator.output")), (5.0, 0.005), "{mode} {level:?}");
        rig.run(200);
        assert_eq!((rig.real("x.output.effort"), rig.real("x.command.velocity")), (5.0, 0.0));
        // 0.005 of 2e7 inc/s^2 for 0.2 s, with a friction time constant of 0.5 s: 0.005 * 1e7 * (1 - exp(-0.4)) =
        // 16,484.
        assert!((rig.real("x.actual.velocity") - 16_484.0).abs() < 1_500.0, "{}", rig.real("x.actual.velocity"));
    }
}

/// AMPMAXCUR limits a value as it limits the loop: 1 A at 250 per mille per ampere is a quarter of the full effort.
///
/// Proves: MACS-AMP-08
#[test]
fn the_cap_of_the_current_caps_a_value() {
    let mut config = torque_config(2);
    let p = &mut config.axes[1].parameters.amplifier;
    (p.torque_constant, p.max_current) = (250.0, 1_000);
    let mut rig = rig(config, motor());
    open(&mut rig, 0.9);
    assert_eq!(rig.real("x.output.effort"), 250.0);
}

/// Every end has the same sequence: the drive stops by its quick stop, the power is removed at rest, and only then the
/// stop is done.
#[test]
fn its_drive_stops_it_and_the_power_goes() {
    let all = AxisSet::one(X);
    // The machine reports the end of a deactivation.
    let stops: [(Action, &str, usize); 5] = [
        (Action::Halt(all), "DISABLED", 1),
        (Action::Disable(all), "DISABLED", 1),
        (Action::QuickStop(all), "STOPPING", 1),
        (Action::Abort, "STOPPING", 1),
        (Action::Deactivate, "DISABLED", 0),
    ];
    for config in [velocity_config(Law::Pid), torque_config(0), torque_config(2)] {
        for (stop, state, ends) in &stops {
            let is_torque = config.axes[1].interface == Interface::Torque;
            let mut rig = rig(config.clone(), if is_torque { motor() } else { lag(20) });
            rig.give(ask(X, if is_torque { 0.02 } else { 0.5 }, Level::Setpoint));
            rig.run(100);
            let sequence = rig.give(stop.clone());
            let case = format!("{stop:?}");
            assert_eq!((rig.real("x.output.velocity"), rig.real("x.output.effort")), (0.0, 0.0), "{case}");
            assert_eq!(rig.int("x.output.control"), i64::from(control::QUICK_STOP), "{case}");
            assert!(rig.real("x.actual.velocity") > 100.0, "{case}");
            assert_eq!(done(&rig, sequence), 0, "{case}: it still moves");
            rig.run(1_000);
            assert_eq!(
                (rig.real("x.actual.velocity"), rig.state("x"), rig.int("x.enabled")),
                (0.0, *state, 0),
                "{case}"
            );
            assert_eq!((done(&rig, sequence), rig.int("x.error")), (*ends, 0), "{case}");
        }
    }
}

/// Any other motion is refused, and changes nothing; after disable and enable the position loop is closed again.
#[test]
fn open_loop_axis_refuses_motion_until_disabled() {
    let mut rig = rig(velocity_config(Law::Pid), lag(5));
    open(&mut rig, 0.1);
    let refused = rig.give(Action::Move(to(X, 100)));
    assert_eq!(refusal(&rig, refused), Some(Code::OUT_AN_RUNS));
    rig.run(10);
    assert_eq!(rig.real("x.output.velocity"), 0.1 * FULL);
    let homing = HomeAxis { axis: X, method: HomingMethod::Cia402(35) };
    let refused = rig.give(Action::HomeAxis(homing));
    assert_eq!(refusal(&rig, refused), Some(Code::NOT_AT_STANDSTILL));
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(500);
    rig.enable();
    let here = rig.int("x.actual.position");
    assert_eq!(rig.int("x.command.position"), here);
    rig.give(Action::Move(to(X, here + 5_000)));
    rig.run(3_000);
    assert_eq!(rig.state("x"), "STANDSTILL");
    assert!((rig.int("x.actual.position") - here - 5_000).abs() < 2_100, "kprop 30 alone");
}

#[test]
fn what_cannot_be_opened_is_refused() {
    let mut rig = rig(velocity_config(Law::Proportional), lag(5));
    for (axis, value, level, code) in [
        (Y, 0.1, Level::Setpoint, Code::OUT_AN_NO_LOOP),
        (0, 0.1, Level::Setpoint, Code::OUT_AN_NO_LOOP),
        (X, 0.1, Level::Effort, Code::OUT_AN_NO_EFFORT),
        (X, 1.001, Level::Setpoint, Code::BAD_NUMBER),
        (X, f64::NAN, Level::Setpoint, Code::BAD_NUMBER),
        (X, f64::NEG_INFINITY, Level::Setpoint, Code::BAD_NUMBER),
    ] {
        let sequence = rig.give(ask(axis, value, level));
        assert_eq!(refusal(&rig, sequence), Some(code), "{axis} {value} {level:?}");
    }
    assert_eq!(rig.state("x"), "STANDSTILL");
    rig.give(Action::Move(to(X, 50_000)));
    rig.run(50);
    let moving = open(&mut rig, 0.1);
    assert_eq!(refusal(&rig, moving), Some(Code::NOT_AT_STANDSTILL));
    rig.run(3_000);
    assert_eq!(rig.int("x.actual.position"), 50_000, "the move went on");
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(100);
    let off = open(&mut rig, 0.1);
    assert_eq!(refusal(&rig, off), Some(Code::NOT_ENABLED));
}

/// A drive that stops immediately with max_deceleration stands before the limit, also if the error is only reported.
#[test]
fn it_stops_before_a_software_limit() {
    for reaction in [0, 2, 4, 5] {
        for value in [0.9, -0.9] {
            let mut config = velocity_config(Law::Pid);
            let p = &mut config.axes[1].parameters;
            (p.error_reaction, p.min_position, p.max_position) = (reaction, Some(-30_000), Some(30_000));
            let mut rig = rig(config, lag(5));
            open(&mut rig, value);
            rig.run(1_000);
            let code = if value > 0.0 { Code::SOFTWARE_LIMIT_POSITIVE } else { Code::SOFTWARE_LIMIT_NEGATIVE };
            assert_eq!(rig.int("x.error"), i64::from(code.0), "{reaction} {value}");
            let place = rig.int("x.actual.position").abs();
            assert!((20_000..=30_000).contains(&place), "{reaction} {value}: {place}");
            assert_eq!((rig.state("x"), rig.real("x.actual.velocity")), ("ERROR_STOP", 0.0), "{reaction} {value}");
        }
    }
}

/// 0.5 of the effort is 1e7 inc/s^2: above 120,000 inc/s after 12 ms. The drive stops it.
#[test]
fn too_fast_is_an_error() {
    let mut rig = rig(torque_config(2), motor());
    open(&mut rig, 0.5);
    let mut fastest: f64 = 0.0;
    for _ in 0..1_000 {
        rig.run(1);
        fastest = fastest.max(rig.real("x.actual.velocity"));
    }
    assert_eq!((rig.int("x.error"), rig.state("x")), (i64::from(Code::OVERSPEED.0), "ERROR_STOP"));
    assert!((120_000.0..160_000.0).contains(&fastest), "{fastest}");
    assert_eq!(rig.real("x.actual.velocity"), 0.0);
}

/// A motor that does not move although a distance above max_following_error was commanded.
#[test]
fn one_that_does_not_move_loses_its_power() {
    let mut config = velocity_config(Law::Pid);
    config.axes[1].parameters.max_following_error = 2_000;
    let mut rig = rig(config, lag(5));
    rig.plant.drive(0).expect("a drive").jam(true);
    open(&mut rig, 0.5);
    rig.run(100);
    assert_eq!((rig.int("x.error"), rig.int("x.enabled")), (i64::from(Code::ENCODER_STANDS.0), 0));
}

#[test]
fn a_restored_machine_goes_on_with_its_value() {
    for config in [torque_config(0), torque_config(2)] {
        let mut rig = rig(config, motor());
        open(&mut rig, 0.01);
        rig.run(50);
        rig.mirror();
        rig.give(ask(X, -0.01, Level::Effort));
        rig.run(20);
        rig.give(Action::Halt(AxisSet::one(X)));
        rig.run(200);
        assert_eq!(rig.int("x.enabled"), 0);
    }
}

/// A value is a share of the full reference at the last rest; a new max_velocity does not change the active value.
#[test]
fn a_new_full_reference_changes_nothing_that_is_under_way() {
    let mut rig = rig(velocity_config(Law::Pid), lag(5));
    open(&mut rig, 0.2);
    let row = Row::find("max_velocity").expect("a row").0;
    rig.give(Action::SetParameters(Box::new([Change { axis: X, row, value: Value::Real(50_000.0) }])));
    rig.run(10);
    assert_eq!(rig.real("x.output.velocity"), 0.2 * FULL);
}

/// Backlash is not compensated while the position loop is open: the position shown is that of the counts.
#[test]
fn no_backlash_is_taken_up_meanwhile() {
    let mut config = velocity_config(Law::Proportional);
    config.axes[1].parameters.compensation.backlash = 50;
    let mut rig = rig(config, lag(5));
    rig.give(Action::HomeAxis(HomeAxis { axis: X, method: HomingMethod::Cia402(35) }));
    rig.run(10);
    rig.give(Action::Move(to(X, 1_000)));
    rig.run(2_000);
    let taken = rig.int("x.compensation");
    for value in [-0.1, 0.1] {
        open(&mut rig, value);
        let counts = rig.int("x.actual.position") - rig.int("x.actual.count");
        for _ in 0..200 {
            rig.run(1);
            assert_eq!(rig.int("x.compensation"), taken, "{value}");
            assert_eq!(rig.int("x.actual.position") - rig.int("x.actual.count"), counts, "{value}");
        }
    }
    rig.give(Action::Disable(AxisSet::one(X)));
    rig.run(500);
    rig.enable();
    rig.give(Action::Move(to(X, -1_000)));
    rig.run(2_000);
    assert_eq!(rig.int("x.compensation"), -50);
}

/// 0.4 A are a tenth of the full effort. Acceleration takes all of it for 25 ms; the integral of the velocity loop does
/// not grow meanwhile, so the axis does not overshoot the commanded velocity.
///
/// Proves: MACS-AMP-05, MACS-AMP-08
#[test]
fn the_sum_of_the_velocity_loop_does_not_grow_beyond_the_cap() {
    let mut config = torque_config(0);
    let p = &mut config.axes[1].parameters.amplifier;
    (p.torque_constant, p.max_current, p.proportional, p.integral, p.limit) = (250.0, 400, 200, 100, 32_767);
    let mut rig = rig(config, motor());
    open(&mut rig, 0.5);
    let (mut fastest, mut most) = (0.0_f64, 0.0_f64);
    for _ in 0..300 {
        rig.run(1);
        fastest = fastest.max(rig.real("x.actual.velocity"));
        most = most.max(rig.real("x.output.effort"));
    }
    assert_eq!(most, 100.0);
    assert!((50_000.0..53_000.0).contains(&fastest), "{fastest}");
}

/// Contacts of the cell: input 0 is the emergency stop, input 1 the interlock; both read 1 when closed.
fn with_contacts(mut config: MachineConfig) -> MachineConfig {
    for (name, kind) in
        [("estop", IoKind::DigitalInput), ("door", IoKind::DigitalInput), ("hold", IoKind::DigitalOutput)]
    {
        config.io.push(IoConfig { name: name.to_owned(), kind, latch: false });
    }
    config.safety = Safety { estop: Some(0), interlock: Some(1) };
    config.axes[1].parameters.outputs.brake = 1;
    config
}

/// An emergency stop while the loop is open, and one while the drive is already stopping, with any error_reaction: the
/// quick stop of the drive continues, the brake closes once the axis is at rest, and the power is removed. The
/// interlock has the same effect without the brake, except with error_reaction 3.
#[test]
fn contacts_leave_it_to_its_drive_and_close_the_brake_at_rest() {
    for reaction in 0..=5 {
        for (contact, brake) in [(0, 1), (1, i64::from(reaction == 3))] {
            for halts in [false, true] {
                let case = format!("reaction {reaction}, contact {contact}, halted before {halts}");
                let mut config = with_contacts(velocity_config(Law::Pid));
                config.axes[1].parameters.error_reaction = reaction;
                let mut rig = Rig::with(config, [lag(20), Model::Ideal]);
                (0..2).for_each(|input| rig.plant.set_digital(input, true));
                rig.enable();
                open(&mut rig, 0.5);
                rig.run(200);
                if halts {
                    rig.give(Action::Halt(AxisSet::one(X)));
                    rig.run(1);
                }
                rig.plant.set_digital(contact, false);
                rig.run(2);
                assert_eq!(rig.state("x"), "ERROR_STOP", "{case}");
                while rig.real("x.actual.velocity") > 1_000.0 {
                    assert_eq!(rig.int("x.output.control"), i64::from(control::QUICK_STOP), "{case}");
                    assert_eq!(rig.int("x.brake"), 0, "{case}: it moves");
                    rig.run(1);
                }
                rig.run(500);
                assert_eq!((rig.int("x.output.control"), rig.int("x.brake")), (0, brake), "{case}");
            }
        }
    }
}

/// An error under power with every error_reaction that stops: the power is removed, the brake closes with 1 and 3.
#[test]
fn every_error_that_stops_it_takes_the_power_at_rest() {
    for reaction in 0..=5 {
        let mut config = with_contacts(velocity_config(Law::Pid));
        let p = &mut config.axes[1].parameters;
        (p.error_reaction, p.min_position, p.max_position) = (reaction, Some(-30_000), Some(30_000));
        let mut rig = Rig::with(config, [lag(5), Model::Ideal]);
        (0..2).for_each(|input| rig.plant.set_digital(input, true));
        rig.enable();
        open(&mut rig, 0.9);
        rig.run(1_000);
        assert_eq!((rig.state("x"), rig.int("x.output.control")), ("ERROR_STOP", 0), "{reaction}");
        assert_eq!(rig.int("x.brake"), i64::from(matches!(reaction, 1 | 3)), "{reaction}");
    }
}

/// Esc closes the brake once the drive has stopped the axis, not earlier.
#[test]
fn an_abort_closes_the_brake_at_rest() {
    let mut rig = Rig::with(with_contacts(velocity_config(Law::Pid)), [lag(20), Model::Ideal]);
    (0..2).for_each(|input| rig.plant.set_digital(input, true));
    rig.enable();
    open(&mut rig, 0.5);
    rig.run(200);
    rig.give(Action::Abort);
    while rig.real("x.actual.velocity") > 1_000.0 {
        assert_eq!((rig.int("x.brake"), rig.int("x.output.control")), (0, i64::from(control::QUICK_STOP)));
        rig.run(1);
    }
    rig.run(500);
    assert_eq!((rig.state("x"), rig.int("x.brake"), rig.int("x.output.control")), ("STOPPING", 1, 0));
}

/// A drive receives a value ten cycles later: a halt before that does not count as a stop at rest, and is done once the
/// axis is at rest.
#[test]
fn halt_waits_for_values_not_yet_received_by_drive() {
    let mut config = config(10);
    config.axes[1].interface = Interface::Velocity;
    config.axes[1].parameters.max_following_error = 20_000;
    let mut rig = rig(config, lag(20));
    open(&mut rig, 0.0);
    rig.run(30);
    open(&mut rig, 1.0);
    rig.run(4);
    let halt = rig.give(Action::Halt(AxisSet::one(X)));
    let mut fastest: f64 = 0.0;
    for _ in 0..1_000 {
        rig.run(1);
        fastest = fastest.max(rig.real("x.actual.velocity"));
        let is_done = done(&rig, halt) == 1;
        assert!(!is_done || rig.real("x.actual.velocity") == 0.0, "done at {} inc/s", rig.real("x.actual.velocity"));
    }
    assert!(fastest > 5_000.0, "{fastest}");
    assert_eq!((done(&rig, halt), rig.state("x"), rig.int("x.enabled")), (1, "DISABLED", 0));
}
