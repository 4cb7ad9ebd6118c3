//! The gains of a Kalman filter in its steady state.
//!
//! Law      x' = F x + G noise, position = H x + quantization. For constant velocity x is position and velocity,
//!          G = (1/2, 1) times an acceleration; for constant acceleration x also contains that, G = (1/6, 1/2, 1) times
//!          a jerk. Both are held over a cycle and independent from cycle to cycle. Quantization is a variance of 1/12
//!          inc^2.
//!          The gain is P H' / (H P H' + R) with the P for which P = F (P - P H' H P / (H P H' + R)) F' + G G'
//! Reads    the index: effect of the noise on the position relative to the quantization
//! Writes   gains of a track
//! Refuses  an index for which the iteration does not settle: none of the allowed indices
//!
//! The equation is iterated by doubling (Anderson): each step is equivalent to as many steps of the filter as all steps
//! before it together. A slow filter needs a million of its own steps, and twenty of these.

use super::track::Gains;
use nalgebra::SMatrix;

/// Standard deviation of a position that is rounded to whole increments: 1/sqrt(12).
pub(super) const QUANTISATION: f64 = 0.288_675_134_594_812_9;

/// Steps after which the iteration ends in any case; it settles long before.
const STEPS: usize = 60;

/// Returns the gains for a model of constant velocity; `index` is acceleration * T^2 / quantization.
pub(super) fn constant_velocity(index: f64) -> Option<Gains> {
    let ahead = SMatrix::<f64, 2, 2>::new(1.0, 1.0, 0.0, 1.0);
    let [place, velocity] = steady(&ahead, &[0.5 * index, index])?;
    Some(Gains { place, velocity, acceleration: 0.0 })
}

/// Returns the gains for a model of constant acceleration; `index` is jerk * T^3 / quantization.
pub(super) fn constant_acceleration(index: f64) -> Option<Gains> {
    let ahead = SMatrix::<f64, 3, 3>::new(1.0, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0);
    let [place, velocity, acceleration] = steady(&ahead, &[index / 6.0, index / 2.0, index])?;
    Some(Gains { place, velocity, acceleration })
}

/// Returns the gain in the steady state, for a variance of the position of 1.
fn steady<const N: usize>(ahead: &SMatrix<f64, N, N>, noise: &[f64; N]) -> Option<[f64; N]> {
    let noise = SMatrix::<f64, N, 1>::from(*noise);
    let mut step = ahead.transpose();
    let mut seen = SMatrix::<f64, N, N>::zeros();
    *seen.get_mut((0, 0))? = 1.0;
    let mut variance = noise * noise.transpose();
    for _ in 0..STEPS {
        let inverse = (SMatrix::identity() + seen * variance).try_inverse()?;
        let through = inverse * step;
        let next = variance + step.transpose() * variance * through;
        seen += step * inverse * seen * step.transpose();
        step *= through;
        // Both are symmetric; rounding must not make them asymmetric.
        seen = (seen + seen.transpose()) / 2.0;
        let settled = next == variance;
        variance = (next + next.transpose()) / 2.0;
        if settled {
            break;
        }
    }
    let place = *variance.get((0, 0))?;
    Some((variance.column(0) / (place + 1.0)).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    const LEAST: i32 = -40;
    const MOST: i32 = 12;

    /// Returns the allowed indices, four per decade.
    fn indices() -> impl Iterator<Item = f64> {
        (LEAST..=MOST).map(|quarter| libm::exp10(f64::from(quarter) / 4.0))
    }

    fn near(actual: f64, expected: f64, relative: f64) {
        assert!((actual / expected - 1.0).abs() < relative, "{actual:e}, not {expected:e}");
    }

    /// Kalata's solution for the same noise: r = (4 + L - sqrt(8 L + L^2)) / 4, alpha = 1 - r^2, beta = 2
    /// (2 - alpha) - 4 sqrt(1 - alpha), which is 2 (1 - r)^2.
    #[test]
    fn the_gains_of_constant_velocity_are_those_of_the_tracking_index() {
        for index in indices() {
            // r = 4 / (4 + L + sqrt(8 L + L^2)), so that neither r nor 1 - r cancels.
            let root = (8.0 * index + index * index).sqrt();
            let (r, rest) = (4.0 / (4.0 + index + root), (index + root) / (4.0 + index + root));
            let gains = constant_velocity(index).unwrap();
            near(gains.place, rest * (1.0 + r), 1e-11);
            near(gains.velocity, 2.0 * rest * rest, 1e-11);
            assert!(gains.is_sound() && gains.acceleration == 0.0);
        }
    }

    /// As printed, at an index of 1: r = 1/2.
    #[test]
    fn an_index_of_1_has_gains_of_three_quarters_and_one_half() {
        let gains = constant_velocity(1.0).unwrap();
        near(gains.place, 0.75, 1e-14);
        near(gains.velocity, 0.5, 1e-14);
    }

    /// By spectral factorisation: on the unit circle
    /// |closed|^2 / (1 - a) = |z - 1|^6 + index^2 |(z^2 + 4 z + 1) / 6|^2, where `closed` is the characteristic
    /// polynomial of the error of the observer.
    #[test]
    fn the_gains_of_constant_acceleration_factor_the_spectrum() {
        for index in indices() {
            let gains = constant_acceleration(index).unwrap();
            let (a, b, c) = (gains.place, gains.velocity, gains.acceleration);
            for angle in [0.01, 0.1, 0.5, 1.0, 2.0, 3.0, 3.1] {
                let (sin, cos) = libm::sincos(angle);
                let z = Complex::new(cos, sin);
                let m = z - 1.0;
                let closed = m * m * m + m * m * (a + b + c / 2.0) + m * (b + c) + (z + 1.0) * (c / 2.0);
                let moved = (z * z + z * 4.0 + 1.0) / 6.0;
                let spectrum = libm::pow(m.norm_sqr(), 3.0) + index * index * moved.norm_sqr();
                near(closed.norm_sqr() / (1.0 - a), spectrum, 1e-10);
            }
            assert!(gains.is_sound());
        }
    }
}
