//! What a type of function shows in addition to its lines: one signal for each value.

use crate::signal::{Measure, Type};

/// Values that a slot publishes in addition to its lines, at most.
pub(super) const MOST_SHOWN: usize = 9;

/// Place of what READ_VALUE has found among the values of a type that finds one.
pub(super) const ANSWER: usize = 3;

/// A value that a slot publishes in addition to its lines; 0 at rest, but for what READ_VALUE has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The end of the name of its signal.
    pub name: &'static str,
    /// How its word is read.
    pub kind: Type,
    /// What it measures.
    pub measure: Measure,
    /// What it is.
    pub help: &'static str,
}

impl Shown {
    /// A position or a distance (inc).
    pub(super) const fn position(name: &'static str, help: &'static str) -> Self {
        Self { name, kind: Type::Int, measure: Measure::Position, help }
    }

    /// A whole number without a unit.
    pub(super) const fn number(name: &'static str, help: &'static str) -> Self {
        Self { name, kind: Type::Int, measure: Measure::None, help }
    }

    /// A bit.
    pub(super) const fn bit(name: &'static str, help: &'static str) -> Self {
        Self { name, kind: Type::Bit, measure: Measure::None, help }
    }
}
