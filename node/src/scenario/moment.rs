//! Reads cycles and times of a scenario.
//!
//! Law      an integer is a cycle; a time is the first cycle with t_k >= time, k = ceil(time / T); `end` is the last
//!          cycle. Relative to a step, both may be negative: cycles before it
//! Refuses  a number without unit that is no integer (cycles or seconds?), negative numbers that are not relative to a
//!          step, fractions of a nanosecond
//! Source   contract section 5

use crate::document::{Allowed, Value};
use lineshaft_core::unit::{Dimension, excerpt, parse_decimal};

/// Maximum length of a scenario: 31 years with 1 ms.
pub(super) const MAX_CYCLES: u64 = 1_000_000_000_000;

/// Maximum number of cycles before a step; the samples of these cycles are stored until it fires.
pub(super) const MAX_BACK: u64 = 100_000;

/// A cycle as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    /// A cycle; negative numbers are before the reference.
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

    /// Does the same relative to a step: up to [`MAX_BACK`] cycles before it are permitted.
    pub(super) fn read_relative(value: &Value<'_>, cycle_ns: u64) -> Option<Self> {
        if !value.peek().is_some_and(|text| text.trim_start().starts_with('-')) {
            return Self::read(value, cycle_ns);
        }
        let back = if value.is_integer() {
            let least = -i64::try_from(MAX_CYCLES).unwrap_or(i64::MAX);
            value.integer(least..=0).map(i64::unsigned_abs)?
        } else {
            // The first cycle with t_k >= -time: rounded towards the step.
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

    /// Returns the cycle, relative to `base`; `end` is always `last`. `None` before cycle 0.
    pub(super) fn from(self, base: u64, last: u64) -> Option<u64> {
        match self {
            Self::Cycle(cycle) if cycle >= 0 => Some(base.saturating_add(cycle.unsigned_abs())),
            Self::Cycle(cycle) => base.checked_sub(cycle.unsigned_abs()),
            Self::End => Some(last),
        }
    }

    /// Does the same as [`Moment::from`]; a cycle before cycle 0 gives cycle 0.
    pub(super) fn after(self, base: u64, last: u64) -> u64 {
        self.from(base, last).unwrap_or(0)
    }

    /// Returns the number of cycles before the reference.
    pub(super) fn back(self) -> u64 {
        match self {
            Self::Cycle(cycle) if cycle < 0 => cycle.unsigned_abs(),
            _ => 0,
        }
    }
}

/// Reads a number of cycles, or a time that is converted to it.
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

/// Does the same as [`cycles`], but at least one.
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

/// Reads a time, not negative; returns it in ns.
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

/// Returns the text of a number without unit.
pub(super) fn bare(value: &Value<'_>) -> Option<String> {
    let text = value.peek()?;
    parse_decimal(text).is_ok().then(|| excerpt(text))
}

/// Returns text such as `cycle 1500 (1.5 s)`.
pub(super) fn text(cycle: u64, cycle_ns: u64) -> String {
    format!("cycle {cycle} ({} s)", seconds(cycle, cycle_ns))
}

/// Returns t_k in s as an exact decimal.
pub(super) fn seconds(cycle: u64, cycle_ns: u64) -> String {
    let mut text = String::new();
    push_seconds(&mut text, cycle, cycle_ns);
    text
}

/// Does the same as [`seconds`], but appends to a text.
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
    // Writing to a string cannot fail.
    let _ = if digits == 0 { write!(text, "{whole}") } else { write!(text, "{whole}.{part:0digits$}") };
}
