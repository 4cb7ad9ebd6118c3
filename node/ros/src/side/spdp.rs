//! Announcements of discovery (RTPS 2.5, 8.5 and 9.6): good-byes in the name of a participant of ours and of a reader, and a
//! participant that we play.

use std::net::SocketAddrV4;

use super::rtps::{Entity, Message, SENTINEL, number, parameter};
use crate::link::guid::{Guid, Prefix};

const SPDP_WRITER: Entity = [0, 1, 0, 0xc2];
const SPDP_READER: Entity = [0, 1, 0, 0xc7];
const PARTICIPANT: Entity = [0, 0, 1, 0xc1];
const READERS_WRITER: Entity = [0, 0, 4, 0xc2];
const READERS_READER: Entity = [0, 0, 4, 0xc7];
/// PID_PARTICIPANT_GUID, PID_ENDPOINT_GUID: keys of what is announced.
const PARTICIPANT_GUID: u16 = 0x50;
const ENDPOINT_GUID: u16 = 0x5a;

/// `who` says good-bye, as sample `sequence` of its announcements.
pub(super) fn farewell(who: Prefix, sequence: i64) -> Vec<u8> {
    let mut guid = [0; 16];
    guid[..12].copy_from_slice(&who.0);
    guid[12..].copy_from_slice(&PARTICIPANT);
    gone(Guid(guid), PARTICIPANT_GUID, (SPDP_READER, SPDP_WRITER), sequence)
}

/// `reader` is no more, as sample `sequence` of the announcements of readers. The DDS library (0.15.1) says so without a key hash,
/// which Fast DDS needs; of two samples of one number it takes the first.
pub(super) fn reader_gone(reader: Guid, sequence: i64) -> Vec<u8> {
    gone(reader, ENDPOINT_GUID, (READERS_READER, READERS_WRITER), sequence)
}

fn gone(who: Guid, key: u16, (reader, writer): (Entity, Entity), sequence: i64) -> Vec<u8> {
    let guid = who.0;
    let mut body = [&[0, 0, 16, 0], reader.as_slice(), &writer, &number(sequence)].concat();
    // PID_KEY_HASH; PID_STATUS_INFO: disposed and unregistered.
    parameter(&mut body, 0x70, &guid);
    parameter(&mut body, 0x71, &[0, 0, 0, 3]);
    body.extend(SENTINEL);
    // The key as parameter list.
    body.extend([0, 3, 0, 0]);
    parameter(&mut body, key, &guid);
    body.extend(SENTINEL);
    let mut message = Message::from(who.prefix());
    message.submessage(0x15, 0b1010, &body);
    message.bytes()
}

fn locator(address: SocketAddrV4) -> Vec<u8> {
    let (kind, port) = (1u32.to_le_bytes(), u32::from(address.port()).to_le_bytes());
    [kind.as_slice(), &port, &[0; 12], &address.ip().octets()].concat()
}

/// Built-in endpoints of a participant that has only its announcement.
const BARE: u32 = 0x3;

/// A participant that we play.
pub(super) fn announced(who: Prefix, address: SocketAddrV4, sequence: i64, lease_s: i32) -> Vec<u8> {
    let mut list = vec![0, 3, 0, 0];
    // Protocol version, vendor, participant, built-in endpoints, locators of discovery and of data, lease.
    parameter(&mut list, 0x15, &[2, 4]);
    parameter(&mut list, 0x16, &[0x01, 0x12]);
    parameter(&mut list, 0x50, &[who.0.as_slice(), &PARTICIPANT].concat());
    parameter(&mut list, 0x58, &BARE.to_le_bytes());
    parameter(&mut list, 0x32, &locator(address));
    parameter(&mut list, 0x31, &locator(address));
    parameter(&mut list, 0x02, &[lease_s.to_le_bytes(), [0; 4]].concat());
    list.extend(SENTINEL);
    let mut message = Message::from(who);
    message.list(SPDP_READER, SPDP_WRITER, sequence, &list);
    message.bytes()
}
