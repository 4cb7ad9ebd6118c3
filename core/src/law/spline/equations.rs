//! The equations of a spline for its derivatives at the points, from the conditions there and at the ends.
//!
//! Law      the derivatives of the integral by y' (quintic spline: also y'') at each point are 0, unless an end
//!          condition replaces them
//! Refuses  numbers that exceed the range of double precision

use super::{Ends, SplineError};
use nalgebra::{Cholesky, Const, SMatrix, SVector};

/// Interval between two points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    length: f64,
    rise: f64,
}

impl Interval {
    pub(super) fn new(x: &[f64], y: &[f64]) -> Option<Self> {
        match (x, y) {
            ([from, to], [before, after]) => Some(Self { length: to - from, rise: after - before }),
            _ => None,
        }
    }
}

/// Contribution of an interval to the equations of its first and of its last point: half of the gradient of its
/// integral.
#[derive(Clone, Copy, Debug)]
struct Part<const N: usize> {
    /// Coefficients of the first point, by the derivatives there.
    first: SMatrix<f64, N, N>,
    /// Coefficients of the last point, by the derivatives there.
    last: SMatrix<f64, N, N>,
    /// Coefficients of the first point, by the derivatives at the last; transposed, of the last point by those at the
    /// first.
    cross: SMatrix<f64, N, N>,
    /// Right sides of the first and of the last point.
    rise: [SVector<f64, N>; 2],
}

/// Returns the part for the integral of y''^2, by y' at both ends.
fn cubic_part(interval: &Interval) -> Part<1> {
    let q = 1.0 / interval.length;
    let rise = SVector::from([3.0 * q * q * interval.rise]);
    Part { first: [[2.0 * q]].into(), last: [[2.0 * q]].into(), cross: [[q]].into(), rise: [rise; 2] }
}

/// Returns the part for the integral of y'''^2, by y' and y'' at both ends: its gradient consists of y'''' and -y'''
/// there.
fn quintic_part(interval: &Interval) -> Part<2> {
    let q = 1.0 / interval.length;
    let (q2, q3) = (q * q, q * q * q);
    let slope = interval.rise * q;
    Part {
        first: SMatrix::<f64, 2, 2>::new(192.0 * q3, 36.0 * q2, 36.0 * q2, 9.0 * q),
        last: SMatrix::<f64, 2, 2>::new(192.0 * q3, -36.0 * q2, -36.0 * q2, 9.0 * q),
        cross: SMatrix::<f64, 2, 2>::new(168.0 * q3, -24.0 * q2, 24.0 * q2, -3.0 * q),
        rise: [[360.0 * q3 * slope, 60.0 * q2 * slope].into(), [360.0 * q3 * slope, -60.0 * q2 * slope].into()],
    }
}

fn cubic_coefficients(interval: &Interval, first: &SVector<f64, 1>, last: &SVector<f64, 1>) -> [f64; 5] {
    let rise = interval.rise;
    let (m, n) = (first.x * interval.length, last.x * interval.length);
    [m, 3.0 * rise - 2.0 * m - n, m + n - 2.0 * rise, 0.0, 0.0]
}

fn quintic_coefficients(interval: &Interval, first: &SVector<f64, 2>, last: &SVector<f64, 2>) -> [f64; 5] {
    let (rise, length) = (interval.rise, interval.length);
    let (m, n) = (first.x * length, last.x * length);
    let (k, l) = (first.y * length * length, last.y * length * length);
    [
        m,
        k / 2.0,
        10.0 * rise - 6.0 * m - 4.0 * n - 1.5 * k + 0.5 * l,
        -15.0 * rise + 8.0 * m + 7.0 * n + 1.5 * k - l,
        6.0 * rise - 3.0 * (m + n) - 0.5 * (k - l),
    ]
}

