//! RTPS messages that are sent in addition to those of the DDS library (little endian), and a parser of the ACKNACKs that answer them.

use std::net::SocketAddrV4;

use super::guid::{Guid, Prefix};

/// Entity ID: the last 4 bytes of a GUID, which identify the endpoint.
pub(super) type Entity = [u8; 4];

/// Returns the entity ID of a GUID.
pub(super) fn entity(guid: Guid) -> Entity {
    std::array::from_fn(|place| guid.0[12 + place])
}

/// Builder of an RTPS message.
pub(super) struct Message(Vec<u8>);

impl Message {
    /// Starts a message with the same header as rustdds 0.15.1: RTPS 2.4, vendor ID of rustdds.
    pub(super) fn from(prefix: Prefix) -> Self {
        Self([b"RTPS".as_slice(), &[2, 4, 0x01, 0x12], &prefix.0].concat())
    }

    /// Adds a submessage (RTPS 2.5, 8.3.8) of at most 64 kB.
    pub(super) fn submessage(&mut self, kind: u8, flags: u8, body: &[u8]) -> &mut Self {
        self.0.extend([kind, flags | 1]);
        self.0.extend((body.len() as u16).to_le_bytes());
        self.0.extend(body);
        self
    }

    /// INFO_DST: the next submessages are for this participant.
    pub(super) fn to(&mut self, prefix: Prefix) -> &mut Self {
        self.submessage(INFO_DST, 0, &prefix.0)
    }

    /// INFO_TS: source timestamp of the next submessages, in 2^-32 s since 1970.
    pub(super) fn time(&mut self, ticks: u64) -> &mut Self {
        let seconds = ((ticks >> 32) as u32).to_le_bytes();
        self.submessage(0x09, 0, &[seconds, (ticks as u32).to_le_bytes()].concat())
    }

    /// GAP: samples `first` to `before - 1` are not for this reader.
    pub(super) fn gap(&mut self, reader: Entity, writer: Entity, first: i64, before: i64) -> &mut Self {
        let body = [reader.as_slice(), &writer, &number(first), &number(before), &[0; 4]].concat();
        self.submessage(GAP, 0, &body)
    }

    /// INFO_REPLY: the answers to the next submessages are sent to this address.
    pub(super) fn reply_to(&mut self, address: SocketAddrV4) -> &mut Self {
        let locators = [&1u32.to_le_bytes()[..], &locator(address)].concat();
        // The DDS library reads one byte more than RTPS specifies: no multicast list.
        self.submessage(0x0f, 0, &[&locators[..], &[0; 4]].concat())
    }

    /// HEARTBEAT of a writer that has no samples; it requests an answer.
    pub(super) fn empty_heartbeat(&mut self, reader: Entity, writer: Entity, count: i32) -> &mut Self {
        let body = [&reader[..], &writer, &number(1), &number(0), &count.to_le_bytes()].concat();
        self.submessage(HEARTBEAT, 0, &body)
    }

    /// ACKNACK that requests no sample.
    pub(super) fn acknack(&mut self, ack: &AckNack) -> &mut Self {
        let body = [&ack.reader[..], &ack.writer, &number(ack.base), &[0; 4], &ack.count.to_le_bytes()].concat();
        self.submessage(ACKNACK, if ack.is_final { FINAL } else { 0 }, &body)
    }

    /// DATA with this payload, including its encapsulation.
    pub(super) fn data(&mut self, reader: Entity, writer: Entity, sequence: i64, payload: &[u8]) -> &mut Self {
        let body = [&[0, 0, 16, 0], reader.as_slice(), &writer, &number(sequence), payload].concat();
        self.submessage(DATA, 0b100, &body)
    }

    /// Length of the message so far, in bytes.
    pub(super) fn length(&self) -> usize {
        self.0.len()
    }

    /// Returns the message as it is sent.
    pub(super) fn bytes(self) -> Vec<u8> {
        self.0
    }
}

const INFO_DST: u8 = 0x0e;
pub(super) const ACKNACK: u8 = 0x06;
pub(super) const HEARTBEAT: u8 = 0x07;
pub(super) const GAP: u8 = 0x08;
pub(super) const DATA: u8 = 0x15;
/// Flag of an ACKNACK that needs no answer.
pub(super) const FINAL: u8 = 0b10;

