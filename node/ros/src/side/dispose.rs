//! Disposes participants of this program (SPDP): those that were killed, and those that a successor replaces.
//!
//! Clients of a killed node keep their requests for the rest of its lease (50 s). Cyclone DDS sends the last ten requests, also those that
//! were answered, to the readers of the next node, because the DDS library requests all samples from number 1. After the disposal no
//! request is kept, and the killed node disappears from the graph at once.

use std::net::{Ipv4Addr, SocketAddrV4};
use std::time::Duration;

use super::socket::OwnSocket;
use super::spdp::{self, GROUP, LATE, PROGRAMS, group_port, own_port};
use crate::link::protocol::Departed;

/// Number of datagrams for each disposal; some may get lost.
const TIMES: i64 = 3;
/// Time that clients need to read the last replies of a participant that is replaced.
const SETTLING: Duration = Duration::from_millis(200);
/// Number of repeated disposals, and the pause before each.
const REPETITIONS: i64 = 15;
const REPETITION_PAUSE: Duration = Duration::from_millis(20);
/// Time from the last disposal to the end of the participant.
const LAST_READING: Duration = Duration::from_millis(5);
/// Time that clients need to handle a disposal.
const PAUSE: Duration = Duration::from_millis(200);

/// Disposes participants that were killed, and waits until clients have handled that.
pub(super) fn dispose_all(dead: &[Departed]) {
    dead.iter().for_each(dispose);
    if !dead.is_empty() {
        std::thread::sleep(PAUSE);
    }
}

/// Disposes a participant.
pub(super) fn dispose(who: &Departed) {
    (LATE..LATE + TIMES).for_each(|sequence| tell_all(who, &spdp::disposal(who.participant, None, sequence)));
}

/// Disposes a participant that a successor replaces, and that still reads. Its library continues to announce it to new clients, so the
/// disposal is repeated.
pub(super) fn dispose_repeatedly(who: &Departed) {
    // Clients read the disposal on another socket, and ignore replies of a disposed participant.
    std::thread::sleep(SETTLING);
    for round in 1..=REPETITIONS {
        std::thread::sleep(REPETITION_PAUSE);
        let first = LATE + round * TIMES;
        (first..first + TIMES).for_each(|sequence| tell_all(who, &spdp::disposal(who.participant, None, sequence)));
    }
    // For requests that were sent just before. In this time, no new client can find the participant, match its readers and call.
    std::thread::sleep(LAST_READING);
}

/// Sends a datagram of discovery to all possible participants of the domain.
pub(super) fn tell_all(who: &Departed, datagram: &[u8]) {
    let networks = who.networks.clone().unwrap_or_else(of_host);
    // The multicast group, and the ports of all participants of this host.
    let local = (0..PROGRAMS).map(|id| SocketAddrV4::new(Ipv4Addr::LOCALHOST, own_port(who.domain, id)));
    let to_host: Vec<_> = local.collect();
    for network in &networks {
        let Ok(socket) = OwnSocket::on(*network) else { continue };
        if network.is_loopback() {
            to_host.iter().for_each(|address| socket.send(datagram, *address));
        } else {
            socket.send(datagram, SocketAddrV4::new(GROUP, group_port(who.domain)));
        }
    }
}

/// Returns all IPv4 addresses of this host.
pub(super) fn of_host() -> Vec<Ipv4Addr> {
    let interfaces = if_addrs::get_if_addrs().unwrap_or_default();
    let ipv4 = interfaces.into_iter().filter_map(|interface| match interface.ip() {
        std::net::IpAddr::V4(address) => Some(address),
        std::net::IpAddr::V6(_) => None,
    });
    ipv4.collect()
}
