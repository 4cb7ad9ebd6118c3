//! Ramps that drive a signal: exact fractions, with an end or as a wrapping counter.

use super::{ALL_WHOLE, EXACT, Number, Type, Value, ValueFormat};
use lineshaft_core::unit::{Fraction, fraction_from_f64, fraction_to_f64};
use num_traits::{CheckedDiv, CheckedSub, ToPrimitive};

/// (start + n step) / denominator; no sum of the scenario overflows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp {
    pub(super) start: i128,
    pub(super) step: i128,
    pub(super) denominator: i128,
    /// First n at which the end is reached, and the value at the end.
    pub(super) end: Option<(u64, Number)>,
    /// Number of bits that the signal gets; `None` for all bits.
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

    /// Returns the range in which an f64 represents each value exactly: +-2^53, times the largest power of 2 that
    /// divides all values.
    pub(super) fn exact_range(&self) -> (i64, i64) {
        // With 2^10, the 53 bits of an f64 cover 64 bits.
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

    /// Returns the first n up to `last` at which the floor is outside of a range.
    pub(super) fn first_beyond(&self, last: u64, (low, high): (i64, i64)) -> Option<u64> {
        let is_inside = |n| (i128::from(low)..=i128::from(high)).contains(&self.floor(n));
        if !is_inside(0) {
            return Some(0);
        }
        if is_inside(last) {
            return None;
        }
        // A ramp that has left the range does not return.
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

/// Returns the lower bits of an integer as a signed number. Without `bits` the number is in range, which was checked.
pub(super) fn wrapped(value: i128, bits: Option<u32>) -> i64 {
    let value = match bits {
        None => value,
        Some(bits) => {
            // If the sum wraps, it does so by 2^128, a multiple of the range of the counter.
            let half = 1_i128 << (bits - 1);
            value.wrapping_add(half).rem_euclid(2 * half) - half
        }
    };
    value.clamp(i64::MIN.into(), i64::MAX.into()) as i64
}

/// Returns the maximum number of bits of a counter whose values are all within a range.
pub(super) fn most_bits((_, high): (i64, i64)) -> u32 {
    // The negative part of every range here is at least as large as the positive one.
    (i128::from(high) + 1).ilog2() + 1
}

/// Reads the number of bits of a counter that fits the signal.
pub(super) fn wrap_bits(value: &Value<'_>, ruler: &ValueFormat) -> Option<u32> {
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

/// Returns the first n at which `from + n step` has reached `until`.
pub(super) fn cycles_between(from: Number, until: Number, step: &Fraction) -> Option<u64> {
    let way = exact(until)?.checked_sub(&exact(from)?)?;
    if way == Fraction::from(0) {
        return Some(0);
    }
    way.checked_div(step)?.ceil().to_integer().to_u64()
}
