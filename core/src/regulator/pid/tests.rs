//! The law with numbers, and properties for all gains and errors.

use super::super::fade::SAMPLES;
use super::*;
use proptest::prelude::*;

/// Gains of a new controller, with KPROP alone.
const NEW: PidGains = PidGains {
    proportional: 30,
    derivative: 0,
    integral: 0,
    limit: 1000,
    limit_time: 0,
    bandwidth: 1000,
    velocity: 0,
    acceleration: 0,
    window: Window { min: 0, max: 0 },
    period_ms: 1,
};

fn at(error: f64) -> PidInput {
    PidInput { error, ..PidInput::default() }
}

/// Returns the outputs for errors, with a sample in each cycle.
fn run<const N: usize>(gains: &PidGains, errors: [f64; N]) -> [f64; N] {
    let mut pid = Pid::default();
    errors.map(|error| pid.step(gains, 1, at(error)))
}

fn assert_near(seen: &[f64], expected: &[f64]) {
    assert_eq!(seen.len(), expected.len());
    let near = seen.iter().zip(expected).all(|(seen, expected)| (seen - expected).abs() < 1e-12);
    assert!(near, "{seen:?} is not {expected:?}");
}

/// Ratios independent of K_OUT: twice the error gives twice the output; KPROP 30 at 2000 inc is the full output here.
///
/// Proves: MACS-REG-01
#[test]
fn the_proportional_part_is_the_error_times_its_gain() {
    assert_near(&run(&NEW, [200.0, 400.0, -400.0, 2000.0]), &[0.1, 0.2, -0.2, 1.0]);
    // The output ends at the full reference.
    assert_near(&run(&NEW, [2500.0, -1e18]), &[1.0, -1.0]);
}

/// e = 0, 100, 100, 60: KDER 600 is 0.01 per increment of change.
///
/// Proves: MACS-REG-01, MACS-REG-02
#[test]
fn the_derivative_part_is_the_change_of_the_error() {
    let gains = PidGains { proportional: 1, derivative: 599, ..NEW };
    let p = |error: f64| error / 60_000.0;
    let d = |change: f64| change * 599.0 / 60_000.0;
    let expected = [0.0, p(100.0) + d(100.0), p(100.0), p(60.0) + d(-40.0)];
    assert_near(&run(&gains, [0.0, 100.0, 100.0, 60.0]), &expected);
    // There is no error before the first one: that is no change.
    assert_near(&run(&gains, [60.0]), &[p(60.0)]);
}

/// Proves: MACS-REG-01, MACS-REG-05
#[test]
fn the_sum_grows_by_each_error_up_to_its_bound_and_comes_back_from_there() {
    let gains = PidGains { proportional: 1, integral: 60, limit: 25, ..NEW };
    let p = 10.0 / 60_000.0;
    let expected = [p + 0.010, p + 0.020, p + 0.025, p + 0.025, -p + 0.015, -p + 0.005, -p - 0.005];
    assert_near(&run(&gains, [10.0, 10.0, 10.0, 10.0, -10.0, -10.0, -10.0]), &expected);
    let none = PidGains { limit: 0, ..gains };
    assert_near(&run(&none, [10.0, 10.0]), &[p, p]);
}

/// Twice the resolution and half the gains give the same loop: here 30 and 15, and the same for the others.
///
/// Proves: MACS-REG-02, MACS-O-21
#[test]
fn a_finer_encoder_takes_smaller_gains() {
    let coarse = PidGains { proportional: 30, derivative: 100, integral: 10, limit: 500, ..NEW };
    let fine = PidGains { proportional: 15, derivative: 50, integral: 5, limit: 1000, ..NEW };
    let errors = [3.0, 40.0, -7.0, 100.0, 100.0, 55.0];
    assert_near(&run(&coarse, errors), &run(&fine, errors.map(|error| error * 2.0)));
}

