//! Axes that people can read: round steps, digits only as far as the step needs them.

use super::text::grouped;

/// Most letters of a label before it is written with a power of ten, or from a base on.
const LONG: usize = 6;
const TOO_LONG: usize = 16;
/// Most letters of a base, as of a time in ns since 1970.
const MOST_DIGITS: usize = 32;
/// Changes below this are none: f64 has hardly any digits for them.
const SMALLEST: f64 = 1e-150;

/// Marks along an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// In the unit of the axis, ascending.
    pub(super) values: Vec<f64>,
    /// One for each value.
    pub(super) labels: Vec<String>,
    /// The labels count this power of ten of the unit.
    pub(super) power: i32,
    /// The labels count from here on, where a full number would be too long.
    pub(super) base: Option<String>,
}

/// Marks from `low` to `high`, at most about `most` of them. `powers`: large and small values may be counted in powers of ten.
pub(super) fn ticks(low: f64, high: f64, most: f64, powers: bool) -> Ticks {
    let (digit, exponent) = step((high - low) / most.max(1.0));
    let step = f64::from(digit) * 10_f64.powi(exponent);
    let (start, end) = ((low / step - 1e-6).ceil(), (high / step + 1e-6).floor());
    let places: Vec<i64> = (0..=(end - start).clamp(0.0, 200.0) as i64).map(|place| start as i64 + place).collect();
    let values: Vec<f64> = places.iter().map(|&place| value(place * i64::from(digit), exponent)).collect();
    let label = |place: i64, power: i32| grouped(&decimal(place * i64::from(digit), exponent - power));
    let length = |power: i32| places.iter().map(|&place| label(place, power).chars().count()).max().unwrap_or(0);
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let thousands = if largest > 0.0 { (largest.log10() / 3.0 + 1e-9).floor() as i32 * 3 } else { 0 };
    let outside = largest > 0.0 && !(1e-2..1e5).contains(&largest);
    let power = if powers && outside && length(thousands) <= LONG { thousands } else { 0 };
    if length(power) <= TOO_LONG {
        let labels = places.iter().map(|&place| label(place, power)).collect();
        return Ticks { values, labels, power, base: None };
    }
    let first = places.first().copied().unwrap_or(0);
    let is_far = label(first, 0).chars().count() > MOST_DIGITS || label(1, 0).chars().count() > MOST_DIGITS;
    let text = |place: i64| if is_far { scientific(place * i64::from(digit), exponent) } else { label(place, 0) };
    let labels = places.iter().map(|&place| format!("+{}", text(place - first))).collect();
    Ticks { values, labels, power: 0, base: Some(text(first)) }
}

/// Marks of a logarithmic axis from `low` to `high`, both above 0: each digit of each power of ten. Those have labels that do not stand
/// closer than `room` decades; powers of ten come first, then 2 and 5.
pub(super) fn decades(low: f64, high: f64, room: f64) -> Ticks {
    let (first, last) = (libm::log10(low).floor() as i32, libm::log10(high).ceil() as i32);
    let slack = 1.0 + 1e-9;
    let places = (first..=last).flat_map(|power| (1..=9).map(move |digit| (digit, power)));
    let places: Vec<(i64, i32)> = places
        .filter(|&(digit, power)| (low / slack..=high * slack).contains(&value(digit, power)))
        .take(200)
        .collect();
    // From 2 to 5 it is as far as from 5 to 2 of the next power, nearly: 0.3 of a decade is the nearest.
    let named: &[i64] = if room <= 0.3 { &[1, 2, 5] } else { &[1] };
    let every = if room <= 1.0 { 1 } else { room.ceil().min(300.0) as i32 };
    let label = |&(digit, power): &(i64, i32)| match named.contains(&digit) && power.rem_euclid(every) == 0 {
        true if (-3..=5).contains(&power) => grouped(&decimal(digit, power)),
        true => format!("{digit}e{power}").replace('-', "\u{2212}"),
        false => String::new(),
    };
    let labels = places.iter().map(label).collect();
    Ticks { values: places.iter().map(|&(digit, power)| value(digit, power)).collect(), labels, power: 0, base: None }
}

/// Marks from `low` to `high` at whole multiples of `step`.
pub(super) fn multiples(low: f64, high: f64, step: f64) -> Ticks {
    let (start, end) = ((low / step - 1e-6).ceil(), (high / step + 1e-6).floor());
    let values: Vec<f64> = (0..=(end - start).clamp(0.0, 200.0) as i64).map(|k| (start + k as f64) * step).collect();
    Ticks { labels: values.iter().map(|&value| number(value)).collect(), values, power: 0, base: None }
}

