//! Discrete-time linear systems.
//!
//! Law      x(k+1) = A x(k) + B u(k), y(k) = C x(k) + D u(k). A continuous system with a hold and a delay is converted
//!          exactly
//! Reads    continuous systems, velocity estimators of the core
//! Writes   matrices, frequency responses, poles
//! Refuses  nothing: a model is checked before

use crate::model::{Continuous, Model};
use lineshaft_core::regulator::{EstimatorError, VelocityEstimator, VelocityMethod};
use nalgebra::{Complex, DMatrix, DVector, RowDVector, SVD, Schur};

pub(crate) type C64 = Complex<f64>;

/// A system with one input and one output.
#[derive(Clone, Debug)]
pub(crate) struct Discrete {
    pub(crate) a: DMatrix<f64>,
    pub(crate) b: DVector<f64>,
    pub(crate) c: RowDVector<f64>,
    pub(crate) d: f64,
}

/// Returns e^(A t) and the integral of e^(A s) B over t.
pub(crate) fn held(system: &Continuous, t: f64) -> (DMatrix<f64>, DVector<f64>) {
    let n = system.a.nrows();
    let mut whole = DMatrix::zeros(n + 1, n + 1);
    whole.view_mut((0, 0), (n, n)).copy_from(&(&system.a * t));
    whole.view_mut((0, n), (n, 1)).copy_from(&(&system.b * t));
    let whole = exponential(&whole);
    (
        whole.view((0, 0), (n, n)).into_owned(),
        DVector::from_column_slice(whole.view((0, n), (n, 1)).into_owned().as_slice()),
    )
}

/// Returns the matrix exponential, by the series of a scaled matrix and repeated squaring.
fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    // B may be large relative to A and converges as A does: it is in each term once.
    let size = matrix.view((0, 0), (n - 1, n - 1)).iter().fold(0.0_f64, |most, x| most.max(x.abs())) * n as f64;
    let mut halvings = 0_u32;
    let mut scale = 1.0;
    while size * scale > 0.25 && halvings < 200 {
        scale *= 0.5;
        halvings += 1;
    }
    let small = matrix * scale;
    let mut sum = DMatrix::identity(n, n);
    let mut term = DMatrix::identity(n, n);
    for order in 1..=16 {
        term = &term * &small / f64::from(order);
        sum += &term;
    }
    for _ in 0..halvings {
        sum = &sum * &sum;
    }
    sum
}

/// A continuous system with a hold of `period` and a `delay`, advanced by one sample.
pub(crate) struct Delayed {
    pub(crate) a: DMatrix<f64>,
    /// Effect of the input `lag` samples ago.
    pub(crate) newer: DVector<f64>,
    /// Effect of the input one sample before that.
    pub(crate) older: DVector<f64>,
    pub(crate) lag: usize,
}

impl Delayed {
    pub(crate) fn of(system: &Continuous, period: f64, delay: f64) -> Self {
        // A value slightly below a whole number of periods counts as that number.
        let lag = (delay / period + 1e-9).floor().max(0.0);
        let late = (delay - lag * period).max(0.0);
        let (rest, newer) = held(system, period - late);
        let (first, older) = held(system, late);
        Self { a: &rest * first, newer, older: rest * older, lag: lag as usize }
    }

    /// Returns the first state at each sample, from rest; `inputs` may be of any length.
    pub(crate) fn response(&self, inputs: &[f64]) -> Vec<f64> {
        let past = |k: usize, back: usize| k.checked_sub(back).and_then(|at| inputs.get(at)).copied().unwrap_or(0.0);
        let mut x: DVector<f64> = DVector::zeros(self.a.nrows());
        let mut next = x.clone();
        let mut positions = Vec::with_capacity(inputs.len());
        for k in 0..inputs.len() {
            positions.push(x[0]);
            next.gemv(1.0, &self.a, &x, 0.0);
            next.axpy(past(k, self.lag), &self.newer, 1.0);
            next.axpy(past(k, self.lag + 1), &self.older, 1.0);
            core::mem::swap(&mut x, &mut next);
        }
        positions
    }
}

