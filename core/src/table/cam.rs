//! Tables as cams of `~/synchronize`: length, repetition at the end, and interpolation. The derived values are computed
//! when the table is created, so that a cycle does not visit each point.
//!
//! Refuses  words, fewer than two points, positions that do not begin at 0 and rise, values beyond [`MAX_VALUE`], form
//!          y without a length
//! Source   contract section 10, PLCopen (MC_CamTableSelect)

use super::{Form, Table};
use crate::law::{Ends, Spline, SplineError};
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Maximum magnitude of a value (inc of the slave), so that the change per period has 31 bits.
pub const MAX_VALUE: i64 = 1 << 30;
/// Maximum length (inc of the master).
pub const MAX_LENGTH: i64 = i32::MAX as i64;

/// Settings of the cell for a table as a cam.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CamSetting {
    /// Length of form y (inc of the master); form xy has its own length.
    pub length: Option<i64>,
    /// Whether the cam repeats at its end.
    pub is_cyclic: bool,
    /// Interpolation between its points.
    pub interpolation: Interpolation,
}

impl Default for CamSetting {
    fn default() -> Self {
        Self { length: None, is_cyclic: true, interpolation: Interpolation::Linear }
    }
}

/// Interpolation between the points of a cam. Splines of a cyclic cam are periodic, others natural.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interpolation {
    /// Straight lines, exact.
    #[default]
    Linear,
    /// A cubic spline: acceleration without jumps.
    Cubic,
    /// A quintic spline: jerk and its derivative without jumps.
    Quintic,
}

impl Interpolation {
    /// All interpolations with their names in cells.
    pub const ALL: [(&'static str, Self); 3] =
        [("linear", Self::Linear), ("cubic", Self::Cubic), ("quintic", Self::Quintic)];

    /// Returns the spline through points; `None` for straight lines.
    pub(super) fn spline(self, x: &[i64], y: &[i64], shape: CamShape) -> Result<Option<Spline>, CamError> {
        if self == Self::Linear {
            return Ok(None);
        }
        let last = y.len().saturating_sub(1).max(1) as f64;
        let even = |point: usize| shape.length as f64 * point as f64 / last;
        let places: Vec<f64> =
            if x.is_empty() { (0..y.len()).map(even).collect() } else { x.iter().map(|x| *x as f64).collect() };
        let values: Vec<f64> = y.iter().map(|y| *y as f64).collect();
        let spline = match (self, shape.is_cyclic) {
            (Self::Cubic, true) => Spline::cubic(&places, &values, &Ends::Periodic),
            (Self::Cubic, false) => Spline::cubic(&places, &values, &Ends::Natural),
            (_, true) => Spline::quintic(&places, &values, &Ends::Periodic),
            (_, false) => Spline::quintic(&places, &values, &Ends::Natural),
        };
        let spline = spline.map_err(|error| match error {
            SplineError::Count { count, fewest } => CamError::Few { count, fewest },
            SplineError::Size { point } => CamError::SplineOvershoot(point + 1),
            // Whole numbers are finite, and the positions of a cam rise.
            _ => CamError::SplineOvershoot(1),
        })?;
        // The coefficients limit the deviation from a value.
        let swing = |interval: &[f64; 5]| interval.iter().map(|coefficient| coefficient.abs()).sum::<f64>();
        let far = |(interval, value): (&[f64; 5], &f64)| value.abs() + swing(interval) > MAX_VALUE as f64;
        match spline.coefficients().iter().zip(&values).position(far) {
            Some(point) => Err(CamError::SplineOvershoot(point + 1)),
            None => Ok(Some(spline)),
        }
    }
}

/// Error of a table that is no cam.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CamError {
    /// Words of a data block have no points.
    #[error("words of a data block are no cam; form y and form xy are")]
    Words,
    /// Too few points.
    #[error("a cam has {count} points; {fewest} or more are needed")]
    Few {
        /// Number of points.
        count: usize,
        /// Required number: 2 for straight lines, 3 for most splines.
        fewest: usize,
    },
    /// Spline that deviates too far after this point, from 1.
    #[error(
        "behind point {0} the spline of a cam leaves -{MAX_VALUE} to {MAX_VALUE}; more points, or linear, is possible"
    )]
    SplineOvershoot(usize),
    /// Form y without a length.
    #[error("a cam of form y has no length; its length in increments of the master is needed, 1 to {MAX_LENGTH}")]
    NoLength,
    /// A length without effect, or out of range.
    #[error("a cam is {0} increments of the master long; 1 to {MAX_LENGTH} are possible")]
    Length(i64),
    /// The position of this point is not after the previous one, or is not 0 for the first point.
    #[error("point {place} of a cam is at {x}; the first is at 0, and each is after the one before it")]
    Place {
        /// Number of the point, from 1.
        place: usize,
        /// Its position.
        x: i64,
    },
    /// A value beyond 31 bits.
    #[error("point {place} of a cam has the value {y}; -{MAX_VALUE} to {MAX_VALUE} are possible")]
    Value {
        /// Number of the point, from 1.
        place: usize,
        /// Its value.
        y: i64,
    },
}

