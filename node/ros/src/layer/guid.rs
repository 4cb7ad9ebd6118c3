//! Identifiers of DDS participants and endpoints.

use std::fmt;

use lineshaft_msgs::foreign::rmw_dds_common::msg::Gid;

/// Vendor of Eclipse Cyclone DDS, as RTPS participants announce it and as its GUIDs begin.
const CYCLONE: [u8; 2] = [0x01, 0x10];

/// GUID of a DDS participant or endpoint: 12 bytes of the participant, 3 of the endpoint, 1 of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Guid(pub(super) [u8; 16]);

/// The participant's part of a [`Guid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Prefix(pub(super) [u8; 12]);

impl Guid {
    /// Which participant it is, or belongs to.
    pub(super) fn prefix(self) -> Prefix {
        let mut prefix = [0; 12];
        prefix.copy_from_slice(&self.0[..12]);
        Prefix(prefix)
    }

    /// Whether it is a reader; RTPS 2.5, table 9.1: all kinds of readers have this bit, no kind of writer has it.
    pub(super) fn is_reader(self) -> bool {
        self.0[15] & 0x04 != 0
    }

    /// Whether it belongs to a participant of Eclipse Cyclone DDS.
    pub(super) fn is_cyclone(self) -> bool {
        self.0[..2] == CYCLONE
    }
}

impl From<Guid> for Gid {
    fn from(guid: Guid) -> Self {
        Self { data: guid.0 }
    }
}

impl fmt::Display for Prefix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Display for Guid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.", self.prefix())?;
        self.0[12..].iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kind_tells_readers_from_writers() {
        let guid = |kind| Guid([1, 16, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 0, 18, kind]);
        // RTPS 2.5, table 9.1: writers 02 (with key) and 03 (no key), readers 07 and 04.
        assert!(guid(0x04).is_reader() && guid(0x07).is_reader());
        assert!(!guid(0x02).is_reader() && !guid(0x03).is_reader());
        assert!(guid(0x03).is_cyclone());
        assert_eq!(guid(0x03).to_string(), "01100203040506070809".to_owned() + "0a0b.00001203");
    }
}
