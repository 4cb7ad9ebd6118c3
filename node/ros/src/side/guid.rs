//! Identifiers of DDS participants and endpoints.
//!
//! The GUID of an endpoint has 12 bytes for its participant (the prefix), 3 for the endpoint, 1 for its kind.

use lineshaft_msgs::foreign::rmw_dds_common::msg::Gid;

pub(super) use crate::link::protocol::{Gid as Guid, ParticipantId as Prefix};

/// Vendor ID of eProsima Fast DDS, as RTPS participants announce it; its GUIDs start with it.
const FAST_DDS: [u8; 2] = [0x01, 0x0f];
/// Vendor ID of Eclipse Cyclone DDS, as RTPS participants announce it; its GUIDs start with it.
const CYCLONE: [u8; 2] = [0x01, 0x10];

impl Guid {
    /// Returns the prefix of the participant that this GUID is, or belongs to.
    pub(super) fn prefix(self) -> Prefix {
        let mut prefix = [0; 12];
        prefix.copy_from_slice(&self.0[..12]);
        Prefix(prefix)
    }

    /// Returns true if it is a reader. RTPS 2.5, table 9.1: all kinds of readers have this bit, no kind of writer has it.
    pub(super) fn is_reader(self) -> bool {
        self.0[15] & 0x04 != 0
    }

    /// Returns true if it is a built-in endpoint (used for discovery); RTPS 2.5, table 9.1.
    pub(super) fn is_builtin(self) -> bool {
        self.0[15] & 0xc0 == 0xc0
    }

    /// Returns true if it belongs to a participant of eProsima Fast DDS.
    pub(super) fn is_fast_dds(self) -> bool {
        self.0[..2] == FAST_DDS
    }

    /// Returns true if it belongs to a participant of Eclipse Cyclone DDS.
    pub(super) fn is_cyclone(self) -> bool {
        self.0[..2] == CYCLONE
    }
}

impl Prefix {
    /// Returns the endpoint of this participant with these last 4 bytes.
    pub(super) fn endpoint(self, entity: [u8; 4]) -> Guid {
        let mut guid = [0; 16];
        guid[..12].copy_from_slice(&self.0);
        guid[12..].copy_from_slice(&entity);
        Guid(guid)
    }
}

impl From<Guid> for Gid {
    fn from(guid: Guid) -> Self {
        Self { data: guid.0 }
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
        // Built-in endpoints: C2, C3, C4, C7.
        assert!(
            guid(0xc2).is_builtin() && guid(0xc7).is_builtin() && !guid(0x03).is_builtin() && !guid(0x04).is_builtin()
        );
        assert_eq!(guid(0x04).prefix().endpoint([0, 0, 18, 0x04]), guid(0x04));
        assert!(guid(0x03).is_cyclone());
        assert_eq!(guid(0x03).prefix().to_string(), "01100203040506070809".to_owned() + "0a0b");
    }
}
