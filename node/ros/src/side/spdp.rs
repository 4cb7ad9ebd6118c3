//! Participant announcements (SPDP; RTPS 2.5, 8.5.3 and 9.6.3): reads and repeats them, disposes our participants, and announces
//! simulated participants.

use std::net::{Ipv4Addr, SocketAddrV4};

use super::guid::Prefix;
use super::rtps::{Entity, Message, SENTINEL, locator, number, parameter};

const SPDP_WRITER: Entity = [0, 1, 0, 0xc2];
const SPDP_READER: Entity = [0, 1, 0, 0xc7];
pub(super) const PARTICIPANT: Entity = [0, 0, 1, 0xc1];

/// Multicast group to which participants announce themselves on networks with multicast.
pub(super) const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 0, 1);
/// Maximum number of participants of one host and domain (RTPS 2.5, 9.6.2.3).
pub(super) const PROGRAMS: u16 = 120;

/// Returns the port of the multicast group in a domain.
pub(super) fn group_port(domain: u16) -> u16 {
    7400 + 250 * domain
}

/// Returns the port on which the participant with this ID reads announcements that are sent to it (unicast).
pub(super) fn own_port(domain: u16, id: u16) -> u16 {
    group_port(domain) + 10 + 2 * id
}

/// Larger than any sequence number that the library gives to its own announcements: Fast DDS accepts only rising numbers.
pub(super) const LATE: i64 = 1 << 30;

/// Maximum number of addresses of a participant that are used; each one adds a datagram.
const ADDRESSES: usize = 4;

/// A received announcement of a participant.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Announcement {
    pub(super) who: Prefix,
    /// Whether the participant is disposed or unregistered.
    pub(super) is_gone: bool,
    /// Addresses on which it reads announcements.
    pub(super) addresses: Vec<SocketAddrV4>,
    /// Parameter list with its encapsulation.
    payload: Vec<u8>,
}

impl Announcement {
    /// Reads the first announcement in a datagram.
    pub(super) fn read(datagram: &[u8]) -> Option<Self> {
        if datagram.get(..4)? != b"RTPS" {
            return None;
        }
        let who = Prefix(datagram.get(8..20)?.try_into().ok()?);
        let mut rest = datagram.get(20..)?;
        while let [kind, flags, ..] = *rest {
            let little = flags & 1 != 0;
            let length = usize::from(u16_at(rest, 2, little)?);
            // The last submessage may have length 0: it extends to the end of the message.
            let end = if length == 0 { rest.len() } else { 4 + length };
            let body = rest.get(4..end)?;
            if kind == 0x15 && body.get(8..12) == Some(&SPDP_WRITER) {
                return Self::of(who, flags, body);
            }
            rest = &rest[end..];
        }
        None
    }

    /// Reads the announcement from the body of a DATA submessage.
    fn of(who: Prefix, flags: u8, body: &[u8]) -> Option<Self> {
        let little = flags & 1 != 0;
        let mut payload = body.get(4 + usize::from(u16_at(body, 2, little)?)..)?;
        // The payload is only a key, without data.
        let mut is_gone = flags & 0b1000 != 0;
        if flags & 0b10 != 0 {
            let (inline, rest) = parameters(payload, little)?;
            // PID_STATUS_INFO: disposed or unregistered.
            is_gone |= inline.iter().any(|(id, value)| *id == 0x71 && value.get(3).is_some_and(|said| said & 3 != 0));
            payload = rest;
        }
        let little = payload.get(1)? & 1 != 0;
        let (list, _) = parameters(payload.get(4..)?, little)?;
        // PID_PARTICIPANT_GUID: the library identifies the participant by this parameter only.
        if list.iter().any(|(id, value)| *id == 0x50 && value.get(..12) != Some(&who.0)) {
            return None;
        }
        // PID_METATRAFFIC_UNICAST_LOCATOR.
        let locators = list.iter().filter(|(id, _)| *id == 0x32);
        let addresses = locators.filter_map(|(_, value)| udp_v4(value, little)).take(ADDRESSES).collect();
        Some(Self { who, is_gone, addresses, payload: payload.to_vec() })
    }

    /// Returns the same announcement as sample `sequence`.
    pub(super) fn again(&self, sequence: i64) -> Vec<u8> {
        if self.is_gone {
            return disposal(self.who, None, sequence);
        }
        let mut message = Message::from(self.who);
        message.data(SPDP_READER, SPDP_WRITER, sequence, &self.payload);
        message.bytes()
    }
}

pub(super) fn u16_at(bytes: &[u8], at: usize, little: bool) -> Option<u16> {
    let two = bytes.get(at..at + 2)?.try_into().ok()?;
    Some(if little { u16::from_le_bytes(two) } else { u16::from_be_bytes(two) })
}

fn u32_at(bytes: &[u8], at: usize, little: bool) -> Option<u32> {
    let four = bytes.get(at..at + 4)?.try_into().ok()?;
    Some(if little { u32::from_le_bytes(four) } else { u32::from_be_bytes(four) })
}

/// IDs and values of a parameter list.
pub(super) type Parameters<'a> = Vec<(u16, &'a [u8])>;

