//! Positions and rates as text.

use lineshaft_core::position::Length;
use lineshaft_core::unit::Unit;

/// Formats a rate, in inc/s^order, as the shortest decimal that is read back as the same f64.
pub(in crate::recording::verb) fn rate(value: f64, order: u8) -> String {
    let unit = Unit::INCREMENT.with_order(order);
    let is_handy = value == 0.0 || (1e-5..1e16).contains(&value.abs());
    if is_handy { format!("{value} {unit}") } else { format!("{value:e} {unit}") }
}

/// Formats a position, in inc, rounded to the tenth decimal.
pub(in crate::recording::verb) fn length(value: Length) -> String {
    const FRACTION_BITS: u32 = 32;
    const DECIMALS: u128 = 10_u128.pow(10);
    let raw = value.exact().raw();
    let magnitude = raw.unsigned_abs();
    let (whole, fraction) = (magnitude >> FRACTION_BITS, magnitude & ((1 << FRACTION_BITS) - 1));
    // The largest fraction, 1 - 2^-32, gives 9999999998 after the point: no carry.
    let decimals = (fraction * DECIMALS + (1 << (FRACTION_BITS - 1))) >> FRACTION_BITS;
    let sign = if raw < 0 { "-" } else { "" };
    let text = format!("{sign}{whole}.{decimals:010}");
    format!("{} inc", text.trim_end_matches('0').trim_end_matches('.'))
}
