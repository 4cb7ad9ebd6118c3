//! Values of objects, as text and as bytes on the bus.
//!
//! Law      bytes are little-endian, as many as the type has; conversion to text or bytes and back returns the same value
//! Reads    integers as EDS files write them, octal ones only from a file; also hexadecimal bits of a negative number if they fill its
//!          type; REAL as decimal; OCTET_STRING, DOMAIN and times as pairs of hexadecimal digits
//! Refuses  numbers beyond the type, numbers that are not finite, a value of another kind, bytes of another length
//! Source   CiA 301, "data types and encoding rules"; CiA 306-1

use super::data_type::{DataType, Kind};
use super::number::number;
use super::quote::quoted;
use std::fmt;

/// Value of an object. The object defines its data type.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// BOOLEAN.
    Boolean(bool),
    /// INTEGER8 to INTEGER64.
    Integer(i64),
    /// UNSIGNED8 to UNSIGNED64.
    Unsigned(u64),
    /// REAL32.
    Real32(f32),
    /// REAL64.
    Real64(f64),
    /// VISIBLE_STRING and UNICODE_STRING.
    Text(String),
    /// OCTET_STRING, DOMAIN and unknown types.
    Bytes(Vec<u8>),
    /// TIME_OF_DAY (since 1984-01-01) and TIME_DIFFERENCE.
    Time {
        /// Milliseconds of the day, 28 bits.
        milliseconds: u32,
        /// Days.
        days: u16,
    },
}

/// Reason why a value, a text or bytes do not fit a data type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ValueError {
    /// The text is no value of the type.
    #[error("{0}")]
    Text(String),
    /// The number is beyond the range of the type.
    #[error("{number} is not within {least} and {most}, as {data_type} is")]
    Range {
        /// Given number.
        number: i128,
        /// Minimum.
        least: i128,
        /// Maximum.
        most: i128,
        /// Data type.
        data_type: DataType,
    },
    /// The number of bytes does not match the type.
    #[error("{data_type} has {allowed} bytes, not {found}")]
    Length {
        /// Data type.
        data_type: DataType,
        /// Length of the type.
        allowed: &'static str,
        /// Given length.
        found: usize,
    },
    /// The value is of another kind.
    #[error("{value} is no value of {data_type}")]
    Kind {
        /// Value as text, shortened if it is long.
        value: String,
        /// Data type.
        data_type: DataType,
    },
    /// The type does not support a character.
    #[error("the character {character:?} does not exist in {data_type}")]
    Character {
        /// Character.
        character: char,
        /// Data type.
        data_type: DataType,
    },
}

/// Returns minimum and maximum of an integer type.
fn range(kind: Kind) -> Option<(i128, i128)> {
    match kind {
        Kind::Boolean => Some((0, 1)),
        Kind::Integer(bytes) => {
            let most = 1_i128 << (bytes * 8 - 1);
            Some((-most, most - 1))
        }
        Kind::Unsigned(bytes) => Some((0, (1_i128 << (bytes * 8)) - 1)),
        _ => None,
    }
}

/// Extends bytes to eight, with `fill` for the upper ones.
fn extend_to_8_bytes(bytes: &[u8], fill: u8) -> [u8; 8] {
    let mut wide = [fill; 8];
    for (to, from) in wide.iter_mut().zip(bytes) {
        *to = *from;
    }
    wide
}

impl Value {
    /// Returns a value of an integer type.
    ///
    /// # Errors
    /// The number is beyond the type, or the type is not an integer type.
    pub fn of_number(data_type: DataType, number: i128) -> Result<Self, ValueError> {
        let kind = data_type.kind();
        let Some((least, most)) = range(kind) else {
            return Err(ValueError::Kind { value: number.to_string(), data_type });
        };
        let beyond = ValueError::Range { number, least, most, data_type };
        if number < least || number > most {
            return Err(beyond);
        }
        match kind {
            Kind::Boolean => Ok(Self::Boolean(number == 1)),
            Kind::Integer(_) => i64::try_from(number).map(Self::Integer).map_err(|_| beyond),
            _ => u64::try_from(number).map(Self::Unsigned).map_err(|_| beyond),
        }
    }

