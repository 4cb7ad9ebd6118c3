//! Parameters in messages: common texts of values, ranges and refusals for all interfaces.

use crate::parameter::{Measure, Range, Refused, Row, Storage, Value};
use crate::unit::{Scale, ScaleKind, number_to_text};

/// End of the range of positions (inc).
const LARGEST_POSITION: i64 = (1 << 62) - 1;

/// Returns a value in the axis unit, or in the unit of the row; the name of a choice.
pub fn value_text(row: &Row, value: Value, scale: &Scale) -> String {
    match (value, row.measure) {
        (Value::Unset, _) => row.default_text.to_owned(),
        (Value::Int(place), Measure::Choice(names)) => usize::try_from(place)
            .ok()
            .and_then(|place| names.get(place))
            .map_or_else(|| place.to_string(), |name| (*name).to_owned()),
        (Value::Int(value), Measure::Position | Measure::Distance) => scale.format_with_increments(value),
        (Value::Int(value), Measure::Time) => format!("{} ms", value as f64 / 1e6),
        (Value::Int(value), _) => value.to_string(),
        (Value::Real(value), Measure::Velocity) => scale.format_rate(value, 1),
        (Value::Real(value), Measure::Acceleration) => scale.format_rate(value, 2),
        (Value::Real(value), Measure::Jerk) => scale.format_rate(value, 3),
        (Value::Real(value), _) => number_to_text(value),
    }
}

/// Returns the permitted values of a row as text; `text` formats one of them.
pub fn range_text(row: &Row, text: impl Fn(Value) -> String) -> String {
    match row.range {
        Range::Int(0, LARGEST_POSITION) => format!("{} and above", text(Value::Int(0))),
        Range::Int(low, LARGEST_POSITION) if low > 0 => {
            let (low, exact) = (text(Value::Int(low)), format!("{low} inc"));
            if low.contains(&exact) { format!("{low} and above") } else { format!("{low} ({exact}) and above") }
        }
        Range::Int(low, high) => format!("{} to {}", text(Value::Int(low)), text(Value::Int(high))),
        Range::Among(ranges) => ranges_text(ranges),
        Range::Real(low, high) => format!("{} to {}", text(Value::Real(low)), text(Value::Real(high))),
        Range::PositiveUpTo(high) => format!("more than 0 up to {}", text(Value::Real(high))),
    }
}

/// Returns the permitted values of a row on an axis of that scale as text; a velocity is limited to `highest` (inc/s),
/// if given.
pub fn allowed_text(row: &Row, scale: &Scale, highest: Option<f64>) -> String {
    let end = |end: f64| highest.map_or(end, |highest| end.min(highest));
    let low_end = match row.range {
        Range::Real(low, _) => low,
        _ => f64::NAN,
    };
    range_text(row, |value| match (value, row.measure.order()) {
        (Value::Real(low), Some(order)) if low == low_end => scale.format_bound(low, order, false),
        (Value::Real(high), Some(order)) => scale.format_bound(end(high), order, true),
        (value, _) => value_text(row, value, scale),
    })
}

/// Returns a value outside its range: with all of its digits if fewer would look like a value in the range.
pub fn outside_text(row: &Row, value: Value, scale: &Scale, allowed: &str) -> String {
    let text = value_text(row, value, scale);
    match (value, row.measure.order()) {
        (Value::Real(rate), Some(order)) if allowed.ends_with(&text) || allowed.starts_with(&text) => {
            scale.format_rate_precisely(rate, order)
        }
        _ => text,
    }
}

/// Returns two compared values, with enough digits to differ.
pub fn pair_text(one: (&Row, Value), other: (&Row, Value), scale: &Scale) -> (String, String) {
    let text = |(row, value): (&Row, Value)| value_text(row, value, scale);
    let usual = (text(one), text(other));
    if usual.0 != usual.1 || one.1 == other.1 {
        return usual;
    }
    let precise = |(row, value): (&Row, Value)| match (value, row.measure.order()) {
        (Value::Real(rate), Some(order)) => scale.format_rate_precisely(rate, order),
        _ => value_text(row, value, scale),
    };
    (precise(one), precise(other))
}

