//! Numbers as exact fractions.

use super::{UnitError, excerpt};
use num_rational::Ratio;
use num_traits::{Signed, Zero};
use std::fmt::Write;

/// An exact number: a reduced fraction of 128-bit integers, the denominator positive.
///
/// Its `+ - * /` overflow like those of integers: use the checked forms of `num_traits` for external values.
pub type Fraction = Ratio<i128>;

/// Decimals after which an f64 is rounded: 10^-24 m or turns is far below an increment of any scale, and numeric noise
/// such as 1e-40 becomes zero instead of an overflow.
const F64_DECIMALS: i32 = 24;

/// Reads a decimal number such as `120`, `-0.5`, `.5` or `1e-3`, exactly.
///
/// # Errors
/// [`UnitError::NotANumber`]; [`UnitError::TooManyDigits`] if it exceeds 128 bits.
pub fn parse_decimal(text: &str) -> Result<Fraction, UnitError> {
    let not_a_number = || UnitError::NotANumber { text: excerpt(text) };
    let too_many = || UnitError::TooManyDigits { text: excerpt(text) };
    if number_length(text) != Some(text.len()) {
        return Err(not_a_number());
    }
    let (mantissa, exponent) = scientific(text).ok_or_else(too_many)?;
    power_of_ten(mantissa, exponent).ok_or_else(too_many)
}

/// Reads a decimal number or a fraction of two, such as `1/3` or `-0.5/7`, exactly.
///
/// # Errors
/// As [`parse_decimal`]; a denominator of 0 is [`UnitError::NotANumber`].
pub fn parse_fraction(text: &str) -> Result<Fraction, UnitError> {
    let Some((numerator, denominator)) = text.split_once('/') else {
        return parse_decimal(text);
    };
    let (numerator, denominator) = (parse_decimal(numerator.trim_end())?, parse_decimal(denominator.trim_start())?);
    if denominator.is_zero() {
        return Err(UnitError::NotANumber { text: excerpt(text) });
    }
    num_traits::CheckedDiv::checked_div(&numerator, &denominator)
        .ok_or_else(|| UnitError::TooManyDigits { text: excerpt(text) })
}

/// Returns the fraction of the shortest decimal that reads back as the same f64. So 0.12 is 12/100, and a number has
/// the same increments whether it comes from a file or through ROS. Decimals after the 24th are rounded.
///
/// # Errors
/// [`UnitError::NotFinite`] for NaN, infinities and magnitudes from 1e38 on.
pub fn fraction_from_f64(value: f64) -> Result<Fraction, UnitError> {
    let not_finite = UnitError::NotFinite { value };
    if !value.is_finite() {
        return Err(not_finite);
    }
    let mut text = ShortText::default();
    // The shortest form of an f64 has at most 17 digits, sign, point and `e-324`: 25 bytes fit.
    if write!(text, "{value:e}").is_err() {
        return Err(not_finite);
    }
    let Some((mantissa, exponent)) = scientific(text.as_str()) else { return Err(not_finite) };
    if exponent >= -F64_DECIMALS {
        return power_of_ten(mantissa, exponent).ok_or(not_finite);
    }
    let cut = power_of_ten(mantissa, exponent + F64_DECIMALS).as_ref().and_then(round_i128).unwrap_or(0);
    Ok(Fraction::new(cut, 10_i128.pow(F64_DECIMALS.unsigned_abs())))
}

/// Returns the nearest f64, ties to even.
pub fn fraction_to_f64(value: &Fraction) -> f64 {
    /// Quotient bits that determine the rounding: 53 of the result, one of the half, and a sticky bit for the rest.
    const BITS: u32 = 55;
    let (numerator, denominator) = (value.numer().unsigned_abs(), value.denom().unsigned_abs());
    if numerator == 0 {
        return 0.0;
    }
    let (mut quotient, mut rest) = (numerator / denominator, numerator % denominator);
    let mut exponent = 0_i32;
    while quotient >> (BITS - 1) == 0 {
        // rest < denominator <= 2^127, so twice the rest fits u128.
        rest <<= 1;
        quotient = quotient << 1 | u128::from(rest >= denominator);
        if rest >= denominator {
            rest -= denominator;
        }
        exponent -= 1;
    }
    // An odd last bit prevents the cast from treating a value near a tie as a tie.
    if rest != 0 {
        quotient |= 1;
    }
    let magnitude = quotient as f64 * f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52);
    if value.is_negative() { -magnitude } else { magnitude }
}

