//! Drives with a velocity setpoint.

use super::*;
use crate::drive::{DriveInput, Mode};
use proptest::prelude::*;

fn at(velocity: f64) -> DriveOutput {
    DriveOutput { velocity, control: control::ENABLE, mode: Mode::Speed, ..DriveOutput::default() }
}

/// Returns an enabled drive at rest, after a speed setpoint of 0.
fn ready(model: Model) -> SimDrive {
    let mut drive = SimDrive::new(model, 0, MS);
    for word in [control::SHUTDOWN, control::SWITCH_ON, control::ENABLE] {
        drive.read();
        drive.write(DriveOutput { control: word, ..at(0.0) });
    }
    assert_eq!(DriveState::from_status(drive.read().status), DriveState::Enabled);
    drive
}

/// Returns its inputs after a number of cycles with one output.
fn run(drive: &mut SimDrive, output: DriveOutput, cycles: usize) -> DriveInput {
    let mut input = DriveInput::default();
    for _ in 0..cycles {
        drive.write(output);
        input = drive.read();
    }
    input
}

fn lag(time_constant_ms: i64) -> Model {
    Model::Velocity(VelocityLag::new(time_constant_ms * 1_000_000, MS).unwrap())
}

fn two_speed() -> Model {
    Model::TwoSpeed(TwoSpeed::new(50_000_000, 100_000_000, MS).unwrap())
}

fn valve(time_constant_ms: i64, dead_time_us: i64) -> Model {
    Model::Valve(Valve::new(time_constant_ms * 1_000_000, dead_time_us * 1_000, MS).unwrap())
}

/// 250.5 inc/s are 0.2505 inc per cycle: the count is always the floor of the travel, and after 2000 cycles the total
/// is exact.
#[test]
fn an_ideal_motor_runs_at_once_and_what_is_left_of_a_count_counts_on() {
    let mut drive = ready(Model::Ideal);
    for k in 1..=4_000_i64 {
        let input = run(&mut drive, at(250.5), 1);
        assert_eq!((input.count, input.velocity), (k * 2505 / 10_000, 250.5), "cycle {k}");
    }
    assert_eq!(run(&mut drive, at(-250.5), 4_000).count, 0);
    let stopped = run(&mut drive, at(0.0), 1);
    assert_eq!((stopped.count, stopped.velocity), (0, 0.0));
}

/// v = u (1 - e^(-t/T)): 63.212 % after T = 50 ms, and the travel is u (t - T (1 - e^(-t/T))) = 1839.4 inc; much later
/// it is u (t - T).
///
/// Proves: WF-FCE-01, WF-FCE-02
#[test]
fn a_dc_drive_lags_to_its_voltage() {
    let mut drive = ready(lag(50));
    let input = run(&mut drive, at(100_000.0), 50);
    assert!((input.velocity - 63_212.06).abs() < 0.01, "{}", input.velocity);
    assert_eq!(input.count, 1_839);
    let input = run(&mut drive, at(100_000.0), 1_950);
    assert_eq!((input.velocity, input.count), (100_000.0, 195_000));
    // The deceleration takes the same distance: T u = 5000 inc.
    let input = run(&mut drive, at(0.0), 1_000);
    assert_eq!(input.velocity, 0.0);
    assert!((199_999..=200_000).contains(&input.count), "{}", input.count);
}

/// When selected, both the high and the low speed are reached with 50 ms; switched off it coasts with 100 ms: 0.1 s *
/// 20000 inc/s.
///
/// Proves: WF-FCE-01, WF-FCE-02, WF-OLC-09
#[test]
fn a_pole_changing_motor_coasts_into_its_target() {
    for off in [at(0.0), DriveOutput { control: control::DISABLE_VOLTAGE, ..at(20_000.0) }] {
        let mut drive = ready(two_speed());
        assert_eq!(run(&mut drive, at(100_000.0), 2_000).count, 200_000 - 5_000);
        let low = run(&mut drive, at(20_000.0), 2_000);
        assert_eq!((low.velocity, low.count), (20_000.0, 195_000 + 40_000 + 4_000));
        let first = run(&mut drive, off, 100);
        // 36.788 % are left after 100 ms.
        assert!((first.velocity - 7_357.6).abs() < 0.1, "{}", first.velocity);
        let end = run(&mut drive, off, 1_000);
        assert_eq!(end.velocity, 0.0);
        assert!((end.count - 241_000).abs() <= 1, "{}", end.count);
    }
}

/// 2.5 ms of dead time: without a lag, half of the third cycle runs at full speed.
///
/// Proves: WF-FCE-01, WF-FCE-02
#[test]
fn a_valve_answers_after_its_dead_time_to_the_part_of_a_cycle() {
    let mut drive = ready(valve(0, 2_500));
    let counts: Vec<_> = (0..5).map(|_| run(&mut drive, at(1_000_000.0), 1).count).collect();
    assert_eq!(counts, [0, 0, 500, 1_500, 2_500]);
    let counts: Vec<_> = (0..5).map(|_| run(&mut drive, at(0.0), 1).count).collect();
    assert_eq!(counts, [3_500, 4_500, 5_000, 5_000, 5_000]);

    // With an additional lag of 50 ms: after 100 ms the velocity is that of the lag 0.5 ms before, 100000 e^-2 (e^0.01
    // - 1) lower.
    let mut drive = ready(valve(50, 500));
    let mut other = ready(lag(50));
    let (late, expected) = (run(&mut drive, at(100_000.0), 100), run(&mut other, at(100_000.0), 100));
    assert!((expected.velocity - late.velocity - 136.0).abs() < 1.0, "{}", late.velocity);
    assert!(late.count < expected.count && late.count > expected.count - 50);
    // After 102 ms the position is that of the lag after 100 ms: 100000 (0.1 - 0.05 * 0.864665).
    let mut drive = ready(valve(50, 2_000));
    assert_eq!(run(&mut drive, at(100_000.0), 102).count, 5_676);
}

