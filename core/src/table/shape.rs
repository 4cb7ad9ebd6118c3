//! Properties of the points of a table as a curve. They are computed when the table is created, so that a START in a
//! cycle does not visit each point.
//!
//! Refuses  a form without points, fewer than two points, a first one that is not 0, positions that do not rise, steps
//!          of 2^15 and more
//! Source   AMK-FIPW-02, AMK-XFIPW-05, -18, -20, A-08

use super::Form;

/// Upper bound of the step between two points (inc).
const STEP: u64 = 1 << 15;

/// Error of a table that is no curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveError {
    /// Words of a data block have no points.
    Words,
    /// Too few points; 2 are needed.
    Few(usize),
    /// The value of the first point, or its position, is not 0.
    First(i64),
    /// The position of this point is not after the previous one.
    Order(usize),
    /// The step to this point is 2^15 or more.
    Step(usize),
}

/// Properties of a table that is a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CurveShape {
    /// Largest magnitude of its values.
    pub max_magnitude: u64,
}

impl CurveShape {
    /// Returns the properties of points.
    pub(super) fn of(form: Form, x: &[i64], y: &[i64]) -> Result<Self, CurveError> {
        if form == Form::Words {
            return Err(CurveError::Words);
        }
        if y.len() < 2 {
            return Err(CurveError::Few(y.len()));
        }
        for list in [x, y] {
            if let Some(first) = list.first().filter(|first| **first != 0) {
                return Err(CurveError::First(*first));
            }
        }
        let rises = |pair: &[i64]| matches!(pair, [before, after] if before < after);
        if let Some(place) = x.windows(2).position(|pair| !rises(pair)) {
            return Err(CurveError::Order(place + 1));
        }
        let is_step = |pair: &[i64]| match *pair {
            [before, after] => after.saturating_sub(before).unsigned_abs() < STEP,
            _ => false,
        };
        if let Some(place) = y.windows(2).position(|pair| !is_step(pair)) {
            return Err(CurveError::Step(place + 1));
        }
        Ok(Self { max_magnitude: y.iter().map(|value| value.unsigned_abs()).max().unwrap_or(0) })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Table;
    use super::*;

    fn even(y: &[i64]) -> Table {
        Table::new(Form::Y, &[], y).expect("points")
    }

    fn uneven(points: &[(i64, i64)]) -> Table {
        let (x, y): (Vec<_>, Vec<_>) = points.iter().copied().unzip();
        Table::new(Form::Xy, &x, &y).expect("points")
    }

    /// Proves: AMK-FIPW-02, AMK-XFIPW-05, AMK-XFIPW-18, AMK-XFIPW-20
    #[test]
    fn invalid_curve_is_reported_with_point() {
        let of = |table: Table| table.shape().map(|shape| shape.max_magnitude);
        assert_eq!(of(Table::new(Form::Words, &[], &[0, 1]).expect("words")), Err(CurveError::Words));
        assert_eq!(of(even(&[0])), Err(CurveError::Few(1)));
        assert_eq!(of(even(&[3, 4])), Err(CurveError::First(3)));
        assert_eq!(of(uneven(&[(1, 0), (2, 4)])), Err(CurveError::First(1)));
        assert_eq!(of(uneven(&[(0, -1), (2, 4)])), Err(CurveError::First(-1)));
        assert_eq!(of(uneven(&[(0, 0), (5, 4), (5, 8)])), Err(CurveError::Order(2)));
        assert_eq!(of(uneven(&[(0, 0), (5, 4), (9, 8), (7, 9)])), Err(CurveError::Order(3)));
        assert_eq!(of(even(&[0, 32_767, 0])), Ok(32_767));
        assert_eq!(of(even(&[0, 32_767, 65_535])), Err(CurveError::Step(2)));
        assert_eq!(of(even(&[0, -32_768])), Err(CurveError::Step(1)));
        assert_eq!(of(even(&[0, i32::MIN.into()])), Err(CurveError::Step(1)));
        assert_eq!(of(uneven(&[(0, 0), (1, -32_767), (32_767, 0)])), Ok(32_767));
    }
}
