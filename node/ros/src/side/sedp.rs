//! Endpoint announcements (SEDP; RTPS 2.5, 8.5.4 and 9.6.3): announces endpoints in the name of a simulated participant, and disposes
//! our readers.

use std::net::SocketAddrV4;

use super::guid::{Guid, Prefix};
use super::rtps::{Entity, Message, SENTINEL, locator, parameter};
use super::spdp::{PARTICIPANT, gone};

/// Maximum length of an announcement in bytes: a datagram has 64 kB.
const LONGEST: usize = 60_000;

/// Data that the DDS library needs to match a remote endpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Endpoint {
    pub(super) guid: Guid,
    pub(super) topic: String,
    pub(super) type_name: String,
    pub(super) reliable: bool,
    pub(super) latched: bool,
    pub(super) addresses: Vec<SocketAddrV4>,
    pub(super) user_data: Vec<u8>,
}

impl Endpoint {
    /// Returns its announcement by `who`, as sample `sequence` of the announcements of readers or of writers. Returns `None` if the names
    /// are too long.
    pub(super) fn announced(&self, who: Prefix, sequence: i64) -> Option<Vec<u8>> {
        if self.topic.len() + self.type_name.len() + self.user_data.len() + 24 * self.addresses.len() > LONGEST {
            return None;
        }
        // All lengths fit into 16 bits.
        let text = |text: &str| [(text.len() as u32 + 1).to_le_bytes().as_slice(), text.as_bytes(), &[0]].concat();
        let mut list = vec![0, 3, 0, 0];
        // Endpoint, its locators, its participant, topic, type, reliability, durability, user data.
        parameter(&mut list, 0x5a, &self.guid.0);
        self.addresses.iter().for_each(|address| parameter(&mut list, 0x2f, &locator(*address)));
        parameter(&mut list, 0x50, &[self.guid.prefix().0.as_slice(), &PARTICIPANT].concat());
        parameter(&mut list, 0x05, &text(&self.topic));
        parameter(&mut list, 0x07, &text(&self.type_name));
        let reliability = 1 + u32::from(self.reliable);
        parameter(&mut list, 0x1a, &[reliability.to_le_bytes(), [0; 4], [0; 4]].concat());
        parameter(&mut list, 0x1d, &u32::from(self.latched).to_le_bytes());
        if !self.user_data.is_empty() {
            parameter(
                &mut list,
                0x2c,
                &[&(self.user_data.len() as u32).to_le_bytes(), self.user_data.as_slice()].concat(),
            );
        }
        list.extend(SENTINEL);
        let topic = if self.guid.is_reader() { 4 } else { 3 };
        let mut message = Message::from(who);
        message.data([0, 0, topic, 0xc7], [0, 0, topic, 0xc2], sequence, &list);
        Some(message.bytes())
    }
}

/// Returns the disposal of `reader`, as sample `sequence` of the reader announcements of its participant. The DDS library (0.15.1)
/// sends its own disposal without a key hash, which Fast DDS needs. If two samples have the same number, Fast DDS uses the first.
pub(super) fn reader_gone(reader: Guid, sequence: i64) -> Vec<u8> {
    let ends: (Entity, Entity) = ([0, 0, 4, 0xc7], [0, 0, 4, 0xc2]);
    let mut message = Message::from(reader.prefix());
    message.submessage(0x15, 0b1010, &gone(&reader.0, 0x5a, ends, sequence));
    message.bytes()
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;

    #[test]
    fn readers_and_writers_are_announced_by_writers_of_their_own() {
        let endpoint = |kind| {
            let mut guid = [7; 16];
            guid[12..].copy_from_slice(&[0, 0, 18, kind]);
            Endpoint {
                guid: Guid(guid),
                topic: "rt/joint_states".to_owned(),
                type_name: "sensor_msgs::msg::dds_::JointState_".to_owned(),
                reliable: true,
                latched: false,
                addresses: vec![SocketAddrV4::new(Ipv4Addr::LOCALHOST, 7411)],
                user_data: b"clientid=7;".to_vec(),
            }
        };
        let writer_of = |kind| endpoint(kind).announced(Prefix([1; 12]), 3).unwrap()[32..36].to_vec();
        assert_eq!((writer_of(0x04), writer_of(0x03)), (vec![0, 0, 4, 0xc2], vec![0, 0, 3, 0xc2]));
        let long = Endpoint { topic: "t".repeat(LONGEST), ..endpoint(4) };
        assert_eq!(long.announced(Prefix([1; 12]), 3), None);
    }
}
