//! Reads numbers of requests, with or without unit. The request checks the unit, as in all other interfaces.

use crate::document::Value;
use lineshaft_core::parameter::ParameterInput;
use lineshaft_core::request::Amount;
use lineshaft_core::unit::{Dimension, Quantity, Scale, Unit, UnitError, parse_decimal};

/// Limit of i64: 2^63.
const I64_END: f64 = (1_u64 << 63) as f64;

/// Reads a position (order 0), velocity, acceleration or jerk; a number without unit is in the units of the request.
pub(super) fn amount(value: &Value<'_>, order: u8, scale: Option<&Scale>, in_increments: bool) -> Option<Amount> {
    let text = value.text()?;
    match parse_decimal(text) {
        // Conversion to f64 would change a large number of increments.
        Ok(number) if in_increments => Some(Amount::Quantity(Quantity::new(number, Unit::INCREMENT.with_order(order)))),
        Ok(_) => value.number(f64::NEG_INFINITY..=f64::INFINITY).map(Amount::Number),
        Err(_) => {
            let expected =
                scale.map_or([Dimension::Length(order), Dimension::Increments(order)], |s| s.dimensions(order));
            quantity(value, text, &expected).map(Amount::Quantity)
        }
    }
}

/// Reads the value of a parameter: a number, a quantity or a name; `null` resets it to unset.
pub(in crate::scenario) fn parameter_input(
    value: &Value<'_>,
    dimensions: Option<[Dimension; 2]>,
) -> Option<ParameterInput> {
    if value.is_null() {
        return Some(ParameterInput::Unset);
    }
    let text = value.text()?;
    // Without a possible unit, every f64 is a valid number, including those too large for an integer, too small for a
    // fraction, and -0. With a unit, no integer is expected, and the range of the parameter refuses a large number.
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    let plain = number.filter(|number| dimensions.is_none() || number.abs() >= I64_END && value.is_integer());
    let is_real = plain.is_some_and(|number| number.abs() >= I64_END || (number == 0.0 && text.starts_with("-0.")));
    if value.is_integer() && !is_real {
        return value.integer(i64::MIN..=i64::MAX).map(ParameterInput::Integer);
    }
    if plain.is_some() || parse_decimal(text).is_ok() {
        return value.number(f64::NEG_INFINITY..=f64::INFINITY).map(ParameterInput::Number);
    }
    if text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        let expected = dimensions.unwrap_or([Dimension::Length(0), Dimension::Increments(0)]);
        return quantity(value, text, &expected).map(ParameterInput::Quantity);
    }
    Some(ParameterInput::Text(text.to_owned()))
}

/// Reads a quantity of any dimension; `expected` is for the error message.
fn quantity(value: &Value<'_>, text: &str, expected: &[Dimension]) -> Option<Quantity> {
    match Quantity::parse(text, expected) {
        Ok(quantity) | Err(UnitError::WrongDimension { given: quantity, .. }) => Some(quantity),
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}
