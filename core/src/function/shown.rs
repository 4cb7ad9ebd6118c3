//! Additional signals of a function type, one for each value.

use crate::signal::{Measure, Type};

/// Maximum number of values that a slot publishes in addition to its inputs and outputs.
pub(super) const MOST_SHOWN: usize = 9;

/// Index of the answer to READ_VALUE among the values of a type that has one.
pub(super) const ANSWER: usize = 3;

const SAK_SHARE: Shown = Shown::position("sak_share", "what compensation of the following error adds to its sink");

const CORRECTION: Shown = Shown::position("correction", "what printing mark control has added to its sink so far");

const DEVIATION: Shown =
    Shown::position("deviation", "how far the last mark was from its place on the slave, 0 where there was none");

/// Values of a type with compensation of the following error.
pub(super) const OF_SAK: &[Shown] = &[SAK_SHARE];

/// Values of a type with printing mark control.
pub(super) const OF_MARKS: &[Shown] = &[SAK_SHARE, CORRECTION, DEVIATION];

/// Values of a type that answers READ_VALUE, whose answer is the last one.
pub(super) const OF_MARKS_AND_ANSWER: &[Shown] =
    &[SAK_SHARE, CORRECTION, DEVIATION, Shown::position("output_value", "what the last READ_VALUE has found")];

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
