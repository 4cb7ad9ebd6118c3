mod marks;
mod motors;
mod torque;

use super::second_order::State;
use super::*;
use crate::drive::{DriveOutput, DriveState, control};

const MS: u64 = 1_000_000;

fn output(position: i64, word: u16) -> DriveOutput {
    DriveOutput { position, control: word, ..DriveOutput::default() }
}

fn switched_on(model: Model, delay: u32) -> SimDrive {
    let mut drive = SimDrive::new(model, delay, MS);
    for word in [control::SHUTDOWN, control::SWITCH_ON, control::ENABLE] {
        drive.read();
        drive.write(output(0, word));
    }
    for _ in 0..delay {
        drive.read();
        drive.write(output(0, control::ENABLE));
    }
    drive
}

#[test]
fn the_drive_goes_through_the_states_of_cia_402() {
    let mut drive = SimDrive::new(Model::Ideal, 0, MS);
    drive.read();
    let words =
        [0, control::SHUTDOWN, control::SWITCH_ON, control::ENABLE, control::QUICK_STOP, control::DISABLE_VOLTAGE];
    let states: Vec<_> = words
        .into_iter()
        .map(|word| {
            drive.write(output(0, word));
            DriveState::from_status(drive.read().status)
        })
        .collect();
    use DriveState::*;
    assert_eq!(states, [SwitchOnDisabled, Ready, SwitchedOn, Enabled, QuickStop, SwitchOnDisabled]);
}

#[test]
fn an_ideal_drive_shows_a_command_one_cycle_and_its_delay_later() {
    for delay in [0, 1, 3] {
        let mut drive = switched_on(Model::Ideal, delay);
        let mut seen = Vec::new();
        for k in 1..=10 {
            // Cycle k: inputs, then outputs.
            seen.push(drive.read().count);
            drive.write(output(k * 100, control::ENABLE));
        }
        let late = 1 + delay as usize;
        assert!(seen[..late].iter().all(|&count| count == 0), "delay {delay}: {seen:?}");
        let expected: Vec<i64> = (1..=10 - late as i64).map(|k| k * 100).collect();
        assert_eq!(seen[late..], expected, "delay {delay}");
        assert_eq!(drive.capabilities().delay, delay);
    }
}

#[test]
fn a_fault_is_left_only_by_a_rising_reset_bit() {
    let mut drive = switched_on(Model::Ideal, 0);
    drive.read();
    drive.inject_fault(0x8611);
    let mut state = |word| {
        drive.write(output(0, word));
        let input = drive.read();
        (DriveState::from_status(input.status), input.fault)
    };
    assert_eq!(state(control::ENABLE), (DriveState::Fault, 0x8611));
    assert_eq!(state(control::ENABLE | control::FAULT_RESET).0, DriveState::SwitchOnDisabled);
}

fn law(bandwidth: f64, damping: f64) -> SecondOrder {
    SecondOrder::new(bandwidth, damping, MS).unwrap()
}

/// A second-order system follows a ramp of v with a lag of 2 d / w * v: 2 * 0.8 / (2 pi 60) s * 100000 inc/s = 424.4
/// inc.
#[test]
fn a_ramp_is_followed_with_the_lag_of_its_damping() {
    let law = law(60.0, 0.8);
    let mut state = State::default();
    for k in 1..=1000 {
        law.step(&mut state, k * 100);
    }
    let lag = 100_000 - state.position();
    assert!((424..=425).contains(&lag), "{lag}");
    assert!((state.velocity() - 100_000.0).abs() < 1e-3);
}

/// v' = -v / T: from 20,000 inc/s with T = 100 ms it has 20,000 / e = 7,357.6 inc/s after T, and travels 2,000 inc in
/// all; without a time constant it stops at once, and so it does in quick stop.
#[test]
fn second_order_drive_without_power_coasts_by_its_time_constant() {
    let ramped = |model: Model| {
        let mut drive = switched_on(model, 0);
        for k in 1..=1_000 {
            drive.read();
            drive.write(output(k * 20, control::ENABLE));
        }
        let from = drive.read().count;
        (drive, from)
    };
    let off = |drive: &mut SimDrive, word: u16, cycles: usize| {
        let mut input = crate::drive::DriveInput::default();
        for _ in 0..cycles {
            drive.write(output(20_000, word));
            input = drive.read();
        }
        input
    };
    let coasting = Model::SecondOrder(law(60.0, 0.8).coasting(100_000_000, MS).unwrap());
    let (mut drive, from) = ramped(coasting);
    let after = off(&mut drive, control::DISABLE_VOLTAGE, 100);
    assert!((after.velocity - 7_357.6).abs() < 0.1, "{}", after.velocity);
    let end = off(&mut drive, control::DISABLE_VOLTAGE, 2_000);
    assert!(matches!(end.count - from, 1_999 | 2_000) && end.velocity == 0.0, "{} {}", end.count - from, end.velocity);
    for (model, word) in
        [(Model::SecondOrder(law(60.0, 0.8)), control::DISABLE_VOLTAGE), (coasting, control::QUICK_STOP)]
    {
        let (mut drive, from) = ramped(model);
        let stopped = off(&mut drive, word, 1);
        assert_eq!((stopped.count, stopped.velocity), (from, 0.0));
    }
    let message = law(60.0, 0.8).coasting(-1_000_000, MS).unwrap_err().to_string();
    assert_eq!(message, "coast is -1 ms; 0 ms to 10000 ms is allowed");
}

/// Overshoot of a step: exp(-pi d / sqrt(1 - d^2)) = 16.3 % at d = 0.5. The step rises over one cycle, which at 5 Hz is
/// short.
#[test]
fn an_underdamped_step_overshoots_by_the_book() {
    let law = law(5.0, 0.5);
    let mut state = State::default();
    let highest = (0..500)
        .map(|_| {
            law.step(&mut state, 100_000);
            state.position()
        })
        .max()
        .unwrap();
    assert!((highest - 116_303).abs() < 100, "{highest}");
}

#[test]
fn every_damping_settles_on_the_setpoint_and_stays() {
    for damping in [0.1, 0.999_999, 1.0, 1.000_001, 3.0, 50.0] {
        for bandwidth in [1.0, 60.0, 5_000.0, 100_000.0] {
            let law = law(bandwidth, damping);
            let mut state = State::default();
            for _ in 0..200_000 {
                law.step(&mut state, 1_000);
            }
            assert_eq!(state.position(), 1_000, "damping {damping}, bandwidth {bandwidth}");
        }
    }
}

#[test]
fn invalid_model_is_refused_with_range() {
    let message = |bandwidth, damping| SecondOrder::new(bandwidth, damping, MS).unwrap_err().to_string();
    assert_eq!(message(0.0, 1.0), "bandwidth is 0 Hz; more than 0 Hz up to 100000 Hz is allowed");
    assert_eq!(message(1.0, f64::NAN), "damping is NaN; 0.01 to 100 is allowed");
}
