//! The controller alone, and in the axis.

use super::super::pid::{Gains, Options, Pid};
use super::super::scale;
use super::rig::Rig;
use proptest::prelude::*;

const PLAIN: Options = Options { clamp_sum: false, chip_integral: false };

/// Executes a sample one chip sample after the previous one.
fn sample(pid: &mut Pid, gains: &Gains, options: Options, error: i64) -> i32 {
    pid.step(gains, options, error as f64, 1.0)
}

fn outputs(gains: Gains, options: Options, errors: &[i64]) -> Vec<i32> {
    let mut pid = Pid::default();
    errors.iter().map(|error| sample(&mut pid, &gains, options, *error)).collect()
}

/// Proves: SAIA-PID-01
#[test]
fn the_law_adds_three_parts() {
    let gains = Gains { proportional: 10, integral: 3, derivative: 100, limit: 32_767, interval: 0 };
    // e = 4, 6, 5: sums 4, 10, 15; differences 4, 2, -1.
    let expected = [40 + 12 + 400, 60 + 30 + 200, 50 + 45 - 100];
    assert_eq!(outputs(gains, PLAIN, &[4, 6, 5]), expected);
}

/// Proves: SAIA-PID-02, SAIA-PID-04, SAIA-EXT-05, SAIA-ORA-05, SAIA-DET-15, SAIA-CAP-10, SAIA-REG-02, SAIA-REG-04
#[test]
fn the_derivative_part_is_held_between_its_samples() {
    let gains = Gains { derivative: 1, interval: 2, ..Gains::default() };
    // Each third sample of the ramp 1, 2, 3..: the first difference is from 0.
    assert_eq!(outputs(gains, PLAIN, &[1, 2, 3, 4, 5, 6, 7]), [1, 1, 1, 3, 3, 3, 3]);
    let us = |code: u64| (code + 1) as f64 * 2048.0 / 6.0;
    assert_eq!(us(2), 1024.0);
    assert!((us(15) - 5461.0).abs() < 0.5 && (us(255) - 87_380.0).abs() < 2.0 && (us(0) - 341.33).abs() < 0.005);
}

/// Proves: SAIA-PID-03, SAIA-REG-03
#[test]
fn the_integral_part_is_limited_and_its_sum_is_not() {
    let gains = Gains { integral: 5, limit: 100, ..Gains::default() };
    let errors = [10, 10, 10, -10, -10, -10];
    // Sums 10, 20, 30, 20, 10, 0.
    assert_eq!(outputs(gains, PLAIN, &errors), [50, 100, 100, 100, 50, 0]);
    // With clamp_sum the sum itself stays within 100 / 5.
    let clamped = Options { clamp_sum: true, ..PLAIN };
    assert_eq!(outputs(gains, clamped, &errors), [50, 100, 100, 50, 0, -50]);
}

/// Proves: SAIA-EXT-04
#[test]
fn the_chip_takes_the_top_16_of_24_bits_of_the_sum() {
    let gains = Gains { integral: 5, limit: 32_767, ..Gains::default() };
    let chip = Options { chip_integral: true, ..PLAIN };
    assert_eq!(outputs(gains, chip, &[255, 1, 256]), [0, 5, 10]);
    // The sum is limited to 24 bits, the error to 16.
    let mut pid = Pid::default();
    for _ in 0..1000 {
        sample(&mut pid, &gains, chip, i64::MAX);
        assert!(pid.is_sound());
    }
    assert_eq!(pid.integral(), 32_767);
    // 2^23 - 1 needs 257 samples of -32 768 to change its sign.
    for _ in 0..256 {
        sample(&mut pid, &gains, chip, i64::MIN);
    }
    assert!(pid.integral() < 0);
    let one = Gains { proportional: 1, ..Gains::default() };
    assert_eq!(outputs(one, PLAIN, &[40_000, -40_000]), [32_767, -32_768]);
}

/// Proves: SAIA-PID-05, SAIA-PID-06
#[test]
fn off_means_no_output_and_no_history() {
    let gains = Gains { proportional: 1, integral: 1, derivative: 1, limit: 1000, interval: 5 };
    let mut pid = Pid::default();
    let first = sample(&mut pid, &gains, PLAIN, 50);
    sample(&mut pid, &gains, PLAIN, 70);
    pid.clear();
    assert_eq!((pid.converter_code(1.0, false), pid.integral()), (0, 0));
    assert_eq!(sample(&mut pid, &gains, PLAIN, 50), first);
}

/// Proves: SAIA-EXT-06, SAIA-CAP-11, SAIA-CAP-12
#[test]
fn the_output_is_the_top_12_or_8_bits() {
    let gains = Gains { proportional: 1, ..Gains::default() };
    for (error, analog, pwm) in [(0, 0, 0), (32_767, 2047, 127), (-32_768, -2048, -128), (16, 1, 0), (256, 16, 1)] {
        let mut pid = Pid::default();
        sample(&mut pid, &gains, PLAIN, error);
        assert_eq!((pid.converter_code(1.0, false), pid.converter_code(1.0, true)), (analog, pwm), "{error}");
        assert_eq!(
            pid.converter_code(1e6, false),
            [0, 2047, -2048, 2047, 2047][[0, 32_767, -32_768, 16, 256].iter().position(|e| *e == error).unwrap()]
        );
    }
}

