use super::*;
use proptest::prelude::*;

mod edges;
mod measured;

/// Cycle time of all tests that name no other (s).
const MS: f64 = 1e-3;

const ALPHA_BETA: VelocityMethod = VelocityMethod::AlphaBeta { bandwidth: 400.0 };
const FILTERED: VelocityMethod = VelocityMethod::Filtered { time: 0.005 };
const VELOCITY: VelocityMethod =
    VelocityMethod::Kalman { model: MotionModel::ConstantVelocity { acceleration: 20_000.0 } };
const ACCELERATION: VelocityMethod = VelocityMethod::Kalman { model: MotionModel::ConstantAcceleration { jerk: 5e6 } };
const METHODS: [VelocityMethod; 5] = [VelocityMethod::Difference, FILTERED, ALPHA_BETA, VELOCITY, ACCELERATION];

fn estimator(method: VelocityMethod) -> VelocityEstimator {
    VelocityEstimator::new(method, MS).unwrap()
}

fn near(actual: f64, expected: f64, tolerance: f64) {
    assert!((actual - expected).abs() <= tolerance, "{actual}, not {expected}");
}

/// 1 - p of the observer of 400 rad/s at 1 ms: 1 - e^(-0.4).
const REST: f64 = 0.329_679_953_964_360_7;

/// Returns the gains of Kalata's solution at an index of acceleration T^2 sqrt(12).
fn kalata(acceleration: f64) -> (f64, f64) {
    let index = acceleration * MS * MS * 12.0_f64.sqrt();
    let r = (4.0 + index - (8.0 * index + index * index).sqrt()) / 4.0;
    (1.0 - r * r, 2.0 * (1.0 - r) * (1.0 - r))
}

/// 2 inc in 1 ms are 2000 inc/s, in 125 us 16000.
#[test]
fn the_difference_is_the_change_by_the_cycle() {
    let mut estimator = estimator(VelocityMethod::Difference);
    assert_eq!([7, 9, 6, 6].map(|position| estimator.step(position)), [0.0, 2000.0, -3000.0, 0.0]);
    let mut fine = VelocityEstimator::new(VelocityMethod::Difference, 0.000_125).unwrap();
    assert_eq!([7, 9].map(|position| fine.step(position)), [0.0, 16_000.0]);
}

/// Rest of a step after one and five time constants with a lag of 5 ms: e^-1, e^-5.
#[test]
fn the_lag_is_that_of_its_time() {
    for cycle in [0.000_125, 0.001, 0.005] {
        let mut estimator = VelocityEstimator::new(FILTERED, cycle).unwrap();
        let per_cycle = libm::round(1e6 * cycle) as i64;
        let count = libm::round(0.005 / cycle) as i64;
        estimator.step(0);
        let velocities: Vec<f64> = (1..=5 * count).map(|k| estimator.step(k * per_cycle)).collect();
        near(velocities[count as usize - 1] / 1e6, 1.0 - 0.367_879_441, 1e-9);
        near(velocities[5 * count as usize - 1] / 1e6, 1.0 - 0.006_737_947, 1e-9);
    }
}

#[test]
fn a_time_of_0_is_no_lag() {
    let (mut plain, mut lag) =
        (estimator(VelocityMethod::Difference), estimator(VelocityMethod::Filtered { time: 0.0 }));
    for position in [5, 8, -100, 1_000_000, 999_999] {
        assert_eq!(plain.step(position), lag.step(position));
    }
}

/// The step response of a double pole: 1 - (n + 1) p^n + n p^(n+1) after n cycles, without overshoot.
#[test]
fn the_observer_answers_a_step_as_its_double_pole_does() {
    let mut estimator = estimator(ALPHA_BETA);
    estimator.step(0);
    let (p, mut power) = (1.0 - REST, 1.0);
    for n in 1..=60 {
        let count = f64::from(n);
        power *= p;
        let expected = 1.0 - (count + 1.0) * power + count * power * p;
        near(estimator.step(1000 * i64::from(n)), 1e6 * expected, 1e-6);
    }
}

