//! Conversion of inputs, with units and names, to values of the core.

use super::{Bare, Measure, Row, Value};
use crate::unit::{Dimension, Fraction, Quantity, Scale, Unit, UnitError, fraction_to_f64};
use num_traits::{CheckedDiv, ToPrimitive};

/// A value as it was given.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterInput {
    /// A number: in SI units, or plain for whole-number parameters.
    Number(f64),
    /// A whole number: in SI units, or plain for whole-number parameters.
    Integer(i64),
    /// A number with its unit.
    Quantity(Quantity),
    /// A name.
    Text(String),
    /// Not set: resets to the default of the row, if that is no value.
    Unset,
}

/// Error of a conversion; the row checks its range separately.
#[derive(Clone, Debug, PartialEq)]
pub enum ConvertError {
    /// Invalid unit, dimension or size.
    Unit(UnitError),
    /// Wrong type for the row: the value as text.
    Type(String),
}

impl Measure {
    /// Returns the order of the time derivative: 1 for a velocity, 2 for an acceleration, 3 for a jerk; `None` if it is
    /// no rate.
    pub fn order(self) -> Option<u8> {
        match self {
            Measure::Velocity => Some(1),
            Measure::Acceleration => Some(2),
            Measure::Jerk => Some(3),
            _ => None,
        }
    }

    /// Returns the dimensions of a quantity of this measure on an axis; `None` for plain numbers and names.
    pub fn dimensions(self, scale: &Scale) -> Option<[Dimension; 2]> {
        match self {
            Measure::Position | Measure::Distance => Some(scale.dimensions(0)),
            Measure::Velocity => Some(scale.dimensions(1)),
            Measure::Acceleration => Some(scale.dimensions(2)),
            Measure::Jerk => Some(scale.dimensions(3)),
            Measure::Time => Some([Dimension::Time; 2]),
            Measure::Integer | Measure::Number | Measure::Choice(_) => None,
        }
    }

    /// Returns the expected values as text.
    pub fn expected(self) -> String {
        match self {
            Measure::Position | Measure::Distance => "a position such as 10 mm".to_owned(),
            Measure::Velocity => "a velocity such as 0.5 m/s".to_owned(),
            Measure::Acceleration => "an acceleration such as 2 m/s^2".to_owned(),
            Measure::Jerk => "a jerk such as 50 m/s^3".to_owned(),
            Measure::Time => "a time such as 20 ms".to_owned(),
            Measure::Integer => "a whole number".to_owned(),
            Measure::Number => "a number".to_owned(),
            Measure::Choice(names) => format!("one of {}", names.join(", ")),
        }
    }
}

impl Row {
    /// Returns the unit in which a plain number of this row may be written; `None` if it has none, or one that files do
    /// not support.
    pub fn own_unit(&self) -> Option<Unit> {
        let is_plain = matches!(self.measure, Measure::Integer | Measure::Number);
        is_plain.then(|| Unit::parse(self.unit)).flatten()
    }

    /// Returns the expected values as text.
    pub fn expected(&self) -> String {
        let what = self.measure.expected();
        self.own_unit().map_or_else(|| what.clone(), |unit| format!("{what} in {unit}"))
    }
}

/// Converts an input to a value of a row on an axis of that scale.
///
/// # Errors
/// A value of another type, unit or size.
pub fn convert(row: &Row, scale: &Scale, input: &ParameterInput) -> Result<Value, ConvertError> {
    let mismatch = || Err(ConvertError::Type(text(input)));
    match (row.measure, input) {
        (_, ParameterInput::Unset) if row.default == Value::Unset && !row.required => Ok(Value::Unset),
        (_, ParameterInput::Unset) => mismatch(),
        (Measure::Integer, ParameterInput::Integer(value)) => Ok(Value::Int(*value)),
        (Measure::Choice(names), ParameterInput::Integer(value)) if names.get(*value as usize).is_some() => {
            Ok(Value::Int(*value))
        }
        (Measure::Choice(names), ParameterInput::Text(name)) => {
            names.iter().position(|known| known == name).map_or_else(mismatch, |place| Ok(Value::Int(place as i64)))
        }
        // Removes the sign of -0.
        (Measure::Number, ParameterInput::Number(number)) if number.is_finite() => Ok(Value::Real(*number + 0.0)),
        (Measure::Number, ParameterInput::Integer(number)) => Ok(Value::Real(*number as f64)),
        (Measure::Integer | Measure::Number, ParameterInput::Quantity(quantity)) => match row.own_unit() {
            Some(unit) => of_own_unit(row.measure, unit, quantity),
            None => mismatch(),
        },
        (Measure::Integer | Measure::Number | Measure::Choice(_), _) | (_, ParameterInput::Text(_)) => mismatch(),
        (measure, ParameterInput::Quantity(quantity)) => of_quantity(measure, scale, quantity),
        (_, ParameterInput::Number(number)) => of_number(row, scale, *number),
        (_, ParameterInput::Integer(number)) => of_number(row, scale, *number as f64),
    }
}

