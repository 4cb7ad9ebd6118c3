//! A table as a curve: straight lines between points at equal distances of the master or at given positions.
//!
//! Law      y: `i = floor(x * (N - 1) / L), y(x) = y[i] + (y[i+1] - y[i]) * (x * (N - 1) - i * L) / L`;
//!          xy: `X[i] <= x < X[i+1], y(x) = y[i] + (y[i+1] - y[i]) * (x - X[i]) / (X[i+1] - X[i]), L = X[N-1]`
//! Source   AMK-FIPW-01 to -03, AMK-XFIPW-04, -10 to -12, -25

use crate::table::{Table, interval};

/// Point on a curve: `y + rise * part / whole`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Point {
    /// Value of the table point before.
    pub y: i64,
    /// Difference from there to the next table point.
    pub rise: i64,
    /// Position in the interval, 0 <= part < whole.
    pub part: i64,
    /// Length of the interval, in the units of `part`.
    pub whole: i64,
}

/// The points of a table over `0 <= x < length`.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    x: &'a [i64],
    y: &'a [i64],
    length: i64,
    /// Units of `length` in one of `x`.
    parts: i64,
}

impl<'a> Curve<'a> {
    /// Returns a table as a curve; without table it is 0 everywhere. With equal distances it is `length` long, at least
    /// 1; a unit of given positions is `parts` units of the master.
    #[inline]
    pub fn new(table: Option<&'a Table>, length: i64, parts: i64) -> Self {
        let (x, y) = table.map_or((&[][..], &[][..]), |table| (table.x(), table.y()));
        let length = x.last().map_or(length, |last| last.saturating_mul(parts));
        Self { x, y, length: length.max(1), parts }
    }

    /// Returns its length (units of the master).
    #[inline]
    pub fn length(&self) -> i64 {
        self.length
    }

    /// Returns the value at its end.
    #[inline]
    pub fn end(&self) -> i64 {
        self.y.last().copied().unwrap_or(0)
    }

    /// Returns the point at `x`, 0 <= x < length. `near` is the index of the point before it, or near it, from which
    /// the search starts.
    #[inline]
    pub fn at(&self, x: i64, near: &mut u32) -> Point {
        let last = self.y.len().saturating_sub(2);
        let (i, part, whole) = if self.x.is_empty() { self.even(x, *near, last) } else { self.uneven(x, *near, last) };
        *near = i as u32;
        let value = |i: usize| self.y.get(i).copied().unwrap_or(0);
        let y = value(i);
        Point { y, rise: value(i + 1).wrapping_sub(y), part, whole }
    }

    /// Returns the interval and the position in it. Lengths are below 2^31 and points fewer than 2^20, so the products
    /// are below 2^51.
    #[inline]
    fn even(&self, x: i64, near: u32, last: usize) -> (usize, i64, i64) {
        let scaled = x.wrapping_mul(last as i64 + 1);
        let part = scaled.wrapping_sub(i64::from(near).wrapping_mul(self.length));
        // Most calls stay in their interval: a division takes as long as everything else.
        if (0..self.length).contains(&part) && near as usize <= last {
            return (near as usize, part, self.length);
        }
        let i = scaled.checked_div(self.length).map_or(0, |i| i.clamp(0, last as i64));
        (i as usize, scaled.wrapping_sub(i.wrapping_mul(self.length)), self.length)
    }

