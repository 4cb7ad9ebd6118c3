//! Matrix exponential of a small matrix: the exact solution of a linear system over a time.
//!
//! Law      exp(A t) = (sum of (A t / 2^s)^n / n!)^(2^s); the norm of the balanced A t / 2^s is at most 0.5, so that
//!          the omitted terms are below the rounding of the sum. Rows and columns are balanced by powers of two, which
//!          causes no rounding
//! Reads    a matrix (1/s) and a time (s)
//! Writes   the matrix that advances a state by that time
//! Refuses  nothing: the callers have checked that the matrix is finite
//! Source   Moler and Van Loan, Nineteen dubious ways to compute the exponential of a matrix, method 3

use libm::{ilogb, scalbn};
use nalgebra::SMatrix;

/// Number of states and held inputs.
pub(super) const WIDTH: usize = 8;

/// Matrix of a system with its held inputs, whose rows are 0.
pub(super) type Square = SMatrix<f64, WIDTH, WIDTH>;

/// Terms of the sum: 0.5^18 / 18! is below 1e-21.
const TERMS: u32 = 18;
/// Rounds of balancing; further rounds change nothing.
const ROUNDS: usize = 4;

/// Returns the sum of the magnitudes in a row or a column, without its diagonal.
fn beside<'a>(values: impl Iterator<Item = &'a f64>, diagonal: usize) -> f64 {
    values.enumerate().filter(|(index, _)| *index != diagonal).map(|(_, value)| value.abs()).sum()
}

/// Balances rows and columns: replaces A by D^-1 A D. Returns the diagonal of D.
fn balance(matrix: &mut Square) -> [f64; WIDTH] {
    let mut scales = [1.0; WIDTH];
    for _ in 0..ROUNDS {
        for (index, scale) in scales.iter_mut().enumerate() {
            let column = beside(matrix.column(index).iter(), index);
            let row = beside(matrix.row(index).iter(), index);
            if column > 0.0 && row > 0.0 {
                let factor = scalbn(1.0, (ilogb(row) - ilogb(column)) / 2);
                matrix.column_mut(index).scale_mut(factor);
                matrix.row_mut(index).unscale_mut(factor);
                *scale *= factor;
            }
        }
    }
    scales
}

/// Returns exp(`matrix` * `time`); not for use in the cycle.
pub(super) fn exponential(matrix: &Square, time: f64) -> Square {
    let mut small = matrix * time;
    let scales = balance(&mut small);
    let norm = small.column_iter().map(|column| column.iter().map(|value| value.abs()).sum()).fold(0.0, f64::max);
    let halvings = if norm > 0.5 { ilogb(norm) + 2 } else { 0 };
    small *= scalbn(1.0, -halvings);
    let (mut sum, mut term) = (Square::identity(), Square::identity());
    for n in 1..=TERMS {
        term = term * small / f64::from(n);
        sum += term;
    }
    for _ in 0..halvings {
        sum *= sum;
    }
    for (index, scale) in scales.iter().enumerate() {
        sum.row_mut(index).scale_mut(*scale);
        sum.column_mut(index).unscale_mut(*scale);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A rotation: exp of [0 -w; w 0] t is [cos, -sin; sin, cos], here over 100 turns and 0.3 rad.
    #[test]
    fn the_generator_of_a_rotation_makes_sine_and_cosine() {
        let mut matrix = Square::zeros();
        (matrix[(0, 1)], matrix[(1, 0)]) = (-1000.0, 1000.0);
        let angle = 200.0 * std::f64::consts::PI + 0.3;
        let result = exponential(&matrix, angle / 1000.0);
        assert!((result[(0, 0)] - libm::cos(angle)).abs() < 1e-11, "{}", result[(0, 0)]);
        assert!((result[(1, 0)] - libm::sin(angle)).abs() < 1e-11, "{}", result[(1, 0)]);
        assert_eq!(result[(7, 7)], 1.0);
    }

    /// A defective matrix: a chain of integrators has t^n / n! above its diagonal.
    #[test]
    fn a_chain_of_integrators_gives_the_powers_of_time() {
        let mut matrix = Square::zeros();
        (0..WIDTH - 1).for_each(|index| matrix[(index, index + 1)] = 1.0);
        let result = exponential(&matrix, 3.0);
        let mut expected = 1.0;
        for n in 1..WIDTH {
            expected *= 3.0 / n as f64;
            assert!((result[(0, n)] / expected - 1.0).abs() < 1e-13, "{n}: {}", result[(0, n)]);
        }
    }

    /// Time constants of 1 us and 1 s over 10 ms: the fast one has decayed, the slow one has lost exp(-0.01).
    #[test]
    fn a_stiff_system_stays_stable() {
        let mut matrix = Square::zeros();
        (matrix[(0, 0)], matrix[(1, 1)], matrix[(0, 1)]) = (-1e6, -1.0, 1e6);
        let result = exponential(&matrix, 0.01);
        assert!(result[(0, 0)].abs() < 1e-9);
        assert!((result[(1, 1)] - libm::exp(-0.01)).abs() < 1e-9);
        assert!((result[(0, 1)] - libm::exp(-0.01) / (1.0 - 1e-6)).abs() < 1e-9);
    }

    proptest! {
        /// exp(A s) exp(A t) = exp(A (s + t)), for any A.
        #[test]
        fn times_add_up(values in proptest::array::uniform32(-3.0..3.0_f64), s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
            let mut matrix = Square::zeros();
            matrix.iter_mut().zip(values).for_each(|(entry, value)| *entry = value);
            let (one, other) = (exponential(&matrix, s) * exponential(&matrix, t), exponential(&matrix, s + t));
            let most = other.amax().max(1.0);
            prop_assert!((one - other).amax() < 1e-11 * most, "{}", (one - other).amax() / most);
        }
    }
}
