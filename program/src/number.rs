//! Arithmetic of floats whose results have the same bits on every machine.
//!
//! Law      a calculation has a single NaN (0x7FC00000, 0x7FF8000000000000); operations that only move bits (abs, neg,
//!          copysign) keep them

use crate::trap::Trap;

/// A float of one width.
pub(crate) trait Float: Copy + PartialOrd {
    fn of(slot: u64) -> Self;
    fn bits(self) -> u64;
    fn widened(self) -> f64;
    fn is_nan(self) -> bool;
    fn is_negative(self) -> bool;
    fn nan() -> Self;
}

impl Float for f32 {
    #[inline(always)]
    fn of(slot: u64) -> Self {
        // The low 32 bits are the value.
        f32::from_bits(slot as u32)
    }
    #[inline(always)]
    fn bits(self) -> u64 {
        self.to_bits().into()
    }
    #[inline(always)]
    fn widened(self) -> f64 {
        self.into()
    }
    #[inline(always)]
    fn is_nan(self) -> bool {
        f32::is_nan(self)
    }
    #[inline(always)]
    fn is_negative(self) -> bool {
        self.is_sign_negative()
    }
    #[inline(always)]
    fn nan() -> Self {
        f32::from_bits(0x7FC0_0000)
    }
}

impl Float for f64 {
    #[inline(always)]
    fn of(slot: u64) -> Self {
        f64::from_bits(slot)
    }
    #[inline(always)]
    fn bits(self) -> u64 {
        self.to_bits()
    }
    #[inline(always)]
    fn widened(self) -> f64 {
        self
    }
    #[inline(always)]
    fn is_nan(self) -> bool {
        f64::is_nan(self)
    }
    #[inline(always)]
    fn is_negative(self) -> bool {
        self.is_sign_negative()
    }
    #[inline(always)]
    fn nan() -> Self {
        f64::from_bits(0x7FF8_0000_0000_0000)
    }
}

/// Returns the result of a calculation as a slot.
#[inline(always)]
pub(crate) fn result<F: Float>(value: F) -> u64 {
    if value.is_nan() { F::nan().bits() } else { value.bits() }
}

/// Returns the smaller value; -0 is below 0.
#[inline(always)]
pub(crate) fn min<F: Float>(a: F, b: F) -> u64 {
    if a.is_nan() || b.is_nan() {
        return F::nan().bits();
    }
    let is_a = if a == b { a.is_negative() } else { a < b };
    if is_a { a.bits() } else { b.bits() }
}

/// Returns the larger value; 0 is above -0.
#[inline(always)]
pub(crate) fn max<F: Float>(a: F, b: F) -> u64 {
    if a.is_nan() || b.is_nan() {
        return F::nan().bits();
    }
    let is_a = if a == b { b.is_negative() } else { a > b };
    if is_a { a.bits() } else { b.bits() }
}

/// Truncates a float to a whole number between two exclusive limits; exact, because every f32 and each limit is an f64.
#[inline(always)]
pub(crate) fn truncate<F: Float>(value: F, above: f64, below: f64) -> Result<f64, Trap> {
    let value = value.widened();
    if value > above && value < below {
        Ok(value)
    } else if f64::is_nan(value) {
        Err(Trap::NotANumber)
    } else {
        Err(Trap::IntegerOverflow)
    }
}

/// Exclusive limits of a conversion to a whole number: a value between them fits after truncation.
pub(crate) const I32: (f64, f64) = (-2_147_483_649.0, 2_147_483_648.0);
pub(crate) const U32: (f64, f64) = (-1.0, 4_294_967_296.0);
/// There is no f64 between -2^63 and the next one below it.
pub(crate) const I64: (f64, f64) = (-9_223_372_036_854_777_856.0, 9_223_372_036_854_775_808.0);
pub(crate) const U64: (f64, f64) = (-1.0, 18_446_744_073_709_551_616.0);
