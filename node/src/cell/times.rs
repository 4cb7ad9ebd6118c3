//! Times of a cell.

use super::names::quote;
use crate::document::{Allowed, Value};
use lineshaft_core::unit::Dimension;

/// Reads a time of 0 to 10 s (ns).
pub(super) fn time(value: &Value<'_>) -> Option<u64> {
    time_up_to(value, 10)
}

/// Reads a time of 0 to so many seconds (ns).
pub(super) fn time_up_to(value: &Value<'_>, longest_s: u32) -> Option<u64> {
    let time = value.quantity(&[Dimension::Time], &Allowed::Any)?;
    let most = i64::from(longest_s) * 1_000_000_000;
    match time.nanoseconds() {
        Ok(ns) if (0..=most).contains(&ns) => u64::try_from(ns).ok(),
        Ok(_) => {
            let given = quote(value.peek().unwrap_or_default());
            value.refuse(format!("{} is {given}; 0 s to {longest_s} s is allowed", value.label()), None);
            None
        }
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}
