//! Checks numbers of the file with the row of a parameter.

use super::names::quote;
use crate::document::{Value, unit_of_bare};
use lineshaft_core::parameter::{Bare, Row};
use lineshaft_core::text::{allowed_text, expected_text};
use lineshaft_core::unit::Scale;

/// Reads a value for a row of integers; the row checks its range.
pub(super) fn whole(row: &Row, value: &Value<'_>, scale: &Scale) -> Option<i64> {
    match value.peek() {
        Some(text) if !value.is_integer() => {
            // It is an integer in quotes.
            let hint = text.parse::<i64>().is_ok().then(|| "write it without quotes".to_owned());
            refuse_type(row, value, text, scale, hint);
            None
        }
        _ => {
            let number = value.integer(i128::MIN..=i128::MAX)?;
            let number = i64::try_from(number);
            number.map_err(|_| refuse_range(row, value, scale, None)).ok()
        }
    }
}

pub(super) fn refuse_type(row: &Row, value: &Value<'_>, written: &str, scale: &Scale, hint: Option<String>) {
    value.refuse(format!("{} is {}; {} is expected", row.key, quote(written), expected_text(row, scale)), hint);
}

/// Refuses a value outside of the range of a row; `highest` is the maximum of a velocity, in inc/s.
pub(super) fn refuse_range(row: &Row, value: &Value<'_>, scale: &Scale, highest: Option<f64>) {
    let range = allowed_text(row, scale, highest);
    let written = value.peek().unwrap_or_default();
    let unit =
        (row.bare == Bare::Si).then(|| row.measure.dimensions(scale)).flatten().map(|[first, _]| first.si_unit());
    let hint = unit.and_then(|unit| unit_of_bare(written, unit));
    value.refuse(format!("{} is {}; {range} is allowed", row.key, quote(written)), hint);
}
