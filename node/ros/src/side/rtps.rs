//! The few RTPS messages that are sent beside the DDS library, little endian.

use crate::link::guid::{Guid, Prefix};

/// The last 4 bytes of a GUID: the endpoint.
pub(super) type Entity = [u8; 4];

/// The endpoint's part of a GUID.
pub(super) fn entity(guid: Guid) -> Entity {
    std::array::from_fn(|place| guid.0[12 + place])
}

/// An RTPS message in the making.
pub(super) struct Message(Vec<u8>);

impl Message {
    /// As rustdds 0.15.1 begins its own: RTPS 2.4, its vendor.
    pub(super) fn from(prefix: Prefix) -> Self {
        Self([b"RTPS".as_slice(), &[2, 4, 0x01, 0x12], &prefix.0].concat())
    }

    /// A submessage of RTPS 2.5, 8.3.8; at most 64 kB.
    pub(super) fn submessage(&mut self, kind: u8, flags: u8, body: &[u8]) -> &mut Self {
        self.0.extend([kind, flags | 1]);
        self.0.extend((body.len() as u16).to_le_bytes());
        self.0.extend(body);
        self
    }

    /// INFO_DST: what follows is for this participant.
    pub(super) fn to(&mut self, prefix: Prefix) -> &mut Self {
        self.submessage(0x0e, 0, &prefix.0)
    }

    /// INFO_TS: when what follows was written, in 2^-32 s since 1970.
    pub(super) fn time(&mut self, ticks: u64) -> &mut Self {
        let seconds = ((ticks >> 32) as u32).to_le_bytes();
        self.submessage(0x09, 0, &[seconds, (ticks as u32).to_le_bytes()].concat())
    }

    /// GAP: samples `first` to `before - 1` are not for this reader.
    pub(super) fn gap(&mut self, reader: Entity, writer: Entity, first: i64, before: i64) -> &mut Self {
        let body = [reader.as_slice(), &writer, &number(first), &number(before), &[0; 4]].concat();
        self.submessage(0x08, 0, &body)
    }

    /// DATA with a parameter list (its encapsulation included) as payload.
    pub(super) fn list(&mut self, reader: Entity, writer: Entity, sequence: i64, payload: &[u8]) -> &mut Self {
        let body = [&[0, 0, 16, 0], reader.as_slice(), &writer, &number(sequence), payload].concat();
        self.submessage(0x15, 0b100, &body)
    }

    /// As it goes out.
    pub(super) fn bytes(self) -> Vec<u8> {
        self.0
    }
}

/// A sequence number as it stands on the wire.
pub(super) fn number(n: i64) -> [u8; 8] {
    let (high, low) = (((n >> 32) as i32).to_le_bytes(), (n as u32).to_le_bytes());
    [high[0], high[1], high[2], high[3], low[0], low[1], low[2], low[3]]
}

/// Adds a parameter to a list.
pub(super) fn parameter(list: &mut Vec<u8>, id: u16, value: &[u8]) {
    let length = value.len().next_multiple_of(4);
    list.extend(id.to_le_bytes());
    list.extend((length as u16).to_le_bytes());
    list.extend(value);
    list.resize(list.len() + length - value.len(), 0);
}

/// Ends a parameter list.
pub(super) const SENTINEL: [u8; 4] = [1, 0, 0, 0];
