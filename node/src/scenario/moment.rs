//! Cycles and times of a scenario.
//!
//! Law      an integer is a cycle; a time is the first cycle with t_k >= it, k = ceil(time / T); `end` is the last cycle
//!          counted from a step, both may be negative: cycles before it
//! Refuses  a bare number that is not whole (cycles or seconds?), negative ones where nothing is counted from, parts of
//!          a nanosecond
//! Source   contract section 5

use crate::document::{Allowed, Value};
use lineshaft_core::unit::{Dimension, excerpt, parse_decimal};

/// Longest scenario: 31 years of 1 ms.
pub(super) const MAX_CYCLES: u64 = 1_000_000_000_000;

/// How far before a step a moment may lie (cycles): what was seen until it fired is kept so long.
pub(super) const MAX_BACK: u64 = 100_000;

/// A cycle, as it may be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    /// Negative: before what it is counted from.
    Cycle(i64),
    End,
}

impl Moment {
    /// Reads a cycle, a time or `end`.
    pub(super) fn read(value: &Value<'_>, cycle_ns: u64) -> Option<Self> {
        if value.peek() == Some("end") {
            return Some(Self::End);
        }
        cycles(value, cycle_ns).map(Self::cycle)
    }

    /// The same, counted from a step: it may lie up to [`MAX_BACK`] cycles before it.
    pub(super) fn read_relative(value: &Value<'_>, cycle_ns: u64) -> Option<Self> {
        if !value.peek().is_some_and(|text| text.trim_start().starts_with('-')) {
            return Self::read(value, cycle_ns);
        }
        let back = if value.is_integer() {
            let least = -i64::try_from(MAX_CYCLES).unwrap_or(i64::MAX);
            value.integer(least..=0).map(i64::unsigned_abs)?
        } else {
            // The first cycle with t_k >= -time: of a part of a cycle nothing is before.
            let ns = time_ns(value, &Allowed::Any)?;
            ns.unsigned_abs() / cycle_ns
        };
        if back > MAX_BACK {
            let sentence = format!("{} is {back} cycles before the step; up to {MAX_BACK} are allowed", value.label());
            value.refuse(sentence, None);
            return None;
        }
        Some(Self::Cycle(-i64::try_from(back).ok()?))
    }

    fn cycle(cycle: u64) -> Self {
        // No scenario has that many cycles.
        Self::Cycle(i64::try_from(cycle).unwrap_or(i64::MAX))
    }

    /// Its cycle, counted from `base`; `end` is `last` from everywhere. None before cycle 0.
    pub(super) fn from(self, base: u64, last: u64) -> Option<u64> {
        match self {
            Self::Cycle(cycle) if cycle >= 0 => Some(base.saturating_add(cycle.unsigned_abs())),
            Self::Cycle(cycle) => base.checked_sub(cycle.unsigned_abs()),
            Self::End => Some(last),
        }
    }

    /// As [`Moment::from`]; what lies before cycle 0 is cycle 0.
    pub(super) fn after(self, base: u64, last: u64) -> u64 {
        self.from(base, last).unwrap_or(0)
    }

    /// How many cycles before what it is counted from it lies.
    pub(super) fn back(self) -> u64 {
        match self {
            Self::Cycle(cycle) if cycle < 0 => cycle.unsigned_abs(),
            _ => 0,
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
    if value.is_integer() {
        return value.integer(1..=MAX_CYCLES);
    }
    let cycles = cycles(value, cycle_ns)?;
    if cycles == 0 {
        value.refuse(format!("{} is 0; at least one cycle is allowed", value.label()), None);
        return None;
    }
    Some(cycles)
}

/// A time in nanoseconds, not negative.
pub(super) fn nanoseconds(value: &Value<'_>) -> Option<u64> {
    time_ns(value, &Allowed::NotNegative).and_then(|ns| u64::try_from(ns).ok())
}

fn time_ns(value: &Value<'_>, allowed: &Allowed) -> Option<i64> {
    if let Some(text) = bare(value) {
        let sentence = format!("{} is {text}; a whole number of cycles, or a time with its unit", value.label());
        value.refuse(format!("{sentence} is allowed"), Some(format!("write `{text} s`")));
        return None;
    }
    let quantity = value.quantity(&[Dimension::Time], allowed)?;
    match quantity.nanoseconds() {
        Ok(ns) => Some(ns),
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
