//! Results of each method for the same motions at 1 ms, for the documents.
//!
//! Noise: the position is the floor of a motion at constant velocity; error of the estimate after 2 s, over 10 s.
//! Delay: for a ramp of 2e6 inc/s^2. Rise: time until 90 % of a step of 1e6 inc/s. Overshoot: of that step.

use super::*;

/// Velocities (inc/cycle): one increment in ten cycles, nearly one per cycle, and many with a fraction.
const VELOCITIES: [f64; 3] = [0.1, 0.97, 10.3];

#[derive(Debug)]
struct Row {
    /// Root mean square of the error at each velocity (inc/s).
    noise: [f64; 3],
    /// Delay (ms).
    late: f64,
    /// Rise time (ms).
    rise: f64,
    /// Overshoot (%).
    overshoot: f64,
}

fn noise(method: VelocityMethod, velocity: f64) -> f64 {
    let mut estimator = estimator(method);
    let hundredths = libm::round(velocity * 100.0) as i64;
    let mut sum = 0.0;
    for k in 0..12_000_i64 {
        let error = estimator.step((k * hundredths).div_euclid(100)) - velocity * 1000.0;
        sum += if k < 2000 { 0.0 } else { error * error };
    }
    (sum / 10_000.0).sqrt()
}

fn row(method: VelocityMethod) -> Row {
    let mut ramp = estimator(method);
    let last = (0..=3000).fold(0.0, |_, k| ramp.step(k * k));
    let mut step = estimator(method);
    step.step(0);
    let velocities: Vec<f64> = (1..=3000).map(|k| step.step(1000 * k) / 1e6).collect();
    let rise = velocities.iter().position(|velocity| *velocity >= 0.9).unwrap() + 1;
    let most = velocities.iter().copied().fold(0.0, f64::max);
    Row {
        noise: VELOCITIES.map(|velocity| noise(method, velocity)),
        late: (6_000_000.0 - last) / 2e3,
        rise: rise as f64,
        overshoot: (most - 1.0).max(0.0) * 100.0,
    }
}

/// `cargo test -p lineshaft-core --lib estimator::tests::measured -- --nocapture` prints it.
#[test]
fn table() {
    let more = [
        VelocityMethod::Filtered { time: 0.02 },
        VelocityMethod::AlphaBeta { bandwidth: 100.0 },
        VelocityMethod::Kalman { model: MotionModel::ConstantVelocity { acceleration: 1000.0 } },
        VelocityMethod::Kalman { model: MotionModel::ConstantAcceleration { jerk: 1e5 } },
    ];
    println!("| method | noise at 100, 970, 10300 inc/s (inc/s) | late (ms) | rise (ms) | overshoot (%) |");
    println!("| --- | --- | --- | --- | --- |");
    let plain = row(VelocityMethod::Difference);
    for method in METHODS.into_iter().chain(more) {
        let Row { noise, late, rise, overshoot } = row(method);
        let [slow, one, fast] = noise;
        println!("| {method:?} | {slow:.1}, {one:.1}, {fast:.1} | {late:.2} | {rise} | {overshoot:.1} |");
        let quieter = noise.iter().zip(plain.noise).all(|(noise, plain)| *noise < plain / 2.0);
        assert!(quieter || method == VelocityMethod::Difference, "{method:?}");
    }
}

/// A change of 1 inc in a share f of the cycles, otherwise 0: sqrt(f (1 - f)), and the same for the fraction of 10.3.
#[test]
fn the_noise_of_the_difference_is_that_of_a_coin() {
    let [slow, one, fast] = row(VelocityMethod::Difference).noise;
    near(slow, 300.0, 1e-6);
    near(one, 1000.0 * (0.97_f64 * 0.03).sqrt(), 1e-6);
    near(fast, 1000.0 * (0.3_f64 * 0.7).sqrt(), 1e-6);
}

/// One increment in ten cycles raises the lag by s to s / (1 - q^10), which decreases by q = 1 - s = e^(-1/5) each
/// cycle.
#[test]
fn the_noise_of_the_lag_is_that_of_its_pulses() {
    let q: f64 = libm::exp(-0.2);
    let (high, whole) = ((1.0 - q) / (1.0 - libm::exp(-2.0)), 1.0 - libm::exp(-4.0));
    let mean_square = high * high * whole / (1.0 - q * q) / 10.0;
    near(row(FILTERED).noise[0], 1000.0 * (mean_square - 0.01).sqrt(), 1e-6);
}

/// With the same delay two poles leave less noise than one.
#[test]
fn an_observer_is_quieter_than_the_lag_and_both_than_the_difference() {
    let [plain, lag, observer] = [VelocityMethod::Difference, FILTERED, ALPHA_BETA].map(row);
    near(observer.late, lag.late, 0.6);
    assert!(observer.noise[0] < lag.noise[0] && lag.noise[0] < plain.noise[0]);
    assert_eq!((lag.overshoot, observer.overshoot), (0.0, 0.0));
}