/// An ACKNACK with an empty set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AckNack {
    pub(super) reader: Entity,
    pub(super) writer: Entity,
    /// All samples before this number are acknowledged; 0: preemptive, before the reader has any information about the writer's samples.
    pub(super) base: i64,
    pub(super) count: i32,
    pub(super) is_final: bool,
}

/// Reader, writer and count of a received ACKNACK.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Acknowledged {
    pub(super) reader: Guid,
    pub(super) writer: Guid,
    pub(super) count: i32,
}

/// Returns the last ACKNACK of a little-endian message.
pub(super) fn read_acknack(datagram: &[u8]) -> Option<Acknowledged> {
    let (from, mut to) = (prefix(datagram, 8)?, None);
    let (mut rest, mut found) = (datagram.get(20..)?, None);
    while let [kind, flags, low, high, ref body @ ..] = *rest {
        if flags & 1 == 0 {
            return found;
        }
        let length = usize::from(u16::from_le_bytes([low, high]));
        // The last submessage may have length 0: it extends to the end of the message.
        let body = body.get(..if length == 0 { body.len() } else { length })?;
        match kind {
            INFO_DST => to = prefix(body, 0),
            ACKNACK => {
                let count = *body.last_chunk::<4>()?;
                let entity = |at: usize| body.get(at..at + 4)?.try_into().ok();
                let (reader, writer) = (from.endpoint(entity(0)?), to?.endpoint(entity(4)?));
                found = Some(Acknowledged { reader, writer, count: i32::from_le_bytes(count) });
            }
            _ => {}
        }
        rest = &rest[4 + body.len()..];
    }
    found
}

fn prefix(bytes: &[u8], at: usize) -> Option<Prefix> {
    bytes.get(at..at + 12)?.try_into().ok().map(Prefix)
}

/// Returns the UDP locator of an address.
pub(super) fn locator(address: SocketAddrV4) -> Vec<u8> {
    let (kind, port) = (1u32.to_le_bytes(), u32::from(address.port()).to_le_bytes());
    [&kind[..], &port, &[0; 12], &address.ip().octets()].concat()
}

/// Returns a sequence number as it is sent.
pub(super) fn number(n: i64) -> [u8; 8] {
    let (high, low) = (((n >> 32) as i32).to_le_bytes(), (n as u32).to_le_bytes());
    [high[0], high[1], high[2], high[3], low[0], low[1], low[2], low[3]]
}

/// Adds a parameter to a parameter list.
pub(super) fn parameter(list: &mut Vec<u8>, id: u16, value: &[u8]) {
    let length = value.len().next_multiple_of(4);
    list.extend(id.to_le_bytes());
    list.extend((length as u16).to_le_bytes());
    list.extend(value);
    list.resize(list.len() + length - value.len(), 0);
}

/// End of a parameter list.
pub(super) const SENTINEL: [u8; 4] = [1, 0, 0, 0];

#[cfg(test)]
mod tests {
    use super::*;

    const READER: Guid = Guid([1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 7, 4]);
    const WRITER: Guid = Guid([2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 0, 0, 9, 3]);

    #[test]
    fn an_acknack_is_read_after_other_submessages() {
        let ack = AckNack { reader: entity(READER), writer: entity(WRITER), base: 7, count: -3, is_final: true };
        let mut message = Message::from(READER.prefix());
        message.time(5).to(WRITER.prefix()).acknack(&ack);
        let bytes = message.bytes();
        assert_eq!(read_acknack(&bytes), Some(Acknowledged { reader: READER, writer: WRITER, count: -3 }));
        for length in 0..bytes.len() {
            assert_eq!(read_acknack(&bytes[..length]), None, "{length} bytes");
        }
    }

    #[test]
    fn a_message_without_destination_has_no_acknack() {
        let ack = AckNack { reader: entity(READER), writer: entity(WRITER), base: 7, count: 1, is_final: false };
        let mut message = Message::from(READER.prefix());
        message.acknack(&ack);
        assert_eq!(read_acknack(&message.bytes()), None);
    }
}
