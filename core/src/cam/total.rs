//! The exact scaled output of a cam since its start.
//!
//! Law      total = floor((sum of the ends + y(x)) * K / 2^n), rounded once: the fraction of an increment in a scaled
//!          end is kept
//! Source   AMK-FIPW-04 to -06, AMK-XFIPW-07, -13, A-04, A-05, A-21

use super::curve::Point;
use serde::{Deserialize, Serialize};

/// A factor K / 2^n.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Scale {
    /// K, 16 bits signed.
    pub mult: i64,
    /// n, 0 to 15.
    pub div_exp: u32,
}

impl Default for Scale {
    fn default() -> Self {
        Self { mult: 1, div_exp: 0 }
    }
}

impl Scale {
    fn mask(self) -> i64 {
        (1_i64 << self.div_exp.min(15)) - 1
    }

    fn shift(self) -> u32 {
        self.div_exp.min(15)
    }
}

/// The scaled sum of all ends that were passed. It wraps at 64 bits, as every sink does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Total {
    whole: i64,
    /// Remainder, in units of 1 / 2^n.
    rest: i64,
}

impl Total {
    /// Adds the end of a table, passed `times` times; negative: backward.
    #[inline]
    pub fn pass(&mut self, end: i64, times: i64, scale: Scale) {
        // An end has 32 bits, K has 16: with any number of times the product has at most 111.
        let sum = i128::from(end) * i128::from(scale.mult) * i128::from(times) + i128::from(self.rest);
        self.whole = self.whole.wrapping_add((sum >> scale.shift()) as i64);
        self.rest = sum as i64 & scale.mask();
    }

    /// Returns the total at a point of the present table.
    ///
    /// Values have 32 bits, rises and K 16, a part fewer than 31, n is at most 15: the result fits 63 bits.
    #[inline]
    pub fn at(self, point: Point, scale: Scale) -> i64 {
        let Point { y, rise, part, whole } = point;
        if scale == Scale::default() {
            let between = rise.wrapping_mul(part).checked_div_euclid(whole).unwrap_or(0);
            return self.whole.wrapping_add(y).wrapping_add(between);
        }
        let scaled = y.wrapping_mul(scale.mult).wrapping_add(self.rest);
        let rest = (scaled & scale.mask()).wrapping_mul(whole);
        let between = rise.wrapping_mul(scale.mult).wrapping_mul(part).wrapping_add(rest);
        let between = between.checked_div_euclid(whole << scale.shift()).unwrap_or(0);
        self.whole.wrapping_add(scaled >> scale.shift()).wrapping_add(between)
    }

    /// Returns the total between two tables.
    #[inline]
    pub fn at_end(self) -> i64 {
        self.whole
    }

    /// Whether the state is possible.
    pub fn is_sound(self) -> bool {
        (0..1 << 15).contains(&self.rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Proves: AMK-FIPW-O3
    #[test]
    fn half_increment_at_an_end_is_kept() {
        let scale = Scale { mult: 1, div_exp: 1 };
        let mut total = Total::default();
        total.pass(1001, 1, scale);
        assert_eq!(total.at_end(), 500);
        total.pass(1001, 1, scale);
        assert_eq!(total.at_end(), 1001);
        total.pass(1001, -2, scale);
        assert_eq!(total, Total::default());
    }

    /// Proves: AMK-FIPW-04, AMK-XFIPW-07, AMK-XFIPW-08
    #[test]
    fn a_factor_applies_to_the_sum() {
        let point = Point { y: 1000, rise: 500, part: 1250, whole: 2500 };
        let of = |mult, div_exp| Total::default().at(point, Scale { mult, div_exp });
        assert_eq!([of(1, 0), of(3, 1), of(-3, 1), of(1, 15), of(-1, 15), of(0, 0)], [1250, 1875, -1875, 0, -1, 0]);
    }

    proptest! {
        /// One rounding of the exact sum, after any history.
        #[test]
        fn a_total_is_the_exact_sum_rounded_down(
            passes in proptest::collection::vec((any::<i32>(), -1_000_i64..1_000), 0..8),
            mult in i16::MIN..=i16::MAX,
            div_exp in 0_u32..16,
            (y, rise) in (any::<i32>(), -32_767_i64..=32_767),
            (whole, share) in (1_i64..1 << 30, 0.0_f64..1.0),
        ) {
            let scale = Scale { mult: mult.into(), div_exp };
            let part = ((whole as f64 * share) as i64).min(whole - 1);
            let mut total = Total::default();
            let mut sum = i128::from(y);
            for (end, times) in passes {
                total.pass(end.into(), times, scale);
                sum += i128::from(end) * i128::from(times);
            }
            let exact = (sum * i128::from(whole) + i128::from(rise) * i128::from(part)) * i128::from(mult);
            let wanted = exact.div_euclid(i128::from(whole) << div_exp);
            let point = Point { y: y.into(), rise, part, whole };
            prop_assert_eq!(i128::from(total.at(point, scale)), wanted);
            prop_assert!(total.is_sound());
        }
    }
}
