//! Positions, rates, ratios and amounts as text.

use super::values::Scalar;
use lineshaft_core::position::Length;
use lineshaft_core::sync::gear::Ratio;
use lineshaft_core::unit::{Amount, Unit, fraction_to_digits};

/// Returns the amount as given; `None` for the number 0 without unit.
pub(super) fn amount(amount: Amount) -> Option<Scalar> {
    match amount {
        Amount::Number(number) => (number != 0.0).then_some(Scalar::Real(number)),
        Amount::Quantity(quantity) => {
            Some(Scalar::Text(format!("{} {}", fraction_to_digits(&quantity.value()), quantity.unit())))
        }
    }
}

pub(super) fn shift(value: Length) -> Option<String> {
    Some(value).filter(|value| *value != Length::default()).map(length)
}

pub(super) fn factor(ratio: Ratio) -> Option<String> {
    (ratio != Ratio::ONE).then(|| format!("{}/{}", ratio.numerator(), ratio.denominator()))
}

/// Returns a rate; `None` if it is the default.
pub(super) fn given(value: f64, order: u8) -> Option<String> {
    (value.to_bits() != 0).then(|| rate(value, order))
}

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
