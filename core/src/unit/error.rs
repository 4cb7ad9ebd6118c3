//! Errors of numbers, units and scales.

use super::{Dimension, Fraction, Quantity, Unit, fraction_to_text, number_to_text};
use thiserror::Error;

/// Error with the given value and the allowed one. [`UnitError::hint`] suggests how to write it instead.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UnitError {
    /// The text is no decimal number.
    #[error("`{text}` is not a number")]
    NotANumber {
        /// The text as given.
        text: String,
    },
    /// The number needs more digits than an exact fraction of 128-bit integers holds.
    #[error("`{text}` has too many digits; numbers from 1e-38 to 1e38 with up to 38 digits are exact")]
    TooManyDigits {
        /// The number as given.
        text: String,
    },
    /// NaN or infinite, or beyond 1e38.
    #[error("{} is not a finite number within +-1e38", number_to_text(*.value))]
    NotFinite {
        /// The given value.
        value: f64,
    },
    /// Number and unit without a blank between them.
    #[error("`{text}` has {} between number and unit", between(.text, *.number))]
    NoBlank {
        /// The text as given.
        text: String,
        /// Length of the number at its start, in bytes.
        number: usize,
    },
    /// Unknown unit.
    #[error("`{unit}` in `{text}` is not a unit; {} has {}", .expected.article(), .expected.units())]
    UnknownUnit {
        /// The whole text as given.
        text: String,
        /// The part at the position of the unit.
        unit: String,
        /// The expected dimension.
        expected: Dimension,
        /// Suggestion of a similar unit.
        meant: Option<&'static str>,
    },
    /// A unit of another dimension.
    #[error(
        "`{given}` is {}; {} such as `{}` is expected",
        .given.unit().dimension().article(), .expected.article(), .given.example(*.expected, *.usual)
    )]
    WrongDimension {
        /// The quantity as given.
        given: Quantity,
        /// The expected dimension.
        expected: Dimension,
        /// Unit of the example if the unit of `given` does not fit: that of the axis if known, otherwise the most
        /// common one.
        usual: Unit,
    },
    /// A position beyond the range of positions.
    #[error("{given} is {} increments; a position stays below 2^62 = 4611686018427387904 increments", Magnitude(.increments))]
    OutOfRange {
        /// The value as given, with its unit.
        given: String,
        /// The position in increments; `None` beyond 128 bits.
        increments: Option<Fraction>,
    },
    /// An exact result exceeds 128 bits.
    #[error("`{given}` has too many digits to be converted exactly; fewer digits, or a smaller exponent, are allowed")]
    Inexact {
        /// The given value.
        given: Quantity,
    },
    /// A velocity, acceleration or jerk that is too low for any machine.
    #[error("`{given}` is {rate:e} {unit}; 0, or 1e-22 {unit} and more, is allowed")]
    RateTooLow {
        /// The given value.
        given: Quantity,
        /// The value in increments.
        rate: f64,
        /// Unit of `rate`.
        unit: Unit,
    },
    /// A velocity, acceleration or jerk beyond all ranges.
    #[error("`{given}` is {rate:e} {unit}; less than 1e30 {unit} is allowed")]
    RateTooHigh {
        /// The given value.
        given: Quantity,
        /// The approximate value in increments.
        rate: f64,
        /// Unit of `rate`.
        unit: Unit,
    },
    /// A time that is no whole number of nanoseconds within i64.
    #[error("`{given}` is not a whole number of nanoseconds; times are whole nanoseconds up to 292 years")]
    NotNanoseconds {
        /// The time as given.
        given: Quantity,
    },
    /// A part of a scale that is not positive.
    #[error("{part} of the scale is {}; a value above 0 is allowed", fraction_to_text(.value))]
    NotPositive {
        /// `increments` or `per`.
        part: &'static str,
        /// The given value.
        value: Fraction,
    },
    /// A MACS unit factor outside its range.
    #[error("{name} is {value}; 1..1073741823 is allowed")]
    MacsFactor {
        /// Name of the parameter.
        name: &'static str,
        /// The given value.
        value: i128,
    },
    /// A MACS position beyond +-MLONG quadcounts.
    #[error("{} user units are {} qc; -1073741823..1073741823 qc is allowed", fraction_to_text(.user_units), Magnitude(.increments))]
    MacsPosition {
        /// The position as given.
        user_units: Fraction,
        /// The position in quadcounts; `None` beyond 128 bits.
        increments: Option<Fraction>,
    },
}

impl UnitError {
    /// Returns the error of a quantity of another dimension; the example has the most common unit.
    pub(crate) fn wrong_dimension(given: Quantity, expected: Dimension) -> Self {
        Self::WrongDimension { given, expected, usual: expected.usual_unit() }
    }