/// Returns ranges one by one; a regular series by its beginning and its end: `0 to 2, 10 to 12, .. 90 to 92`.
fn ranges_text(ranges: &[(i64, i64)]) -> String {
    /// A shorter series is written in full.
    const REGULAR: usize = 5;
    let one = |&(low, high): &(i64, i64)| if low == high { low.to_string() } else { format!("{low} to {high}") };
    let mut parts = Vec::new();
    let mut rest = ranges;
    while let [first, tail @ ..] = rest {
        let shift = tail.first().map(|second| (second.0 - first.0, second.1 - first.1));
        let follows = |pair: &&[(i64, i64)]| match pair {
            [before, after] => Some((after.0 - before.0, after.1 - before.1)) == shift,
            _ => false,
        };
        let length = 1 + rest.windows(2).take_while(follows).count();
        match rest.get(..length) {
            Some([first, second, .., last]) if length >= REGULAR => {
                parts.push(format!("{}, {}, .. {}", one(first), one(second), one(last)));
                rest = rest.get(length..).unwrap_or_default();
            }
            _ => {
                parts.push(one(first));
                rest = tail;
            }
        }
    }
    parts.join(", ")
}

/// Returns the allowed values of a row as text, for an input that is no value.
pub fn expected_text(row: &Row, scale: &Scale) -> String {
    let unit = match scale.kind() {
        ScaleKind::Linear => ["10 mm", "0.5 m/s", "2 m/s^2", "50 m/s^3"],
        ScaleKind::Rotary => ["10 deg", "90 deg/s", "360 deg/s^2", "9000 deg/s^3"],
    };
    let range = || allowed_text(row, scale, None);
    match row.measure {
        Measure::Position | Measure::Distance => format!("a position such as {}", unit[0]),
        Measure::Velocity => format!("a velocity such as {}", unit[1]),
        Measure::Acceleration => format!("an acceleration such as {}", unit[2]),
        Measure::Jerk => format!("a jerk such as {}", unit[3]),
        Measure::Integer => format!("{}, {},", row.expected(), range()),
        Measure::Number => format!("{}, {},", row.expected(), range()),
        Measure::Time | Measure::Choice(_) => row.measure.expected(),
    }
}