/// Returns a parameter list, and the bytes after it.
pub(super) fn parameters(bytes: &[u8], little: bool) -> Option<(Parameters<'_>, &[u8])> {
    let (mut all, mut rest) = (Vec::new(), bytes);
    loop {
        let (id, length) = (u16_at(rest, 0, little)?, usize::from(u16_at(rest, 2, little)?));
        rest = &rest[4..];
        if id == 1 {
            return Some((all, rest));
        }
        all.push((id, rest.get(..length)?));
        rest = &rest[length..];
    }
}

fn udp_v4(locator: &[u8], little: bool) -> Option<SocketAddrV4> {
    let is_udp_v4 = u32_at(locator, 0, little)? == 1;
    let port = u16::try_from(u32_at(locator, 4, little)?).ok()?;
    let address: [u8; 4] = locator.get(20..24)?.try_into().ok()?;
    is_udp_v4.then(|| SocketAddrV4::new(Ipv4Addr::from(address), port))
}

/// Returns the disposal of `who`, as sample `sequence` of its announcements; for `whom` only, or for all participants.
pub(super) fn disposal(who: Prefix, whom: Option<Prefix>, sequence: i64) -> Vec<u8> {
    let guid = [who.0.as_slice(), &PARTICIPANT].concat();
    let mut message = Message::from(who);
    if let Some(whom) = whom {
        message.to(whom);
    }
    message.submessage(0x15, 0b1010, &gone(&guid, 0x50, (SPDP_READER, SPDP_WRITER), sequence));
    message.bytes()
}

/// Returns the body of a DATA submessage that disposes the entity with this GUID. `key` is the parameter ID of the GUID.
pub(super) fn gone(guid: &[u8], key: u16, (reader, writer): (Entity, Entity), sequence: i64) -> Vec<u8> {
    let mut body = [&[0, 0, 16, 0], reader.as_slice(), &writer, &number(sequence)].concat();
    // PID_KEY_HASH; PID_STATUS_INFO: disposed and unregistered.
    parameter(&mut body, 0x70, guid);
    parameter(&mut body, 0x71, &[0, 0, 0, 3]);
    body.extend(SENTINEL);
    // The key as a parameter list.
    body.extend([0, 3, 0, 0]);
    parameter(&mut body, key, guid);
    body.extend(SENTINEL);
    body
}

/// A simulated participant.
pub(super) struct SimulatedParticipant<'a> {
    pub(super) who: Prefix,
    /// Addresses on which it reads.
    pub(super) addresses: &'a [SocketAddrV4],
    /// Bit set of its built-in endpoints.
    pub(super) builtin: u32,
    pub(super) lease_s: i32,
}

/// Built-in endpoints of a participant that only announces itself.
pub(super) const BARE: u32 = 0x3;
/// Built-in endpoints of a participant that also announces endpoints, and reads no announcements of endpoints.
pub(super) const ANNOUNCER: u32 = 0x15;

impl SimulatedParticipant<'_> {
    /// Returns its announcement as sample `sequence`.
    pub(super) fn announced(&self, sequence: i64) -> Vec<u8> {
        let mut list = vec![0, 3, 0, 0];
        // Protocol version, vendor, participant, built-in endpoints, locators of discovery and of data, lease.
        parameter(&mut list, 0x15, &[2, 4]);
        parameter(&mut list, 0x16, &[0x01, 0x12]);
        parameter(&mut list, 0x50, &[self.who.0.as_slice(), &PARTICIPANT].concat());
        parameter(&mut list, 0x58, &self.builtin.to_le_bytes());
        self.addresses.iter().for_each(|address| parameter(&mut list, 0x32, &locator(*address)));
        self.addresses.iter().for_each(|address| parameter(&mut list, 0x31, &locator(*address)));
        parameter(&mut list, 0x02, &[self.lease_s.to_le_bytes(), [0; 4]].concat());
        list.extend(SENTINEL);
        let mut message = Message::from(self.who);
        message.data(SPDP_READER, SPDP_WRITER, sequence, &list);
        message.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADDRESS: SocketAddrV4 = SocketAddrV4::new(Ipv4Addr::new(10, 1, 2, 3), 7410);

    fn announced() -> Vec<u8> {
        SimulatedParticipant { who: Prefix([5; 12]), addresses: &[ADDRESS], builtin: BARE, lease_s: 3 }.announced(1)
    }

    #[test]
    fn announcement_is_read_as_written() {
        let heard = Announcement::read(&announced()).unwrap();
        assert_eq!(
            (heard.who, heard.is_gone, heard.addresses.as_slice()),
            (Prefix([5; 12]), false, [ADDRESS].as_slice())
        );
        assert_eq!(Announcement::read(&heard.again(1 << 40)), Some(heard));
        let gone = Announcement::read(&disposal(Prefix([5; 12]), Some(Prefix([6; 12])), 2)).unwrap();
        assert_eq!((gone.who, gone.is_gone), (Prefix([5; 12]), true));
        assert_eq!(Announcement::read(&gone.again(1 << 40)), Some(gone));
    }

    #[test]
    fn pieces_and_nonsense_are_not_read() {
        let whole = announced();
        for length in 0..whole.len() {
            assert_eq!(Announcement::read(&whole[..length]), None, "{length}");
        }
        // In the name of another participant.
        let mut forged = whole.clone();
        forged[8..20].fill(6);
        assert_eq!(Announcement::read(&forged), None);
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut bent = whole.clone();
                bent[at] ^= 1 << bit;
                let _ = Announcement::read(&bent);
            }
        }
    }
}
