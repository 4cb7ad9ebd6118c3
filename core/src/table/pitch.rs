//! Tables as pitch errors of an axis: positions, and the error of the motor at each. The derived values are computed
//! when the table is created.
//!
//! Law      error(position) = linear between the points, rounded to whole increments, half of one up; beyond its ends a
//!          table holds its end values; for an axis with a turn, the last point is connected to the first one, a turn
//!          ahead
//! Refuses  another form than xy, fewer than two points, positions that do not rise or are outside the turn, an error
//!          that changes by more than one part in [`MAX_SLOPE_DIVISOR`] of the distance
//! Source   WF-INC-04, contract section 10

use super::{Form, Table, interval};

/// The error changes by at most this part of the distance, so that positions and counts keep their order.
pub const MAX_SLOPE_DIVISOR: i64 = 10;

/// Error of a table that is no pitch error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PitchError {
    /// Wrong form.
    #[error("a table of form {} has no places; form xy is expected", .0.name())]
    Form(Form),
    /// Too few points.
    #[error("a pitch error has {0} points; 2 or more are needed")]
    Few(usize),
    /// The position of this point is not after the previous one.
    #[error("point {point} of a pitch error is at {x}; each is after the one before it")]
    Order {
        /// Number of the point, from 1.
        point: usize,
        /// Its position (inc).
        x: i64,
    },
    /// The position is outside the turn of its axis.
    #[error("point {point} of a pitch error is at {x}; the turn of its axis has 0 to {} inc", turn - 1)]
    Turn {
        /// Number of the point, from 1.
        point: usize,
        /// Its position (inc).
        x: i64,
        /// Length of the turn (inc).
        turn: i64,
    },
    /// The error changes too fast before this point.
    #[error(
        "up to point {point} a pitch error changes by {change} inc on {way} inc; a part of {MAX_SLOPE_DIVISOR} of the way is \
         possible"
    )]
    Steep {
        /// Number of the point, from 1; the first one follows the last one if there is a turn.
        point: usize,
        /// Change of the error (inc).
        change: i64,
        /// Distance of the points (inc).
        way: i64,
    },
}

impl PitchError {
    /// Returns the invalid point, from 1; 0 for the whole table.
    pub fn point(self) -> usize {
        match self {
            Self::Form(_) | Self::Few(_) => 0,
            Self::Order { point, .. } | Self::Turn { point, .. } | Self::Steep { point, .. } => point,
        }
    }
}

/// Checks the change of the error before a point.
fn check_slope(point: usize, (x, y): (i64, i64), (to_x, to_y): (i64, i64)) -> Result<(), PitchError> {
    // Both have 32 bits, a turn at most 62: no difference wraps.
    let (way, change) = (to_x - x, to_y - y);
    let is_flat = change.saturating_abs().saturating_mul(MAX_SLOPE_DIVISOR) <= way;
    if is_flat { Ok(()) } else { Err(PitchError::Steep { point, change, way }) }
}

/// Checks that the points of a table are a pitch error, independently of the turn of the axis.
pub(super) fn check(form: Form, x: &[i64], y: &[i64]) -> Result<(), PitchError> {
    if form != Form::Xy {
        return Err(PitchError::Form(form));
    }
    if y.len() < 2 {
        return Err(PitchError::Few(y.len()));
    }
    for (point, (x, y)) in (2..).zip(x.windows(2).zip(y.windows(2))) {
        let (&[x, to_x], &[y, to_y]) = (x, y) else { continue };
        if to_x <= x {
            return Err(PitchError::Order { point, x: to_x });
        }
        check_slope(point, (x, y), (to_x, to_y))?;
    }
    Ok(())
}

impl Table {
    /// Checks that it can be the pitch error of an axis with that turn (inc). Only the end points are evaluated.
    ///
    /// # Errors
    /// The problem of the table.
    pub fn check_pitch(&self, turn: Option<i64>) -> Result<(), PitchError> {
        self.pitch?;
        let (Some(turn), [x, .., last_x], [y, .., last_y]) = (turn, self.x(), self.y()) else { return Ok(()) };
        for (point, x) in [(1, *x), (self.len(), *last_x)] {
            if !(0..turn).contains(&x) {
                return Err(PitchError::Turn { point, x, turn });
            }
        }
        check_slope(1, (*last_x, *last_y), (x.saturating_add(turn), *y))
    }

    /// Returns the error at a position (inc), which is within the turn if there is one.
    pub(crate) fn pitch_at(&self, place: i64, turn: Option<i64>) -> i64 {
        let (x, y) = (self.x(), self.y());
        let last = x.len().saturating_sub(1);
        let point = |at: usize| Some((*x.get(at)?, *y.get(at)?));
        let (Some(first), Some(end)) = (point(0), point(last)) else { return 0 };
        if place < first.0 || place >= end.0 {
            return match turn {
                None if place < first.0 => first.1,
                None => end.1,
                Some(turn) => {
                    let place = if place < first.0 { place.saturating_add(turn) } else { place };
                    interpolate(place, end, (first.0.saturating_add(turn), first.1))
                }
            };
        }
        let at = interval(0, last, |at| x.get(at).is_some_and(|x| *x <= place));
        match (point(at), point(at.saturating_add(1))) {
            (Some(before), Some(behind)) => interpolate(place, before, behind),
            _ => end.1,
        }
    }
}