    /// Parses a value that a user has written. Integers with leading zeros are refused: a file means octal numbers by them, a user probably
    /// does not.
    ///
    /// # Errors
    /// The text is no value of the type; with a message.
    pub fn parse(data_type: DataType, text: &str) -> Result<Self, ValueError> {
        let digits = text.trim().trim_start_matches(['-', '+']);
        let is_octal =
            digits.len() > 1 && digits.starts_with('0') && digits.bytes().all(|digit| digit.is_ascii_digit());
        if is_octal && range(data_type.kind()).is_some() {
            let why = "begins with 0: write a decimal number without it, or 0x and a hexadecimal one";
            return Err(ValueError::Text(format!("{} {why}", quoted(text))));
        }
        Self::read(data_type, text)
    }

    /// Parses a value of a file, in which integers with leading zeros are octal.
    ///
    /// # Errors
    /// The text is no value of the type; with a message.
    pub fn read(data_type: DataType, text: &str) -> Result<Self, ValueError> {
        let text = text.trim();
        let kind = data_type.kind();
        match kind {
            Kind::Boolean if text.eq_ignore_ascii_case("true") => Ok(Self::Boolean(true)),
            Kind::Boolean if text.eq_ignore_ascii_case("false") => Ok(Self::Boolean(false)),
            Kind::Boolean | Kind::Integer(_) | Kind::Unsigned(_) => {
                let read = number(text).map_err(ValueError::Text)?;
                Self::of_number(data_type, as_signed_if_hex(kind, read.value, read.is_hex))
            }
            Kind::Real32 => real(text, data_type, f32::is_finite).map(Self::Real32),
            Kind::Real64 => real(text, data_type, f64::is_finite).map(Self::Real64),
            Kind::Visible | Kind::Unicode => {
                let value = Self::Text(text.to_owned());
                value.to_bytes(data_type).map(|_| value)
            }
            Kind::Bytes => hex(text, data_type).map(Self::Bytes),
            Kind::Time => Self::from_bytes(data_type, &hex(text, data_type)?),
            Kind::Unknown => {
                Err(ValueError::Text(format!("{} cannot be read: values of {data_type} are not known", quoted(text))))
            }
        }
    }

    /// Returns the bytes for the bus.
    ///
    /// # Errors
    /// The value is not of the type.
    pub fn to_bytes(&self, data_type: DataType) -> Result<Vec<u8>, ValueError> {
        let kind = data_type.kind();
        let numbers = |number: i128, wide: [u8; 8], bytes: u32| {
            let (least, most) = range(kind).unwrap_or_default();
            if number < least || number > most {
                return Err(ValueError::Range { number, least, most, data_type });
            }
            Ok(wide.into_iter().take(bytes as usize).collect())
        };
        match (kind, self) {
            (Kind::Boolean, Self::Boolean(value)) => Ok(vec![u8::from(*value)]),
            (Kind::Integer(bytes), Self::Integer(value)) => numbers(i128::from(*value), value.to_le_bytes(), bytes),
            (Kind::Unsigned(bytes), Self::Unsigned(value)) => numbers(i128::from(*value), value.to_le_bytes(), bytes),
            (Kind::Real32, Self::Real32(value)) => Ok(value.to_le_bytes().to_vec()),
            (Kind::Real64, Self::Real64(value)) => Ok(value.to_le_bytes().to_vec()),
            (Kind::Visible, Self::Text(text)) => text
                .chars()
                .map(|character| u8::try_from(character).map_err(|_| ValueError::Character { character, data_type }))
                .collect(),
            (Kind::Unicode, Self::Text(text)) => Ok(text.encode_utf16().flat_map(u16::to_le_bytes).collect()),
            (Kind::Bytes | Kind::Unknown, Self::Bytes(bytes)) => Ok(bytes.clone()),
            (Kind::Time, Self::Time { milliseconds, days }) => {
                let (number, most) = (i128::from(*milliseconds), (1 << 28) - 1);
                if number > most {
                    return Err(ValueError::Range { number, least: 0, most, data_type });
                }
                Ok(milliseconds.to_le_bytes().into_iter().chain(days.to_le_bytes()).collect())
            }
            _ => Err(ValueError::Kind { value: quoted(&self.to_string()), data_type }),
        }
    }

