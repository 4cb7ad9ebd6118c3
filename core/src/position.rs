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
/// Limit below which a number of units of 2^-32 is rounded in 64 bits.
const NARROW: f64 = (1_u64 << 62) as f64;

/// A position or a difference of positions (inc) with a fraction of 2^-32.
///
/// Encoders and drives use whole values; positions that are generated or latched have a fraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Position(i128);

impl Position {
    /// Zero.
    pub const ZERO: Self = Self(0);
    /// Limit of legal positions: |position| < 2^62 inc.
    pub const LIMIT: i64 = 1 << 62;

    /// Returns a position of whole increments.
    pub const fn whole(increments: i64) -> Self {
        Self((increments as i128) << FRACTION_BITS)
    }

    /// Returns the value in units of 2^-32 inc.
    pub const fn raw(self) -> i128 {
        self.0
    }

    /// Returns the position of a value in units of 2^-32 inc.
    pub const fn from_raw(raw: i128) -> Self {
        Self(raw)
    }

    /// Returns the multiple of 2^-32 nearest to `increments`; NaN gives 0, infinities saturate.
    #[inline]
    pub fn from_f64(increments: f64) -> Self {
        // The product is exact (a power of two) unless it overflows to infinity.
        let raw = increments * ONE;
        if raw.abs() >= NARROW {
            return Self::from_far(raw);
        }
        // In 64 bits the conversion takes a tenth of the time. The remainder of the whole part is exact; NaN gives 0.
        let whole = raw as i64;
        let rest = raw - whole as f64;
        Self(i128::from(whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)))
    }

    #[cold]
    fn from_far(raw: f64) -> Self {
        // f64 to i128 saturates by definition.
        Self(raw.round() as i128)
    }

    /// Returns the value in increments, rounded to f64.
    #[inline]
    pub fn to_f64(self) -> f64 {
        // In 64 bits, if it fits, the conversion takes a tenth of the time.
        (if self.0 == i128::from(self.0 as i64) { self.0 as i64 as f64 } else { self.far_to_f64() }) / ONE
    }

    #[cold]
    fn far_to_f64(self) -> f64 {
        self.0 as f64
    }

    /// Returns the largest whole number of increments that does not exceed the value; saturates at i64.
    #[inline]
    pub fn floor(self) -> i64 {
        // A value beyond i64 has a significant upper half.
        let upper = (self.0 >> 64) as i64;
        if upper == i64::from(upper as i32) { (self.0 >> FRACTION_BITS) as i64 } else { self.far_floor() }
    }

    #[cold]
    fn far_floor(self) -> i64 {
        saturate(self.0 >> FRACTION_BITS)
    }

    /// Returns the smallest whole number of increments that is not below the value; saturates at i64.
    pub fn ceil(self) -> i64 {
        (-self).floor().saturating_neg()
    }

    /// Returns the nearest whole number of increments, half away from zero; saturates at i64.
    pub fn nearest(self) -> i64 {
        let half = 1_i128 << (FRACTION_BITS - 1);
        let magnitude = self.0.abs().saturating_add(half) >> FRACTION_BITS;
        saturate(if self.0 < 0 { -magnitude } else { magnitude })
    }

    /// Returns the remainder of [`floor`](Self::floor): 0 <= fraction < 1, exact in f64.
    #[inline]
    pub fn fraction(self) -> f64 {
        f64::from(self.0 as u32) / ONE
    }

    /// Returns the saturated value.
    #[cold]
    fn end(up: bool) -> Self {
        Self(if up { i128::MAX } else { i128::MIN })
    }

    /// Returns true if |position| < 2^62 inc.
    pub const fn is_legal(self) -> bool {
        self.0.unsigned_abs() < (Self::LIMIT as u128) << FRACTION_BITS
    }
}

#[inline]
fn saturate(value: i128) -> i64 {
    i64::try_from(value).unwrap_or(if value < 0 { i64::MIN } else { i64::MAX })
}

impl Add for Position {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        match self.0.checked_add(other.0) {
            Some(sum) => Self(sum),
            None => Self::end(other.0 > 0),
        }
    }
}

impl AddAssign for Position {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Position {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        match self.0.checked_sub(other.0) {
            Some(difference) => Self(difference),
            None => Self::end(other.0 < 0),
        }
    }
}

impl Neg for Position {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

/// A length in a command: nearest whole increments and the remainder of the rounding. `rest` is half an increment only
/// towards 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Length {
    /// Nearest whole increments, half away from zero.
    pub nearest: i64,
    /// Exact value minus `nearest`, to 2^-32 inc: with it repeated relative moves do not drift (MACS-UNIT-05).
    pub rest: Position,
}

impl Length {
    /// Returns a length of whole increments.
    pub const fn whole(increments: i64) -> Self {
        Self { nearest: increments, rest: Position::ZERO }
    }

    /// Returns the value to 2^-32 inc.
    pub fn exact(self) -> Position {
        Position::whole(self.nearest) + self.rest
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

    #[test]
    fn position_beyond_range_saturates() {
        let (low, high, one) = (Position(i128::MIN), Position(i128::MAX), Position(1));
        assert_eq!([high + one, low - one, high - low, low - high, -low], [high, low, high, low, high]);
        assert_eq!([high + low, low + one, high - one].map(Position::raw), [-1, i128::MIN + 1, i128::MAX - 1]);
    }

    proptest! {
        #[test]
        fn floor_and_fraction_make_the_whole(raw in -(1_i128 << 94)..(1_i128 << 94)) {
            let p = Position::from_raw(raw);
            let again = Position::whole(p.floor()) + Position::from_f64(p.fraction());
            prop_assert_eq!(p, again);
        }

        /// The fast and the general conversion are equal bit for bit, for every f64 and every position.
        #[test]
        fn fast_and_general_conversion_are_equal(
            bits in prop_oneof![any::<u64>(), (-4e9..4e9_f64).prop_map(f64::to_bits)],
            halves in -(1_i64 << 53)..1 << 53,
            raw in prop_oneof![
                any::<i128>(),
                any::<i64>().prop_map(i128::from),
                -(1_i128 << 66)..1 << 66,
                -(1_i128 << 96)..1 << 96,
            ],
        ) {
            let half = 0.5 * halves as f64 / ONE;
            for number in [f64::from_bits(bits), half, half.next_down(), half.next_up()] {
                let wide = (number * ONE).round() as i128;
                prop_assert_eq!(Position::from_f64(number).raw(), wide, "{}", number);
            }
            let position = Position::from_raw(raw);
            prop_assert_eq!(position.to_f64().to_bits(), (raw as f64 / ONE).to_bits());
            prop_assert_eq!(position.floor(), saturate(raw >> FRACTION_BITS));
            prop_assert_eq!(position.fraction(), (raw & ((1 << FRACTION_BITS) - 1)) as f64 / ONE);
        }
    }
}