/// It settles with the lag of its damping: 2 d / w * u = 424.4 inc at 60 Hz and 0.8.
#[test]
fn a_second_order_drive_follows_a_velocity_as_well() {
    let mut drive = ready(Model::SecondOrder(law(60.0, 0.8)));
    let input = run(&mut drive, DriveOutput { mode: Mode::Velocity, ..at(100_000.0) }, 1_000);
    assert_eq!((input.velocity, input.count), (100_000.0, 99_575));
    let input = run(&mut drive, DriveOutput { mode: Mode::Velocity, ..at(0.0) }, 1_000);
    assert_eq!(input.velocity, 0.0);
    assert!((input.count - 100_000).abs() <= 1, "{}", input.count);
}

#[test]
fn each_model_fits_the_interfaces_that_give_it_what_it_takes() {
    use Interface::{OpenLoop, Position, Torque, Velocity};
    let fits = |model: Model| [Position, Velocity, OpenLoop, Torque].map(|interface| model.fits(interface));
    assert_eq!(fits(Model::Ideal), [true, true, true, false]);
    assert_eq!(fits(Model::SecondOrder(law(60.0, 0.8))), [true, true, false, false]);
    assert_eq!(fits(lag(5)), [false, true, true, false]);
    assert_eq!(fits(two_speed()), [false, false, true, false]);
    assert_eq!(fits(valve(5, 5)), [false, false, true, false]);
}

#[test]
fn times_outside_their_ranges_are_refused_with_them() {
    let message = |error: ModelError| error.to_string();
    let lag = |ns| message(VelocityLag::new(ns, MS).unwrap_err());
    assert_eq!(lag(-1_000_000), "time_constant is -1 ms; 0 ms to 10000 ms is allowed");
    assert_eq!(lag(10_000_000_001), "time_constant is 10000.000001 ms; 0 ms to 10000 ms is allowed");
    let coast = message(TwoSpeed::new(0, 10_001_000_000, MS).unwrap_err());
    assert_eq!(coast, "coast is 10001 ms; 0 ms to 10000 ms is allowed");
    let dead = |ns| message(Valve::new(0, ns, MS).unwrap_err());
    assert_eq!(dead(1_000_000_001), "dead_time is 1000.000001 ms; 0 ms to 1000 ms is allowed");
    assert_eq!(dead(i64::MIN).split(';').next_back(), Some(" 0 ms to 1000 ms is allowed"));
    assert!(Valve::new(10_000_000_000, 1_000_000_000, 125_000).is_ok());
}

fn any_model() -> impl Strategy<Value = Model> {
    let ms = 1_000_000_i64;
    prop_oneof![
        Just(Model::Ideal),
        (0..=10_000_i64).prop_map(lag),
        (0..=10_000_i64, 0..=10_000_i64)
            .prop_map(move |(run, coast)| Model::TwoSpeed(TwoSpeed::new(run * ms, coast * ms, MS).unwrap())),
        (0..=10_000_i64, 0..=1_000_000_i64).prop_map(|(constant, dead)| valve(constant, dead)),
        (0.1..1e5_f64, 0.01..100.0_f64).prop_map(|(bandwidth, damping)| Model::SecondOrder(law(bandwidth, damping))),
    ]
}

fn any_setpoint() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1e7..1e7_f64,
        2 => Just(0.0),
        1 => prop::sample::select(&[f64::NAN, f64::INFINITY, f64::MAX, f64::MIN, 5e-324, -0.0][..]),
    ]
}

proptest! {
    /// For any setpoint: the travel in counts is that of the velocities, and no value becomes NaN.
    #[test]
    fn no_setpoint_breaks_a_motor(
        model in any_model(), asked in prop::collection::vec((any_setpoint(), any::<bool>(), 1_usize..50), 1..20),
    ) {
        let mut drive = ready(model);
        for (velocity, on, cycles) in asked {
            let word = if on { control::ENABLE } else { control::DISABLE_VOLTAGE };
            let input = run(&mut drive, DriveOutput { control: word, ..at(velocity) }, cycles);
            prop_assert!(input.velocity.is_finite(), "{}", input.velocity);
        }
    }

    /// A lag never overshoots its setpoint, and the travel is between those of the two speeds.
    #[test]
    fn a_lag_stays_between_its_speeds(
        constant in 0..2_000_i64, setpoints in prop::collection::vec(-1e6..1e6_f64, 1..30),
    ) {
        let mut drive = ready(lag(constant));
        let (mut count, mut velocity) = (0, 0.0_f64);
        for setpoint in setpoints {
            let input = run(&mut drive, at(setpoint), 1);
            let (low, high) = (velocity.min(setpoint), velocity.max(setpoint));
            prop_assert!((low..=high).contains(&input.velocity));
            let way = (input.count - count) as f64;
            prop_assert!(way >= (low * 1e-3).floor() - 1.0 && way <= (high * 1e-3).ceil() + 1.0);
            (count, velocity) = (input.count, input.velocity);
        }
    }
}
