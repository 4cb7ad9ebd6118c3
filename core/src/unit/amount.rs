//! Amounts of a request, with or without a unit of their own.
//!
//! Law      a bare number is in the units of its request; what rounding to whole increments leaves is kept to 2^-32
//! Refuses  what a scale refuses
//! Source   contract section 7, MACS-UNIT-05

use super::{AxisUnit, Fraction, Quantity, Scale, Unit, UnitError, fraction_to_f64};
use crate::position::{Length, Position};

/// In which units a request gives its bare numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// m or rad, and their derivatives by s.
    #[default]
    Si,
    /// The axis unit, and its derivatives by s.
    AxisUnit,
    /// Increments, and their derivatives by s.
    Increments,
}

impl Units {
    /// The unit of a length with such a scale.
    pub fn unit(self, scale: &Scale) -> AxisUnit {
        match self {
            Self::Si => scale.kind().dimension(0).si_unit().into(),
            Self::AxisUnit => scale.unit(),
            Self::Increments => Unit::INCREMENT.into(),
        }
    }
}

/// A value of a request: a bare number in the request's units, or one with its own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// In the units of the request.
    Number(f64),
    /// In its own.
    Quantity(Quantity),
}

impl Default for Amount {
    fn default() -> Self {
        Self::Number(0.0)
    }
}

impl Amount {
    /// With its unit, as the derivative of that order.
    ///
    /// # Errors
    /// No finite number.
    pub fn quantity(self, units: Units, scale: &Scale, order: u8) -> Result<Quantity, UnitError> {
        match self {
            Self::Number(number) => units.unit(scale).with_order(order).times_f64(number),
            Self::Quantity(quantity) => Ok(quantity),
        }
    }

    /// As a position or distance (inc).
    ///
    /// # Errors
    /// No finite number, the wrong dimension, beyond 2^62 inc.
    pub fn length(self, units: Units, scale: &Scale) -> Result<Length, UnitError> {
        let quantity = self.quantity(units, scale, 0)?;
        let nearest = scale.position(&quantity)?;
        let exact = scale.exact(&quantity)?;
        Ok(Length { nearest, rest: rest(&exact, nearest) })
    }

    /// As a velocity (order 1), acceleration (2) or jerk (3) (inc/s^order).
    ///
    /// # Errors
    /// No finite number, the wrong dimension.
    pub fn rate(self, units: Units, scale: &Scale, order: u8) -> Result<f64, UnitError> {
        scale.rate(&self.quantity(units, scale, order)?, order)
    }
}

/// What rounding to `nearest` left, to 2^-32; below a half in truth it stays below a half.
fn rest(exact: &Fraction, nearest: i64) -> Position {
    let left = exact - Fraction::from_integer(nearest.into());
    let half = Fraction::new(1, 2);
    let position = Position::from_f64(fraction_to_f64(&left));
    let bound = Position::from_f64(0.5).raw() - i128::from(left < half && left > -half);
    Position::from_raw(position.raw().clamp(-bound, bound))
}