impl Discrete {
    /// Returns an axis from command to position, sampled each cycle.
    pub(crate) fn of(model: &Model) -> Self {
        let parts = Delayed::of(&model.continuous(), model.cycle, model.delay);
        let (n, past) = (parts.a.nrows(), parts.lag + 1);
        let size = n + past;
        // The states of the axis are followed by the inputs of previous samples, the last one first.
        let mut a = DMatrix::zeros(size, size);
        a.view_mut((0, 0), (n, n)).copy_from(&parts.a);
        let mut b = DVector::zeros(size);
        for back in 1..past {
            a[(n + back, n + back - 1)] = 1.0;
        }
        b[n] = 1.0;
        a.view_mut((0, n + parts.lag), (n, 1)).copy_from(&parts.older);
        match parts.lag.checked_sub(1) {
            None => b.rows_mut(0, n).copy_from(&parts.newer),
            Some(back) => {
                let column = a.view((0, n + back), (n, 1)) + &parts.newer;
                a.view_mut((0, n + back), (n, 1)).copy_from(&column);
            }
        }
        let mut c = RowDVector::zeros(size);
        c[0] = 1.0;
        Self { a, b, c, d: 0.0 }
    }

    /// Returns an estimator from position to velocity, found from its impulse response.
    ///
    /// # Errors
    /// Settings for which the core has no estimator.
    pub(crate) fn estimator(method: VelocityMethod, cycle: f64) -> Result<Self, EstimatorError> {
        const SIZE: i64 = 1 << 40;
        let mut estimator = VelocityEstimator::new(method, cycle)?;
        estimator.step(0);
        let answers: Vec<f64> = (0..40).map(|k| estimator.step(if k == 0 { SIZE } else { 0 }) / SIZE as f64).collect();
        let (d, tail) = (answers[0], &answers[1..]);
        // Observers of the core have at most three states.
        (1..=3).find_map(|order| from_impulse_response(d, tail, order)).ok_or(EstimatorError::Unsettled {
            name: "cycle",
            value: cycle,
            unit: "s",
        })
    }

    /// Combines `count` samples to one, with the input held.
    pub(crate) fn held_for(&self, count: u32) -> Self {
        let (mut a, mut b) = (self.a.clone(), self.b.clone());
        for _ in 1..count {
            b = &self.a * b + &self.b;
            a = &self.a * a;
        }
        Self { a, b, c: self.c.clone(), d: self.d }
    }

    /// Connects the output of this system to the input of the next one.
    pub(crate) fn connect(&self, next: &Self) -> Self {
        let (n, m) = (self.a.nrows(), next.a.nrows());
        let mut a = DMatrix::zeros(n + m, n + m);
        a.view_mut((0, 0), (n, n)).copy_from(&self.a);
        a.view_mut((n, n), (m, m)).copy_from(&next.a);
        a.view_mut((n, 0), (m, n)).copy_from(&(&next.b * &self.c));
        let mut b = DVector::zeros(n + m);
        b.rows_mut(0, n).copy_from(&self.b);
        b.rows_mut(n, m).copy_from(&(&next.b * self.d));
        let mut c = RowDVector::zeros(n + m);
        c.columns_mut(0, n).copy_from(&(&self.c * next.d));
        c.columns_mut(n, m).copy_from(&next.c);
        Self { a, b, c, d: self.d * next.d }
    }

    /// Returns the system with its output multiplied by a factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { c: &self.c * factor, d: self.d * factor, ..self.clone() }
    }

    /// Returns the state matrix of the closed loop of this chain, which must have no direct feedthrough.
    pub(crate) fn closed(&self) -> DMatrix<f64> {
        &self.a - &self.b * &self.c
    }

    /// Returns C (zI - A)^-1 B + D.
    pub(crate) fn at(&self, z: C64) -> C64 {
        let n = self.a.nrows();
        if n == 0 {
            return C64::new(self.d, 0.0);
        }
        let matrix = DMatrix::from_fn(n, n, |i, j| {
            let own = C64::new(-self.a[(i, j)], 0.0);
            if i == j { own + z } else { own }
        });
        let b = self.b.map(|x| C64::new(x, 0.0));
        match matrix.lu().solve(&b) {
            Some(x) => (0..n).fold(C64::new(self.d, 0.0), |sum, i| sum + x[i] * self.c[i]),
            None => C64::new(f64::INFINITY, 0.0),
        }
    }
}

