//! Classical CAN frames with 11-bit identifiers, as CANopen uses them (CiA 301).

use lineshaft_core::drive::FrameKind;

/// Reason why a frame or an identifier is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// The identifier exceeds 11 bits.
    #[error("CAN identifier {0:X}h; 0h to 7FFh is allowed")]
    Id(u16),
    /// The frame has more than 8 bytes.
    #[error("{0} bytes of data; 0 to 8 are allowed")]
    Length(usize),
}

/// An 11-bit identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id(u16);

impl Id {
    /// Network management (NMT, CiA 301).
    pub const NMT: Self = Self(0x000);
    /// SYNC (CiA 301, object 1005h by default).
    pub const SYNC: Self = Self(0x080);
    /// TIME (CiA 301, object 1012h by default).
    pub const TIME: Self = Self(0x100);
    /// From LSS slaves to the LSS master (CiA 305).
    pub const LSS_SLAVE: Self = Self(0x7E4);
    /// From the LSS master to its slaves (CiA 305).
    pub const LSS_MASTER: Self = Self(0x7E5);

    /// Creates an identifier of 0h to 7FFh.
    ///
    /// # Errors
    /// The number is larger.
    pub const fn new(id: u16) -> Result<Self, FrameError> {
        if id <= 0x7FF { Ok(Self(id)) } else { Err(FrameError::Id(id)) }
    }

    /// Returns the identifier of a function of one node: at most 780h + 127.
    pub(crate) const fn of_function(function: u16, node: u8) -> Self {
        Self((function & 0x780) + (node & 0x7F) as u16)
    }

    /// Returns the number.
    pub const fn get(self) -> u16 {
        self.0
    }
}

/// A data or remote frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    id: Id,
    data: [u8; 8],
    length: u8,
    remote: bool,
}

impl Frame {
    /// Creates a data frame.
    ///
    /// # Errors
    /// There are more than 8 bytes.
    pub fn data(id: Id, bytes: &[u8]) -> Result<Self, FrameError> {
        let mut data = [0; 8];
        let place = data.get_mut(..bytes.len()).ok_or(FrameError::Length(bytes.len()))?;
        place.copy_from_slice(bytes);
        Ok(Self { id, data, length: bytes.len() as u8, remote: false })
    }

    /// Creates a data frame of 8 bytes.
    pub const fn of(id: Id, data: [u8; 8]) -> Self {
        Self { id, data, length: 8, remote: false }
    }

    /// Creates a data frame of 2 bytes.
    pub(crate) const fn short(id: Id, [a, b]: [u8; 2]) -> Self {
        Self { id, data: [a, b, 0, 0, 0, 0, 0, 0], length: 2, remote: false }
    }

    /// Creates a remote frame that requests `length` bytes.
    ///
    /// # Errors
    /// The length exceeds 8 bytes.
    pub fn remote(id: Id, length: u8) -> Result<Self, FrameError> {
        if length > 8 {
            return Err(FrameError::Length(length.into()));
        }
        Ok(Self { id, data: [0; 8], length, remote: true })
    }

    /// Returns the identifier.
    pub fn id(&self) -> Id {
        self.id
    }

    /// Returns the data; empty for a remote frame.
    pub fn bytes(&self) -> &[u8] {
        if self.remote { &[] } else { &self.data[..usize::from(self.length)] }
    }

    /// Returns the number of bytes that the frame carries or requests.
    pub fn length(&self) -> u8 {
        self.length
    }

    /// Returns true for a remote frame.
    pub fn is_remote(&self) -> bool {
        self.remote
    }

    /// Returns the bytes of the frame in capture files of SocketCAN ([`CAPTURE`]): identifier and flags (big-endian),
    /// length, three reserved bytes, data.
    pub fn to_capture(&self) -> [u8; 16] {
        const REMOTE: u32 = 1 << 30;
        let word = u32::from(self.id.0) | if self.remote { REMOTE } else { 0 };
        let ([a, b, c, d], data) = (word.to_be_bytes(), if self.remote { [0; 8] } else { self.data });
        let [e, f, g, h, i, j, k, l] = data;
        [a, b, c, d, self.length, 0, 0, 0, e, f, g, h, i, j, k, l]
    }
}

/// Kind of recorded frames: LINKTYPE_CAN_SOCKETCAN.
pub const CAPTURE: FrameKind = FrameKind(227);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_have_eleven_bits() {
        assert_eq!(Id::new(0x7FF).map(Id::get), Ok(0x7FF));
        assert_eq!(Id::new(0x800).unwrap_err().to_string(), "CAN identifier 800h; 0h to 7FFh is allowed");
    }

    #[test]
    fn frames_carry_up_to_eight_bytes() {
        let frame = Frame::data(Id::SYNC, &[1, 2, 3]).unwrap();
        assert_eq!((frame.id(), frame.bytes(), frame.is_remote()), (Id::SYNC, &[1, 2, 3][..], false));
        assert_eq!(Frame::data(Id::NMT, &[0; 8]).unwrap().length(), 8);
        assert_eq!(Frame::data(Id::NMT, &[0; 9]), Err(FrameError::Length(9)));
    }

    #[test]
    fn remote_frame_has_length_but_no_data() {
        let frame = Frame::remote(Id::SYNC, 8).unwrap();
        assert_eq!((frame.bytes(), frame.length(), frame.is_remote()), (&[][..], 8, true));
        assert_eq!(Frame::remote(Id::SYNC, 9), Err(FrameError::Length(9)));
    }

    #[test]
    fn captured_frame_has_identifier_flag_length_and_data() {
        let data = Frame::data(Id::new(0x183).unwrap(), &[1, 2, 3]).unwrap();
        assert_eq!(data.to_capture(), [0, 0, 0x01, 0x83, 3, 0, 0, 0, 1, 2, 3, 0, 0, 0, 0, 0]);
        let remote = Frame::remote(Id::new(0x703).unwrap(), 1).unwrap();
        assert_eq!(remote.to_capture(), [0x40, 0, 0x07, 0x03, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    }
}
