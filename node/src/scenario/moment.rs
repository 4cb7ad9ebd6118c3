//! Cycles and times of a scenario.
//!
//! Law      an integer is a cycle; a time is the first cycle with t_k >= it, k = ceil(time / T); `end` is the last cycle
//! Refuses  a bare number that is not whole (cycles or seconds?), negative ones, parts of a nanosecond
//! Source   contract section 5

use crate::document::{Allowed, Value};
use lineshaft_core::unit::{Dimension, excerpt, parse_decimal};

/// Longest scenario: 31 years of 1 ms.
pub(super) const MAX_CYCLES: u64 = 1_000_000_000_000;

/// A cycle, as it may be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    Cycle(u64),
    End,
}

impl Moment {
    /// Reads a cycle, a time or `end`.
    pub(super) fn read(value: &Value<'_>, cycle_ns: u64) -> Option<Self> {
        if value.peek() == Some("end") {
            return Some(Self::End);
        }
        cycles(value, cycle_ns).map(Self::Cycle)
    }

    /// Its cycle, counted from `base`; `end` is `last` from everywhere.
    pub(super) fn after(self, base: u64, last: u64) -> u64 {
        match self {
            Self::Cycle(cycle) => base.saturating_add(cycle),
            Self::End => last,
        }
    }
}

/// A cycle, or the number of cycles that a time takes.
pub(super) fn cycles(value: &Value<'_>, cycle_ns: u64) -> Option<u64> {
    if value.is_integer() {
        return value.integer(0..=MAX_CYCLES);
    }
    let ns = nanoseconds(value)?;
    let cycles = ns.div_ceil(cycle_ns);
    if cycles > MAX_CYCLES {
        value.refuse(format!("{} is {cycles} cycles; up to {MAX_CYCLES} are allowed", value.label()), None);
        return None;
    }
    Some(cycles)
}

/// As [`cycles`], but at least one.
pub(super) fn positive_cycles(value: &Value<'_>, cycle_ns: u64) -> Option<u64> {
    let cycles = cycles(value, cycle_ns)?;
    if cycles == 0 {
        value.refuse(format!("{} is 0; at least one cycle is allowed", value.label()), None);
        return None;
    }
    Some(cycles)
}

/// A time in nanoseconds, not negative.
pub(super) fn nanoseconds(value: &Value<'_>) -> Option<u64> {
    if let Some(text) = bare(value) {
        let sentence = format!("{} is {text}; a whole number of cycles, or a time with its unit", value.label());
        value.refuse(format!("{sentence} is allowed"), Some(format!("write `{text} s`")));
        return None;
    }
    let quantity = value.quantity(&[Dimension::Time], &Allowed::NotNegative)?;
    match quantity.nanoseconds() {
        Ok(ns) => u64::try_from(ns).ok(),
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}

/// The text of a number without a unit.
pub(super) fn bare(value: &Value<'_>) -> Option<String> {
    let text = value.peek()?;
    parse_decimal(text).is_ok().then(|| excerpt(text))
}

/// `cycle 1500 (1.5 s)`
pub(super) fn text(cycle: u64, cycle_ns: u64) -> String {
    format!("cycle {cycle} ({} s)", seconds(cycle, cycle_ns))
}

/// t_k (s) as an exact decimal.
pub(super) fn seconds(cycle: u64, cycle_ns: u64) -> String {
    let mut text = String::new();
    push_seconds(&mut text, cycle, cycle_ns);
    text
}

/// As [`seconds`], at the end of a text.
pub(super) fn push_seconds(text: &mut String, cycle: u64, cycle_ns: u64) {
    use std::fmt::Write;
    const SECOND: u128 = 1_000_000_000;
    let ns = u128::from(cycle) * u128::from(cycle_ns);
    let (whole, mut part) = (ns / SECOND, ns % SECOND);
    let mut digits = 9;
    while digits > 0 && part % 10 == 0 {
        part /= 10;
        digits -= 1;
    }
    // Writing to a text cannot fail.
    let _ = if digits == 0 { write!(text, "{whole}") } else { write!(text, "{whole}.{part:0digits$}") };
}
