//! Numbers of requests, with or without a unit. Whether the unit fits is judged by the request, as at every other door.

use crate::document::Value;
use lineshaft_core::parameter::ParameterInput;
use lineshaft_core::request::Amount;
use lineshaft_core::unit::{Dimension, Quantity, Scale, Unit, UnitError, parse_decimal};

/// From here on no number is an i64: 2^63.
const I64_END: f64 = (1_u64 << 63) as f64;

/// A position (order 0), velocity, acceleration or jerk; a bare number is in the units of the request.
pub(super) fn amount(value: &Value<'_>, order: u8, scale: Option<&Scale>, in_increments: bool) -> Option<Amount> {
    let text = value.text()?;
    match parse_decimal(text) {
        // By way of an f64 a large number of increments would not be what the file says.
        Ok(number) if in_increments => Some(Amount::Quantity(Quantity::new(number, Unit::INCREMENT.with_order(order)))),
        Ok(_) => value.number(f64::NEG_INFINITY..=f64::INFINITY).map(Amount::Number),
        Err(_) => {
            let expected =
                scale.map_or([Dimension::Length(order), Dimension::Increments(order)], |s| s.dimensions(order));
            quantity(value, text, &expected).map(Amount::Quantity)
        }
    }
}

/// A parameter's value: a number, a quantity or a name; `null` takes it back to being left out.
pub(in crate::scenario) fn parameter_input(
    value: &Value<'_>,
    dimensions: Option<[Dimension; 2]>,
) -> Option<ParameterInput> {
    if value.is_null() {
        return Some(ParameterInput::Unset);
    }
    let text = value.text()?;
    // Where no unit is possible every f64 is a number: those too large for an integer, too small for a fraction, and -0.
    // Where one is, no integer is asked for, and a large number is for the range of the parameter to refuse.
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

/// A quantity of any dimension; `expected` is what a sentence asks for.
fn quantity(value: &Value<'_>, text: &str, expected: &[Dimension]) -> Option<Quantity> {
    match Quantity::parse(text, expected) {
        Ok(quantity) | Err(UnitError::WrongDimension { given: quantity, .. }) => Some(quantity),
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}
