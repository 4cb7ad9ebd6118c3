//! Reads values of a signal from a file, and formats them for a report.
//!
//! Law      numbers without unit are in the unit of the signal (inc, inc/s, V); quantities are converted with the scale
//!          of the object, integers to the nearest increment, half away from zero (contract section 1); enums are read
//!          by name
//!          values of parameters are read and written as in `set_parameters`

use super::moment::bare;
use super::names::{Names, did_you_mean, nearest};
use super::verb::parameter_input;
use crate::document::{Allowed, Value};
use lineshaft_core::code::Code;
use lineshaft_core::parameter::{self, ConvertError, Row, convert};
use lineshaft_core::signal::{Measure, Signal, Type, Value as Number};
use lineshaft_core::text::{expected_text, value_text};
use lineshaft_core::unit::{
    Dimension, Fraction, Quantity, Scale, UnitError, excerpt, fraction_to_f64, number_to_text, parse_decimal,
};

/// Format of the values of a signal, or of the difference of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValueFormat {
    pub kind: Type,
    pub measure: Measure,
    pub scale: Option<Scale>,
    /// Whether its values are error codes.
    pub is_code: bool,
    /// Bits of a signal that are compared; `None` for the whole signal.
    pub mask: Option<i64>,
    /// The row of a parameter.
    pub row: Option<&'static Row>,
    /// Minimum and maximum of integers.
    pub range: (i64, i64),
    /// Whether commands have its integers as f64, so that they must be exact.
    pub in_f64: bool,
}

/// Range of integers without narrower limits.
pub(super) const ALL_WHOLE: (i64, i64) = (i64::MIN, i64::MAX);

impl ValueFormat {
    pub(super) fn of(names: &Names<'_>, signal: Signal) -> Self {
        let entry = names.directory.entry(signal);
        Self {
            kind: entry.kind,
            measure: entry.measure,
            scale: names.scale_of(&entry.name),
            is_code: entry.kind == Type::Int
                && entry.measure == Measure::None
                && (entry.name.ends_with(".error") || entry.name.ends_with(".fault.code")),
            mask: None,
            row: None,
            range: ALL_WHOLE,
            in_f64: false,
        }
    }

    /// Returns the ruler of a parameter, with the same format as elsewhere.
    pub(super) fn of_parameter(row: &'static Row, scale: Scale) -> Self {
        let kind = match row.measure {
            parameter::Measure::Choice(names) => Type::Enum(names),
            parameter::Measure::Velocity
            | parameter::Measure::Acceleration
            | parameter::Measure::Jerk
            | parameter::Measure::Number => Type::Real,
            _ => Type::Int,
        };
        Self {
            kind,
            measure: Measure::None,
            scale: Some(scale),
            is_code: false,
            mask: None,
            row: Some(row),
            range: ALL_WHOLE,
            in_f64: false,
        }
    }

    /// Returns the ruler of positions of an object with that scale.
    pub(super) fn of_positions(scale: Scale) -> Self {
        let (kind, measure) = (Type::Int, Measure::Position);
        let scale = Some(scale);
        Self { kind, measure, scale, is_code: false, mask: None, row: None, range: ALL_WHOLE, in_f64: false }
    }

    /// Returns the same ruler with another range of integers.
    pub(super) fn within(self, range: (i64, i64)) -> Self {
        Self { range, ..self }
    }

    /// Whether the values have an order.
    pub(super) fn is_ordered(&self) -> bool {
        self.mask.is_none() && !matches!(self.kind, Type::Enum(_) | Type::Bit)
    }

    /// Reads a value.
    pub(super) fn read(&self, value: &Value<'_>) -> Option<Number> {
        if let Some((row, scale)) = self.row.zip(self.scale) {
            return read_parameter(value, row, &scale);
        }
        if let Some(mask) = self.mask {
            return read_bits(value, mask).map(Number::Int);
        }
        match self.kind {
            Type::Real => self.read_real(value).map(Number::Real),
            Type::Enum(names) if value.is_integer() => value.integer(0..=names.len() as i64 - 1).map(Number::Int),
            Type::Enum(names) => {
                let choices: Vec<_> = names.iter().copied().zip(0_i64..).collect();
                value.choice(&choices).map(Number::Int)
            }
            Type::Bit if value.peek() == Some("true") => Some(Number::Int(1)),
            Type::Bit if value.peek() == Some("false") => Some(Number::Int(0)),
            Type::Bit => value.integer(0..=1_i64).map(Number::Int),
            Type::Int | Type::Word => self.read_int(value).map(Number::Int),
        }
    }

