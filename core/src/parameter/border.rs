//! Conversion of core values to numbers without units, for interfaces that have types but no units: the inverse of
//! `convert`.
//!
//! Law      a shown number converts back to the same value, if a number of 64 bits can do that; the number with the
//!          fewest digits is used, so that a value reads as it was written
//! Source   contract section 2: the unit of a number without a unit is that of the row

use super::{Bare, Measure, ParameterInput, Range, Refused, Row, Value, convert};
use crate::unit::Scale;

/// Type of a parameter at such an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BorderType {
    /// Off or on.
    Switch,
    /// A whole number.
    Integer,
    /// A number.
    Real,
    /// One of a list of names.
    Name,
}

/// Value at such an interface, in the unit of the row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BorderValue {
    /// Not set.
    Unset,
    /// Off or on.
    Switch(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// A name.
    Name(&'static str),
}

/// Permitted values, in the unit of the row. Both ends are included, except a low end that the range of the row
/// excludes ([`Range::PositiveUpTo`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BorderRange {
    /// Range of whole numbers.
    Integer {
        /// Minimum.
        low: i64,
        /// Maximum.
        high: i64,
        /// Step between two values.
        step: u64,
    },
    /// Range of numbers.
    Real {
        /// Minimum.
        low: f64,
        /// Maximum.
        high: f64,
        /// Step between two values; 0: any value.
        step: f64,
    },
}

impl From<BorderValue> for ParameterInput {
    fn from(value: BorderValue) -> Self {
        match value {
            BorderValue::Unset => Self::Unset,
            BorderValue::Switch(is_on) => Self::Text(is_on.to_string()),
            BorderValue::Integer(number) => Self::Integer(number),
            BorderValue::Real(number) => Self::Number(number),
            BorderValue::Name(name) => Self::Text(name.to_owned()),
        }
    }
}

impl Row {
    /// Returns the type of its values.
    pub fn border_type(&self) -> BorderType {
        match self.measure {
            Measure::Choice(["false", "true"]) => BorderType::Switch,
            Measure::Choice(_) => BorderType::Name,
            Measure::Integer => BorderType::Integer,
            _ => BorderType::Real,
        }
    }

    /// Returns the unit of its values on an axis of that scale; empty for none.
    pub fn border_unit(&self, scale: &Scale) -> String {
        let order = match self.measure {
            Measure::Position | Measure::Distance => 0,
            Measure::Velocity => 1,
            Measure::Acceleration => 2,
            Measure::Jerk => 3,
            Measure::Time if self.bare == Bare::Milliseconds => return "ms".to_owned(),
            Measure::Time => return "s".to_owned(),
            Measure::Choice(_) => return String::new(),
            Measure::Integer | Measure::Number => return self.unit.to_owned(),
        };
        match self.bare {
            Bare::Si | Bare::Milliseconds => scale.kind().dimension(order).si_unit().to_string(),
            Bare::AxisUnit => scale.unit().with_order(order).to_string(),
            Bare::AxisUnitPerMs => format!("{}/ms", scale.unit()),
        }
    }

    /// Converts a value of this row on an axis of that scale.
    pub fn to_border(&self, scale: &Scale, value: Value) -> BorderValue {
        match (value, self.measure) {
            (Value::Unset, _) => BorderValue::Unset,
            (Value::Int(place), Measure::Choice(names)) => {
                let name = usize::try_from(place).ok().and_then(|place| names.get(place));
                match self.border_type() {
                    BorderType::Switch => BorderValue::Switch(place == 1),
                    _ => name.map_or(BorderValue::Unset, |name| BorderValue::Name(name)),
                }
            }
            (Value::Int(number), Measure::Integer) => BorderValue::Integer(number),
            (Value::Real(number), Measure::Number) => BorderValue::Real(number),
            _ => BorderValue::Real(self.number(scale, value)),
        }
    }

    /// Returns the permitted values on an axis of that scale; `None` for names and switches.
    pub fn shown_range(&self, scale: &Scale) -> Option<BorderRange> {
        if matches!(self.measure, Measure::Choice(_)) {
            return None;
        }
        let (low, high) = match self.range {
            Range::Int(low, high) => (Value::Int(low), Value::Int(high)),
            // Gaps in the range are only described in text.
            Range::Among(ranges) => (Value::Int(ranges.first()?.0), Value::Int(ranges.last()?.1)),
            Range::PositiveUpTo(high) => (Value::Real(0.0), Value::Real(high)),
            Range::Real(low, high) => (Value::Real(low), Value::Real(high)),
        };
        Some(match (low, high, self.measure) {
            (Value::Int(low), Value::Int(high), Measure::Integer) => {
                BorderRange::Integer { low, high, step: self.step() }
            }
            _ => {
                let step = if self.step() > 0 { self.number(scale, Value::Int(1)) } else { 0.0 };
                let low = self.rounded_inwards(scale, self.number(scale, low), f64::next_up);
                let high = self.rounded_inwards(scale, self.number(scale, high), f64::next_down);
                BorderRange::Real { low, high, step }
            }
        })
    }

    /// Returns the number of a value with as few digits as it needs.
    fn number(&self, scale: &Scale, value: Value) -> f64 {
        let plain = self.plain_number(scale, value);
        let converts_back = |number: &f64| convert(self, scale, &ParameterInput::Number(*number)) == Ok(value);
        let short = |digits: usize| format!("{plain:.digits$e}").parse().unwrap_or(plain);
        let (below, above) = (plain.next_down(), plain.next_up());
        let near = [short(14), short(15), plain, below, above, below.next_down(), above.next_up()];
        near.into_iter().find(converts_back).unwrap_or(plain)
    }

    fn plain_number(&self, scale: &Scale, value: Value) -> f64 {
        let per_axis_unit = |bare: Bare| match bare {
            Bare::AxisUnit => Some(1.0),
            Bare::AxisUnitPerMs => Some(1000.0),
            Bare::Si | Bare::Milliseconds => None,
        };
        match (value, self.measure, per_axis_unit(self.bare)) {
            (Value::Unset, ..) => 0.0,
            (Value::Int(time), Measure::Time, _) if self.bare == Bare::Milliseconds => time as f64 / 1e6,
            (Value::Int(time), Measure::Time, _) => time as f64 / 1e9,
            (Value::Int(position), Measure::Position | Measure::Distance, Some(share)) => {
                scale.position_to_unit(position, 0.0) / share
            }
            (Value::Int(position), Measure::Position | Measure::Distance, None) => scale.position_to_si(position, 0.0),
            (Value::Real(rate), Measure::Velocity | Measure::Acceleration | Measure::Jerk, Some(share)) => {
                scale.rate_to_unit(rate) / share
            }
            (Value::Real(rate), Measure::Velocity | Measure::Acceleration | Measure::Jerk, None) => {
                scale.rate_to_si(rate)
            }
            (Value::Int(number), ..) => number as f64,
            (Value::Real(number), ..) => number,
        }
    }

    /// Returns the end of a range, rounded inwards if its last digit is outside.
    fn rounded_inwards(&self, scale: &Scale, end: f64, inwards: fn(f64) -> f64) -> f64 {
        let is_taken = |number: &f64| {
            let value = convert(self, scale, &ParameterInput::Number(*number));
            value.is_ok_and(|value| self.check(value) != Err(Refused::OutOfRange))
        };
        // 0 is not in a range above 0, but it is the end of the range.
        if end == 0.0 {
            return end;
        }
        std::iter::successors(Some(end), |number| Some(inwards(*number))).take(16).find(is_taken).unwrap_or(end)
    }
}

#[cfg(test)]
mod tests;
