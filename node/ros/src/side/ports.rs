//! UDP ports of the participant (RTPS 2.5, 9.6.2.3): one for discovery and one for data, both given by its participant ID.
//!
//! The DDS library (0.15.1) uses the first participant ID with a free discovery port. If the data port of that ID is in use, the library
//! reads another port, but its writers announce the one in use: no acknowledgement arrives, and after some samples nothing is sent.
//! Fast DDS uses data ports of other IDs. So IDs with only one free port are kept from the library.

use std::fs;
use std::net::{Ipv4Addr, UdpSocket};
use std::os::unix::ffi::OsStrExt;

use super::spdp::{PROGRAMS, own_port};

/// Port on which the participant with this ID reads data.
pub(super) fn data_port(domain: u16, id: u16) -> u16 {
    own_port(domain, id) + 1
}

/// Occupies the discovery ports of all IDs whose data port is in use, up to the first ID with two free ports.
pub(super) fn occupy(domain: u16) -> Vec<UdpSocket> {
    let bind = |port| UdpSocket::bind((Ipv4Addr::UNSPECIFIED, port));
    let mut occupied = Vec::new();
    for id in 0..PROGRAMS {
        let Ok(discovery) = bind(own_port(domain, id)) else { continue };
        if bind(data_port(domain, id)).is_ok() {
            break;
        }
        occupied.push(discovery);
    }
    occupied
}

/// Whether this process has bound a UDP port; `None` if the system does not report it.
pub(super) fn is_own(port: u16) -> Option<bool> {
    let sockets = fs::read_to_string("/proc/self/net/udp").ok()?;
    let suffix = format!(":{port:04X}");
    // proc(5): the second field is the local address, the tenth the inode.
    let inodes = sockets.lines().filter_map(|line| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        fields.get(1)?.ends_with(&suffix).then(|| format!("socket:[{}]", fields.get(9).copied().unwrap_or_default()))
    });
    let bound: Vec<String> = inodes.collect();
    let mut own = fs::read_dir("/proc/self/fd").ok()?.filter_map(|entry| fs::read_link(entry.ok()?.path()).ok());
    Some(own.any(|link| bound.iter().any(|inode| inode.as_bytes() == link.as_os_str().as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::super::dds::Participant;
    use super::*;

    #[test]
    fn participant_skips_id_whose_data_port_is_in_use() {
        // No other test of this process joins this domain.
        let domain = 170 + u16::try_from(std::process::id() % 30).unwrap();
        let is_free = |port| UdpSocket::bind((Ipv4Addr::UNSPECIFIED, port)).is_ok();
        let mut ids = 0..PROGRAMS;
        let taken = ids.find(|id| is_free(own_port(domain, *id)) && is_free(data_port(domain, *id))).unwrap();
        let other = UdpSocket::bind((Ipv4Addr::LOCALHOST, data_port(domain, taken))).unwrap();
        assert_eq!(is_own(data_port(domain, taken)), Some(true));
        let participant = Participant::new(domain, Some(&[Ipv4Addr::LOCALHOST])).unwrap();
        let port = participant.data_address().port();
        assert!(port > data_port(domain, taken), "{port}");
        assert_eq!(is_own(port), Some(true));
        // The occupied discovery port is free again.
        UdpSocket::bind((Ipv4Addr::UNSPECIFIED, own_port(domain, taken))).unwrap();
        drop(other);
        assert_eq!(is_own(data_port(domain, taken)), Some(false));
    }
}
