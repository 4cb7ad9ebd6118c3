//! Parses numbers of EDS files.
//!
//! Law      decimal; hexadecimal with `0x`; octal with a leading `0`; an optional sign; `$NODEID` alone, or a sum with it in either order
//! Reads    also `0x-80`, which the exporter of python-canopen writes for -128
//! Refuses  any other text, and numbers above 64 bits
//! Source   CiA 306-1, "number notation"

use super::problem::quoted;

/// Number with its notation: hexadecimal digits may be the bits of a negative number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Number {
    pub(super) value: i128,
    pub(super) is_hex: bool,
}

/// Parses a number.
///
/// # Errors
/// A message without subject: "is no number".
pub(super) fn number(text: &str) -> Result<Number, String> {
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

/// Returns the number that is added to the node ID; `None` if the text does not contain `$NODEID`.
pub(super) fn plus_node_id(text: &str) -> Option<Result<u64, String>> {
    const NODE_ID: &str = "$NODEID";
    let text = text.trim();
    let upper = text.to_ascii_uppercase();
    let (before, after) = upper.split_once(NODE_ID)?;
    let (before, after) = (before.trim(), after.trim());
    let summand = match (before.is_empty(), after.is_empty()) {
        (true, true) => return Some(Ok(0)),
        (true, false) => after.strip_prefix('+'),
        (false, true) => before.strip_suffix('+'),
        (false, false) => None,
    };
    // The copy in upper case has `0X`, which is accepted like `0x`.
    let value = summand.and_then(|summand| number(summand).ok()).and_then(|number| u64::try_from(number.value).ok());
    Some(value.ok_or_else(|| format!("{} is neither $NODEID, $NODEID+number nor number+$NODEID", quoted(text))))
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

    #[test]
    fn node_id_is_parsed_on_either_side_of_sum() {
        assert_eq!(plus_node_id("0x180"), None);
        let rows = [
            ("$NODEID", 0),
            ("$NODEID+0x180", 0x180),
            ("$nodeid + 512", 512),
            ("1280+$NODEID", 1280),
            (" 0x80000000 + $NodeID ", 0x8000_0000),
        ];
        for (text, offset) in rows {
            assert_eq!(plus_node_id(text), Some(Ok(offset)), "{text}");
        }
        for text in ["$NODEID+", "+$NODEID", "$NODEID*2", "$NODEID-1", "$NODEID+-1", "1+$NODEID+1", "$NODEID+$NODEID"] {
            assert!(plus_node_id(text).unwrap().unwrap_err().contains("neither $NODEID"), "{text}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in ".{0,40}") {
            let _ = (number(&text), plus_node_id(&text));
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
