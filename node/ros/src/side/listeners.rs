//! Sockets that receive the announcements of other participants, in addition to the DDS library.
//!
//! Law      on networks with multicast, announcements are sent to the multicast group of the domain. Without multicast, they are sent to
//!          the ports of all participants that a host may have; a listener binds one of these ports, as another participant would

use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};

use socket2::{Domain, Protocol, Socket, Type};

use super::spdp::{GROUP, PROGRAMS, group_port, own_port};

/// Opens the listeners of a participant that was created on these networks.
pub(super) fn open(domain: u16, networks: &[Ipv4Addr]) -> io::Result<Vec<UdpSocket>> {
    let mut all = Vec::new();
    let far: Vec<_> = networks.iter().filter(|network| !network.is_loopback()).collect();
    if !far.is_empty() {
        let group = group(domain)?;
        for network in &far {
            // The network may have been removed since, or may lack multicast.
            if let Err(error) = group.join_multicast_v4(&GROUP, network) {
                tracing::debug!("announcements on the network of {network} are not heard: {error}");
            }
        }
        all.push(group);
    }
    let here = if far.is_empty() { Ipv4Addr::LOCALHOST } else { Ipv4Addr::UNSPECIFIED };
    let ports = (0..PROGRAMS).map(|id| own_port(domain, id));
    all.extend(ports.map(|port| UdpSocket::bind((here, port))).find_map(Result::ok));
    all.iter().try_for_each(|listener| listener.set_nonblocking(true))?;
    Ok(all)
}

fn group(domain: u16) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    // All participants of the host share the port. This socket is bound to the group, so it receives no unicast datagrams to them.
    socket.set_reuse_address(true)?;
    socket.set_reuse_port(true)?;
    socket.bind(&SocketAddrV4::new(GROUP, group_port(domain)).into())?;
    Ok(socket.into())
}