/// A steadily increasing error, sampled every ms and every 2 ms: KDER 100 and 50 give the same derivative part, KINT 10
/// and 20 the same mean integral part, KPROP does not change.
///
/// Proves: MACS-REG-02, MACS-REG-04, MACS-O-21
#[test]
fn a_longer_period_takes_half_the_derivative_and_twice_the_integral() {
    let ramp = |ms: u32| f64::from(ms) * 4.0;
    let fast = PidGains { derivative: 100, ..NEW };
    let slow = PidGains { derivative: 50, period_ms: 2, ..NEW };
    let (mut one, mut two) = (Pid::default(), Pid::default());
    for ms in 0..20 {
        let every_ms = one.step(&fast, 1, at(ramp(ms)));
        if ms % 2 == 0 {
            let every_other = two.step(&slow, 1, at(ramp(ms)));
            assert!((every_ms - every_other).abs() < 1e-12 || ms == 0, "{ms}: {every_ms} {every_other}");
        }
    }
    let (fast, slow) = (PidGains { integral: 10, ..NEW }, PidGains { integral: 20, period_ms: 2, ..NEW });
    let (mut one, mut two) = (Pid::default(), Pid::default());
    for ms in 0..40_u32 {
        let (every_ms, every_other) = (one.step(&fast, 1, at(5.0)), two.step(&slow, 2, at(5.0)));
        if ms % 2 == 1 {
            assert!((every_ms - every_other).abs() < 1e-12, "{ms}: {every_ms} {every_other}");
        }
    }
}

/// Proves: MACS-REG-04
#[test]
fn inputs_between_samples_are_ignored() {
    let mut pid = Pid::default();
    let gains = PidGains { period_ms: 4, ..NEW };
    let seen = [100.0, 900.0, -900.0, f64::NAN, 200.0, 0.0].map(|error| pid.step(&gains, 4, at(error)));
    assert_near(&seen, &[0.05, 0.05, 0.05, 0.05, 0.1, 0.1]);
}

/// In motion the bound rises by a quarter of 40 per sample; at rest it falls, and limits the sum.
///
/// Proves: MACS-REG-06, MACS-REG-07
#[test]
fn the_sum_is_clamped_with_a_bound_that_falls() {
    let gains = PidGains { integral: 1, limit: 40, limit_time: 4, ..NEW };
    let mut pid = Pid::default();
    let step = |pid: &mut Pid, moves: bool| {
        pid.step(&gains, 1, PidInput { velocity: f64::from(u8::from(moves)) / 2.0, ..at(100.0) });
        pid.sum()
    };
    let up = [false, true, true, true, true, true].map(|moves| step(&mut pid, moves));
    assert_near(&up, &[0.0, 10.0, 20.0, 30.0, 40.0, 40.0]);
    let down = [false; 5].map(|moves| step(&mut pid, moves));
    assert_near(&down, &[30.0, 20.0, 10.0, 0.0, 0.0]);
    let at_rest = PidGains { limit_time: -4, ..gains };
    let mut pid = Pid::default();
    pid.step(&at_rest, 1, at(100.0));
    assert_eq!(pid.sum(), 40.0);
    pid.step(&at_rest, 1, PidInput { velocity: 0.5, ..at(100.0) });
    assert_eq!(pid.sum(), 30.0);
}

/// The loop is limited to half of the output; the feed-forward is added to it.
///
/// Proves: MACS-REG-08, MACS-REG-09
#[test]
fn the_bandwidth_bounds_the_loop_and_not_the_feed_forward() {
    let gains = PidGains { bandwidth: 500, velocity: 1000, ..NEW };
    let mut pid = Pid::default();
    let seen = [(2000.0, 0.0), (2000.0, 0.3), (2000.0, 0.9), (-2000.0, 0.9)]
        .map(|(error, velocity)| pid.step(&gains, 1, PidInput { velocity, ..at(error) }));
    assert_near(&seen, &[0.5, 0.8, 1.0, 0.4]);
    let closed = PidGains { bandwidth: 0, ..gains };
    assert_near(&run(&closed, [2000.0]), &[0.0]);
}

/// A drive with 4000 rpm at 10 V, VELMAX 3000: FFVEL 750, and 0.5 VELMAX are 3.75 V.
///
/// Proves: MACS-REG-09, MACS-REG-10
#[test]
fn feed_forward_is_a_share_of_the_command() {
    let gains = PidGains { velocity: 1000 * 3000 / 4000, ..NEW };
    let mut pid = Pid::default();
    let output = pid.step(&gains, 1, PidInput { velocity: 0.5, ..at(0.0) });
    assert_near(&[10.0 * output], &[3.75]);
    let gains = PidGains { acceleration: 200, ..NEW };
    let input = PidInput { acceleration: -1.0, ..at(0.0) };
    assert_near(&[Pid::default().step(&gains, 1, input), Pid::default().step(&NEW, 1, input)], &[-0.2, 0.0]);
}