/// The smallest of 1, 2, 5 times a power of ten that is `raw` or more, or 25, 250.. where the half makes no
/// further digit: digits and exponent.
fn step(raw: f64) -> (u8, i32) {
    let raw = if raw.is_finite() { raw.max(0.01 * SMALLEST) } else { 1.0 };
    let mut exponent = raw.log10().floor() as i32;
    // The logarithm may be one off at a power of ten.
    while 10_f64.powi(exponent) > raw {
        exponent -= 1;
    }
    let part = raw / 10_f64.powi(exponent);
    match part {
        part if part <= 1.0 + 1e-9 => (1, exponent),
        part if part <= 2.0 + 1e-9 => (2, exponent),
        part if part <= 2.5 + 1e-9 && exponent > 0 => (25, exponent - 1),
        part if part <= 5.0 + 1e-9 => (5, exponent),
        _ => (1, exponent + 1),
    }
}

/// The nearest number to `digits` times a power of ten.
fn value(digits: i64, exponent: i32) -> f64 {
    if exponent < 0 { digits as f64 / 10_f64.powi(-exponent) } else { digits as f64 * 10_f64.powi(exponent) }
}

/// `digits` times a power of ten, exactly.
fn decimal(digits: i64, exponent: i32) -> String {
    if digits == 0 {
        return match usize::try_from(-exponent) {
            Ok(places) if places > 0 => format!("0.{}", "0".repeat(places)),
            _ => "0".to_owned(),
        };
    }
    let sign = if digits < 0 { "-" } else { "" };
    let digits = digits.unsigned_abs().to_string();
    match usize::try_from(-exponent) {
        Ok(places) if places > 0 => {
            let digits = format!("{digits:0>width$}", width = places + 1);
            let (whole, part) = digits.split_at(digits.len() - places);
            format!("{sign}{whole}.{part}")
        }
        _ => format!("{sign}{digits}{}", "0".repeat(exponent.unsigned_abs() as usize)),
    }
}

/// `digits` times a power of ten, with a power of ten: `1.2e145`.
fn scientific(digits: i64, exponent: i32) -> String {
    let text = format!("{digits:e}");
    match text.split_once('e').and_then(|(front, power)| Some((front, power.parse::<i32>().ok()?))) {
        Some((front, power)) if digits != 0 => format!("{front}e{}", power + exponent).replace('-', "\u{2212}"),
        _ => "0".to_owned(),
    }
}

/// What a panel shows of values that lie between `low` and `high`: with air above and below, and with zero where it is near.
pub(super) fn range(low: f64, high: f64) -> (f64, f64) {
    let largest = low.abs().max(high.abs());
    // A change of the last digits of an f64 is the noise of computing, not of the machine.
    let is_constant = high - low <= (largest * 1e-13).max(SMALLEST);
    let (low, high) = match (is_constant, largest > SMALLEST) {
        (true, false) => (-1.0, 1.0),
        (true, true) => (low - 0.1 * largest, high + 0.1 * largest),
        (false, _) => (low, high),
    };
    let span = high - low;
    let air = 0.06 * span;
    let low = if low > 0.0 && low < 0.25 * span { 0.0 } else { low };
    let high = if high < 0.0 && high > -0.25 * span { 0.0 } else { high };
    (low - air, high + air)
}

