//! Requests of clients of Fast DDS without a wait of 3 s.
//!
//! Where a client matched the service before the DDS library matched the client, its request is dropped. The library then asks for
//! news by an ACKNACK from number 1 on; Fast DDS (since 2.6.9, 2.10.4, 2.14.1) answers that one by its next heartbeat, 3 s later. An
//! ACKNACK from 0 on it answers at once; but it refuses ACKNACKs that are not counted upwards, also those of the library after ours.
//! Sequence  on a match of a reader with a writer of Fast DDS:
//!           1. `counted` twice, count 1 and 2, to our library: it counts on to 2, and answers where nobody listens
//!           2. 2 ms later `first_please`, then `heartbeat_please`, to every address of the writer: counts 1, 2
//!           A new client sends its first sample for the former, others a heartbeat for the latter, upon which the library asks,
//!           count 3.

use std::net::SocketAddrV4;
use std::time::Duration;

use super::member::Shared;
use super::rtps::{Message, entity, number};
use crate::link::guid::Guid;

/// What our library needs for two heartbeats.
const PAUSE: Duration = Duration::from_millis(2);

/// Has a writer send what our reader has missed.
pub(super) async fn nudge(shared: &Shared, reader: Guid, writer: Guid) {
    let (beside, inside) = (&shared.beside, shared.participant.data_address());
    for count in 1..=2 {
        beside.send(&counted(reader, writer, count, beside.address()), inside);
    }
    tokio::time::sleep(PAUSE).await;
    for address in shared.participant.addresses_of_writer(writer) {
        beside.send(&first_please(reader, writer), address);
        beside.send(&heartbeat_please(reader, writer), address);
    }
}

fn ends(from: Guid, to: Guid) -> Message {
    let mut message = Message::from(from.prefix());
    message.to(to.prefix());
    message
}

/// For our library, as if it came from `writer`: a heartbeat of nothing, to be answered to `nobody` (INFO_REPLY).
fn counted(reader: Guid, writer: Guid, count: u32, nobody: SocketAddrV4) -> Vec<u8> {
    let mut message = ends(writer, reader);
    let one = 1u32.to_le_bytes();
    let kind_and_port = [one, u32::from(nobody.port()).to_le_bytes()].concat();
    let locator = [kind_and_port.as_slice(), &[0; 12], &nobody.ip().octets()].concat();
    // The library reads a byte more than RTPS has: no other list.
    message.submessage(0x0f, 0, &[one.as_slice(), &locator, &[0; 4]].concat());
    let range = [number(1), number(0)].concat();
    let body = [entity(reader).as_slice(), &entity(writer), &range, &count.to_le_bytes()].concat();
    message.submessage(0x07, 0, &body);
    message.bytes()
}

/// Asks `writer` for its sample 1. One that has none, or none any more, does nothing.
fn first_please(reader: Guid, writer: Guid) -> Vec<u8> {
    let mut message = ends(reader, writer);
    let one = 1u32.to_le_bytes();
    let wanted = [one, (1u32 << 31).to_le_bytes(), one].concat();
    message.submessage(0x06, 0b10, &[entity(reader).as_slice(), &entity(writer), &number(1), &wanted].concat());
    message.bytes()
}

/// Asks `writer` for a heartbeat.
fn heartbeat_please(reader: Guid, writer: Guid) -> Vec<u8> {
    let mut message = ends(reader, writer);
    let nothing = [[0; 4], 2u32.to_le_bytes()].concat();
    message.submessage(0x06, 0, &[entity(reader).as_slice(), &entity(writer), &number(0), &nothing].concat());
    message.bytes()
}
