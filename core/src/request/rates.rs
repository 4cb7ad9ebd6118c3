//! Rates of a goal, common to all requests.

use super::{Amount, RequestError, Units, bad_value};
use crate::unit::Scale;

/// Velocity, acceleration, deceleration and jerk of a goal; 0 means the default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Velocity; in mode velocity it is signed, and 0 is 0.
    pub velocity: Amount,
    /// Acceleration.
    pub acceleration: Amount,
    /// Deceleration.
    pub deceleration: Amount,
    /// Jerk, for acceleration and deceleration.
    pub jerk: Amount,
}

impl Rates {
    /// The fields with their names and orders of the time derivative.
    pub const FIELDS: [(&str, u8); 4] = [("velocity", 1), ("acceleration", 2), ("deceleration", 2), ("jerk", 3)];

    /// Returns rates without units, in the order of the fields.
    pub fn numbers(numbers: [f64; 4]) -> Self {
        let [velocity, acceleration, deceleration, jerk] = numbers.map(Amount::Number);
        Self { velocity, acceleration, deceleration, jerk }
    }

    /// Returns rates in increments (inc/s^order), in the order of the fields.
    pub(super) fn in_increments(rates: [f64; 4]) -> Self {
        let [velocity, acceleration, deceleration, jerk] = rates.map(Amount::IncrementsPerTime);
        Self { velocity, acceleration, deceleration, jerk }
    }

    /// Converts the rates to increments, in the order of the fields (inc/s^order).
    pub(super) fn resolve(&self, units: Units, scale: &Scale) -> Result<[f64; 4], RequestError> {
        let mut rates = [0.0; 4];
        let amounts = [self.velocity, self.acceleration, self.deceleration, self.jerk];
        for ((rate, amount), (field, order)) in rates.iter_mut().zip(amounts).zip(Self::FIELDS) {
            *rate = amount.rate(units, scale, order).map_err(|error| bad_value(field, error))?;
        }
        Ok(rates)
    }
}