/// Returns the nearest whole number, half away from zero; `None` beyond i64.
pub fn round(value: &Fraction) -> Option<i64> {
    round_i128(value).and_then(|whole| i64::try_from(whole).ok())
}

fn round_i128(value: &Fraction) -> Option<i128> {
    let (numerator, denominator) = (value.numer().unsigned_abs(), value.denom().unsigned_abs());
    let (quotient, rest) = (numerator / denominator, numerator % denominator);
    let magnitude = i128::try_from(quotient).ok()?.checked_add(i128::from(rest >= denominator - rest))?;
    Some(if value.is_negative() { -magnitude } else { magnitude })
}

/// Returns the number as text: the exact decimal if 15 digits suffice, otherwise nine digits.
pub fn fraction_to_text(value: &Fraction) -> String {
    short_decimal(value).unwrap_or_else(|| nine_digits(fraction_to_f64(value)))
}

/// Returns all digits of a decimal, which therefore reads back as the same number. A fraction that is no decimal is
/// written as by [`fraction_to_text`].
pub fn fraction_to_digits(value: &Fraction) -> String {
    /// Largest power of 10 within 128 bits.
    const MOST: u32 = 38;
    let exact = || {
        let places = (0..=MOST).find(|&n| 10_i128.pow(n) % value.denom() == 0)?;
        let scaled = value.numer().checked_mul(10_i128.pow(places) / value.denom())?;
        Some(format!("{scaled}e-{places}"))
    };
    short_decimal(value).or_else(exact).unwrap_or_else(|| fraction_to_text(value))
}