/// Cubic or quintic spline.
#[derive(Clone, Copy)]
pub(super) struct Kind<const N: usize> {
    part: fn(&Interval) -> Part<N>,
    /// Function for the coefficients from the derivatives at both ends.
    coefficients: fn(&Interval, &SVector<f64, N>, &SVector<f64, N>) -> [f64; 5],
}

impl Kind<1> {
    /// Equations of y'.
    pub(super) const CUBIC: Self = Self { part: cubic_part, coefficients: cubic_coefficients };
}

impl Kind<2> {
    /// Equations of y' and y''.
    pub(super) const QUINTIC: Self = Self { part: quintic_part, coefficients: quintic_coefficients };
}

impl<const N: usize> Kind<N> {
    /// Returns the coefficients of u^1 to u^5 of each interval.
    pub(super) fn coefficients(self, intervals: &[Interval], ends: &Ends<N>) -> Result<Vec<[f64; 5]>, SplineError> {
        let (Some(first), Some(last)) = (intervals.first(), intervals.last()) else { return Ok(Vec::new()) };
        let equations = Equations { part: self.part, intervals, first: (self.part)(first), last: (self.part)(last) };
        let derivatives = match ends {
            Ends::Natural => equations.natural()?,
            Ends::Clamped { first, last } => equations.clamped((*first).into(), (*last).into())?,
            Ends::Periodic => equations.periodic()?,
        };
        let coefficients = |(interval, ends): (&Interval, &[SVector<f64, N>])| match ends {
            [first, last] => Some((self.coefficients)(interval, first, last)),
            _ => None,
        };
        Ok(intervals.iter().zip(derivatives.windows(2)).filter_map(coefficients).collect())
    }
}

/// Derivatives at the points, in order.
type Derivatives<const N: usize> = Vec<SVector<f64, N>>;

struct Equations<'a, const N: usize> {
    part: fn(&Interval) -> Part<N>,
    intervals: &'a [Interval],
    /// Part of the first interval.
    first: Part<N>,
    /// Part of the last interval.
    last: Part<N>,
}

impl<'a, const N: usize> Equations<'a, N> {
    /// Solves for natural ends: they are points like others, with an interval on one side.
    fn natural(&self) -> Result<Derivatives<N>, SplineError> {
        let Self { first, last, .. } = *self;
        let diagonal = [first.first].into_iter().chain(self.blocks()).chain([last.last]);
        let chain = Chain::new(self.part, self.intervals, 0, diagonal)?;
        let sides = [first.rise[0]].into_iter().chain(self.sides()).chain([last.rise[1]]);
        Ok(chain.solve(sides.collect()))
    }

    /// Solves for known derivatives at the ends.
    fn clamped(&self, start: SVector<f64, N>, end: SVector<f64, N>) -> Result<Derivatives<N>, SplineError> {
        let mut sides: Vec<_> = self.sides().collect();
        self.subtract(&mut sides, start, end);
        Ok(around(start, self.inner()?.solve(sides), end))
    }

    /// Solves for both ends as one point. The inner derivatives depend linearly on those of this point: they are solved
    /// with all of them 0 and for each of them alone, and the equation of that point gives them.
    fn periodic(&self) -> Result<Derivatives<N>, SplineError> {
        let chain = self.inner()?;
        let mut inner = chain.solve(self.sides().collect());
        let side = self.first.rise[0] + self.last.rise[1] - self.at_ends(&inner);
        let mut matrix = self.first.first + self.last.last;
        let mut changes = Vec::with_capacity(N);
        for (unit, mut column) in SMatrix::<f64, N, N>::identity().column_iter().zip(matrix.column_iter_mut()) {
            let mut sides = vec![SVector::zeros(); inner.len()];
            self.subtract(&mut sides, unit.into(), unit.into());
            let change = chain.solve(sides);
            column += self.at_ends(&change);
            changes.push(change);
        }
        let end = Cholesky::new(matrix).ok_or(SplineError::Size { point: 0 })?.solve(&side);
        for (change, amount) in changes.iter().zip(end.iter()) {
            for (derivatives, change) in inner.iter_mut().zip(change) {
                *derivatives += change * *amount;
            }
        }
        Ok(around(end, inner, end))
    }