/// Derived values of a table that is a cam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CamShape {
    /// Length (inc of the master), above 0.
    pub length: i64,
    /// Travel of the slave per period (inc).
    pub travel: i64,
    /// Whether the cam repeats at its end.
    pub is_cyclic: bool,
}

impl CamShape {
    /// Returns the position `behind` after a point (inc of the master).
    pub fn place(self, table: &Table, point: usize, behind: i64) -> Position {
        let last = table.len().saturating_sub(1).max(1);
        let at = match table.x().get(point) {
            Some(x) => Position::whole(*x),
            // Form y, or a point after the last one.
            None => {
                let scaled = Position::whole(self.length).raw() * point.min(last) as i128;
                Position::from_raw(scaled / last as i128)
            }
        };
        at + Position::whole(behind)
    }

    /// Returns the cam of points.
    pub(super) fn of(form: Form, x: &[i64], y: &[i64], setting: CamSetting) -> Result<Self, CamError> {
        let given = match (form, x.last()) {
            (Form::Words, _) => return Err(CamError::Words),
            (Form::Y, _) => setting.length,
            (Form::Xy, last) => last.copied(),
        };
        let ([first, .., last], Some(length)) = (y, given) else {
            return Err(if y.len() < 2 { CamError::Few { count: y.len(), fewest: 2 } } else { CamError::NoLength });
        };
        let rises = |place: &usize| match place.checked_sub(1) {
            None => x.first() == Some(&0),
            Some(before) => x.get(before) < x.get(*place),
        };
        if let Some(place) = (0..x.len()).find(|place| !rises(place)) {
            return Err(CamError::Place { place: place + 1, x: x.get(place).copied().unwrap_or_default() });
        }
        if !(1..=MAX_LENGTH).contains(&length) {
            return Err(CamError::Length(length));
        }
        let is_value = |value: &i64| (-MAX_VALUE..=MAX_VALUE).contains(value);
        if let Some((place, value)) = (1..).zip(y).find(|(_, value)| !is_value(value)) {
            return Err(CamError::Value { place, y: *value });
        }
        Ok(Self { length, travel: last.saturating_sub(*first), is_cyclic: setting.is_cyclic })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_cam_is_reported_with_point() {
        let long = |length| CamSetting { length, ..CamSetting::default() };
        let of = |x: &[i64], y: &[i64]| CamShape::of(Form::Xy, x, y, CamSetting::default());
        let even = |length, y: &[i64]| CamShape::of(Form::Y, &[], y, long(length));
        assert_eq!(CamShape::of(Form::Words, &[], &[0, 1], long(Some(9))), Err(CamError::Words));
        assert_eq!(even(Some(9), &[0]), Err(CamError::Few { count: 1, fewest: 2 }));
        assert_eq!(of(&[], &[]), Err(CamError::Few { count: 0, fewest: 2 }));
        assert_eq!(even(None, &[0, 1]), Err(CamError::NoLength));
        assert_eq!(even(Some(0), &[0, 1]), Err(CamError::Length(0)));
        assert_eq!(of(&[0, 1 << 31], &[0, 1]), Err(CamError::Length(1 << 31)));
        assert_eq!(of(&[1, 2], &[0, 1]), Err(CamError::Place { place: 1, x: 1 }));
        assert_eq!(of(&[0, 5, 5], &[0, 1, 2]), Err(CamError::Place { place: 3, x: 5 }));
        assert_eq!(of(&[0, 5], &[0, MAX_VALUE + 1]), Err(CamError::Value { place: 2, y: MAX_VALUE + 1 }));
        assert_eq!(of(&[0, 5], &[i64::MIN, 0]), Err(CamError::Value { place: 1, y: i64::MIN }));
    }

    /// Points at 0, 1 and 10000 inc with a peak between the first two: the cubic spline overshoots by thousands of its
    /// height.
    #[test]
    fn a_spline_that_swings_too_far_is_refused_and_so_are_too_few_points() {
        let of = |x: &[i64], y: &[i64], is_cyclic| {
            let setting = CamSetting { is_cyclic, interpolation: Interpolation::Cubic, ..CamSetting::default() };
            Table::new(Form::Xy, x, y).expect("points").with_cam(setting).cam()
        };
        assert!(matches!(of(&[0, 1, 10_000], &[0, 1 << 29, 0], true), Err(CamError::SplineOvershoot(_))));
        assert_eq!(of(&[0, 10], &[0, 5], true), Err(CamError::Few { count: 2, fewest: 3 }));
        assert!(of(&[0, 10], &[0, 5], false).is_ok());
    }

    #[test]
    fn a_period_makes_the_way_from_the_first_point_to_the_last() {
        let shape = CamShape::of(Form::Xy, &[0, 10, 40], &[7, 100, -3], CamSetting::default());
        assert_eq!(shape, Ok(CamShape { length: 40, travel: -10, is_cyclic: true }));
        let once = CamSetting { length: Some(90), is_cyclic: false, ..CamSetting::default() };
        let shape = CamShape::of(Form::Y, &[], &[0, 40_000, -MAX_VALUE], once);
        assert_eq!(shape, Ok(CamShape { length: 90, travel: -MAX_VALUE, is_cyclic: false }));
    }
}
