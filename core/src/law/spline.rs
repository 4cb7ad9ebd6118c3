//! Splines through the points of a table: cubic splines with continuous curvature, quintic splines with continuous
//! fourth derivative.
//!
//! Law      `X[i] <= x < X[i+1], u = (x - X[i]) / (X[i+1] - X[i]): y(x) = y[i] + c1 u + .. + c5 u^5`. Of all
//!          curves through the points a cubic spline has the least integral of y''^2, a quintic one of y'''^2: the
//!          equations for the derivatives at the points are block tridiagonal, symmetric and positive definite, and are
//!          solved in one pass forward and one backward
//! Reads    points; outside the cycle, except [`Spline::rise`] and [`Spline::slope`]
//! Refuses  fewer points than its ends need, numbers that are not finite, positions that do not ascend

mod equations;

use super::polynomial::Polynomial;
use super::transfer::{Derivatives, Peaks};
use equations::{Interval, Kind};

/// Conditions at the ends of a spline; N is 1 for a cubic one, 2 for a quintic one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends<const N: usize> {
    /// The N derivatives from y^(N+1) on are 0: y'' of a cubic spline, y''' and y'''' of a quintic one.
    Natural,
    /// The first N derivatives are given.
    Clamped {
        /// Derivatives at the first point.
        first: [f64; N],
        /// Derivatives at the last point.
        last: [f64; N],
    },
    /// All derivatives are the same at both ends. The values may differ, by the travel of a period.
    Periodic,
}

impl<const N: usize> Ends<N> {
    /// Returns the smallest number of points. With two points the curvature of a natural quintic spline is undefined:
    /// any parabola through them has a third derivative of 0.
    fn smallest_point_count(&self) -> usize {
        match self {
            Self::Natural => N + 1,
            Self::Clamped { .. } => 2,
            Self::Periodic => 3,
        }
    }
}

/// Error in the points of a spline. Points count from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// The two lists have different lengths.
    #[error("a spline has {x} places and {y} values; as many of both are needed")]
    Lengths {
        /// Number of positions.
        x: usize,
        /// Number of values.
        y: usize,
    },
    /// There are too few points.
    #[error("a spline has {count} points; {fewest} at least are needed with its ends")]
    Count {
        /// Number of points.
        count: usize,
        /// Smallest number of points.
        fewest: usize,
    },
    /// A coordinate is not finite.
    #[error("point {point}: {name} is {value}; a finite number is needed")]
    NotFinite {
        /// Index of the point.
        point: usize,
        /// Coordinate: `x` or `y`.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The position of a point is not above that of the one before.
    #[error("point {point}: x is {x}; more than {before}, where the point before it is, is needed")]
    Order {
        /// Index of the point.
        point: usize,
        /// Position of the point before.
        before: f64,
        /// Its position.
        x: f64,
    },
    /// A derivative at an end is not finite.
    #[error("derivative {derivative} at the {end} point is {value}; a finite number is needed")]
    End {
        /// End: `first` or `last`.
        end: &'static str,
        /// Order of the derivative.
        derivative: usize,
        /// Its value.
        value: f64,
    },
    /// The numbers exceed the range of f64, or the distances are too uneven for its accuracy.
    #[error("point {point}: it is too near to, or too far from, its neighbours for double precision")]
    Size {
        /// Index of the point.
        point: usize,
    },
}

/// A spline without its points: it returns the difference from the value of the point before.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Coefficients of u^1 to u^5 of each interval.
    coefficients: Box<[[f64; 5]]>,
}

impl Spline {
    /// Returns the cubic spline through points.
    ///
    /// # Errors
    /// The error in the points.
    pub fn cubic(x: &[f64], y: &[f64], ends: &Ends<1>) -> Result<Self, SplineError> {
        Self::through(x, y, ends, Kind::CUBIC)
    }

    /// Returns the quintic spline through points.
    ///
    /// # Errors
    /// The error in the points.
    pub fn quintic(x: &[f64], y: &[f64], ends: &Ends<2>) -> Result<Self, SplineError> {
        Self::through(x, y, ends, Kind::QUINTIC)
    }