proptest! {
    /// The same observer without its position: v(k) = 2 p v(k-1) - p^2 v(k-2) + (1 - p)^2 d(k).
    #[test]
    fn the_observer_is_a_filter_of_the_difference(changes in prop::collection::vec(-5000_i64..5000, 1..80)) {
        let mut estimator = estimator(ALPHA_BETA);
        let (mut position, mut before, mut last) = (123, 0.0, 0.0);
        estimator.step(position);
        for change in changes {
            position += change;
            let velocity = 2.0 * (1.0 - REST) * last - (1.0 - REST) * (1.0 - REST) * before + REST * REST * change as f64;
            (before, last) = (last, velocity);
            prop_assert!((estimator.step(position) / 1000.0 - velocity).abs() < 1e-8);
        }
    }

    /// A Kalman filter of constant velocity is the same observer with Kalata's gains: poles from a + b - 2 and 1 - a.
    #[test]
    fn the_kalman_filter_of_constant_velocity_has_the_gains_of_the_tracking_index(
        acceleration in 1.0..1e7_f64, changes in prop::collection::vec(-5000_i64..5000, 1..80),
    ) {
        let method = VelocityMethod::Kalman { model: MotionModel::ConstantVelocity { acceleration } };
        let mut estimator = estimator(method);
        let (a, b) = kalata(acceleration);
        let (mut position, mut before, mut last) = (0, 0.0, 0.0);
        estimator.step(position);
        for change in changes {
            position += change;
            let velocity = (2.0 - a - b) * last - (1.0 - a) * before + b * change as f64;
            (before, last) = (last, velocity);
            prop_assert!((estimator.step(position) / 1000.0 - velocity).abs() < 1e-6 * 5000.0);
        }
    }
}

/// A velocity of whole increments is found exactly, one between them as the mean of its period.
#[test]
fn a_constant_velocity_has_no_bias() {
    for method in METHODS {
        for velocity in [37_000_i64, -37_000, 1000, 0] {
            let mut estimator = estimator(method);
            let last = (0..2000).fold(0.0, |_, k| estimator.step(k * velocity / 1000));
            near(last, velocity as f64, 1e-6);
        }
        // Tenths of an increment each cycle.
        for tenths in [1_i64, 7, -3, 103] {
            let mut estimator = estimator(method);
            (0..2000).for_each(|k| _ = estimator.step((k * tenths).div_euclid(10)));
            let sum: f64 = (2000..2100).map(|k| estimator.step((k * tenths).div_euclid(10))).sum();
            near(sum / 100.0, tenths as f64 * 100.0, 1e-6);
        }
    }
}

/// x = k^2: 2 inc/cycle^2, which is 2e6 inc/s^2; with a delay the velocity is behind by the acceleration times the
/// delay.
#[test]
fn a_ramp_is_late_by_what_the_method_says() {
    let (a, b) = kalata(20_000.0);
    let late = [0.5, 1.0 / (libm::exp(0.2) - 1.0) + 0.5, (2.0 - REST) / REST - 0.5, a / b - 0.5, 0.0];
    for (method, cycles) in METHODS.into_iter().zip(late) {
        let mut estimator = estimator(method);
        let last = (0..=3000).fold(0.0, |_, k| estimator.step(k * k));
        near((6_000_000.0 - last) / 2e6, cycles * MS, 1e-9);
    }
    assert_eq!(estimator(ALPHA_BETA).acceleration(), 0.0);
}

#[test]
fn constant_acceleration_filter_has_no_bias_at_constant_acceleration() {
    let mut estimator = estimator(ACCELERATION);
    (0..=3000).for_each(|k| _ = estimator.step(-k * k));
    near(estimator.acceleration(), -2e6, 1e-3);
    estimator.restart();
    assert_eq!((estimator.velocity(), estimator.acceleration()), (0.0, 0.0));
}

#[test]
fn a_step_is_reached() {
    for method in METHODS {
        let mut estimator = estimator(method);
        (0..100).for_each(|_| _ = estimator.step(-5));
        let last = (1..=1000).fold(0.0, |_, k| estimator.step(-5 + 250 * k));
        near(last, 250_000.0, 1e-3);
        let last = (1..=1000).fold(0.0, |_, _| estimator.step(249_995));
        near(last, 0.0, 1e-3);
    }
}