    /// Decodes bytes from the bus.
    ///
    /// # Errors
    /// The bytes are no value of the type.
    pub fn from_bytes(data_type: DataType, bytes: &[u8]) -> Result<Self, ValueError> {
        let kind = data_type.kind();
        let wrong = |allowed| ValueError::Length { data_type, allowed, found: bytes.len() };
        let of_length = |length: u32| {
            let allowed = ["0", "1", "2", "3", "4", "5", "6", "7", "8"].get(length as usize).copied().unwrap_or("8");
            if bytes.len() == length as usize { Ok(()) } else { Err(wrong(allowed)) }
        };
        match kind {
            Kind::Boolean => {
                of_length(1)?;
                Self::of_number(data_type, i128::from(u64::from_le_bytes(extend_to_8_bytes(bytes, 0))))
            }
            Kind::Unsigned(length) => {
                of_length(length)?;
                Ok(Self::Unsigned(u64::from_le_bytes(extend_to_8_bytes(bytes, 0))))
            }
            Kind::Integer(length) => {
                of_length(length)?;
                let is_negative = bytes.last().is_some_and(|last| last & 0x80 != 0);
                Ok(Self::Integer(i64::from_le_bytes(extend_to_8_bytes(bytes, if is_negative { 0xFF } else { 0 }))))
            }
            Kind::Real32 => {
                bytes.try_into().map(|bytes| Self::Real32(f32::from_le_bytes(bytes))).map_err(|_| wrong("4"))
            }
            Kind::Real64 => {
                bytes.try_into().map(|bytes| Self::Real64(f64::from_le_bytes(bytes))).map_err(|_| wrong("8"))
            }
            Kind::Visible => Ok(Self::Text(bytes.iter().copied().map(char::from).collect())),
            Kind::Unicode => {
                let (units, rest) = bytes.as_chunks::<2>();
                if !rest.is_empty() {
                    return Err(wrong("an even number of"));
                }
                let units: Vec<u16> = units.iter().map(|unit| u16::from_le_bytes(*unit)).collect();
                let no_text = |_| ValueError::Text(format!("the bytes are no text of {data_type}"));
                String::from_utf16(&units).map(Self::Text).map_err(no_text)
            }
            Kind::Bytes | Kind::Unknown => Ok(Self::Bytes(bytes.to_vec())),
            Kind::Time => {
                let [a, b, c, d, e, f] = *bytes else { return Err(wrong("6")) };
                let value =
                    Self::Time { milliseconds: u32::from_le_bytes([a, b, c, d]), days: u16::from_le_bytes([e, f]) };
                value.to_bytes(data_type).map(|_| value)
            }
        }
    }

    /// Returns the value as a number if it is an integer.
    pub fn number(&self) -> Option<i128> {
        match self {
            Self::Boolean(value) => Some(i128::from(*value)),
            Self::Integer(value) => Some(i128::from(*value)),
            Self::Unsigned(value) => Some(i128::from(*value)),
            _ => None,
        }
    }
}

impl fmt::Display for Value {
    /// Writes the text that [`parse`](Self::parse) reads.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boolean(value) => write!(f, "{}", u8::from(*value)),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Unsigned(value) => write!(f, "{value}"),
            Self::Real32(value) => write!(f, "{value}"),
            Self::Real64(value) => write!(f, "{value}"),
            Self::Text(text) => f.write_str(text),
            Self::Bytes(bytes) => bytes.iter().try_for_each(|byte| write!(f, "{byte:02X}")),
            Self::Time { milliseconds, days } => milliseconds
                .to_le_bytes()
                .into_iter()
                .chain(days.to_le_bytes())
                .try_for_each(|byte| write!(f, "{byte:02X}")),
        }
    }
}

/// Interprets hexadecimal digits as the bits of a negative number if they fill the type; returns any other number unchanged.
fn as_signed_if_hex(kind: Kind, value: i128, is_hex: bool) -> i128 {
    let Kind::Integer(bytes) = kind else { return value };
    let all = 1_i128 << (bytes * 8);
    if is_hex && value >= all / 2 && value < all { value - all } else { value }
}

fn real<T: std::str::FromStr + Copy>(
    text: &str,
    data_type: DataType,
    is_finite: fn(T) -> bool,
) -> Result<T, ValueError> {
    let value = text.parse().ok().filter(|value| is_finite(*value));
    value.ok_or_else(|| ValueError::Text(format!("{} is no finite number like 1.5 within {data_type}", quoted(text))))
}

fn hex(text: &str, data_type: DataType) -> Result<Vec<u8>, ValueError> {
    let wrong = || {
        let said = quoted(text);
        ValueError::Text(format!("{said} is no value of {data_type}: pairs of hexadecimal digits, like 0A FF"))
    };
    let digits: Option<Vec<u32>> =
        text.chars().filter(|character| !character.is_whitespace()).map(|character| character.to_digit(16)).collect();
    let digits = digits.ok_or_else(wrong)?;
    let (pairs, rest) = digits.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(wrong());
    }
    Ok(pairs.iter().map(|[high, low]| (high << 4 | low) as u8).collect())
}

#[cfg(test)]
mod tests;