/// Returns the linear interpolation between two points; a half is rounded up.
fn interpolate(place: i64, (x, y): (i64, i64), (to_x, to_y): (i64, i64)) -> i64 {
    let way = i128::from(to_x) - i128::from(x);
    if way <= 0 {
        return y;
    }
    let gone = (i128::from(place) - i128::from(x)).clamp(0, way);
    // 2^33 * 2^62 at most, twice.
    let scaled = 2 * (i128::from(to_y) - i128::from(y)) * gone + way;
    y.saturating_add(scaled.div_euclid(2 * way) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn table(points: &[(i64, i64)]) -> Table {
        let (x, y): (Vec<_>, Vec<_>) = points.iter().copied().unzip();
        Table::new(Form::Xy, &x, &y).expect("points")
    }

    /// By hand: 12 inc on 100 is 0.12 inc per increment of distance, -6 on 60 is -0.1.
    #[test]
    fn between_points_are_straight_lines_and_beyond_them_the_ends() {
        let pitch = table(&[(-20, 4), (100, 16), (160, 10)]);
        assert_eq!(pitch.check_pitch(None), Ok(()));
        for (place, error) in [
            (i64::MIN, 4),
            (-21, 4),
            (-20, 4),
            (-16, 4),
            (-15, 5),
            (0, 6),
            (44, 10),
            (45, 11),
            (100, 16),
            (104, 16),
            (105, 16),
            (106, 15),
            (159, 10),
            (160, 10),
            (161, 10),
            (i64::MAX, 10),
        ] {
            assert_eq!(pitch.pitch_at(place, None), error, "{place}");
        }
    }

    #[test]
    fn a_turn_leads_from_the_last_point_to_the_first_one() {
        let pitch = table(&[(100, 5), (300, -15)]);
        assert_eq!(pitch.check_pitch(Some(1_000)), Ok(()));
        // 20 inc on the remaining 800: one per 40.
        for (place, error) in [(100, 5), (300, -15), (340, -14), (700, -5), (999, 2), (0, 3), (20, 3), (99, 5)] {
            assert_eq!(pitch.pitch_at(place, Some(1_000)), error, "{place}");
        }
    }

    #[test]
    fn invalid_pitch_error_is_reported_with_point() {
        let of = |points: &[(i64, i64)], turn| table(points).check_pitch(turn);
        let even = Table::new(Form::Y, &[], &[0, 1]).expect("values");
        assert_eq!(even.check_pitch(None), Err(PitchError::Form(Form::Y)));
        assert_eq!(of(&[(5, 0)], None), Err(PitchError::Few(1)));
        assert_eq!(of(&[(0, 0), (100, 10), (100, 10)], None), Err(PitchError::Order { point: 3, x: 100 }));
        assert_eq!(of(&[(0, 0), (100, 11)], None), Err(PitchError::Steep { point: 2, change: 11, way: 100 }));
        assert_eq!(of(&[(0, 0), (100, -10)], None), Ok(()));
        assert_eq!(of(&[(-1, 0), (100, 0)], Some(200)), Err(PitchError::Turn { point: 1, x: -1, turn: 200 }));
        assert_eq!(of(&[(0, 0), (200, 0)], Some(200)), Err(PitchError::Turn { point: 2, x: 200, turn: 200 }));
        // Down by 10 again on the last 90.
        assert_eq!(of(&[(0, 0), (110, 10)], Some(200)), Err(PitchError::Steep { point: 1, change: -10, way: 90 }));
        assert_eq!(of(&[(0, 0), (100, 10)], Some(200)), Ok(()));
        let sentence = PitchError::Steep { point: 2, change: 11, way: 100 }.to_string();
        assert_eq!(
            sentence,
            "up to point 2 a pitch error changes by 11 inc on 100 inc; a part of 10 of the way is possible"
        );
        let widest = [(i64::from(i32::MIN), i64::from(i32::MIN)), (i64::from(i32::MAX), i64::from(i32::MAX))];
        assert!(matches!(of(&widest, None), Err(PitchError::Steep { .. })));
        assert_eq!(table(&widest).pitch_at(0, None), 0);
    }

    proptest! {
        /// Errors of neighbouring positions differ by at most one increment, and a position plus its error keeps its
        /// order.
        #[test]
        fn the_error_changes_by_no_more_than_an_increment_from_place_to_place(
            steps in prop::collection::vec((10_i64..5_000, -1.0..=1.0_f64), 1..30),
            start in -1_000_000..1_000_000_i64,
            turns in any::<bool>(),
        ) {
            let mut points = vec![(if turns { 0 } else { start }, 0_i64)];
            for (way, share) in steps {
                let (x, y) = *points.last().expect("a first one");
                points.push((x + way, y + (way as f64 / 10.0 * share) as i64));
            }
            let (x, y) = *points.last().expect("a last one");
            let turn = turns.then_some(x + y.abs() * MAX_SLOPE_DIVISOR + 1);
            let pitch = table(&points);
            prop_assert_eq!(pitch.check_pitch(turn), Ok(()));
            for (x, y) in points {
                prop_assert_eq!(pitch.pitch_at(x, turn), y);
            }
            let (from, to) = turn.map_or((start - 3, x + 3), |turn| (0, turn - 1));
            let mut last = pitch.pitch_at(turn.map_or(from, |turn| turn - 1), turn);
            for place in (from..=to).take(20_000) {
                let here = pitch.pitch_at(place, turn);
                prop_assert!((here - last).abs() <= 1, "{} at {}", here - last, place);
                last = here;
            }
        }
    }
}