    /// Returns the same error with its example in this unit, which is that of the axis. A unit of another kind changes
    /// nothing.
    #[must_use]
    pub fn in_unit(self, unit: Unit) -> Self {
        match self {
            Self::WrongDimension { given, expected, .. } => {
                Self::WrongDimension { given, expected, usual: expected.unit_like(unit) }
            }
            other => other,
        }
    }

    /// Returns the error with its hint, as text.
    pub fn message_with_hint(&self) -> String {
        self.hint().map_or_else(|| self.to_string(), |hint| format!("{self}; {hint}"))
    }

    /// Returns the error with its hint, as text. For a text that is no number, the hint is an example in this unit,
    /// which is that of the axis.
    pub fn message_with_example(self, expected: Dimension, unit: Unit) -> String {
        match self {
            Self::NotANumber { .. } if self.hint().is_none() => {
                format!("{self}; {} is expected", expected.such_as(Some(unit)))
            }
            error => error.in_unit(unit).message_with_hint(),
        }
    }

    /// Returns a suggestion how to write it instead, if there is one.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::NotANumber { text } if text.contains(',') => Some("write a decimal point, not a comma".to_owned()),
            Self::NotANumber { text } => special_space(text).map(|space| format!("it has {space}")),
            Self::NoBlank { text, number } => {
                let (number, unit) = text.split_at_checked(*number)?;
                let plain = unit.trim_start();
                let kind = if plain.len() < unit.len() { " with an ordinary space" } else { "" };
                Some(format!("write `{number} {plain}`{kind}"))
            }
            Self::UnknownUnit { meant, .. } => meant.map(|unit| format!("did you mean `{unit}`?")),
            _ => None,
        }
    }
}

/// Returns what a text has at the end of its number, instead of a space.
fn between(text: &str, number: usize) -> String {
    let first = text.get(number..).unwrap_or_default().chars().next();
    let found = first.and_then(|sign| special_space(sign.encode_utf8(&mut [0; 4])));
    found.unwrap_or_else(|| "no blank".to_owned())
}

/// Returns the name of the first space in a text that is no ordinary space. Such spaces look like ordinary ones, and do
/// not separate a number from its unit or a key from its value.
pub fn special_space(text: &str) -> Option<String> {
    let is_special = |sign: &char| sign.is_whitespace() && !sign.is_control() && *sign != ' ';
    let sign = text.chars().find(is_special)?;
    let what = if matches!(sign, '\u{a0}' | '\u{2007}' | '\u{202f}') { "a no-break space" } else { "a special space" };
    Some(format!("{what} (U+{:04X})", u32::from(sign)))
}

/// Increments as text, or a note that they are beyond 128 bits.
struct Magnitude<'a>(&'a Option<Fraction>);

impl std::fmt::Display for Magnitude<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            Some(increments) => f.write_str(&fraction_to_text(increments)),
            None => f.write_str("more than 2^127"),
        }
    }
}

/// Returns an excerpt of external text for a message: on one line and at most 60 characters long.
pub fn excerpt(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut piece = String::new();
    for (index, c) in text.chars().enumerate() {
        if index == LONGEST {
            piece.push_str("..");
            break;
        }
        // U+2028 and U+2029 break lines like control characters.
        if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') {
            piece.extend(c.escape_default());
        } else {
            piece.push(c);
        }
    }
    piece
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_excerpt_is_short_and_on_one_line() {
        assert_eq!(excerpt("1 ms\n\u{2028}ü"), "1 ms\\n\\u{2028}ü");
        assert_eq!(excerpt(&"9".repeat(61)), format!("{}..", "9".repeat(60)));
        assert_eq!(excerpt(&"9".repeat(60)), "9".repeat(60));
    }

    #[test]
    fn special_space_between_number_and_unit_is_named() {
        let said = |text: &str| {
            let error = Quantity::parse(text, &[Dimension::Length(0)]).unwrap_err();
            (error.to_string(), error.hint())
        };
        let (sentence, hint) = said("850\u{a0}mm");
        assert_eq!(sentence, "`850\u{a0}mm` has a no-break space (U+00A0) between number and unit");
        assert_eq!(hint.as_deref(), Some("write `850 mm` with an ordinary space"));
        let (sentence, _) = said("850\u{2009}mm");
        assert_eq!(sentence, "`850\u{2009}mm` has a special space (U+2009) between number and unit");
        let (sentence, hint) = said("1\u{202f}000 mm");
        assert_eq!(sentence, "`1\u{202f}000` is not a number");
        assert_eq!(hint.as_deref(), Some("it has a no-break space (U+202F)"));
        assert_eq!(special_space("850 mm\t\n"), None);
    }

    #[test]
    fn a_refusal_does_not_repeat_a_whole_file() {
        let text = "1 ".repeat(1 << 20);
        let error = Quantity::parse(&text, &[Dimension::Time]).unwrap_err();
        assert!(error.to_string().len() < 300, "{error}");
    }
}
