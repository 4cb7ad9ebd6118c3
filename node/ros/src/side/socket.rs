//! Separate UDP socket, for datagrams that are sent in addition to those of the DDS library.

use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};

/// Sends datagrams. Its listener receives the answers.
pub(super) struct OwnSocket {
    socket: UdpSocket,
    address: SocketAddrV4,
}

impl OwnSocket {
    /// Creates a socket for all networks.
    pub(super) fn new() -> io::Result<Self> {
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        let address = SocketAddrV4::new(Ipv4Addr::LOCALHOST, socket.local_addr()?.port());
        Ok(Self { socket, address })
    }

    /// Creates a socket on one network. Its multicast datagrams are sent on this network, too.
    pub(super) fn on(network: Ipv4Addr) -> io::Result<Self> {
        let socket = UdpSocket::bind((network, 0))?;
        let address = SocketAddrV4::new(network, socket.local_addr()?.port());
        Ok(Self { socket, address })
    }

    /// Returns its address for senders on this host.
    pub(super) fn address(&self) -> SocketAddrV4 {
        self.address
    }

    /// Returns a socket that receives the answers.
    pub(super) fn listener(&self) -> io::Result<UdpSocket> {
        // For the system, both are the same socket, so sending does not block, either: a datagram without buffer space is lost.
        self.socket.set_nonblocking(true)?;
        self.socket.try_clone()
    }

    /// Sends a datagram. Errors are ignored, because a datagram can always get lost.
    pub(super) fn send(&self, datagram: &[u8], to: SocketAddrV4) {
        // The error of a closed port is reported at the next datagram.
        for _ in 0..2 {
            if self.socket.send_to(datagram, to).is_ok() {
                return;
            }
        }
    }
}