    /// Reads a difference of values; it must not be negative.
    pub(super) fn read_tolerance(&self, value: &Value<'_>) -> Option<Number> {
        let number = self.read(value)?;
        if number.to_f64() < 0.0 {
            value.refuse(format!("{} is {}; 0 and above is allowed", value.label(), self.text(number)), None);
            return None;
        }
        Some(number)
    }

    fn read_int(&self, value: &Value<'_>) -> Option<i64> {
        match self.scale {
            Some(scale) if self.order() == Some(0) && !value.is_integer() => {
                if let Some(text) = bare(value) {
                    let sentence =
                        format!("{} is {text}; whole increments, or a position with its unit", value.label());
                    let hint = parse_decimal(&text).ok().and_then(|number| hint_of_fraction(&scale, number));
                    value.refuse(format!("{sentence} is allowed"), hint);
                    return None;
                }
                let quantity = value.quantity_in(Some(scale.unit().unit()), &scale.dimensions(0), &Allowed::Any)?;
                good(value, scale.position(&quantity))
            }
            _ if self.is_code => read_code(value).map(i64::from),
            _ => {
                let whole = value.integer(self.range.0..=self.range.1)?;
                (!self.in_f64 || refuse_inexact(value, whole, self.range)).then_some(whole)
            }
        }
    }

    fn read_real(&self, value: &Value<'_>) -> Option<f64> {
        if bare(value).is_some() {
            return value.number(f64::NEG_INFINITY..=f64::INFINITY);
        }
        match (self.scale, self.order(), self.measure) {
            (Some(scale), Some(order), _) => {
                let quantity = value.quantity_in(Some(scale.unit().unit()), &scale.dimensions(order), &Allowed::Any)?;
                good(value, real(&scale, &quantity, order))
            }
            (_, _, Measure::Voltage) => {
                value.quantity(&[Dimension::Voltage], &Allowed::Any).map(|quantity| quantity.si())
            }
            _ => value.number(f64::NEG_INFINITY..=f64::INFINITY),
        }
    }

    /// Returns the order of the derivative of a position.
    fn order(&self) -> Option<u8> {
        match self.measure {
            Measure::Position => Some(0),
            Measure::Velocity => Some(1),
            Measure::Acceleration => Some(2),
            Measure::Jerk => Some(3),
            Measure::None | Measure::Voltage => None,
        }
    }

    /// Formats a value in the unit of the signal and in the axis unit: `12582912 inc (120 mm)`.
    pub(super) fn text(&self, number: Number) -> String {
        if let Some((row, scale)) = self.row.zip(self.scale) {
            return parameter_text(row, number, &scale);
        }
        if let (Some(_), Number::Int(bits)) = (self.mask, number) {
            return format!("{bits:#x}");
        }
        let plain = match (number, self.kind) {
            (Number::Int(place), Type::Enum(names)) => {
                let name = usize::try_from(place).ok().and_then(|place| names.get(place));
                return name.map_or_else(|| place.to_string(), |name| (*name).to_owned());
            }
            (Number::Int(value), _) => value.to_string(),
            (Number::Real(value), _) => number_to_text(value),
        };
        if self.is_code {
            let name = Code::rows().find(|row| number == Number::Int(row.code.0.into())).map(|row| row.name);
            return name.filter(|_| number != Number::Int(0)).map_or(plain.clone(), |name| format!("{plain} ({name})"));
        }
        let unit = self.measure.unit();
        let own = if unit.is_empty() { plain } else { format!("{plain} {unit}") };
        match (self.scale.filter(|scale| !scale.is_in_increments()), self.order(), number) {
            (Some(scale), Some(0), Number::Int(value)) => format!("{own} ({})", scale.format_increments(value)),
            (Some(scale), Some(order), _) => format!("{own} ({})", scale.format_rate(number.to_f64(), order)),
            _ => own,
        }
    }
}

/// Returns true if an f64 represents an integer exactly: every one up to 2^53, beyond that only some.
pub(super) fn is_exact(whole: i64) -> bool {
    // The cast rounds to the nearest f64, at most 2^63.
    whole as f64 as i128 == i128::from(whole)
}

