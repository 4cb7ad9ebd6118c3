//! Axis unit: a unit such as `mm`, or a multiple of one such as `0.1 mm`.
//!
//! Law      a number in the axis unit is that multiple of its share, exact: 9000 in `0.1 mm` are 900 mm
//! Refuses  a share that is not above 0, results beyond 128 bits
//! Source   the user unit (UU) of MACS-UNIT-01 and AMC-PAR, the basic resolution of WF-MD-21

use super::{Fraction, Quantity, Unit, UnitError, fraction_from_f64, fraction_to_text};
use num_traits::{CheckedMul, One, Signed};
use std::fmt;

/// A unit, or a multiple of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisUnit {
    share: Fraction,
    unit: Unit,
}

impl AxisUnit {
    /// Creates the axis unit of a share such as 0.1 mm.
    ///
    /// # Errors
    /// [`UnitError::NotPositive`].
    pub fn new(one: Quantity) -> Result<Self, UnitError> {
        let (share, unit) = (one.value(), one.unit());
        if share.is_positive() {
            Ok(Self { share, unit })
        } else {
            Err(UnitError::NotPositive { part: "unit", value: share })
        }
    }

    /// Returns the unit of the share.
    pub fn unit(self) -> Unit {
        self.unit
    }

    /// Returns true if the share is 1.
    pub fn is_whole(self) -> bool {
        self.share.is_one()
    }

    /// Returns the unit per second to the power `order` (0..=3).
    #[must_use]
    pub fn with_order(self, order: u8) -> Self {
        Self { unit: self.unit.with_order(order), ..self }
    }

    /// Returns that number of axis units as a quantity.
    ///
    /// # Errors
    /// [`UnitError::TooManyDigits`].
    pub fn times(self, number: Fraction) -> Result<Quantity, UnitError> {
        let value = number.checked_mul(&self.share);
        let value = value.ok_or_else(|| UnitError::TooManyDigits { text: fraction_to_text(&number) })?;
        Ok(Quantity::new(value, self.unit))
    }

    /// Returns that number of axis units, by the shortest decimal of an f64.
    ///
    /// # Errors
    /// [`UnitError::NotFinite`]; as [`AxisUnit::times`].
    pub fn times_f64(self, number: f64) -> Result<Quantity, UnitError> {
        self.times(fraction_from_f64(number)?)
    }

    /// Returns a number of axis units as text: `900 mm`, `9000 * 0.1 mm`.
    pub(super) fn text(self, number: &str) -> String {
        if self.is_whole() { format!("{number} {}", self.unit) } else { format!("{number} * {self}") }
    }

    pub(super) fn share(self) -> Fraction {
        self.share
    }
}

impl From<Unit> for AxisUnit {
    fn from(unit: Unit) -> Self {
        Self { share: Fraction::from_integer(1), unit }
    }
}

impl fmt::Display for AxisUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_whole() {
            write!(f, "{} ", fraction_to_text(&self.share))?;
        }
        self.unit.fmt(f)
    }
}
