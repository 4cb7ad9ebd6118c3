//! Parses numbers of device descriptions.
//!
//! Law      decimal; hexadecimal with `0x`; octal with a leading `0`; an optional sign
//! Reads    also `0x-80`, which the exporter of python-canopen writes for -128
//! Refuses  any other text, and numbers above 64 bits
//! Source   CiA 306-1, "number notation"

use super::quote::quoted;

/// Number with its notation: hexadecimal digits may be the bits of a negative number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    /// Value.
    pub value: i128,
    /// Whether the digits are hexadecimal.
    pub is_hex: bool,
}

/// Parses a number.
///
/// # Errors
/// A message without subject: "is no number".
pub fn number(text: &str) -> Result<Number, String> {
    let text = text.trim();
    let (is_negative, body) = match text.strip_prefix('-') {
        Some(body) => (true, body),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let no_number = || format!("{} is no number: decimal (12), hexadecimal (0x0C) or octal (014)", quoted(text));
    let (is_negative, radix, digits) = match body.strip_prefix("0x").or_else(|| body.strip_prefix("0X")) {
        Some(digits) => match digits.strip_prefix('-') {
            Some(digits) if !is_negative => (true, 16, digits),
            _ => (is_negative, 16, digits),
        },
        None => match body.strip_prefix('0') {
            Some(digits) if !digits.is_empty() => (is_negative, 8, digits),
            _ => (is_negative, 10, body),
        },
    };
    // `from_str_radix` would accept a sign here.
    if digits.is_empty() || !digits.chars().all(|digit| digit.is_digit(radix)) {
        return Err(no_number());
    }
    let most = i128::from(u64::MAX);
    let value = i128::from_str_radix(digits, radix)
        .ok()
        .filter(|value| *value <= most)
        .ok_or_else(|| format!("{} is beyond 64 bits", quoted(text)))?;
    Ok(Number { value: if is_negative { -value } else { value }, is_hex: radix == 16 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_are_decimal_hexadecimal_and_octal() {
        let rows = [
            ("0", 0, false),
            ("00", 0, false),
            (" 12 ", 12, false),
            ("-128", -128, false),
            ("+7", 7, false),
            ("0x1A", 26, true),
            ("0X1a", 26, true),
            ("-0x80", -128, true),
            ("0x-80", -128, true),
            ("014", 12, false),
            ("0xFFFFFFFFFFFFFFFF", 18_446_744_073_709_551_615, true),
            ("18446744073709551615", 18_446_744_073_709_551_615, false),
        ];
        for (text, value, is_hex) in rows {
            assert_eq!(number(text), Ok(Number { value, is_hex }), "{text}");
        }
    }

    #[test]
    fn invalid_number_is_refused_with_its_text() {
        for text in ["", "-", "0x", "0x-", "-0x-1", "0x+1", "--1", "08", "1.5", "1_0", "abc", "12h", "٣"] {
            assert!(number(text).unwrap_err().contains("is no number"), "{text}");
        }
        for text in ["18446744073709551616", "0x10000000000000000", &"9".repeat(60)] {
            assert!(number(text).unwrap_err().contains("is beyond 64 bits"), "{text}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in ".{0,40}") {
            let _ = number(&text);
        }

        #[test]
        fn every_number_of_64_bits_is_read_back(value in any::<u64>()) {
            let value_wide = i128::from(value);
            prop_assert_eq!(number(&value.to_string()), Ok(Number { value: value_wide, is_hex: false }));
            prop_assert_eq!(number(&format!("0x{value:X}")), Ok(Number { value: value_wide, is_hex: true }));
            prop_assert_eq!(number(&format!("-{value}")).map(|number| number.value), Ok(-value_wide));
        }
    }
}
