//! Data types of objects.

use std::fmt;

/// Data type of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "the names are those of CiA 301, table 44")]
pub enum DataType {
    Boolean,
    Integer8,
    Integer16,
    Integer32,
    Unsigned8,
    Unsigned16,
    Unsigned32,
    Real32,
    VisibleString,
    OctetString,
    UnicodeString,
    TimeOfDay,
    TimeDifference,
    Domain,
    Integer24,
    Real64,
    Integer40,
    Integer48,
    Integer56,
    Integer64,
    Unsigned24,
    Unsigned40,
    Unsigned48,
    Unsigned56,
    Unsigned64,
    /// A record of the standard, or a type of a profile or of the device, whose encoding is not known here.
    Other(u16),
}

/// Encoding that several data types share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Boolean,
    /// Two's complement, with its number of bytes.
    Integer(u32),
    /// Unsigned, with its number of bytes.
    Unsigned(u32),
    Real32,
    Real64,
    /// Text with one byte per character.
    Visible,
    /// Text with two bytes per character.
    Unicode,
    Bytes,
    Time,
    Unknown,
}

/// Number in the dictionary, type, name in the standard.
const TYPES: [(u16, DataType, &str); 25] = [
    (0x01, DataType::Boolean, "BOOLEAN"),
    (0x02, DataType::Integer8, "INTEGER8"),
    (0x03, DataType::Integer16, "INTEGER16"),
    (0x04, DataType::Integer32, "INTEGER32"),
    (0x05, DataType::Unsigned8, "UNSIGNED8"),
    (0x06, DataType::Unsigned16, "UNSIGNED16"),
    (0x07, DataType::Unsigned32, "UNSIGNED32"),
    (0x08, DataType::Real32, "REAL32"),
    (0x09, DataType::VisibleString, "VISIBLE_STRING"),
    (0x0A, DataType::OctetString, "OCTET_STRING"),
    (0x0B, DataType::UnicodeString, "UNICODE_STRING"),
    (0x0C, DataType::TimeOfDay, "TIME_OF_DAY"),
    (0x0D, DataType::TimeDifference, "TIME_DIFFERENCE"),
    (0x0F, DataType::Domain, "DOMAIN"),
    (0x10, DataType::Integer24, "INTEGER24"),
    (0x11, DataType::Real64, "REAL64"),
    (0x12, DataType::Integer40, "INTEGER40"),
    (0x13, DataType::Integer48, "INTEGER48"),
    (0x14, DataType::Integer56, "INTEGER56"),
    (0x15, DataType::Integer64, "INTEGER64"),
    (0x16, DataType::Unsigned24, "UNSIGNED24"),
    (0x18, DataType::Unsigned40, "UNSIGNED40"),
    (0x19, DataType::Unsigned48, "UNSIGNED48"),
    (0x1A, DataType::Unsigned56, "UNSIGNED56"),
    (0x1B, DataType::Unsigned64, "UNSIGNED64"),
];

impl DataType {
    /// Returns the type with a number in the dictionary.
    pub fn of(number: u16) -> Self {
        TYPES.iter().find(|row| row.0 == number).map_or(Self::Other(number), |row| row.1)
    }

    /// Returns the number in the dictionary.
    pub fn number(self) -> u16 {
        match self {
            Self::Other(number) => number,
            known => TYPES.iter().find(|row| row.1 == known).map_or(0, |row| row.0),
        }
    }

    /// Returns the number of bits in a PDO; `None` if values differ in length.
    pub fn bits(self) -> Option<u32> {
        match self.kind() {
            Kind::Boolean => Some(1),
            Kind::Integer(bytes) | Kind::Unsigned(bytes) => Some(bytes * 8),
            Kind::Real32 => Some(32),
            Kind::Real64 => Some(64),
            Kind::Time => Some(48),
            Kind::Visible | Kind::Unicode | Kind::Bytes | Kind::Unknown => None,
        }
    }

    /// Returns true if values of this type are integers of that many bits, signed or unsigned; also for a type that is not known.
    pub fn may_be_integer(self, bits: u32) -> bool {
        match self {
            Self::Other(_) => true,
            Self::Real32 | Self::Real64 => false,
            known => known.bits() == Some(bits),
        }
    }

    /// Returns true if values are text.
    pub fn is_text(self) -> bool {
        matches!(self.kind(), Kind::Visible | Kind::Unicode)
    }

    /// Returns true if values are integers, signed or unsigned; false for BOOLEAN.
    pub fn is_integer(self) -> bool {
        matches!(self.kind(), Kind::Integer(_) | Kind::Unsigned(_))
    }

    pub(super) fn kind(self) -> Kind {
        match self {
            Self::Boolean => Kind::Boolean,
            Self::Integer8 => Kind::Integer(1),
            Self::Integer16 => Kind::Integer(2),
            Self::Integer24 => Kind::Integer(3),
            Self::Integer32 => Kind::Integer(4),
            Self::Integer40 => Kind::Integer(5),
            Self::Integer48 => Kind::Integer(6),
            Self::Integer56 => Kind::Integer(7),
            Self::Integer64 => Kind::Integer(8),
            Self::Unsigned8 => Kind::Unsigned(1),
            Self::Unsigned16 => Kind::Unsigned(2),
            Self::Unsigned24 => Kind::Unsigned(3),
            Self::Unsigned32 => Kind::Unsigned(4),
            Self::Unsigned40 => Kind::Unsigned(5),
            Self::Unsigned48 => Kind::Unsigned(6),
            Self::Unsigned56 => Kind::Unsigned(7),
            Self::Unsigned64 => Kind::Unsigned(8),
            Self::Real32 => Kind::Real32,
            Self::Real64 => Kind::Real64,
            Self::VisibleString => Kind::Visible,
            Self::UnicodeString => Kind::Unicode,
            Self::OctetString | Self::Domain => Kind::Bytes,
            Self::TimeOfDay | Self::TimeDifference => Kind::Time,
            Self::Other(_) => Kind::Unknown,
        }
    }
}

impl fmt::Display for DataType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match TYPES.iter().find(|row| row.1 == *self) {
            Some((_, _, name)) => f.write_str(name),
            None => write!(f, "data type {:04X}h", self.number()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_that_of_its_type() {
        for number in 0..=u16::MAX {
            assert_eq!(DataType::of(number).number(), number);
        }
        // CiA 301 has no type 0Eh and no type 17h.
        assert_eq!(DataType::of(0x0E), DataType::Other(0x0E));
        assert_eq!(DataType::of(0x17), DataType::Other(0x17));
    }

    #[test]
    fn names_say_how_many_bits_there_are() {
        for (_, data_type, name) in TYPES {
            let digits: String = name.chars().filter(char::is_ascii_digit).collect();
            if let Ok(bits) = digits.parse() {
                assert_eq!(data_type.bits(), Some(bits), "{name}");
            }
            assert_eq!(data_type.to_string(), name);
        }
        assert_eq!(DataType::Boolean.bits(), Some(1));
        assert_eq!(DataType::Domain.bits(), None);
        assert_eq!(DataType::Other(0x20).to_string(), "data type 0020h");
    }
}
