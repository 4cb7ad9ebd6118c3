//! Drives with a torque setpoint, or with a velocity loop on a motor.

use super::*;
use crate::drive::{DriveInput, HomingOrder, Mode, Outputs};

/// 1 Nm on 5e-4 kg m^2 is 2000 rad/s^2; 62832 counts per turn are nearly 10000 per radian.
fn data() -> MotorData {
    MotorData {
        inertia: 2.5e-4,
        friction: Friction::default(),
        load: Load { inertia: 2.5e-4, ..Load::default() },
        coupling: None,
        amplifier: Amplifier { stage: Stage::Torque { rated: 1.0, lag_ns: 0 }, limit: 3.0, dead_time_ns: 0 },
        reading: Reading { counts_per_turn: 62_832.0, noise: 0.0, seed: 1, at_load: false },
    }
}

fn ready(model: Model) -> SimDrive {
    let mut drive = SimDrive::new(model, 0, MS);
    for word in [control::SHUTDOWN, control::SWITCH_ON, control::ENABLE] {
        drive.read();
        drive.write(DriveOutput { control: word, mode: Mode::Torque, ..DriveOutput::default() });
    }
    assert_eq!(DriveState::from_status(drive.read().status), DriveState::Enabled);
    drive
}

fn motor(data: MotorData) -> Model {
    Model::Motor(Motor::new(data).unwrap())
}

fn asks(effort: f64) -> DriveOutput {
    DriveOutput { effort, control: control::ENABLE, mode: Mode::Torque, ..DriveOutput::default() }
}

fn runs(velocity: f64) -> DriveOutput {
    DriveOutput { velocity, mode: Mode::Velocity, ..asks(0.0) }
}

fn run(drive: &mut SimDrive, output: DriveOutput, cycles: usize) -> DriveInput {
    let mut input = DriveInput::default();
    for _ in 0..cycles {
        drive.write(output);
        input = drive.read();
    }
    input
}

/// Returns the counts of an angle (rad).
fn counts(angle: f64) -> i64 {
    (angle * 62_832.0 / std::f64::consts::TAU).floor() as i64
}

/// 500 per mille are 1000 rad/s^2: 5 rad after 100 ms, and the velocity is that of the counts of the last cycle.
#[test]
fn an_effort_is_per_mille_of_the_rated_torque() {
    let mut drive = ready(motor(data()));
    let before = run(&mut drive, asks(500.0), 99);
    let input = run(&mut drive, asks(500.0), 1);
    assert_eq!((before.count, input.count, input.effort), (counts(4.9005), counts(5.0), 500.0));
    assert_eq!(input.velocity, (input.count - before.count) as f64 * 1000.0);
    assert_eq!(input.mode, Mode::Torque.number());
    // Without a torque it continues at 100 rad/s.
    assert_eq!(run(&mut drive, asks(f64::NAN), 100).count, counts(15.0));
    // Beyond the limit of 3 times: -6000 rad/s^2 for 10 ms from 100 rad/s.
    let limited = run(&mut drive, asks(-1e9), 10);
    assert_eq!((limited.count, limited.effort), (counts(15.0 + 1.0 - 0.3), -3000.0));
}

#[test]
fn without_power_there_is_no_torque_and_quick_stop_brakes() {
    for (word, state) in [
        (control::DISABLE_VOLTAGE, DriveState::SwitchOnDisabled),
        (control::SWITCH_ON, DriveState::SwitchedOn),
        (control::QUICK_STOP, DriveState::QuickStop),
    ] {
        let mut drive = ready(motor(data()));
        run(&mut drive, asks(500.0), 100);
        let before = run(&mut drive, DriveOutput { control: word, ..asks(500.0) }, 1);
        assert_eq!(DriveState::from_status(before.status), state);
        let input = run(&mut drive, DriveOutput { control: word, ..asks(500.0) }, 500);
        if state == DriveState::QuickStop {
            let still = run(&mut drive, DriveOutput { control: word, ..asks(500.0) }, 10);
            assert!(input.count < counts(10.0) && still.velocity == 0.0, "{input:?} {still:?}");
        } else {
            assert_eq!((input.effort, input.count), (0.0, counts(5.0 + 50.1)));
        }
    }
    let mut drive = ready(motor(data()));
    run(&mut drive, asks(500.0), 100);
    drive.inject_fault(0x2310);
    assert_eq!(run(&mut drive, asks(500.0), 100).count, counts(15.0));
}

