//! Errors of decoding.

use std::fmt;

use serde::de;

use super::MAX_PADDING;

/// Error of bytes that are no value of the requested type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodeError {
    /// ROS 2 name of the type; empty if the error occurred before the type.
    pub type_name: &'static str,
    /// Field of the error, such as `axes[3].name`; empty: the value as a whole.
    pub field: String,
    /// Byte offset of the error, from 0, without an encapsulation header.
    pub at: usize,
    /// The problem.
    pub problem: Problem,
}

/// Problem of the bytes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Problem {
    /// The bytes end within a value.
    #[error("{needed} bytes are needed, {left} are left")]
    TooShort {
        /// Bytes that the value needs, including its alignment.
        needed: usize,
        /// Remaining bytes.
        left: usize,
    },
    /// There are bytes after the last field.
    #[error("{left} bytes are left over, at most {MAX_PADDING} are allowed")]
    LeftOver {
        /// Number of bytes after the last field.
        left: usize,
    },
    /// A bool that is neither false nor true.
    #[error("a bool is {value}, only 0 and 1 are allowed")]
    Bool {
        /// The byte.
        value: u8,
    },
    /// A string of length 0, which has no room for the terminating zero.
    #[error("a string has length 0, at least 1 is needed for the zero at its end")]
    NoRoomForZero,
    /// A string whose last byte is not zero.
    #[error("a string ends in byte {last:#04x}, only 0x00 is allowed")]
    NoZero {
        /// Last byte of the string.
        last: u8,
    },
    /// A string that is not UTF-8.
    #[error("a string is no UTF-8 from its byte {valid} on")]
    Utf8 {
        /// Number of valid bytes.
        valid: usize,
    },
    /// A sequence that announces more elements than the remaining bytes.
    #[error("a sequence announces {length} elements, {left} bytes are left")]
    SequenceLength {
        /// Announced elements.
        length: u32,
        /// Remaining bytes.
        left: usize,
    },
    /// The encapsulation header is not that of plain CDR.
    #[error("the header is {start:02x?}, only [00, 00, ..] and [00, 01, ..] of four bytes are allowed")]
    Header {
        /// The bytes in its place.
        start: Vec<u8>,
    },
    /// The type contains something that ROS 2 messages cannot contain.
    #[error("{what} cannot stand in a message")]
    Unsupported {
        /// Kind of the content.
        what: &'static str,
    },
    /// The type itself rejected the value, for example because of a bound.
    #[error("{0}")]
    Refused(String),
}

impl DecodeError {
    /// Creates an error; [`of`](Self::of) and [`within`](Self::within) add its location on the way up.
    pub(super) fn new(problem: Problem) -> Self {
        Self { type_name: "", field: String::new(), at: 0, problem }
    }

    /// Returns the error with its type and byte offset.
    pub(super) fn of(self, type_name: &'static str, at: usize) -> Self {
        Self { type_name, at, ..self }
    }

    /// Returns the error with the enclosing field before its location.
    pub(super) fn within(mut self, field: &str) -> Self {
        let dot = if self.field.is_empty() || self.field.starts_with('[') { "" } else { "." };
        self.field = format!("{field}{dot}{}", self.field);
        self
    }
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.type_name.is_empty() {
            write!(f, "{}", self.type_name)?;
            if !self.field.is_empty() {
                write!(f, ", {}", self.field)?;
            }
            write!(f, ", byte {}: ", self.at)?;
        }
        write!(f, "{}", self.problem)
    }
}

impl std::error::Error for DecodeError {}

impl de::Error for DecodeError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new(Problem::Refused(message.to_string()))
    }
}
