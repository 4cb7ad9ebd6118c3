//! Additional signals of a function type, one for each value.

use crate::signal::{Measure, Type};

/// Maximum number of values that a slot publishes in addition to its inputs and outputs.
pub(super) const MOST_SHOWN: usize = 9;

/// Index of the answer to READ_VALUE among the values of a type that has one.
pub(super) const ANSWER: usize = 3;

/// A value that a slot publishes in addition to its inputs and outputs; 0 at rest, except the answer to READ_VALUE.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Last part of the name of its signal.
    pub name: &'static str,
    /// Type of its signal.
    pub kind: Type,
    /// Quantity that it measures.
    pub measure: Measure,
    /// Description.
    pub help: &'static str,
}

impl Shown {
    /// Returns a position or a distance (inc).
    pub(super) const fn position(name: &'static str, help: &'static str) -> Self {
        Self { name, kind: Type::Int, measure: Measure::Position, help }
    }

    /// Returns a whole number without a unit.
    pub(super) const fn number(name: &'static str, help: &'static str) -> Self {
        Self { name, kind: Type::Int, measure: Measure::None, help }
    }

    /// Returns a bit.
    pub(super) const fn bit(name: &'static str, help: &'static str) -> Self {
        Self { name, kind: Type::Bit, measure: Measure::None, help }
    }
}