/// Returns the system of this order with these impulse responses, to eight digits.
fn from_impulse_response(d: f64, tail: &[f64], order: usize) -> Option<Discrete> {
    let rows = tail.len() - order;
    let hankel = DMatrix::from_fn(rows, order, |i, j| tail[i + j]);
    let next = DVector::from_fn(rows, |i, _| tail[i + order]);
    let size = tail.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let svd = SVD::try_new(hankel.clone(), true, true, f64::EPSILON, 10_000)?;
    let taps = svd.solve(&next, size * 1e-13).ok()?;
    if (&hankel * &taps - &next).amax() > 1e-8 * size {
        return None;
    }
    let mut a = DMatrix::zeros(order, order);
    for i in 1..order {
        a[(i - 1, i)] = 1.0;
    }
    a.row_mut(order - 1).copy_from(&taps.transpose());
    let mut c = RowDVector::zeros(order);
    c[0] = 1.0;
    Some(Discrete { a, b: DVector::from_column_slice(&tail[..order]), c, d })
}

/// Returns the eigenvalues; none if they are not found.
pub(crate) fn poles(a: &DMatrix<f64>) -> Vec<C64> {
    let schur = Schur::try_new(a.clone(), 1e-14, 10_000);
    schur.map_or_else(Vec::new, |schur| schur.complex_eigenvalues().iter().copied().collect())
}

/// Returns the largest magnitude of an eigenvalue; infinite if none is found.
pub(crate) fn radius(a: &DMatrix<f64>) -> f64 {
    let poles = poles(a);
    if poles.is_empty() { f64::INFINITY } else { poles.iter().fold(0.0_f64, |most, &x| most.max(magnitude(x))) }
}

/// Returns the magnitude.
pub(crate) fn magnitude(x: C64) -> f64 {
    (x.re * x.re + x.im * x.im).sqrt()
}

