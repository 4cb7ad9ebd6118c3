//! A socket of our own, for what is sent next to the DDS library.

use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};

/// Sends datagrams; what comes back is for its listener.
pub(super) struct OwnSocket {
    socket: UdpSocket,
    address: SocketAddrV4,
}

impl OwnSocket {
    /// To anywhere.
    pub(super) fn new() -> io::Result<Self> {
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        let address = SocketAddrV4::new(Ipv4Addr::LOCALHOST, socket.local_addr()?.port());
        Ok(Self { socket, address })
    }

    /// On one network, which its datagrams to groups take, too.
    pub(super) fn on(network: Ipv4Addr) -> io::Result<Self> {
        let socket = UdpSocket::bind((network, 0))?;
        let address = SocketAddrV4::new(network, socket.local_addr()?.port());
        Ok(Self { socket, address })
    }

    /// Where it is reached on this host.
    pub(super) fn address(&self) -> SocketAddrV4 {
        self.address
    }

    /// Hears what comes back.
    pub(super) fn listener(&self) -> io::Result<UdpSocket> {
        // The two are one socket to the system: what finds no room is lost then, as anywhere on its way.
        self.socket.set_nonblocking(true)?;
        self.socket.try_clone()
    }

    /// Sends, where there is a way: a datagram may get lost in any case.
    pub(super) fn send(&self, datagram: &[u8], to: SocketAddrV4) {
        // A closed port comes back as an error of the next datagram.
        for _ in 0..2 {
            if self.socket.send_to(datagram, to).is_ok() {
                return;
            }
        }
    }
}
