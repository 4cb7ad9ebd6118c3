//! Values from outside, with units and names, to values of the core.

use super::{Measure, Row, Value};
use crate::unit::{Dimension, Quantity, Scale, Unit, UnitError};

/// A value as it was given.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterInput {
    /// A number: SI, or whole for whole parameters.
    Number(f64),
    /// A whole number: SI, or itself for whole parameters.
    Integer(i64),
    /// With its unit.
    Quantity(Quantity),
    /// A name.
    Text(String),
    /// Left out: back to what the row's default means, where it has one without a value.
    Unset,
}

/// Why a value is none for a row; its range is checked by the row.
#[derive(Clone, Debug, PartialEq)]
pub enum ConvertError {
    /// Unit, dimension or size.
    Unit(UnitError),
    /// Not of the row's type: the value as text.
    Type(String),
}

impl Measure {
    /// Dimensions that a quantity of this measure may have on an axis; none for plain numbers and names.
    pub fn dimensions(self, scale: &Scale) -> Option<[Dimension; 2]> {
        match self {
            Measure::Position | Measure::Distance => Some(scale.dimensions(0)),
            Measure::Velocity => Some(scale.dimensions(1)),
            Measure::Acceleration => Some(scale.dimensions(2)),
            Measure::Jerk => Some(scale.dimensions(3)),
            Measure::Time => Some([Dimension::Time; 2]),
            Measure::Integer | Measure::Choice(_) => None,
        }
    }

    /// What a value may be, in words.
    pub fn expected(self) -> String {
        match self {
            Measure::Position | Measure::Distance => "a position such as 10 mm".to_owned(),
            Measure::Velocity => "a velocity such as 0.5 m/s".to_owned(),
            Measure::Acceleration => "an acceleration such as 2 m/s^2".to_owned(),
            Measure::Jerk => "a jerk such as 50 m/s^3".to_owned(),
            Measure::Time => "a time such as 20 ms".to_owned(),
            Measure::Integer => "a whole number".to_owned(),
            Measure::Choice(names) => format!("one of {}", names.join(", ")),
        }
    }
}

/// The value of a row on an axis of that scale.
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
        (Measure::Integer | Measure::Choice(_), _) | (_, ParameterInput::Text(_)) => mismatch(),
        (measure, ParameterInput::Quantity(quantity)) => of_quantity(measure, scale, quantity),
        (measure, ParameterInput::Number(number)) => of_number(measure, scale, *number),
        (measure, ParameterInput::Integer(number)) => of_number(measure, scale, *number as f64),
    }
}

fn of_number(measure: Measure, scale: &Scale, number: f64) -> Result<Value, ConvertError> {
    let unit = match measure {
        Measure::Time => Unit::SECOND,
        Measure::Velocity => scale.kind().dimension(1).si_unit(),
        Measure::Acceleration => scale.kind().dimension(2).si_unit(),
        Measure::Jerk => scale.kind().dimension(3).si_unit(),
        _ => scale.kind().dimension(0).si_unit(),
    };
    of_quantity(measure, scale, &Quantity::from_f64(number, unit).map_err(ConvertError::Unit)?)
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

fn text(input: &ParameterInput) -> String {
    match input {
        ParameterInput::Number(value) => value.to_string(),
        ParameterInput::Integer(value) => value.to_string(),
        ParameterInput::Quantity(value) => value.to_string(),
        ParameterInput::Text(value) => crate::unit::excerpt(value),
        ParameterInput::Unset => "null".to_owned(),
    }
}