/// Returns the point of an angle on the unit circle.
pub(crate) fn unit_circle(angle: f64) -> C64 {
    C64::new(libm::cos(angle), libm::sin(angle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Dynamics, first_order, second_order};
    use lineshaft_core::regulator::MotionModel;

    #[test]
    fn a_lag_is_held_exactly() {
        for (rate, t) in [(0.0, 0.01), (1.0, 0.001), (200.0, 0.001), (1e5, 0.001)] {
            let (a, b) = held(&first_order(3.0, rate), t);
            let fading = libm::exp(-rate * t);
            let way = if rate == 0.0 { t } else { (1.0 - fading) / rate };
            let far = if rate == 0.0 { 1.5 * t * t } else { 3.0 * (t - way) / rate };
            for (value, expected) in [(a[(0, 1)], way), (a[(1, 1)], fading), (b[0], far), (b[1], 3.0 * way)] {
                assert!((value - expected).abs() <= 1e-9 * expected.abs() + 1e-15, "{rate}: {value} {expected}");
            }
        }
    }

    #[test]
    fn a_swing_is_held_exactly() {
        let (omega, t) = (400.0, 0.001);
        let (a, b) = held(&second_order(omega, 0.0), t);
        let (sine, cosine) = (libm::sin(omega * t), libm::cos(omega * t));
        for (value, expected) in [
            (a[(0, 0)], cosine),
            (a[(0, 1)], sine / omega),
            (a[(1, 0)], -omega * sine),
            (b[0], (1.0 - cosine) / omega / omega),
        ] {
            assert!((value - expected).abs() < 1e-12 * omega, "{value} {expected}");
        }
    }

    /// A ramp of the position begins one delay after the step, for any fraction of a cycle.
    #[test]
    fn a_delay_shifts_what_follows() {
        let integrator = Continuous { a: DMatrix::zeros(1, 1), b: DVector::from_vec(vec![1.0]) };
        for delay in [0.0, 0.3, 1.0, 1.75, 4.0] {
            let way = Delayed::of(&integrator, 1.0, delay).response(&[1.0; 10]);
            for (k, place) in way.iter().enumerate() {
                let expected = (k as f64 - delay).max(0.0);
                assert!((place - expected).abs() < 1e-12, "{delay} {k}: {place}");
            }
        }
    }

    /// The states of past inputs have the effect of the delay.
    #[test]
    fn a_system_with_its_past_answers_as_its_parts_do() {
        for delay in [0.0, 0.0004, 0.001, 0.0023, 0.005] {
            let dynamics = Dynamics::Velocity { gain: 100.0, time_constant: 0.004, offset: 0.0 };
            let model = Model { cycle: 0.001, delay, dynamics };
            let inputs: Vec<f64> = (0..40).map(|k| if k % 7 < 3 { 1.0 } else { -0.5 }).collect();
            let expected = Delayed::of(&model.continuous(), 0.001, delay).response(&inputs);
            let system = Discrete::of(&model);
            let mut x = DVector::zeros(system.a.nrows());
            for (input, expected) in inputs.iter().zip(expected) {
                let y = (&system.c * &x)[0];
                assert!((y - expected).abs() < 1e-12, "{delay}: {y} {expected}");
                x = &system.a * x + &system.b * *input;
            }
        }
    }

    /// Each estimator of the core, as a system of its least order: both agree on a long zigzag.
    #[test]
    fn an_estimator_is_what_the_core_makes_of_it() {
        let methods = [
            (VelocityMethod::Difference, 1),
            (VelocityMethod::Filtered { time: 0.004 }, 2),
            (VelocityMethod::AlphaBeta { bandwidth: 300.0 }, 2),
            (VelocityMethod::Kalman { model: MotionModel::ConstantVelocity { acceleration: 1e6 } }, 2),
            (VelocityMethod::Kalman { model: MotionModel::ConstantAcceleration { jerk: 1e9 } }, 3),
        ];
        for (method, most) in methods {
            let system = Discrete::estimator(method, 0.001).unwrap();
            assert!(system.a.nrows() <= most, "{method:?}: {}", system.a.nrows());
            let mut estimator = VelocityEstimator::new(method, 0.001).unwrap();
            let mut x = DVector::zeros(system.a.nrows());
            let mut largest = 0.0_f64;
            for k in 0..500_i64 {
                let position = (k * k * 37) % 1009 * i64::from(k > 0);
                let expected = estimator.step(position);
                let y = (&system.c * &x)[0] + system.d * position as f64;
                largest = largest.max(expected.abs());
                assert!((y - expected).abs() < 1e-5 * largest + 1e-9, "{method:?} {k}: {y} {expected}");
                x = &system.a * x + &system.b * position as f64;
            }
        }
    }

    /// The response at a frequency is the ratio of output and input.
    #[test]
    fn a_response_is_that_of_a_long_sinusoid() {
        let system = Discrete {
            a: DMatrix::from_row_slice(1, 1, &[0.8]),
            b: DVector::from_vec(vec![0.3]),
            c: RowDVector::from_vec(vec![2.0]),
            d: 0.1,
        };
        // 0.1 + 0.6 / (z - 0.8) at z = i.
        let at = system.at(unit_circle(core::f64::consts::FRAC_PI_2));
        let expected = C64::new(0.1, 0.0) + C64::new(0.6, 0.0) / C64::new(-0.8, 1.0);
        assert!(magnitude(at - expected) < 1e-12, "{at}");
        let held = system.held_for(3);
        assert!((held.a[(0, 0)] - 0.512).abs() < 1e-12);
        assert!((held.b[0] - 0.3 * (1.0 + 0.8 + 0.64)).abs() < 1e-12);
    }
}