/// `10^n` as people write it.
pub(super) fn power(exponent: i32) -> String {
    let digits = [
        '\u{2070}', '\u{b9}', '\u{b2}', '\u{b3}', '\u{2074}', '\u{2075}', '\u{2076}', '\u{2077}', '\u{2078}',
        '\u{2079}',
    ];
    let raised = |letter: char| letter.to_digit(10).map_or('\u{207b}', |digit| digits[digit as usize]);
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

/// A value for a line of text: up to six digits.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.fract() == 0.0 && value.abs() < 1e15 {
        return grouped(&format!("{value:.0}"));
    }
    if !(1e-4..1e9).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let digits = (5 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    grouped(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        ticks(low, high, 5.0, true).labels
    }

    #[test]
    fn steps_are_round_and_labels_have_the_digits_of_their_step() {
        assert_eq!(labels(0.0, 7.0), ["0", "2", "4", "6"]);
        assert_eq!(labels(-0.31, 0.31), ["\u{2212}0.2", "0.0", "0.2"]);
        assert_eq!(labels(118.3, 121.9), ["119", "120", "121"]);
        assert_eq!(labels(0.0, 0.05), ["0.00", "0.01", "0.02", "0.03", "0.04", "0.05"]);
    }

    #[test]
    fn large_and_small_values_are_counted_in_powers_of_ten() {
        let large = ticks(0.0, 4.2e7, 5.0, true);
        assert_eq!((large.power, large.labels.join(" ")), (6, "0 10 20 30 40".to_owned()));
        let small = ticks(-2e-6, 2e-6, 5.0, true);
        assert_eq!((small.power, small.labels.join(" ")), (-6, "\u{2212}2 \u{2212}1 0 1 2".to_owned()));
        assert_eq!(power(-6), "10\u{207b}\u{2076}");
    }

    #[test]
    fn a_small_change_of_a_large_value_keeps_its_digits() {
        let ticks = ticks(1e9 - 1.0, 1e9 + 1.0, 4.0, true);
        assert_eq!(ticks.base, None);
        assert_eq!(ticks.labels[2], "1\u{2009}000\u{2009}000\u{2009}000.0");
        assert_eq!(ticks.labels.len(), 5);
    }

    #[test]
    fn where_digits_would_not_end_labels_count_from_a_base() {
        let ticks = ticks(1e12, 1e12 + 1.0, 4.0, true);
        assert_eq!(ticks.base.as_deref(), Some("1\u{2009}000\u{2009}000\u{2009}000\u{2009}000.0"));
        assert_eq!(ticks.labels, ["+0.0", "+0.5", "+1.0"]);
    }

    #[test]
    fn a_logarithmic_axis_has_each_digit_and_labels_where_there_is_room() {
        let ticks = decades(0.5, 20.0, 0.2);
        assert_eq!(ticks.values, [0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 20.0]);
        let labels: Vec<&str> = ticks.labels.iter().map(String::as_str).filter(|label| !label.is_empty()).collect();
        assert_eq!(labels, ["0.5", "1", "2", "5", "10", "20"]);
        let narrow = decades(0.5, 20.0, 0.5).labels;
        assert_eq!(narrow.iter().filter(|label| !label.is_empty()).collect::<Vec<_>>(), ["1", "10"]);
        let far = decades(1e-9, 1e9, 3.0).labels;
        let far: Vec<&str> = far.iter().map(String::as_str).filter(|label| !label.is_empty()).collect();
        assert_eq!(far, ["1e\u{2212}9", "1e\u{2212}6", "0.001", "1", "1000", "1e6", "1e9"]);
    }

    #[test]
    fn multiples_of_a_step_lie_within() {
        let ticks = multiples(-230.0, -10.0, 45.0);
        assert_eq!(ticks.values, [-225.0, -180.0, -135.0, -90.0, -45.0]);
        assert_eq!(ticks.labels[1], "\u{2212}180");
    }

    #[test]
    fn what_never_changes_has_a_range_all_the_same() {
        assert_eq!(range(0.0, 0.0), (-1.12, 1.12));
        let (low, high) = range(120.0, 120.0);
        assert!(low < 110.0 && high > 130.0);
        // The noise of the last digit is no change.
        let (low, high) = range(120.0, 120.0 + 1e-13);
        assert!(low < 110.0 && high > 130.0);
    }

    #[test]
    fn labels_stay_short_from_the_smallest_values_to_the_largest() {
        let values = [5e-324, 1e-300, 1e-201, 3e-150, 1e-149, 1e-30, 1e30, 1e149, 1e150];
        let spans = [(0.0, 1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, 1.0 + 1e-9), (1.0, 1.0 + 1e-12)];
        for (value, (from, to)) in values.iter().flat_map(|value| spans.iter().map(move |span| (value, span))) {
            let (low, high) = range(from * value, to * value);
            let ticks = ticks(low, high, 5.0, true);
            assert!(low < high && ticks.labels.len() >= 2, "{value} {from} {to}: {ticks:?}");
            let longest = ticks.labels.iter().chain(&ticks.base).map(|label| label.chars().count()).max();
            assert!(longest <= Some(MOST_DIGITS), "{value} {from} {to}: {ticks:?}");
            assert!(ticks.labels.windows(2).all(|pair| pair[0] != pair[1]), "{value} {from} {to}: {ticks:?}");
        }
        assert_eq!(range(0.0, 1e-200), (-1.12, 1.12));
        assert_eq!(ticks(1e149, 1e149 + 1e139, 2.0, true).labels[1], "+5e138");
    }

    #[test]
    fn zero_is_shown_where_it_is_near() {
        assert!(range(10.0, 400.0).0 < 0.0);
        assert!(range(300.0, 400.0).0 > 250.0);
        assert!(range(-400.0, -10.0).1 > 0.0);
    }

    #[test]
    fn numbers_in_a_line_of_text_are_short() {
        let of = |value: f64| number(value);
        assert_eq!(of(0.1 + 0.2), "0.3");
        assert_eq!(of(-12_582_912.0), "\u{2212}12\u{2009}582\u{2009}912");
        assert_eq!(of(1.0 / 3.0), "0.333333");
        assert_eq!(of(1.5e-9), "1.500e-9");
    }

    proptest! {
        #[test]
        fn ticks_lie_in_the_range_and_are_few(low in -1e12..1e12, span in 1e-3..1e12) {
            let (low, high) = range(low, low + span);
            let ticks = ticks(low, high, 6.0, true);
            prop_assert!(ticks.values.len() <= 7, "{:?}", ticks);
            prop_assert!(ticks.values.len() >= 2, "{:?}", ticks);
            let slack = (high - low) * 1e-5;
            prop_assert!(ticks.values.iter().all(|&value| value >= low - slack && value <= high + slack));
            prop_assert!(ticks.values.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(ticks.labels.windows(2).all(|pair| pair[0] != pair[1]), "{:?}", ticks.labels);
            prop_assert!(ticks.labels.iter().all(|label| label.chars().count() <= TOO_LONG + 2), "{:?}", ticks.labels);
        }
    }
}