#[test]
fn a_motor_with_swapped_leads_turns_against_its_setpoint() {
    let mut drive = ready(motor(data()).wired(true));
    let input = run(&mut drive, asks(500.0), 100);
    assert_eq!((input.count, input.effort), (counts(-5.0), 500.0));
    let mut drive = ready(motor(data()).wired(true));
    run(&mut drive, runs(50_000.0), 500);
    let input = run(&mut drive, runs(50_000.0), 1);
    assert!((input.velocity + 50_000.0).abs() <= 1000.0, "{}", input.velocity);
}

/// A jammed or braked motor has its torque and does not turn; when released, it starts from rest.
#[test]
fn held_motor_has_torque_and_does_not_turn() {
    let mut drive = ready(motor(data()));
    run(&mut drive, asks(500.0), 100);
    drive.jam(true);
    let input = run(&mut drive, asks(800.0), 50);
    assert_eq!((input.count, input.velocity, input.effort), (counts(5.0), 0.0, 800.0));
    drive.jam(false);
    assert_eq!(run(&mut drive, asks(500.0), 100).count, counts(10.0));
}

/// A load falls with its acceleration, with power and without, unless the brake holds it; a torque can hold it.
#[test]
fn a_hanging_load_pulls_all_the_time() {
    let brake = SimBrake { output: 0, closes_with_one: false, opens_ns: 0, closes_ns: 0 };
    let mut drive = ready(motor(data()));
    drive.attach_mechanics(&Mechanics { load: -200_000.0, brake: Some(brake), ..Mechanics::default() });
    let mut outputs = Outputs { digital: vec![0], ..Outputs::default() };
    let mut with_brake = |drive: &mut SimDrive, output: DriveOutput, opens: bool, cycles: usize| {
        outputs.set_digital(0, opens);
        let mut input = DriveInput::default();
        for _ in 0..cycles {
            let output = drive.wired_to(output, &outputs);
            drive.write(output);
            input = drive.read();
        }
        input
    };
    assert_eq!(with_brake(&mut drive, asks(0.0), false, 50).count, 0);
    // -200000 counts/s^2 for 100 ms.
    let fallen = with_brake(&mut drive, asks(0.0), true, 100).count;
    assert!((fallen + 1000).abs() <= 1, "{fallen}");
    let off = DriveOutput { control: control::DISABLE_VOLTAGE, ..asks(0.0) };
    let further = with_brake(&mut drive, off, true, 100).count;
    assert!((further + 4000).abs() <= 1, "{further}");
    assert_eq!(with_brake(&mut drive, off, false, 100).count, further);
    // Nearly 20 rad/s^2 on 5e-4 kg m^2 are 10 mNm: 10 per mille.
    let mut drive = ready(motor(data()));
    drive.attach_mechanics(&Mechanics { load: -200_000.0, ..Mechanics::default() });
    let torque = 1000.0 * 200_000.0 * std::f64::consts::TAU / 62_832.0 * 5e-4;
    let carried = run(&mut drive, asks(torque), 1000).count;
    assert!((-1..=0).contains(&carried), "{carried}");
}

/// The loop of the drive has no steady error; its count gives the velocity.
#[test]
fn a_velocity_is_closed_by_the_drive() {
    let mut drive = ready(motor(data()));
    let before = run(&mut drive, runs(80_000.0), 1000).count;
    let after = run(&mut drive, runs(80_000.0), 1000).count;
    assert!((after - before - 80_000).abs() < 80, "{}", after - before);
    let at_rest = run(&mut drive, runs(f64::NAN), 1000);
    assert_eq!((at_rest.velocity, at_rest.count), (0.0, run(&mut drive, runs(0.0), 10).count));
    // A mode without a setpoint causes no torque.
    assert_eq!(run(&mut drive, DriveOutput { mode: Mode::Position, ..runs(0.0) }, 5).effort, 0.0);
}