/// An error that rises by 3 counts in each cycle: kd 100 acts on its rise in SampI + 1 samples of 341.333 us, for any
/// cycle time.
///
/// Proves: SAIA-PID-01, SAIA-PID-02, SAIA-SW-01
#[test]
fn the_derivative_part_sees_its_interval_at_every_cycle_length() {
    for cycle_ns in [125_000, 250_000, 341_333, 500_000, 700_000, 1_000_000, 2_000_000, 4_000_000, 20_000_000] {
        for interval in [0, 1, 2, 15] {
            let gains = Gains { derivative: 100, interval, ..Gains::default() };
            let (mut pid, mut rest) = (Pid::default(), 0);
            for cycle in 0..500 {
                let due = (scale::samples(&mut rest, cycle_ns), scale::in_samples(cycle_ns));
                let output = pid.run_cycle(&gains, PLAIN, 3 * cycle, due);
                let expected = 100.0 * 3.0 * f64::from(interval + 1) * (2048.0 / 6e6) / (cycle_ns as f64 * 1e-9);
                // Two intervals of 16 samples in cycles with one sample in three.
                if cycle > 100 {
                    assert!(
                        (f64::from(output) - expected).abs() <= 0.501,
                        "{cycle_ns} {interval}: {output} {expected}"
                    );
                }
            }
        }
    }
}

/// Between two cycles the error is interpolated linearly: from 0 to 90 in three samples it is 30, 60 and 90, whose sum
/// is 180. In the first cycle there is no previous error. A change during a time without samples does not count.
///
/// Proves: SAIA-PID-01, SAIA-SW-01
#[test]
fn error_is_interpolated_linearly_between_cycles() {
    let gains = Gains { integral: 1, limit: 32_767, ..Gains::default() };
    let mut pid = Pid::default();
    let sums = [30, 0, 90].map(|error| {
        pid.run_cycle(&gains, PLAIN, error, (3, 3.0));
        pid.integral()
    });
    assert_eq!(sums, [90, 90 + 20 + 10, 120 + 180]);
    // The proportional term is that of the last sample alone, the derivative term that of its change from 60.
    let gains = Gains { proportional: 2, derivative: 5, ..Gains::default() };
    let mut pid = Pid::default();
    let outputs = [0, 90, 90].map(|error| pid.run_cycle(&gains, PLAIN, error, (3, 3.0)));
    assert_eq!(outputs, [0, 2 * 90 + 5 * 30, 2 * 90]);
    pid.forget_past();
    assert_eq!(pid.run_cycle(&gains, PLAIN, 300, (3, 3.0)), 2 * 300);
    assert!(pid.is_sound());
}

/// 1 ms holds 2.93 samples: 2, 3, 3.. and in a second 2929.
///
/// Proves: SAIA-SW-01
#[test]
fn a_cycle_has_whole_samples_and_keeps_the_rest() {
    let mut rest = 0;
    let first: Vec<u64> = (0..4).map(|_| scale::samples(&mut rest, 1_000_000)).collect();
    assert_eq!(first, [2, 3, 3, 3]);
    let second: u64 = (4..1000).map(|_| scale::samples(&mut rest, 1_000_000)).sum::<u64>() + 11;
    assert_eq!(second, 2929); // 1 s / 341.333 us = 2929.69
}

/// Proves: SAIA-CMD-22, SAIA-REG-18, SAIA-REG-01
#[test]
fn the_integral_part_of_the_axis_is_read_within_its_limit() {
    let set = [("veloc", 50_000.0), ("accel", 1e6), ("kint", 2.0), ("intl", 1000.0), ("destp", 500.0)];
    let mut rig = Rig::ready(&set);
    rig.does(&[], "fldda fstart");
    rig.run_until("x.saia.ondest", 1);
    rig.does(&[], "frdits");
    assert_eq!(rig.int("x.saia.rintts"), 0, "an ideal drive has no error");
    rig.plant.drive(0).unwrap().jump(-100);
    rig.run(4);
    rig.does(&[], "frdits");
    let read = rig.int("x.saia.rintts");
    // 0 to 100 counts in the 2 or 3 samples of one cycle, 100 to 0 in those of the next: 33, 67, 100 and 67, 33, 0, or
    // 50, 100 and 50, 0; times 2.
    assert!(read == 500 || read == 600, "{read}");
    rig.plant.drive(0).unwrap().jump(-1000);
    rig.run(4);
    rig.does(&[], "frdits");
    assert_eq!(rig.int("x.saia.rintts"), 1000);
    rig.does(&[], "fmotoff frdits");
    assert_eq!(rig.int("x.saia.rintts"), 0);
}

proptest! {
    #[test]
    fn any_regulator_stays_within_16_bits_and_sound(
        gains in (0..=32_767, 0..=32_767, 0..=32_767, 0..=32_767, 0..=255),
        options in (any::<bool>(), any::<bool>()),
        errors in prop::collection::vec(prop_oneof![any::<i64>(), -9..9_i64], 1..200),
    ) {
        let (proportional, integral, derivative, limit, interval) = gains;
        let gains = Gains { proportional, integral, derivative, limit, interval };
        let options = Options { clamp_sum: options.0, chip_integral: options.1 };
        let mut pid = Pid::default();
        for error in errors {
            let output = sample(&mut pid, &gains, options, error);
            prop_assert!((-32_768..=32_767).contains(&output));
            prop_assert!(pid.integral().abs() <= limit && pid.is_sound());
        }
    }
}
