//! Amounts of a request, with or without a unit of their own.
//!
//! Law      a number without a unit is in the units of its request; the remainder of rounding to whole increments is
//!          kept to 2^-32
//! Refuses  the errors of a scale
//! Source   contract section 7, MACS-UNIT-05

use super::{AxisUnit, Fraction, Quantity, Scale, Unit, UnitError, fraction_to_f64};
use crate::position::{Length, Position};

/// Units of the numbers in a request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// m or rad, and their time derivatives.
    #[default]
    Si,
    /// The axis unit, and its time derivatives.
    AxisUnit,
    /// Increments, and their time derivatives.
    Increments,
}

impl Units {
    /// Returns the unit of a length for that scale.
    pub fn unit(self, scale: &Scale) -> AxisUnit {
        match self {
            Self::Si => scale.kind().dimension(0).si_unit().into(),
            Self::AxisUnit => scale.unit(),
            Self::Increments => Unit::INCREMENT.into(),
        }
    }
}

/// A value of a request: a number in the units of the request, one with its own unit, or one that a command has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// A number in the units of the request.
    Number(f64),
    /// A number with its own unit.
    Quantity(Quantity),
    /// A position or distance (inc).
    Increments(Length),
    /// A velocity, acceleration or jerk (inc/s^order).
    IncrementsPerTime(f64),
}

impl Default for Amount {
    fn default() -> Self {
        Self::Number(0.0)
    }
}

impl Amount {
    /// Returns true for 0 in any unit.
    pub fn is_zero(&self) -> bool {
        match self {
            Self::Number(number) | Self::IncrementsPerTime(number) => *number == 0.0,
            Self::Quantity(quantity) => quantity.value() == Fraction::default(),
            Self::Increments(length) => *length == Length::default(),
        }
    }

    /// Returns the amount with its unit, as the derivative of that order.
    ///
    /// # Errors
    /// The number is not finite.
    pub fn quantity(self, units: Units, scale: &Scale, order: u8) -> Result<Quantity, UnitError> {
        match self {
            Self::Number(number) => units.unit(scale).with_order(order).times_f64(number),
            Self::Quantity(quantity) => Ok(quantity),
            Self::Increments(length) => {
                let value = Fraction::new(length.exact().raw(), Position::whole(1).raw());
                Ok(Quantity::new(value, Unit::INCREMENT))
            }
            Self::IncrementsPerTime(rate) => AxisUnit::from(Unit::INCREMENT).with_order(order).times_f64(rate),
        }
    }

    /// Converts to a position or distance (inc).
    ///
    /// # Errors
    /// The number is not finite, has the wrong dimension, or is beyond 2^62 inc.
    pub fn length(self, units: Units, scale: &Scale) -> Result<Length, UnitError> {
        if let Self::Increments(length) = self
            && length.nearest.unsigned_abs() < Position::LIMIT.unsigned_abs()
        {
            return Ok(length);
        }
        let quantity = self.quantity(units, scale, 0)?;
        let nearest = scale.position(&quantity)?;
        let exact = scale.exact(&quantity)?;
        Ok(Length { nearest, rest: rest(&exact, nearest) })
    }

    /// Converts to a velocity (order 1), acceleration (2) or jerk (3) (inc/s^order).
    ///
    /// # Errors
    /// The number is not finite, or has the wrong dimension.
    pub fn rate(self, units: Units, scale: &Scale, order: u8) -> Result<f64, UnitError> {
        match self {
            Self::IncrementsPerTime(rate) if rate.is_finite() => Ok(rate),
            _ => scale.rate(&self.quantity(units, scale, order)?, order),
        }
    }
}

/// Returns the remainder of rounding to `nearest`, to 2^-32; a remainder slightly below a half is not rounded up to a
/// half.
fn rest(exact: &Fraction, nearest: i64) -> Position {
    let left = exact - Fraction::from_integer(nearest.into());
    let half = Fraction::new(1, 2);
    let position = Position::from_f64(fraction_to_f64(&left));
    let bound = Position::from_f64(0.5).raw() - i128::from(left < half && left > -half);
    Position::from_raw(position.raw().clamp(-bound, bound))
}
