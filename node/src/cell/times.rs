//! Reads times of a cell.

use super::names::quote;
use crate::document::{Allowed, Value, unit_of_bare};
use lineshaft_core::unit::Dimension;
use std::ops::RangeInclusive;

/// Reads a time of 0 to 10 s; returns it in ns.
pub(super) fn time(value: &Value<'_>) -> Option<u64> {
    time_up_to(value, 10)
}

/// Reads a time of 0 to `longest_s` seconds; returns it in ns.
pub(super) fn time_up_to(value: &Value<'_>, longest_s: u32) -> Option<u64> {
    time_within(value, 0..=u64::from(longest_s) * 1_000_000_000, &format!("0 s to {longest_s} s"))
}

/// Reads a time within a range, in ns; `allowed` is the text of the range.
pub(super) fn time_within(value: &Value<'_>, range: RangeInclusive<u64>, allowed: &str) -> Option<u64> {
    let time = value.quantity(&[Dimension::Time], &Allowed::Any)?;
    match time.nanoseconds() {
        Ok(ns) => {
            let ns = u64::try_from(ns).ok().filter(|ns| range.contains(ns));
            if ns.is_none() {
                let given = value.peek().unwrap_or_default();
                let hint = unit_of_bare(given, time.unit());
                value.refuse(format!("{} is {}; {allowed} is allowed", value.label(), quote(given)), hint);
            }
            ns
        }
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}
