//! The rates of a goal, as every request for one gives them.

use super::{Amount, RequestError, Units, bad_value};
use crate::unit::Scale;

/// How fast a goal may move; each of them 0 asks for its default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// In mode velocity with its sign, and 0 is 0.
    pub velocity: Amount,
    /// Speeding up.
    pub acceleration: Amount,
    /// Slowing down.
    pub deceleration: Amount,
    /// Change of both.
    pub jerk: Amount,
}

impl Rates {
    /// Each rate by the name of its field, with its order.
    pub const FIELDS: [(&str, u8); 4] = [("velocity", 1), ("acceleration", 2), ("deceleration", 2), ("jerk", 3)];

    /// Bare numbers, in the order of the fields.
    pub fn numbers(numbers: [f64; 4]) -> Self {
        let [velocity, acceleration, deceleration, jerk] = numbers.map(Amount::Number);
        Self { velocity, acceleration, deceleration, jerk }
    }

    /// As the machine takes them, in the order of the fields (inc/s^order).
    pub(super) fn resolve(&self, units: Units, scale: &Scale) -> Result<[f64; 4], RequestError> {
        let mut rates = [0.0; 4];
        let amounts = [self.velocity, self.acceleration, self.deceleration, self.jerk];
        for ((rate, amount), (field, order)) in rates.iter_mut().zip(amounts).zip(Self::FIELDS) {
            *rate = amount.rate(units, scale, order).map_err(|error| bad_value(field, error))?;
        }
        Ok(rates)
    }
}
