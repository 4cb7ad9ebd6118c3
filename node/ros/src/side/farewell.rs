//! Good-bye for participants of ours that were killed, and other news of ours for all.
//!
//! Their clients keep, for the rest of the lease (50 s), what they sent: Cyclone DDS gives the last ten requests, answered
//! ones too, to the readers of the next node, because the DDS library asks for all from number 1 on. After a good-bye there is
//! nothing to give; and the dead node leaves the graph at once.

use std::net::{Ipv4Addr, SocketAddrV4};
use std::time::Duration;

use super::beside::Beside;
use super::spdp::{self, GROUP, LATE, PROGRAMS, group_port, own_port};
use crate::link::protocol::Departed;

/// Each good-bye is said so often: datagrams get lost.
const TIMES: i64 = 3;
/// What receivers need until nothing is left of the dead.
const PAUSE: Duration = Duration::from_millis(200);

/// Says good-bye for the dead, and waits until that has been heard.
pub(super) fn bury(dead: &[Departed]) {
    dead.iter().for_each(say);
    if !dead.is_empty() {
        std::thread::sleep(PAUSE);
    }
}

/// Says good-bye in the name of a participant.
pub(super) fn say(who: &Departed) {
    (LATE..LATE + TIMES).for_each(|sequence| tell_all(who, &spdp::farewell(who.prefix, None, sequence)));
}

/// Sends a datagram of discovery to all who may know a participant.
pub(super) fn tell_all(who: &Departed, datagram: &[u8]) {
    let networks = who.networks.clone().unwrap_or_else(of_host);
    // The group, and where each program of the host listens to its own.
    let local = (0..PROGRAMS).map(|id| SocketAddrV4::new(Ipv4Addr::LOCALHOST, own_port(who.domain, id)));
    let to_host: Vec<_> = local.collect();
    for network in &networks {
        let Ok(beside) = Beside::on(*network) else { continue };
        if network.is_loopback() {
            to_host.iter().for_each(|address| beside.send(datagram, *address));
        } else {
            beside.send(datagram, SocketAddrV4::new(GROUP, group_port(who.domain)));
        }
    }
}

/// All addresses of this host.
pub(super) fn of_host() -> Vec<Ipv4Addr> {
    let interfaces = if_addrs::get_if_addrs().unwrap_or_default();
    let ipv4 = interfaces.into_iter().filter_map(|interface| match interface.ip() {
        std::net::IpAddr::V4(address) => Some(address),
        std::net::IpAddr::V6(_) => None,
    });
    ipv4.collect()
}
