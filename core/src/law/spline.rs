//! Splines through the points of a table: cubic ones of one curvature, quintic ones of one fourth derivative.
//!
//! Law      X[i] <= x < X[i+1], u = (x - X[i]) / (X[i+1] - X[i]): y(x) = y[i] + c1 u + .. + c5 u^5. Of all curves through the points a cubic
//!          spline has the least integral of y''^2, a quintic one of y'''^2: the equations for the derivatives at the points are
//!          block tridiagonal, symmetric and positive definite, and are solved in one pass there and one back
//! Reads    points; outside the cycle, but for [`Spline::rise`] and [`Spline::slope`]
//! Refuses  fewer points than its ends need, numbers that are not finite, places that do not rise

mod equations;

use super::polynomial::Polynomial;
use super::transfer::{Derivatives, Peaks};
use equations::{Interval, Kind};

/// What holds at the ends of a spline; N is 1 of a cubic one, 2 of a quintic one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends<const N: usize> {
    /// The N derivatives from y^(N+1) on are 0: y'' of a cubic spline, y''' and y'''' of a quintic one.
    Natural,
    /// The first N derivatives are these.
    Clamped {
        /// At the first point.
        first: [f64; N],
        /// At the last point.
        last: [f64; N],
    },
    /// All derivatives are the same at both ends. The value may differ, by the way of a period.
    Periodic,
}

impl<const N: usize> Ends<N> {
    /// Fewest points. Two leave a natural quintic spline its curvature: any parabola through them has a third derivative of 0.
    fn fewest(&self) -> usize {
        match self {
            Self::Natural => N + 1,
            Self::Clamped { .. } => 2,
            Self::Periodic => 3,
        }
    }
}

/// Why there is no spline through points. Points count from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Two lists that do not belong together.
    #[error("a spline has {x} places and {y} values; as many of both are needed")]
    Lengths {
        /// Places.
        x: usize,
        /// Values.
        y: usize,
    },
    /// Too few points.
    #[error("a spline has {count} points; {fewest} at least are needed with its ends")]
    Count {
        /// How many there are.
        count: usize,
        /// How many there are at least.
        fewest: usize,
    },
    /// A coordinate that is no number.
    #[error("point {point}: {name} is {value}; a finite number is needed")]
    NotFinite {
        /// Which.
        point: usize,
        /// `x` or `y`.
        name: &'static str,
        /// What it is.
        value: f64,
    },
    /// It does not lie behind the one before it.
    #[error("point {point}: x is {x}; more than {before}, where the point before it is, is needed")]
    Order {
        /// Which.
        point: usize,
        /// Place of the one before.
        before: f64,
        /// Its place.
        x: f64,
    },
    /// A derivative of an end that is no number.
    #[error("derivative {derivative} at the {end} point is {value}; a finite number is needed")]
    End {
        /// `first` or `last`.
        end: &'static str,
        /// Which.
        derivative: usize,
        /// What it is.
        value: f64,
    },
    /// Numbers that no double has room for, or distances so uneven that its digits do not suffice.
    #[error("point {point}: it is too near to, or too far from, its neighbours for double precision")]
    Size {
        /// Which.
        point: usize,
    },
}

/// A spline, without the points that it goes through: what it adds to the value of the point before.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Coefficients of u^1 to u^5 of each interval.
    coefficients: Box<[[f64; 5]]>,
}

impl Spline {
    /// The cubic spline through points.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn cubic(x: &[f64], y: &[f64], ends: &Ends<1>) -> Result<Self, SplineError> {
        Self::through(x, y, ends, Kind::CUBIC)
    }

    /// The quintic spline through points.
    ///
    /// # Errors
    /// What is wrong with them.
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

    /// Coefficients of u^1 to u^5 of each interval.
    pub fn coefficients(&self) -> &[[f64; 5]] {
        &self.coefficients
    }

    /// From the value of point `i` to that at `u`, 0 <= u < 1, of the interval behind it; 0 where there is none.
    ///
    /// Products and sums in one order, none of them fused: the same bits on every machine.
    #[inline]
    pub fn rise(&self, i: usize, u: f64) -> f64 {
        self.coefficients.get(i).map_or(0.0, |[c1, c2, c3, c4, c5]| (c1 + (c2 + (c3 + (c4 + c5 * u) * u) * u) * u) * u)
    }

    /// Change of that value by `u` there; 0 where there is no interval.
    #[inline]
    pub fn slope(&self, i: usize, u: f64) -> f64 {
        let slope =
            |[c1, c2, c3, c4, c5]: &[f64; 5]| c1 + (2.0 * c2 + (3.0 * c3 + (4.0 * c4 + 5.0 * c5 * u) * u) * u) * u;
        self.coefficients.get(i).map_or(0.0, slope)
    }

    /// The rise and the derivatives at `u` of interval `i`, which is `length` long.
    pub fn at(&self, i: usize, u: f64, length: f64) -> Derivatives {
        let polynomial = self.coefficients.get(i).map_or(Polynomial([0.0; 8]), polynomial);
        polynomial.at(u).over(0.0, length, 1.0)
    }

    /// The largest velocity, acceleration and jerk, and where, if it goes through points with these places.
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
    let (count, fewest) = (x.len(), ends.fewest());
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