    /// Returns the parts on both sides of each inner point.
    fn parts(&self) -> impl Iterator<Item = (Part<N>, Part<N>)> + '_ {
        self.intervals
            .iter()
            .zip(self.intervals.iter().skip(1))
            .map(|(before, after)| ((self.part)(before), (self.part)(after)))
    }

    fn blocks(&self) -> impl Iterator<Item = SMatrix<f64, N, N>> + '_ {
        self.parts().map(|(before, after)| before.last + after.first)
    }

    fn sides(&self) -> impl Iterator<Item = SVector<f64, N>> + '_ {
        self.parts().map(|(before, after)| before.rise[1] + after.rise[0])
    }

    /// Returns the equations of the inner points.
    fn inner(&self) -> Result<Chain<'a, N>, SplineError> {
        Chain::new(self.part, self.intervals.get(1..).unwrap_or_default(), 1, self.blocks())
    }

    /// Subtracts the effect of the derivatives at the ends from the right sides of the points next to them.
    fn subtract(&self, sides: &mut [SVector<f64, N>], start: SVector<f64, N>, end: SVector<f64, N>) {
        if let Some(side) = sides.first_mut() {
            *side -= self.first.cross.transpose() * start;
        }
        if let Some(side) = sides.last_mut() {
            *side -= self.last.cross * end;
        }
    }

    /// Returns the effect of the inner derivatives on the equation of the ends.
    fn at_ends(&self, inner: &[SVector<f64, N>]) -> SVector<f64, N> {
        let zero = SVector::zeros();
        let [start, end] = [inner.first(), inner.last()].map(|derivatives| derivatives.unwrap_or(&zero));
        self.first.cross * start + self.last.cross.transpose() * end
    }
}

fn around<const N: usize>(start: SVector<f64, N>, inner: Derivatives<N>, end: SVector<f64, N>) -> Derivatives<N> {
    [start].into_iter().chain(inner).chain([end]).collect()
}

/// Factored equations of consecutive points, block tridiagonal.
struct Chain<'a, const N: usize> {
    part: fn(&Interval) -> Part<N>,
    /// Interval after each point; the one after the last point is not used.
    intervals: &'a [Interval],
    pivots: Vec<Cholesky<f64, Const<N>>>,
}

impl<'a, const N: usize> Chain<'a, N> {
    fn new(
        part: fn(&Interval) -> Part<N>,
        intervals: &'a [Interval],
        first: usize,
        diagonal: impl Iterator<Item = SMatrix<f64, N, N>>,
    ) -> Result<Self, SplineError> {
        let mut pivots = Vec::new();
        let mut carried = SMatrix::zeros();
        for (i, block) in diagonal.enumerate() {
            let pivot = Cholesky::new(block - carried).ok_or(SplineError::Size { point: first + i })?;
            if let Some(interval) = intervals.get(i) {
                let cross = part(interval).cross;
                carried = cross.transpose() * pivot.solve(&cross);
            }
            pivots.push(pivot);
        }
        Ok(Self { part, intervals, pivots })
    }

    fn solve(&self, mut sides: Derivatives<N>) -> Derivatives<N> {
        let cross = |i: usize| self.intervals.get(i).map_or(SMatrix::zeros(), |interval| (self.part)(interval).cross);
        let mut carried = SVector::zeros();
        for (i, (side, pivot)) in sides.iter_mut().zip(&self.pivots).enumerate() {
            *side = pivot.solve(&(*side - carried));
            carried = cross(i).transpose() * *side;
        }
        let mut next = SVector::zeros();
        for (i, (side, pivot)) in sides.iter_mut().zip(&self.pivots).enumerate().rev() {
            *side -= pivot.solve(&(cross(i) * next));
            next = *side;
        }
        sides
    }
}
