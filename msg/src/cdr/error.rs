//! Why bytes were refused.

use std::fmt;

use serde::de;

use super::MAX_PADDING;

/// Bytes that are no value of the type that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodeError {
    /// ROS 2 name of the type, empty when the bytes were refused before a type was begun.
    pub type_name: &'static str,
    /// Field in which it happened, for instance `axes[3].name`; empty: the value as a whole.
    pub field: String,
    /// Byte at which it was noticed, from 0, not counting an encapsulation header.
    pub at: usize,
    /// What was wrong.
    pub problem: Problem,
}

/// What was wrong with the bytes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Problem {
    /// The bytes end within a value.
    #[error("{needed} bytes are needed, {left} are left")]
    TooShort {
        /// Bytes that the value needs, its alignment among them.
        needed: usize,
        /// Bytes that are there.
        left: usize,
    },
    /// The bytes go on behind the last field.
    #[error("{left} bytes are left over, at most {MAX_PADDING} are allowed")]
    LeftOver {
        /// Bytes behind the last field.
        left: usize,
    },
    /// A bool that is neither false nor true.
    #[error("a bool is {value}, only 0 and 1 are allowed")]
    Bool {
        /// Byte that was found.
        value: u8,
    },
    /// A string of length 0, where the terminating zero has no place.
    #[error("a string has length 0, at least 1 is needed for the zero at its end")]
    NoRoomForZero,
    /// A string whose last byte is not zero.
    #[error("a string ends in byte {last:#04x}, only 0x00 is allowed")]
    NoZero {
        /// Last byte of the string.
        last: u8,
    },
    /// A string that is no UTF-8.
    #[error("a string is no UTF-8 from its byte {valid} on")]
    Utf8 {
        /// Bytes that are good.
        valid: usize,
    },
    /// A sequence that announces more elements than there are bytes.
    #[error("a sequence announces {length} elements, {left} bytes are left")]
    SequenceLength {
        /// Elements that are announced.
        length: u32,
        /// Bytes that are left for them.
        left: usize,
    },
    /// The encapsulation header is not that of plain CDR.
    #[error("the header is {start:02x?}, only [00, 00, ..] and [00, 01, ..] of four bytes are allowed")]
    Header {
        /// The bytes that stand in its place.
        start: Vec<u8>,
    },
    /// The type holds something that ROS 2 messages cannot.
    #[error("{what} cannot stand in a message")]
    Unsupported {
        /// What it holds.
        what: &'static str,
    },
    /// The type itself refused the value; a bound for instance.
    #[error("{0}")]
    Refused(String),
}

impl DecodeError {
    /// A problem; [`of`](Self::of) and [`within`](Self::within) say where, on the way out.
    pub(super) fn new(problem: Problem) -> Self {
        Self { type_name: "", field: String::new(), at: 0, problem }
    }

    /// The same, of a type and at a byte.
    pub(super) fn of(self, type_name: &'static str, at: usize) -> Self {
        Self { type_name, at, ..self }
    }

    /// The same, within a field of what it was within so far.
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