/// Returns true if an f64 represents an integer exactly. Otherwise refuses it, with the nearest one within the range as
/// hint.
pub(super) fn refuse_inexact(value: &Value<'_>, whole: i64, (low, high): (i64, i64)) -> bool {
    if is_exact(whole) {
        return true;
    }
    let nearest = whole as f64 as i128;
    let sentence = format!("{} is {whole}; beyond +-2^53 only what an f64 holds can be set", value.label());
    let fits = (i128::from(low)..=i128::from(high)).contains(&nearest);
    value.refuse(sentence, fits.then(|| format!("the nearest is {nearest}")));
    false
}

/// Reads the bits of a mask; refuses bits outside of it, which would always be 0.
fn read_bits(value: &Value<'_>, mask: i64) -> Option<i64> {
    let bits = value.integer(0..=i64::MAX)?;
    if bits & !mask != 0 {
        value.refuse(format!("{} is {bits:#x}, which has bits outside of the mask {mask:#x}", value.label()), None);
        return None;
    }
    Some(bits)
}

fn read_parameter(value: &Value<'_>, row: &Row, scale: &Scale) -> Option<Number> {
    let input = parameter_input(value, row.measure.dimensions(scale))?;
    match convert(row, scale, &input) {
        Ok(found) => Some(number(found)),
        Err(ConvertError::Unit(error)) => good(value, Err(error)),
        Err(ConvertError::Type(text)) => {
            let names = match row.measure {
                parameter::Measure::Choice(names) => names,
                _ => &[],
            };
            let hint = nearest(value.peek().unwrap_or_default(), names.iter().copied()).map(did_you_mean);
            value.refuse(format!("{} is {text}; {} is allowed", value.label(), expected_text(row, scale)), hint);
            None
        }
    }
}

/// Converts the value of a parameter to a number; an unset value to NaN.
pub(super) fn number(value: parameter::Value) -> Number {
    match value {
        parameter::Value::Unset => Number::Real(f64::NAN),
        parameter::Value::Int(value) => Number::Int(value),
        parameter::Value::Real(value) => Number::Real(value),
    }
}

fn parameter_text(row: &Row, number: Number, scale: &Scale) -> String {
    let value = match number {
        Number::Int(value) => parameter::Value::Int(value),
        Number::Real(value) if value.is_nan() => return "not set".to_owned(),
        Number::Real(value) => parameter::Value::Real(value),
    };
    // Two different values must have different texts.
    if let (parameter::Value::Real(rate), Some(order)) = (value, row.measure.order()) {
        return scale.format_rate_precisely(rate, order);
    }
    let unit = row.own_unit().map_or_else(String::new, |unit| format!(" {unit}"));
    value_text(row, value, scale) + &unit
}

fn real(scale: &Scale, quantity: &Quantity, order: u8) -> Result<f64, UnitError> {
    if order == 0 { scale.exact(quantity).map(|exact| fraction_to_f64(&exact)) } else { scale.rate(quantity, order) }
}

fn good<T>(value: &Value<'_>, result: Result<T, UnitError>) -> Option<T> {
    result.map_err(|error| value.refuse(format!("{}: {error}", value.label()), error.hint())).ok()
}

/// Returns a hint for a fraction without a unit, which is no number of increments. One below 1 was probably meant in
/// SI, as in a command.
fn hint_of_fraction(scale: &Scale, number: Fraction) -> Option<String> {
    let unit = scale.unit();
    let si = Quantity::new(number, scale.kind().dimension(0).si_unit());
    let is_small = number > Fraction::from(-1) && number < Fraction::from(1);
    if unit.unit() == si.unit() || !is_small && !scale.is_in_increments() {
        return unit.times(number).ok().map(|meant| format!("write `{meant}`"));
    }
    let whole = scale.position(&si).ok()?;
    let meant = scale.with_unit(unit.unit()).ok()?.format_increments(whole);
    Some(format!("a number without a unit is in increments; `{si}` is `{meant}`"))
}

/// Reads a code by number or name.
pub(super) fn read_code(value: &Value<'_>) -> Option<u32> {
    if value.is_integer() {
        return value.integer(0..=u32::MAX);
    }
    let text = value.text()?;
    let found = Code::rows().find(|row| row.name == text).map(|row| row.code.0);
    if found.is_none() {
        let hint = nearest(text, Code::rows().map(|row| row.name)).map(did_you_mean);
        value.refuse(format!("no code is called `{}`; a number or a name is expected", excerpt(text)), hint);
    }
    found
}