/// Returns a number as text with all digits: with an exponent if it would have more than 20 digits, most of them zeros.
pub fn number_to_text(value: f64) -> String {
    let is_plain = (1e-9..1e20).contains(&value.abs()) || value == 0.0 || !value.is_finite();
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

/// Returns nine significant digits of a measured or computed value, without trailing zeros.
pub(super) fn nine_digits(value: f64) -> String {
    // Converted to text and back: a number of nine digits prints with at most nine digits.
    match format!("{value:.8e}").parse::<f64>() {
        Ok(0.0) => "0".to_owned(),
        Ok(rounded) => number_to_text(rounded),
        Err(_) => number_to_text(value),
    }
}

/// Returns the exact decimal if 15 digits suffice.
pub(super) fn short_decimal(value: &Fraction) -> Option<String> {
    const DIGITS: u32 = 15;
    /// All digits of a 64-bit number.
    const WHOLE: u32 = 20;
    // The smallest power of ten that is a multiple of the denominator, if any.
    let places = (0..=DIGITS).find(|&n| 10_i128.pow(n) % value.denom() == 0)?;
    let scaled = value.numer().checked_mul(10_i128.pow(places) / value.denom())?.unsigned_abs();
    if scaled >= 10_u128.pow(if places > 0 { DIGITS } else { WHOLE }) {
        return None;
    }
    let width = places as usize + 1;
    let mut text = format!("{scaled:0width$}");
    if places > 0 {
        text.insert(text.len() - places as usize, '.');
    }
    if value.is_negative() {
        text.insert(0, '-');
    }
    Some(text)
}

/// Returns the length in bytes of the decimal number at the start of `text`.
pub(super) fn number_length(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let whole = digits(sign);
    let mut end = sign + whole;
    if bytes.get(end) == Some(&b'.') {
        let decimals = digits(end + 1);
        if whole + decimals == 0 {
            return None;
        }
        end += 1 + decimals;
    } else if whole == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    Some(end)
}

/// Splits a number into whole mantissa without trailing zeros and exponent of ten; `None` beyond i128.
fn scientific(number: &str) -> Option<(i128, i32)> {
    let (digits, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let (mut mantissa, mut zeros, mut decimals, mut behind_point) = (0_i128, 0_u32, 0_i32, false);
    for byte in digits.bytes() {
        match byte {
            b'.' => behind_point = true,
            b'0'..=b'9' => {
                decimals = decimals.checked_add(i32::from(behind_point))?;
                if byte == b'0' {
                    zeros += 1;
                } else {
                    let shift = if mantissa == 0 { 1 } else { 10_i128.checked_pow(zeros + 1)? };
                    mantissa = mantissa.checked_mul(shift)?.checked_add(i128::from(byte - b'0'))?;
                    zeros = 0;
                }
            }
            _ => {}
        }
    }
    if mantissa == 0 {
        return Some((0, 0));
    }
    let exponent = exponent.parse::<i32>().ok()?.checked_sub(decimals)?.checked_add_unsigned(zeros)?;
    Some((if digits.starts_with('-') { -mantissa } else { mantissa }, exponent))
}

fn power_of_ten(mantissa: i128, exponent: i32) -> Option<Fraction> {
    let power = 10_i128.checked_pow(exponent.unsigned_abs())?;
    if exponent < 0 { Some(Fraction::new(mantissa, power)) } else { mantissa.checked_mul(power).map(Fraction::from) }
}

/// A short text on the stack, so that converting an f64 does not allocate.
#[derive(Default)]
struct ShortText {
    bytes: [u8; 32],
    length: usize,
}

impl ShortText {
    fn as_str(&self) -> &str {
        str::from_utf8(&self.bytes[..self.length]).unwrap_or_default()
    }
}

impl Write for ShortText {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        let end = self.length + text.len();
        self.bytes.get_mut(self.length..end).ok_or(std::fmt::Error)?.copy_from_slice(text.as_bytes());
        self.length = end;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fraction(numerator: i128, denominator: i128) -> Fraction {
        Fraction::new(numerator, denominator)
    }

    #[test]
    fn decimals_are_exact() {
        for (text, expected) in [
            ("120", fraction(120, 1)),
            ("-0.5", fraction(-1, 2)),
            ("+.5", fraction(1, 2)),
            ("5.", fraction(5, 1)),
            ("1e-3", fraction(1, 1000)),
            ("1.5E+2", fraction(150, 1)),
            ("0.1000000000000000000000000000000000000000000000", fraction(1, 10)),
            ("000000000000000000000000000000000000000000000007", fraction(7, 1)),
            ("0e999999999999", fraction(0, 1)),
            ("-0", fraction(0, 1)),
        ] {
            assert_eq!(parse_decimal(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn text_that_is_no_decimal_is_refused() {
        for text in
            ["", "-", ".", "e3", "1e", "1/3", "1,5", "0x10", "1_000", "inf", "nan", ".nan", " 1", "1 ", "--1", "٣"]
        {
            assert_eq!(parse_decimal(text), Err(UnitError::NotANumber { text: text.into() }), "{text}");
        }
    }

    /// 1e308 has 309 digits, of which one is significant; 2^62 has 19, all significant.
    #[test]
    fn a_large_number_is_short_and_a_whole_one_exact() {
        for (value, text) in [
            (1e308, "1e308"),
            (-1.25e-300, "-1.25e-300"),
            (1e20, "1e20"),
            (1e19, "10000000000000000000"),
            (1e-9, "0.000000001"),
            (5e-10, "5e-10"),
            (4.611_686_018_427_388e18, "4611686018427388000"),
            (0.0, "0"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(number_to_text(value), text);
            assert!(value.is_nan() || text.parse() == Ok(value), "{text} reads back");
        }
        assert_eq!(nine_digits(1.234_567_891_234e300), "1.23456789e300");
        assert_eq!(fraction_to_text(&fraction((1 << 62) - 1, 1)), "4611686018427387903");
        assert_eq!(fraction_to_text(&fraction(10_i128.pow(38), 1)), "1e38");
        assert_eq!(fraction_to_text(&fraction(-10_i128.pow(38), 3)), "-3.33333333e37");
        let told = UnitError::NotFinite { value: 1e308 }.to_string();
        assert_eq!(told, "1e308 is not a finite number within +-1e38");
    }

    #[test]
    fn overflow_is_reported() {
        for text in ["1e39", "1e-39", "1e99999999999999999999", "123456789012345678901234567890123456789.5"] {
            let error = parse_decimal(text).unwrap_err();
            assert!(matches!(error, UnitError::TooManyDigits { .. }), "{error}");
            assert!(error.to_string().contains("too many digits"), "{error}");
        }
        assert_eq!(parse_decimal(&"9".repeat(100_000)).unwrap_err().hint(), None);
    }

    #[test]
    fn fractions_of_two_decimals() {
        assert_eq!(parse_fraction("1/3"), Ok(fraction(1, 3)));
        assert_eq!(parse_fraction("-0.5 / 7"), Ok(fraction(-1, 14)));
        assert_eq!(parse_fraction("2"), Ok(fraction(2, 1)));
        assert_eq!(parse_fraction("1/0"), Err(UnitError::NotANumber { text: "1/0".into() }));
        assert!(parse_fraction("1/2/3").is_err());
    }

    #[test]
    fn an_f64_means_its_shortest_decimal() {
        assert_eq!(fraction_from_f64(0.12), Ok(fraction(12, 100)));
        assert_eq!(fraction_from_f64(-1e-9), Ok(fraction(-1, 1_000_000_000)));
        assert_eq!(fraction_from_f64(-0.0), Ok(fraction(0, 1)));
        assert_eq!(fraction_from_f64(1e22), Ok(fraction(10_i128.pow(22), 1)));
    }

    #[test]
    fn noise_below_the_24th_decimal_is_rounded_away() {
        assert_eq!(fraction_from_f64(f64::MIN_POSITIVE), Ok(fraction(0, 1)));
        assert_eq!(fraction_from_f64(1.6e-24), Ok(fraction(2, 10_i128.pow(24))));
        assert_eq!(fraction_from_f64(-6.123233995736766e-17), Ok(fraction(-61_232_340, 10_i128.pow(24))));
    }

    #[test]
    fn f64_without_a_value_is_refused() {
        for value in [f64::INFINITY, f64::NEG_INFINITY, 1e39, f64::MAX] {
            assert_eq!(fraction_from_f64(value), Err(UnitError::NotFinite { value }));
        }
        assert!(matches!(fraction_from_f64(f64::NAN), Err(UnitError::NotFinite { value }) if value.is_nan()));
    }

    /// Proves: MACS-UNIT-05
    #[test]
    fn halves_round_away_from_zero() {
        for (numerator, whole) in [(1, 1), (-1, -1), (3, 2), (-3, -2), (0, 0), (4, 2)] {
            assert_eq!(round(&fraction(numerator, 2)), Some(whole));
        }
        assert_eq!(round(&fraction(499_999, 1_000_000)), Some(0));
        assert_eq!(round(&fraction(i128::MAX, 3)), None);
    }

    #[test]
    fn text_is_exact_where_it_is_short() {
        for (value, text) in [
            (fraction(900, 1), "900"),
            (fraction(-1, 2), "-0.5"),
            (fraction(1, 1000), "0.001"),
            (fraction(403, 8), "50.375"),
            (fraction(1, 3), "0.333333333"),
            (fraction(-2, 30_000), "-0.0000666666667"),
            (fraction(0, 1), "0"),
            (fraction(123_456_789_012_345_678, 1), "123456789012345678"),
        ] {
            assert_eq!(fraction_to_text(&value), text);
        }
    }

    proptest! {
        #[test]
        fn any_f64_in_range_round_trips(value in prop_oneof![-1e15_f64..1e15, -1.0_f64..1.0]) {
            prop_assume!(value == 0.0 || value.abs() > 1e-6);
            prop_assert_eq!(fraction_to_f64(&fraction_from_f64(value).unwrap()), value);
        }

        #[test]
        fn a_decimal_text_and_its_f64_are_one_number(mantissa in -999_999_999_999_999_i64..=999_999_999_999_999, places in 0..9) {
            let text = format!("{mantissa}e-{places}");
            prop_assert_eq!(parse_decimal(&text), fraction_from_f64(text.parse().unwrap()));
        }

        /// The standard library reads `n` and `n/2^k` correctly rounded; a division by a power of two is exact.
        #[test]
        fn to_f64_rounds_to_nearest_even(n in any::<i128>().prop_map(|n| n >> 1), k in 0_u32..120) {
            let value = fraction(n, 1 << k);
            prop_assert_eq!(fraction_to_f64(&value), n as f64 / (1_u128 << k) as f64);
        }

        #[test]
        fn rounding_leaves_at_most_a_half(n in -(1_i128 << 80)..(1 << 80), d in (1_i128 << 20)..(1 << 40)) {
            let whole = i128::from(round(&fraction(n, d)).unwrap());
            prop_assert!((n - whole * d).abs() * 2 <= d);
        }
    }
}
