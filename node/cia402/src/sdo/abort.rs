//! SDO abort codes (CiA 301).

use std::fmt;

/// SDO abort code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Abort(pub u32);

impl Abort {
    /// Toggle bit not alternated.
    pub const TOGGLE: Self = Self(0x0503_0000);
    /// SDO protocol timed out.
    pub const TIMEOUT: Self = Self(0x0504_0000);
    /// Command specifier not valid or unknown.
    pub const COMMAND: Self = Self(0x0504_0001);
    /// Invalid block size: 0 or more than 127 segments.
    pub const BLOCK_SIZE: Self = Self(0x0504_0002);
    /// Invalid sequence number of a segment.
    pub const SEQUENCE: Self = Self(0x0504_0003);
    /// CRC error of a block transfer.
    pub const CRC: Self = Self(0x0504_0004);
    /// Out of memory: more bytes than there is room for.
    pub const MEMORY: Self = Self(0x0504_0005);
    /// The length differs from the size that was announced.
    pub const LENGTH: Self = Self(0x0607_0010);

    /// Returns the text of the code; `None` for a code of the vendor.
    pub fn text(self) -> Option<&'static str> {
        Some(match self.0 {
            0x0503_0000 => "the toggle bit does not alternate",
            0x0504_0000 => "the SDO transfer has timed out",
            0x0504_0001 => "the command is not known",
            0x0504_0002 => "the size of a block is not 1 to 127 segments",
            0x0504_0003 => "a segment of a block is out of its sequence",
            0x0504_0004 => "the check sum does not fit",
            0x0504_0005 => "there is not enough memory",
            0x0601_0000 => "the object does not support this access",
            0x0601_0001 => "the object can only be written",
            0x0601_0002 => "the object can only be read",
            0x0602_0000 => "the object does not exist",
            0x0604_0041 => "the object cannot be mapped to a PDO",
            0x0604_0042 => "the mapped objects are longer than a PDO",
            0x0604_0043 => "the parameters are incompatible",
            0x0604_0047 => "the device is incompatible in itself",
            0x0606_0000 => "the hardware does not allow the access",
            0x0607_0010 => "the length does not match the object",
            0x0607_0012 => "there are too many bytes for the object",
            0x0607_0013 => "there are too few bytes for the object",
            0x0609_0011 => "the subindex does not exist",
            0x0609_0030 => "the value is out of its range",
            0x0609_0031 => "the value is too high",
            0x0609_0032 => "the value is too low",
            0x0609_0036 => "the maximum is less than the minimum",
            0x060A_0023 => "a resource is not available",
            0x0800_0000 => "a general error",
            0x0800_0020 => "the data cannot be stored",
            0x0800_0021 => "the data cannot be stored under local control",
            0x0800_0022 => "the data cannot be stored in the present state of the device",
            0x0800_0023 => "there is no object dictionary",
            0x0800_0024 => "there is no data",
            _ => return None,
        })
    }
}

impl fmt::Display for Abort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.text() {
            Some(text) => write!(f, "{text} ({:08X}h)", self.0),
            None => write!(f, "abort code {:08X}h of the device", self.0),
        }
    }
}
