//! Address of an object in the dictionary of a device.

use std::fmt;

/// Object of a device's dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Object {
    /// Index.
    pub index: u16,
    /// Subindex.
    pub sub: u8,
}

impl Object {
    /// Returns the multiplexer of SDO frames: index, low byte first, and subindex.
    pub fn mux(self) -> [u8; 3] {
        let [low, high] = self.index.to_le_bytes();
        [low, high, self.sub]
    }
}

impl fmt::Display for Object {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04X}h:{:02X}", self.index, self.sub)
    }
}