/// Below this limit a double distinguishes whole numbers.
const EXACT: f64 = (1_u64 << 52) as f64;

fn of_number(row: &Row, scale: &Scale, number: f64) -> Result<Value, ConvertError> {
    if row.measure == Measure::Time {
        // A computed number is rarely whole: it is rounded to the nearest, as for increments.
        let nanoseconds = (number * if row.bare == Bare::Milliseconds { 1e6 } else { 1e9 }).round();
        if nanoseconds.abs() < EXACT {
            return Ok(Value::Int(nanoseconds as i64));
        }
    }
    let order = match row.measure {
        Measure::Velocity => 1,
        Measure::Acceleration => 2,
        Measure::Jerk => 3,
        _ => 0,
    };
    let (number, unit) = match (row.measure, row.bare) {
        (Measure::Time, Bare::Milliseconds) => (number, Unit::MILLISECOND.into()),
        (Measure::Time, _) => (number, Unit::SECOND.into()),
        (_, Bare::Si | Bare::Milliseconds) => (number, scale.kind().dimension(order).si_unit().into()),
        (_, Bare::AxisUnit) => (number, scale.unit().with_order(order)),
        (_, Bare::AxisUnitPerMs) => (number * 1000.0, scale.unit().with_order(order)),
    };
    of_quantity(row.measure, scale, &unit.times_f64(number).map_err(ConvertError::Unit)?)
}

fn of_quantity(measure: Measure, scale: &Scale, quantity: &Quantity) -> Result<Value, ConvertError> {
    let rate = |order| scale.rate(quantity, order).map(Value::Real);
    let value = match measure {
        Measure::Velocity => rate(1),
        Measure::Acceleration => rate(2),
        Measure::Jerk => rate(3),
        Measure::Time => quantity.nanoseconds().map(Value::Int),
        _ => scale.position(quantity).map(Value::Int),
    };
    value.map_err(ConvertError::Unit)
}

/// Returns a quantity in the unit of the row.
fn of_own_unit(measure: Measure, unit: Unit, quantity: &Quantity) -> Result<Value, ConvertError> {
    let expected = unit.dimension();
    if quantity.unit().dimension() != expected {
        return Err(ConvertError::Unit(UnitError::wrong_dimension(*quantity, expected)));
    }
    let one = Quantity::new(Fraction::from_integer(1), unit);
    let exact = quantity.exact().zip(one.exact()).and_then(|(all, one)| all.checked_div(&one));
    if measure == Measure::Number {
        let number = exact.map_or_else(|| quantity.si() / one.si(), |number| fraction_to_f64(&number));
        return Ok(Value::Real(number + 0.0));
    }
    let whole = exact.filter(Fraction::is_integer).and_then(|number| number.to_integer().to_i64());
    whole.map(Value::Int).ok_or_else(|| ConvertError::Type(quantity.to_string()))
}

fn text(input: &ParameterInput) -> String {
    match input {
        ParameterInput::Number(value) => crate::unit::number_to_text(*value),
        ParameterInput::Integer(value) => value.to_string(),
        ParameterInput::Quantity(value) => value.to_string(),
        ParameterInput::Text(value) => crate::unit::excerpt(value),
        ParameterInput::Unset => "null".to_owned(),
    }
}
