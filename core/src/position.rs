//! Positions: whole increments and a fraction in units of 2^-32.
//!
//! Law      value = whole + fraction / 2^32, 0 <= fraction < 2^32, |value| < 2^62 (contract section 1)
//! Refuses  nothing: arithmetic is exact within the range above; beyond it saturates and never wraps

use serde::{Deserialize, Serialize};
use std::ops::{Add, AddAssign, Neg, Sub};

/// Bits of the fraction.
const FRACTION_BITS: u32 = 32;
/// One increment in units of 2^-32.
const ONE: f64 = (1_u64 << FRACTION_BITS) as f64;

/// A position or a difference of positions (inc) with a fraction of 2^-32.
///
/// Whole values are what encoders count and what drives are given; the fraction exists where a position is generated or
/// latched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Position(i128);

impl Position {
    /// Zero.
    pub const ZERO: Self = Self(0);
    /// Beyond every legal position: |position| < 2^62 inc.
    pub const LIMIT: i64 = 1 << 62;

    /// Whole increments.
    pub const fn whole(increments: i64) -> Self {
        Self((increments as i128) << FRACTION_BITS)
    }

    /// The value in units of 2^-32 inc.
    pub const fn raw(self) -> i128 {
        self.0
    }

    /// From units of 2^-32 inc.
    pub const fn from_raw(raw: i128) -> Self {
        Self(raw)
    }

    /// Nearest multiple of 2^-32 to `increments`; NaN gives 0, infinities saturate.
    pub fn from_f64(increments: f64) -> Self {
        // f64 to i128 saturates by definition; the product is exact (a power of two) unless it overflows to infinity.
        Self((increments * ONE).round() as i128)
    }

    /// The value in increments, rounded to f64.
    pub fn to_f64(self) -> f64 {
        self.0 as f64 / ONE
    }

    /// Largest whole number of increments that is not above the value; saturates at i64.
    pub fn floor(self) -> i64 {
        saturate(self.0 >> FRACTION_BITS)
    }

    /// Smallest whole number of increments that is not below the value; saturates at i64.
    pub fn ceil(self) -> i64 {
        (-self).floor().saturating_neg()
    }

    /// Nearest whole number of increments, half away from zero; saturates at i64.
    pub fn nearest(self) -> i64 {
        let half = 1_i128 << (FRACTION_BITS - 1);
        let magnitude = self.0.abs().saturating_add(half) >> FRACTION_BITS;
        saturate(if self.0 < 0 { -magnitude } else { magnitude })
    }

    /// What [`floor`](Self::floor) leaves: 0 <= fraction < 1, exact in f64.
    pub fn fraction(self) -> f64 {
        (self.0 & ((1 << FRACTION_BITS) - 1)) as f64 / ONE
    }

    /// True within |position| < 2^62 inc.
    pub const fn is_legal(self) -> bool {
        self.0.unsigned_abs() < (Self::LIMIT as u128) << FRACTION_BITS
    }
}

fn saturate(value: i128) -> i64 {
    i64::try_from(value).unwrap_or(if value < 0 { i64::MIN } else { i64::MAX })
}

impl Add for Position {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl AddAssign for Position {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Position {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Position {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_negative_fraction_floors_down() {
        let p = Position::from_f64(-0.25);
        assert_eq!((p.floor(), p.fraction()), (-1, 0.75));
    }

    /// Proves: MACS-UNIT-05
    #[test]
    fn halves_round_away_from_zero() {
        for (value, nearest) in [(0.5, 1), (-0.5, -1), (1.499, 1), (-1.5, -2), (2.5, 3), (0.0, 0)] {
            assert_eq!(Position::from_f64(value).nearest(), nearest, "{value}");
        }
    }

    #[test]
    fn the_legal_range_excludes_two_to_the_62() {
        assert!(Position::whole(Position::LIMIT - 1).is_legal());
        assert!(!Position::whole(Position::LIMIT).is_legal());
        assert!(!Position::whole(-Position::LIMIT).is_legal());
    }

    #[test]
    fn what_no_f64_holds_is_zero_or_saturates() {
        assert_eq!(Position::from_f64(f64::NAN), Position::ZERO);
        assert_eq!(Position::from_f64(f64::INFINITY).floor(), i64::MAX);
        assert_eq!(Position::from_f64(f64::NEG_INFINITY).floor(), i64::MIN);
    }

    proptest! {
        #[test]
        fn floor_and_fraction_make_the_whole(raw in -(1_i128 << 94)..(1_i128 << 94)) {
            let p = Position::from_raw(raw);
            let again = Position::whole(p.floor()) + Position::from_f64(p.fraction());
            prop_assert_eq!(p, again);
        }
    }
}
