//! Least squares on stretches of a record.
//!
//! Law      in each stretch, the effect of an unknown initial state (a constant; with friction a constant velocity;
//!          with a resonance a decaying oscillation) is removed from the measured positions and from each column; the
//!          sum of squares of the residual over all stretches is minimized
//! Reads    measured positions, columns: the effect of a unit of each figure
//! Writes   figures, their covariance, the explained variance
//! Refuses  nothing: a column without information gets the weight 0

use core::ops::Range;
use nalgebra::{DMatrix, DVector, SVD};
use std::collections::{BTreeMap, BTreeSet};

/// Maximum iterations of the singular value decomposition.
const ROUNDS: usize = 10_000;

/// Unknown initial state of a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum InitialState {
    /// A position.
    Place,
    /// A position and a velocity.
    Motion,
    /// Both, and an oscillation: its frequency (rad per cycle), its damping relative to the critical one.
    Oscillation(f64, f64),
}

/// Stretches of a record.
pub(crate) struct Stretches {
    ranges: Vec<Range<usize>>,
    /// For each length of a stretch: orthonormal basis of the effects of its initial state.
    bases: BTreeMap<usize, Vec<Vec<f64>>>,
    measured: Vec<f64>,
}

impl InitialState {
    /// Returns an orthonormal basis.
    fn basis(self, length: usize) -> Vec<Vec<f64>> {
        let of = |law: &dyn Fn(f64) -> f64| (0..length).map(|k| law(k as f64)).collect::<Vec<f64>>();
        let mut laws = vec![of(&|_| 1.0)];
        if self != Self::Place {
            laws.push(of(&|k| k - 0.5 * length as f64));
        }
        if let Self::Oscillation(omega, damping) = self {
            let swings = omega * (1.0 - damping * damping).max(0.0).sqrt();
            laws.push(of(&|k| libm::exp(-damping * omega * k) * libm::cos(swings * k)));
            laws.push(of(&|k| libm::exp(-damping * omega * k) * libm::sin(swings * k)));
        }
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for mut law in laws {
            let whole = product(&law, &law);
            take_out(&mut law, &basis);
            let left = product(&law, &law);
            // A function that depends on the previous ones is omitted.
            if left > 1e-12 * whole {
                let size = left.sqrt();
                law.iter_mut().for_each(|x| *x /= size);
                basis.push(law);
            }
        }
        basis
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn take_out(part: &mut [f64], basis: &[Vec<f64>]) {
    for law in basis {
        let share = product(part, law);
        part.iter_mut().zip(law).for_each(|(x, law)| *x -= share * law);
    }
}

/// Figures that explain the measured positions best.
pub(crate) struct Fit {
    /// One figure for each column.
    pub(crate) figures: Vec<f64>,
    /// Residual sum of squares (inc^2).
    pub(crate) residual_squares: f64,
    /// Residual of each sample (inc).
    pub(crate) residual: DVector<f64>,
}

impl Stretches {
    pub(crate) fn new(ranges: Vec<Range<usize>>, beginning: InitialState, positions: &[f64]) -> Self {
        let lengths: BTreeSet<usize> = ranges.iter().map(Range::len).collect();
        let bases = lengths.into_iter().map(|length| (length, beginning.basis(length))).collect();
        let mut stretches = Self { ranges, bases, measured: Vec::new() };
        stretches.measured = stretches.reduced(positions);
        stretches
    }

    /// Returns the same stretches with another type of initial state.
    pub(crate) fn beginning_with(&self, beginning: InitialState, positions: &[f64]) -> Self {
        Self::new(self.ranges.clone(), beginning, positions)
    }

    /// Returns the number of samples in all of them.
    pub(crate) fn len(&self) -> usize {
        self.measured.len()
    }

    /// Returns the sum of squares to explain (inc^2).
    pub(crate) fn whole(&self) -> f64 {
        self.measured.iter().map(|x| x * x).sum()
    }

    /// Returns a column without the effects of the initial states.
    pub(crate) fn reduced(&self, column: &[f64]) -> Vec<f64> {
        let mut all = Vec::with_capacity(column.len());
        for range in &self.ranges {
            let from = all.len();
            all.extend_from_slice(column.get(range.clone()).unwrap_or_default());
            if let (Some(part), Some(basis)) = (all.get_mut(from..), self.bases.get(&range.len())) {
                // The mean first: values far from 0 would cause rounding errors.
                let mean = part.iter().sum::<f64>() / part.len().max(1) as f64;
                part.iter_mut().for_each(|x| *x -= mean);
                take_out(part, basis);
            }
        }
        all
    }

    /// Fits reduced columns.
    pub(crate) fn fit(&self, columns: &[Vec<f64>]) -> Fit {
        let measured = DVector::from_column_slice(&self.measured);
        let (matrix, sizes) = scaled(columns, self.len());
        let n = columns.len();
        let qr = matrix.clone().qr();
        let (r, mut turned) = (qr.r(), measured.clone());
        qr.q_tr_mul(&mut turned);
        let solved = SVD::try_new(r, true, true, f64::EPSILON, ROUNDS).and_then(|svd| {
            let most = svd.singular_values.iter().fold(0.0_f64, |most, &x| most.max(x));
            svd.solve(&turned.rows(0, n).into_owned(), most * 1e-10).ok()
        });
        let solved = solved.unwrap_or_else(|| DVector::zeros(n));
        let residual = measured - matrix * &solved;
        let figures = solved.iter().zip(&sizes).map(|(x, size)| x / size).collect();
        Fit { figures, residual_squares: residual.norm_squared(), residual }
    }

    /// Returns the standard deviation of each figure from its column, with the residual of `fit`.
    pub(crate) fn deviations(&self, columns: &[Vec<f64>], fit: &Fit) -> Vec<f64> {
        let (matrix, sizes) = scaled(columns, self.len());
        let unknown = vec![f64::INFINITY; sizes.len()];
        let Some(svd) = SVD::try_new(matrix.qr().r(), false, true, f64::EPSILON, ROUNDS) else { return unknown };
        let most = svd.singular_values.iter().fold(0.0_f64, |most, &x| most.max(x));
        let parts: f64 = self.ranges.iter().map(|range| self.bases.get(&range.len()).map_or(0, Vec::len) as f64).sum();
        let freedom = (self.len() as f64 - columns.len() as f64 - parts).max(1.0);
        // Residuals of neighbours are correlated, so that they contain less information than independent ones.
        let r = &fit.residual;
        let next: f64 = r.iter().zip(r.iter().skip(1)).map(|(a, b)| a * b).sum();
        let likeness = if fit.residual_squares > 0.0 { (next / fit.residual_squares).clamp(0.0, 0.99) } else { 0.0 };
        let variance = fit.residual_squares / freedom * (1.0 + likeness) / (1.0 - likeness);
        let Some(v_t) = svd.v_t else { return unknown };
        let of = |column: usize| {
            svd.singular_values.iter().enumerate().fold(0.0, |sum, (i, &s)| {
                let part = v_t[(i, column)] / s.max(most * 1e-10);
                sum + part * part
            })
        };
        sizes.iter().enumerate().map(|(column, size)| (variance * of(column)).sqrt() / size).collect()
    }
}

/// Returns the columns scaled to length 1, and their lengths.
fn scaled(columns: &[Vec<f64>], rows: usize) -> (DMatrix<f64>, Vec<f64>) {
    let size = |column: &Vec<f64>| column.iter().map(|x| x * x).sum::<f64>().sqrt();
    let sizes: Vec<f64> = columns.iter().map(size).map(|s| if s > 0.0 { s } else { 1.0 }).collect();
    let matrix = DMatrix::from_fn(rows, columns.len(), |i, j| columns[j][i] / sizes[j]);
    (matrix, sizes)
}

/// Returns the minimum of `cost` near `start`, by a simplex with edges `step`.
pub(crate) fn minimize(
    start: &[f64],
    step: &[f64],
    rounds: usize,
    mut cost: impl FnMut(&[f64]) -> f64,
) -> (Vec<f64>, f64) {
    let n = start.len();
    let mut corners: Vec<(Vec<f64>, f64)> = (0..=n)
        .map(|i| {
            let mut at = start.to_vec();
            if let (Some(x), Some(d)) =
                (i.checked_sub(1).and_then(|i| at.get_mut(i)), i.checked_sub(1).map(|i| step[i]))
            {
                *x += d;
            }
            let value = cost(&at);
            (at, value)
        })
        .collect();
    let order = |corners: &mut Vec<(Vec<f64>, f64)>| corners.sort_by(|a, b| a.1.total_cmp(&b.1));
    for _ in 0..rounds {
        order(&mut corners);
        let worst = corners[n].clone();
        let centre: Vec<f64> = (0..n).map(|j| corners[..n].iter().map(|c| c.0[j]).sum::<f64>() / n as f64).collect();
        let mut along = |by: f64| {
            let at: Vec<f64> = (0..n).map(|j| centre[j] + by * (worst.0[j] - centre[j])).collect();
            let value = cost(&at);
            (at, value)
        };
        let mirrored = along(-1.0);
        let chosen = if mirrored.1 < corners[0].1 {
            let farther = along(-2.0);
            if farther.1 < mirrored.1 { farther } else { mirrored }
        } else if mirrored.1 < corners[n - 1].1 {
            mirrored
        } else {
            along(0.5)
        };
        if chosen.1 < worst.1 {
            corners[n] = chosen;
            continue;
        }
        let best = corners[0].0.clone();
        for corner in corners.iter_mut().skip(1) {
            let at: Vec<f64> = corner.0.iter().zip(&best).map(|(x, b)| 0.5 * (x + b)).collect();
            *corner = (at.clone(), cost(&at));
        }
    }
    order(&mut corners);
    corners.swap_remove(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(law: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..300).map(|k| law(f64::from(k))).collect()
    }

    #[test]
    fn initial_state_of_each_stretch_has_no_effect() {
        let column = line(|k| 1e-3 * k * k);
        // Another position and another velocity from 100 on, and from 200 on.
        let jump = |k: f64| (k / 100.0).floor() * (1e6 - 33.0 * k);
        let measured = line(|k| 7e-3 * k * k + jump(k));
        let stretches = Stretches::new(vec![0..100, 100..200, 200..300], InitialState::Motion, &measured);
        let fit = stretches.fit(&[stretches.reduced(&column)]);
        assert!((fit.figures[0] - 7.0).abs() < 1e-6, "{:?}", fit.figures);
        assert!(fit.residual_squares < 1e-6 * stretches.whole(), "{}", fit.residual_squares);
        let place =
            Stretches::new(vec![0..100, 100..200], InitialState::Place, &line(|k| 2.0 * k + (k / 100.0).floor()));
        let fit = place.fit(&[place.reduced(&line(|k| k))]);
        assert!((fit.figures[0] - 2.0).abs() < 1e-9, "{:?}", fit.figures);
    }

    #[test]
    fn a_swing_that_fades_is_a_beginning() {
        let swing = |k: f64| 5.0 * libm::exp(-0.02 * k) * libm::cos(0.4 * k + 1.0);
        let damped = (0.4_f64 * 0.4 + 0.02 * 0.02).sqrt();
        let stretches = |beginning| Stretches::new(vec![0..150, 150..300], beginning, &line(swing));
        assert!(stretches(InitialState::Oscillation(damped, 0.02 / damped)).whole() < 1e-18);
        assert!(stretches(InitialState::Motion).whole() > 1.0);
    }

    /// Equal columns share their figure, and a column without information has none.
    #[test]
    fn columns_that_say_nothing_break_nothing() {
        let column = line(libm::sin);
        let stretches = Stretches::new(vec![0..150, 150..300], InitialState::Place, &column);
        let column = stretches.reduced(&column);
        let fit = stretches.fit(&[column.clone(), column.clone(), vec![0.0; 300]]);
        assert!((fit.figures[0] - 0.5).abs() < 1e-9 && (fit.figures[1] - 0.5).abs() < 1e-9, "{:?}", fit.figures);
        assert_eq!(fit.figures[2], 0.0);
        assert!(stretches.deviations(&[column], &fit)[0] < 1e-9);
    }

    /// The standard deviation of 200 fits is the stated one.
    #[test]
    fn a_deviation_is_that_of_many_fits() {
        let column = line(|k| libm::sin(0.1 * k));
        let mut random = 88_172_645_463_325_252_u64;
        let mut noise = || {
            // The sum of twelve uniform numbers is nearly normal.
            (0..12).fold(-6.0, |sum, _| {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                sum + (random >> 11) as f64 / (1_u64 << 53) as f64
            })
        };
        // Independent noise, and noise with a correlation of 0.8: there neighbours are correlated.
        for (stays, least, most) in [(0.0, 0.9, 1.1), (0.8, 0.6, 1.2)] {
            let (mut squares, mut stated, mut last) = (0.0, 0.0, 0.0);
            for _ in 0..200 {
                let mut value = |x: &f64| {
                    last = stays * last + noise();
                    3.0 * x + last
                };
                let measured: Vec<f64> = column.iter().map(&mut value).collect();
                let stretches = Stretches::new(vec![0..150, 150..300], InitialState::Motion, &measured);
                let reduced = vec![stretches.reduced(&column)];
                let fit = stretches.fit(&reduced);
                squares += (fit.figures[0] - 3.0) * (fit.figures[0] - 3.0) / 200.0;
                stated += stretches.deviations(&reduced, &fit)[0] / 200.0;
            }
            let part = squares.sqrt() / stated;
            assert!((least..most).contains(&part), "{stays}: {part}");
        }
    }

    #[test]
    fn a_simplex_finds_the_end_of_a_bent_valley() {
        let valley = |at: &[f64]| {
            let (x, y) = (at[0], at[1]);
            (1.0 - x) * (1.0 - x) + 100.0 * (y - x * x) * (y - x * x)
        };
        let (at, value) = minimize(&[-1.2, 1.0], &[0.3, 0.3], 200, valley);
        assert!(value < 1e-8 && (at[0] - 1.0).abs() < 1e-3, "{at:?} {value}");
        let (at, _) = minimize(&[5.0], &[1.0], 60, |at| (at[0] - 2.5).abs());
        assert!((at[0] - 2.5).abs() < 1e-6, "{at:?}");
    }
}
