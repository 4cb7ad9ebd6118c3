//! Mapping of PDOs: objects 1400h to 1BFFh.

use crate::object::Object;

/// Direction of a PDO, from the view of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The device receives it.
    Receive,
    /// The device sends it.
    Transmit,
}

impl Direction {
    /// Returns the first index of the communication parameters and of the mapping.
    pub fn first(self) -> (u16, u16) {
        match self {
            Self::Receive => (0x1400, 0x1600),
            Self::Transmit => (0x1800, 0x1A00),
        }
    }

    /// Returns the index of the communication parameters of a PDO, `number` from 1.
    pub fn communication(self, number: u8) -> u16 {
        self.first().0 + u16::from(number.max(1)) - 1
    }

    /// Returns the index of the mapping of a PDO, `number` from 1.
    pub fn mapping(self, number: u8) -> u16 {
        self.first().1 + u16::from(number.max(1)) - 1
    }
}

/// Object in a PDO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mapped {
    /// Object.
    pub object: Object,
    /// Length, in bits.
    pub bits: u8,
}