/// A jump and new counts are handled as in any drive; the velocity shows a jump, because a drive derives it from its
/// counts.
#[test]
fn jumps_and_new_counts_are_those_of_any_drive() {
    let mut drive = ready(motor(data()));
    drive.jump(40);
    let jumped = run(&mut drive, asks(0.0), 1);
    assert_eq!((jumped.count, jumped.velocity), (40, 40_000.0));
    run(&mut drive, asks(500.0), 100);
    drive.restart_counts();
    let renewed = run(&mut drive, asks(0.0), 1);
    // 100 rad/s for 1 ms.
    assert!((renewed.count - 1000).abs() <= 1 && renewed.epoch == 1, "{renewed:?}");
    assert_eq!(renewed.velocity, renewed.count as f64 * 1000.0);
}

/// Index and switches are along the travel of the motor; a lost index gives no pulses.
#[test]
fn an_index_passes_with_the_motor() {
    let fixtures =
        Fixtures { index: Some(Index { every: 1000, at: 300 }), home: Some((200, 400)), ..Default::default() };
    let mut drive = ready(motor(data()));
    drive.install_fixtures(fixtures);
    let mut seen = Vec::new();
    for _ in 0..100 {
        let input = run(&mut drive, asks(100.0), 1);
        seen.extend(input.index);
        let at_home = input.inputs & crate::drive::inputs::HOME != 0;
        assert_eq!(at_home, (200..=400).contains(&input.count));
    }
    // 200 rad/s^2 for 100 ms: 1 rad.
    assert_eq!(seen, [300, 1300, 2300, 3300, 4300, 5300, 6300, 7300, 8300, 9300]);
    drive.lose_index();
    assert!((0..100).all(|_| run(&mut drive, asks(100.0), 1).index.is_none()));
}

/// Homing by the drive itself moves a motor like any other drive, and leaves it at rest.
#[test]
fn motor_is_at_rest_after_homing_by_drive() {
    let mut drive = ready(motor(data()));
    run(&mut drive, asks(500.0), 100);
    let order = HomingOrder { method: 35, search_velocity: 1e3, zero_velocity: 1e3, acceleration: 1e4 };
    let home = DriveOutput { mode: Mode::Homing(order), control: control::ENABLE, ..DriveOutput::default() };
    run(&mut drive, home, 1);
    let homed = run(&mut drive, DriveOutput { control: control::ENABLE | control::START_HOMING, ..home }, 1);
    assert_eq!((homed.count, homed.velocity, homed.epoch), (0, 0.0, 1));
    let behind = run(&mut drive, asks(0.0), 10);
    assert_eq!((behind.count, behind.velocity), (0, 0.0));
}

/// An encoder on the load reads the twist: -0.4 Nm at 100 Nm/rad are 4 mrad behind; within the gap it does not follow
/// the motor.
#[test]
fn an_encoder_of_the_axis_may_sit_on_the_load() {
    let mut data = data();
    data.coupling = Some(Coupling { stiffness: 100.0, damping: 0.05, backlash: 0.0 });
    data.load.torque = -0.4;
    let drive = SimDrive::new(motor(data), 0, MS);
    assert_eq!((drive.place(), drive.encoder_position()), (0, 0));
    data.reading.at_load = true;
    let drive = SimDrive::new(motor(data), 0, MS);
    assert_eq!((drive.place(), drive.encoder_position()), (0, counts(-0.004)));
}

/// Noise is in the reading only, and moves neither position nor index.
#[test]
fn noise_affects_reading_only() {
    let mut data = data();
    data.reading.noise = 4.0;
    let mut drive = ready(motor(data));
    let told: Vec<_> = (0..200).map(|_| run(&mut drive, asks(0.0), 1)).collect();
    assert!(told.iter().any(|input| input.count > 2) && told.iter().any(|input| input.count < -2));
    assert!(told.windows(2).all(|pair| pair[1].velocity == (pair[1].count - pair[0].count) as f64 * 1000.0));
    assert_eq!(drive.place(), 0);
}

#[test]
fn a_motor_fits_torque_and_velocity() {
    let model = motor(data());
    let fitting = [Interface::Position, Interface::Velocity, Interface::Torque, Interface::OpenLoop];
    assert_eq!(fitting.map(|interface| model.fits(interface)), [false, true, true, false]);
    let offers = model.capabilities(2);
    assert_eq!((offers.delay, offers.torque, offers.velocity, offers.position), (2, true, true, false));
}