    fn through<const N: usize>(x: &[f64], y: &[f64], ends: &Ends<N>, kind: Kind<N>) -> Result<Self, SplineError> {
        check(x, y, ends)?;
        let intervals: Vec<_> = x.windows(2).zip(y.windows(2)).filter_map(|(x, y)| Interval::new(x, y)).collect();
        let coefficients: Box<[_]> = kind.coefficients(&intervals, ends)?.into();
        match coefficients.iter().position(|interval| !interval.iter().all(|value| value.is_finite())) {
            Some(point) => Err(SplineError::Size { point }),
            None => Ok(Self { coefficients }),
        }
    }

    /// Returns the coefficients of u^1 to u^5 of each interval.
    pub fn coefficients(&self) -> &[[f64; 5]] {
        &self.coefficients
    }

    /// Returns the difference from the value of point `i` to that at `u`, 0 <= u < 1, of the interval after it; 0 if
    /// there is none.
    ///
    /// Products and sums have a fixed order, none of them fused: identical bits on every machine.
    #[inline]
    pub fn rise(&self, i: usize, u: f64) -> f64 {
        self.coefficients.get(i).map_or(0.0, |[c1, c2, c3, c4, c5]| (c1 + (c2 + (c3 + (c4 + c5 * u) * u) * u) * u) * u)
    }

    /// Returns the derivative of that value by `u`; 0 if there is no interval.
    #[inline]
    pub fn slope(&self, i: usize, u: f64) -> f64 {
        let slope =
            |[c1, c2, c3, c4, c5]: &[f64; 5]| c1 + (2.0 * c2 + (3.0 * c3 + (4.0 * c4 + 5.0 * c5 * u) * u) * u) * u;
        self.coefficients.get(i).map_or(0.0, slope)
    }

    /// Returns the rise and the derivatives at `u` of interval `i` with the given length.
    pub fn at(&self, i: usize, u: f64, length: f64) -> Derivatives {
        let polynomial = self.coefficients.get(i).map_or(Polynomial([0.0; 8]), polynomial);
        polynomial.at(u).over(0.0, length, 1.0)
    }

    /// Returns the largest velocity, acceleration and jerk with their positions, for points with these positions.
    pub fn peaks(&self, x: &[f64]) -> Peaks {
        let intervals = x.windows(2).zip(&self.coefficients).filter_map(|(x, interval)| match x {
            [from, to] => Some(polynomial(interval).peaks().over(*from, to - from, 1.0)),
            _ => None,
        });
        intervals.fold(Peaks::default(), Peaks::or)
    }
}

fn polynomial(&[c1, c2, c3, c4, c5]: &[f64; 5]) -> Polynomial {
    Polynomial([0.0, c1, c2, c3, c4, c5, 0.0, 0.0])
}

fn check<const N: usize>(x: &[f64], y: &[f64], ends: &Ends<N>) -> Result<(), SplineError> {
    let (count, fewest) = (x.len(), ends.smallest_point_count());
    if count != y.len() {
        return Err(SplineError::Lengths { x: count, y: y.len() });
    }
    if count < fewest {
        return Err(SplineError::Count { count, fewest });
    }
    for (point, (x, y)) in x.iter().zip(y).enumerate() {
        for (name, value) in [("x", *x), ("y", *y)] {
            if !value.is_finite() {
                return Err(SplineError::NotFinite { point, name, value });
            }
        }
    }
    for (point, pair) in (1..).zip(x.windows(2)) {
        if let &[before, x] = pair
            && x <= before
        {
            return Err(SplineError::Order { point, before, x });
        }
    }
    if let Ends::Clamped { first, last } = ends {
        for (end, derivatives) in [("first", first), ("last", last)] {
            for (derivative, value) in (1..).zip(*derivatives) {
                if !value.is_finite() {
                    return Err(SplineError::End { end, derivative, value });
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
