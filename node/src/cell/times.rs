//! Times of a cell.

use super::names::quote;
use crate::document::{Allowed, Value};
use lineshaft_core::unit::Dimension;

/// Longest one (ns).
const LONGEST_NS: i64 = 10_000_000_000;

/// 0 to 10 s (ns).
pub(super) fn time(value: &Value<'_>) -> Option<u64> {
    let time = value.quantity(&[Dimension::Time], &Allowed::Any)?;
    match time.nanoseconds() {
        Ok(ns @ 0..=LONGEST_NS) => u64::try_from(ns).ok(),
        Ok(_) => {
            let given = quote(value.peek().unwrap_or_default());
            value.refuse(format!("{} is {given}; 0 s to 10 s is allowed", value.label()), None);
            None
        }
        Err(error) => {
            value.refuse(format!("{}: {error}", value.label()), error.hint());
            None
        }
    }
}