    #[inline]
    fn uneven(&self, x: i64, near: u32, last: usize) -> (usize, i64, i64) {
        let place = |i: usize| self.x.get(i).map_or(self.length, |place| place.saturating_mul(self.parts));
        let i = interval(near as usize, last, |i| x >= place(i));
        (i, x.wrapping_sub(place(i)), place(i + 1).wrapping_sub(place(i)).max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Form;
    use proptest::prelude::*;

    fn even(y: &[i64]) -> Table {
        Table::new(Form::Y, &[], y).expect("points")
    }

    fn uneven(points: &[(i64, i64)]) -> Table {
        let (x, y): (Vec<_>, Vec<_>) = points.iter().copied().unzip();
        Table::new(Form::Xy, &x, &y).expect("points")
    }

    /// Returns the value, rounded down.
    fn floor(point: Point) -> i64 {
        point.y + (point.rise * point.part).div_euclid(point.whole)
    }

    /// The table of section 3.10.2.
    const T: [i64; 9] = [0, 1000, 1500, 2000, 4000, 8000, 12_000, 15_000, 20_000];

    /// Proves: AMK-FIPW-03, AMK-XFIPW-10, AMK-XFIPW-11, AMK-XFIPW-12, AMK-XFIPW-25
    #[test]
    fn even_and_uneven_forms_agree() {
        let twin: Vec<_> = T.iter().enumerate().map(|(i, y)| (2500 * i as i64, *y)).collect();
        let (y, xy) = (even(&T), uneven(&twin));
        let (even, uneven) = (Curve::new(Some(&y), 20_000, 1), Curve::new(Some(&xy), 77, 1));
        assert_eq!((even.length(), uneven.length(), even.end(), uneven.end()), (20_000, 20_000, 20_000, 20_000));
        let (mut near, mut close) = (0, 0);
        for x in 0..20_000 {
            assert_eq!(floor(even.at(x, &mut near)), floor(uneven.at(x, &mut close)), "{x}");
        }
        for (x, value) in [(1250, 500), (2500, 1000), (3750, 1250), (10_000, 4000), (11_000, 5600), (19_999, 19_998)] {
            assert_eq!((floor(even.at(x, &mut near)), floor(uneven.at(x, &mut close))), (value, value), "{x}");
        }
    }

    #[test]
    fn places_may_be_finer_than_those_of_the_table() {
        let (coarse, fine) = (uneven(&[(0, 0), (2, 8), (3, 0)]), uneven(&[(0, 0), (8, 8), (12, 0)]));
        let (parts, whole) = (Curve::new(Some(&coarse), 0, 4), Curve::new(Some(&fine), 0, 1));
        assert_eq!((parts.length(), whole.length()), (12, 12));
        assert!((0..12).all(|x| parts.at(x, &mut 0) == whole.at(x, &mut 0)));
    }

    #[test]
    fn a_step_of_the_master_may_be_smaller_than_an_increment_and_larger_than_a_table() {
        let table = even(&[0, 7, -5]);
        let curve = Curve::new(Some(&table), 3, 1);
        // Intervals of 1.5: at 1 it is 2/3 of the first, at 2 1/3 of the second.
        assert_eq!([0, 1, 2].map(|x| floor(curve.at(x, &mut 0))), [0, 4, 3]);
    }

    /// The largest table with the longest master: no overflow.
    #[test]
    fn a_million_points_are_read_to_their_end() {
        const LENGTH: i64 = i32::MAX as i64;
        let y: Vec<i64> = (0..1_000_000).map(|i| i % 2 * 32_767).collect();
        let x: Vec<i64> = (0..1_000_000).map(|i| i * LENGTH / 999_999).collect();
        let (y, xy) = (even(&y), Table::new(Form::Xy, &x, &y).expect("points"));
        let (even, uneven) = (Curve::new(Some(&y), LENGTH, 1), Curve::new(Some(&xy), 0, 1));
        for place in [0, 1, 2147, 2148, LENGTH / 2, LENGTH - 2148, LENGTH - 1] {
            let i = i128::from(place) * 999_999 / i128::from(LENGTH);
            let part = i128::from(place) * 999_999 - i * i128::from(LENGTH);
            let odd = i % 2;
            for near in [0, 1, i as u32, 999_998, u32::MAX] {
                let Point { y, rise, part: found, whole } = even.at(place, &mut near.clone());
                assert_eq!((y, rise), (odd as i64 * 32_767, (1 - 2 * odd as i64) * 32_767), "{place} {near}");
                assert_eq!((i128::from(found), whole), (part, LENGTH), "{place} {near}");
                let j = x.partition_point(|at| *at <= place) - 1;
                let wanted = (place - x[j], x[j + 1] - x[j]);
                let found = uneven.at(place, &mut near.clone());
                assert_eq!((found.part, found.whole), wanted, "{place} {near}");
            }
        }
    }

    proptest! {
        /// With any hint the same point is found, and it is that of the law.
        #[test]
        fn a_hint_changes_nothing(
            steps in proptest::collection::vec((1_i64..400, -32_767_i64..=32_767), 1..40),
            length in 50_i64..32_768,
            places in proptest::collection::vec((0.0_f64..1.0, 0_u32..90), 1..30),
        ) {
            let mut points = vec![(0, 0)];
            for (wide, high) in steps {
                let (x, y) = points[points.len() - 1];
                points.push((x + wide, y + high));
            }
            let values: Vec<i64> = points.iter().map(|(_, y)| *y).collect();
            let (xy, y) = (uneven(&points), even(&values));
            let (uneven, even) = (Curve::new(Some(&xy), 0, 1), Curve::new(Some(&y), length, 1));
            for (place, near) in places {
                let x = (place * uneven.length() as f64) as i64;
                let i = points.iter().rposition(|(at, _)| *at <= x).expect("one");
                let (from, to) = (points[i], points[i + 1]);
                let wanted = Point { y: from.1, rise: to.1 - from.1, part: x - from.0, whole: to.0 - from.0 };
                prop_assert_eq!(uneven.at(x, &mut near.clone()), wanted);
                let x = (place * length as f64) as i64;
                let count = values.len() as i64 - 1;
                let i = x * count / length;
                let rise = values[i as usize + 1] - values[i as usize];
                let wanted = Point { y: values[i as usize], rise, part: x * count - i * length, whole: length };
                prop_assert_eq!(even.at(x, &mut near.clone()), wanted);
            }
        }
    }
}
