//! Ramps that drive a signal: exact fractions, with an end or as a counter that wraps.

use super::{ALL_WHOLE, EXACT, Number, Ruler, Type, Value};
use lineshaft_core::unit::{Fraction, fraction_from_f64, fraction_to_f64};
use num_traits::{CheckedDiv, CheckedSub, ToPrimitive};

/// (start + n step) / denominator; the sums of a whole scenario fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp {
    pub(super) start: i128,
    pub(super) step: i128,
    pub(super) denominator: i128,
    /// The first n at which the end is reached, and the end.
    pub(super) end: Option<(u64, Number)>,
    /// Bits that the signal gets of it; all of them without.
    pub(super) wrap: Option<u32>,
    pub(super) is_real: bool,
}

impl Ramp {
    pub(super) fn at(&self, n: u64) -> Number {
        if let Some((_, end)) = self.end.filter(|(reached, _)| n >= *reached) {
            return end;
        }
        if self.is_real {
            let value = self.start + self.step * i128::from(n);
            return Number::Real(fraction_to_f64(&Fraction::new(value, self.denominator)));
        }
        Number::Int(wrapped(self.floor(n), self.wrap))
    }

    pub(super) fn floor(&self, n: u64) -> i128 {
        (self.start + self.step * i128::from(n)).div_euclid(self.denominator)
    }

    /// Returns the range in which an f64 holds each value: +-2^53, times the largest power of 2 of which all values are multiples.
    pub(super) fn exact_range(&self) -> (i64, i64) {
        // With 2^10 the 53 bits of an f64 reach as far as 64 bits do.
        const MOST_ZEROS: u32 = 10;
        let zeros = if self.denominator == 1 {
            self.start.trailing_zeros().min(self.step.trailing_zeros()).min(MOST_ZEROS)
        } else {
            0
        };
        match EXACT.1.checked_mul(1 << zeros) {
            Some(bound) => (-bound, bound),
            None => ALL_WHOLE,
        }
    }

    /// Returns the first n up to `last` at which the floor is beyond a range.
    pub(super) fn first_beyond(&self, last: u64, (low, high): (i64, i64)) -> Option<u64> {
        let is_inside = |n| (i128::from(low)..=i128::from(high)).contains(&self.floor(n));
        if !is_inside(0) {
            return Some(0);
        }
        if is_inside(last) {
            return None;
        }
        // A ramp that has left does not come back.
        let (mut inside, mut beyond) = (0, last);
        while beyond - inside > 1 {
            let middle = inside + (beyond - inside) / 2;
            if is_inside(middle) {
                inside = middle;
            } else {
                beyond = middle;
            }
        }
        Some(beyond)
    }
}

/// The low bits of a whole number as a signed one. Without `bits` the number fits, which was checked.
pub(super) fn wrapped(value: i128, bits: Option<u32>) -> i64 {
    let value = match bits {
        None => value,
        Some(bits) => {
            // 2^128, by which the sum may wrap, is a multiple of the counter's range.
            let half = 1_i128 << (bits - 1);
            value.wrapping_add(half).rem_euclid(2 * half) - half
        }
    };
    value.clamp(i64::MIN.into(), i64::MAX.into()) as i64
}

/// The most bits of a counter whose values are all within a range.
pub(super) fn most_bits((_, high): (i64, i64)) -> u32 {
    // Below 0 every range here goes at least as far as above it.
    (i128::from(high) + 1).ilog2() + 1
}

/// Bits of a counter that the signal can hold.
pub(super) fn wrap_bits(value: &Value<'_>, ruler: &Ruler) -> Option<u32> {
    if ruler.kind == Type::Real {
        value.refuse("wrap is for whole numbers; the signal is a real one", None);
        return None;
    }
    value.integer(2..=most_bits(ruler.range))
}

pub(super) fn exact(number: Number) -> Option<Fraction> {
    match number {
        Number::Int(value) => Some(Fraction::from(i128::from(value))),
        Number::Real(value) => fraction_from_f64(value).ok(),
    }
}

/// The first n at which `from + n step` has come to `until` or beyond.
pub(super) fn cycles_between(from: Number, until: Number, step: &Fraction) -> Option<u64> {
    let way = exact(until)?.checked_sub(&exact(from)?)?;
    if way == Fraction::from(0) {
        return Some(0);
    }
    way.checked_div(step)?.ceil().to_integer().to_u64()
}