/// Returns why a row refuses a value: key, value and permitted values, without the name of the axis. A velocity is
/// limited to `highest` (inc/s), if given.
pub fn refused_text(row: &Row, why: Refused, value: Value, scale: &Scale, highest: Option<f64>) -> String {
    let key = row.key;
    let text = |value| value_text(row, value, scale);
    match why {
        Refused::OutOfRange | Refused::WrongType => {
            let allowed = allowed_text(row, scale, highest);
            format!("{key} is {}; {allowed} is allowed", outside_text(row, value, scale, &allowed))
        }
        Refused::NotBuilt => {
            let (value, default) = (text(value), text(row.default));
            format!("{key} is {value}: {}; only {default} is allowed", row.missing_text())
        }
        Refused::ReadOnly => match row.storage {
            Storage::Cell => format!("{key} is part of the cell; it changes with the file and a new start"),
            Storage::Signal(signal) => format!("{key} is read-only; read the signal {signal} of the axis"),
            _ => format!("{key} is computed from other parameters"),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::{Fraction, Quantity, Unit};

    fn row(key: &str) -> &'static Row {
        Row::find(key).unwrap_or_else(|| panic!("no row {key}")).1
    }

    fn millimetres() -> Scale {
        let one = Quantity::new(Fraction::from(1), Unit::MILLIMETRE);
        Scale::new(Fraction::from(1000), one).and_then(|scale| scale.with_unit(Unit::MILLIMETRE)).expect("a good scale")
    }

    fn range(key: &str) -> String {
        range_text(row(key), |value| value_text(row(key), value, &millimetres()))
    }

    #[test]
    fn range_text_is_in_unit_of_row() {
        assert_eq!(range("error_reaction"), "0 to 5");
        assert_eq!(range("wf.md22"), "0.01 to 100");
        assert_eq!(range("following_error_time"), "0 ms to 10000 ms");
        assert_eq!(range("in_position_window"), "0 mm and above");
        assert_eq!(range("max_following_error"), "0.001 mm (1 inc) and above");
        assert_eq!(range("max_velocity"), "more than 0 up to 1000000000000 mm/s");
    }

    /// A limit rounded to nine digits must not look like a value beyond it, or the reverse.
    #[test]
    fn an_end_of_a_range_never_reads_as_a_value_that_is_refused() {
        let allowed = |key: &str, highest| allowed_text(row(key), &millimetres(), highest);
        // 2^31 increments in 1 ms.
        let highest = Some(2_147_483_648_000.0);
        assert_eq!(allowed("max_velocity", highest), "more than 0 up to 2147483648 mm/s");
        assert_eq!(allowed("max_velocity", None), "more than 0 up to 1000000000000 mm/s");
        assert_eq!(allowed("master_simulation_velocity", None), "-1000000 mm/s to 1000000 mm/s");
        let refused = |rate, highest| {
            refused_text(row("max_velocity"), Refused::OutOfRange, Value::Real(rate), &millimetres(), highest)
        };
        assert_eq!(
            refused(2_147_483_650_000.0, highest),
            "max_velocity is 2147483650 mm/s; more than 0 up to 2147483648 mm/s is allowed"
        );
        assert_eq!(
            refused(1_000_000_000_000_125.0, None),
            "max_velocity is 1000000000000.125 mm/s; more than 0 up to 1000000000000 mm/s is allowed"
        );
    }

    #[test]
    fn many_ranges_are_shortened_to_their_rule() {
        // rule 0 to 2 + 10 output + 100 node, and -10 to -90.
        assert_eq!(range("revers"), "-90, -80, .. -10, 0 to 2, 10 to 12, .. 12790 to 12792");
        assert_eq!(range("canbaud"), "0 to 8, 10 to 18, .. 80 to 88");
        assert_eq!(range("cannr"), "0 to 127, 9999");
        assert_eq!(ranges_text(&[(0, 1), (4, 5), (8, 9)]), "0 to 1, 4 to 5, 8 to 9");
        assert_eq!(ranges_text(&[]), "");
    }

    #[test]
    fn what_is_expected_fits_the_axis() {
        let turn = Quantity::new(Fraction::from(1), Unit::REVOLUTION);
        let rotary = Scale::new(Fraction::from(1000), turn).unwrap();
        assert_eq!(expected_text(row("max_velocity"), &millimetres()), "a velocity such as 0.5 m/s");
        assert_eq!(expected_text(row("max_velocity"), &rotary), "a velocity such as 90 deg/s");
        assert_eq!(expected_text(row("kprop"), &rotary), "a whole number, 1 to 65000,");
    }

    #[test]
    fn a_refusal_names_key_value_and_what_is_permitted() {
        let text = |key, why, value| refused_text(row(key), why, value, &millimetres(), None);
        assert_eq!(
            text("max_following_error", Refused::OutOfRange, Value::Int(0)),
            "max_following_error is 0 mm; 0.001 mm (1 inc) and above is allowed"
        );
        assert_eq!(text("velmaxqc", Refused::ReadOnly, Value::Int(5)), "velmaxqc is computed from other parameters");
        assert_eq!(
            text("posfact_z", Refused::ReadOnly, Value::Int(5)),
            "posfact_z is part of the cell; it changes with the file and a new start"
        );
    }
}