/// Proves: MACS-REG-11
#[test]
fn inside_the_window_the_loop_is_off_its_sum_is_cleared_and_feed_forward_stays() {
    let gains = PidGains { integral: 60, velocity: 1000, window: Window { min: 5, max: 20 }, ..NEW };
    let mut pid = Pid::default();
    let step = |pid: &mut Pid, error: f64| pid.step(&gains, 1, PidInput { velocity: 0.25, ..at(error) });
    assert!(step(&mut pid, 21.0) > 0.25 && pid.sum() == 21.0);
    assert_eq!((step(&mut pid, 4.0), pid.sum(), pid.is_out()), (0.25, 0.0, true));
    assert_eq!((step(&mut pid, 20.0), pid.sum()), (0.25, 0.0));
    assert!(step(&mut pid, 21.0) > 0.25 && !pid.is_out());
}

fn gains() -> impl Strategy<Value = PidGains> {
    let k = 0..=65_000_i64;
    let window = (0..100_i64, 0..100_i64).prop_map(|(min, max)| Window { min, max });
    let forward = 0..=100_000_i64;
    (
        (1..=65_000_i64, k.clone(), k.clone(), k),
        (-32_767..=32_767_i64, 0..=1000_i64, forward.clone(), forward, window, 1..=1000_i64),
    )
        .prop_map(
            |((proportional, derivative, integral, limit), (time, bandwidth, velocity, acceleration, window, ms))| {
                PidGains {
                    proportional,
                    derivative,
                    integral,
                    limit,
                    limit_time: time,
                    bandwidth,
                    velocity,
                    acceleration,
                    window,
                    period_ms: ms,
                }
            },
        )
}

fn input() -> impl Strategy<Value = PidInput> {
    let any = || prop_oneof![-5e3..5e3_f64, -1e19..1e19_f64, Just(f64::NAN), Just(f64::INFINITY)];
    (any(), any(), any()).prop_map(|(error, velocity, acceleration)| PidInput { error, velocity, acceleration })
}

proptest! {
    #[test]
    fn output_and_state_stay_sound_for_any_input(
        steps in prop::collection::vec((gains(), 1..8_u32, input()), 1..60),
    ) {
        let mut pid = Pid::default();
        for (gains, cycles, input) in steps {
            let output = pid.step(&gains, cycles, input);
            prop_assert!(output.abs() <= 1.0, "{}", output);
            prop_assert!(pid.is_sound(), "{:?}", pid);
        }
    }

    /// Opposite errors give opposite outputs.
    #[test]
    fn opposite_errors_give_opposite_outputs(gains in gains(), errors in prop::collection::vec(-3000.0..3000.0_f64, 1..40)) {
        let (mut one, mut other) = (Pid::default(), Pid::default());
        for error in errors {
            let (a, b) = (one.step(&gains, 1, at(error)), other.step(&gains, 1, at(-error)));
            prop_assert_eq!(a, -b);
        }
    }

    /// At constant error new gains cause no step: the first sample with them is equal to the last one without, and each
    /// of the following ones changes by at most the 64th part of the fading rest, apart from the sum that grows.
    #[test]
    fn new_gains_cause_no_step(old in gains(), new in gains(), error in -3000.0..3000.0_f64) {
        let still = |gains: PidGains| PidGains { integral: 0, limit_time: 0, period_ms: 1, ..gains };
        let (old, new) = (still(old), still(new));
        let mut pid = Pid::default();
        let before = (0..3).map(|_| pid.step(&old, 1, at(error))).last().unwrap_or_default();
        let outputs: Vec<_> = (0..=SAMPLES).map(|_| pid.step(&new, 1, at(error))).collect();
        let settled = Pid { before: Some(error), is_out: pid.is_out, ..Pid::default() }.step(&new, 1, at(error));
        let mut last = before;
        for (sample, output) in outputs.iter().enumerate() {
            let most = (settled - before).abs() / f64::from(SAMPLES) + 1e-12;
            prop_assert!((output - last).abs() <= most, "sample {}: {} after {}", sample, output, last);
            last = *output;
        }
        prop_assert!((outputs[0] - before).abs() < 1e-12);
        prop_assert!((last - settled).abs() < 1e-12, "{} is not {}", last, settled);
    }
}
