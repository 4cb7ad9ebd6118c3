//! Parses times on the command line. A number without unit is in seconds.

use lineshaft_core::unit::{Dimension, Quantity};
use std::time::Duration;

/// Parses a time; returns it in s.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    Quantity::parse(text, &[Dimension::Time]).map(|time| time.si()).map_err(|error| error.message_with_hint())
}

/// Parses a time from a minimum to a maximum, in s; `range` is the text of the range.
pub(super) fn within(text: &str, (least, most): (f64, f64), range: &str) -> Result<Duration, String> {
    let time = seconds(text)?;
    // A decimal such as 0.01 may be slightly less as f64.
    match (least - 1e-12..=most).contains(&time) {
        true => Ok(Duration::from_secs_f64(time)),
        false => Err(format!("{text} is not allowed; {range} is")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_seconds_or_have_a_unit() {
        assert_eq!(seconds("1.2 s"), Ok(1.2));
        assert_eq!(seconds("250 ms"), Ok(0.25));
        assert_eq!(seconds("3"), Ok(3.0));
        assert!(seconds("3 mm").is_err());
    }

    #[test]
    fn time_outside_of_its_range_is_refused_with_the_range() {
        let read = |text| within(text, (0.01, 60.0), "10 ms to 60 s");
        assert_eq!(read("10 ms"), Ok(Duration::from_millis(10)));
        assert_eq!(read("60"), Ok(Duration::from_secs(60)));
        for text in ["9 ms", "61 s", "-1 s"] {
            assert_eq!(read(text), Err(format!("{text} is not allowed; 10 ms to 60 s is")));
        }
    }
}
