//! Datagrams on loopback, compatible with the bus `udp_multicast` of python-can: for development and tests, not for drives.
//!
//! Law      each frame is sent to all members of the group; the own frames are not received. Datagrams may get lost and may be reordered
//! Reads    datagrams of the group on loopback; invalid ones are counted and ignored
//! Refuses  nothing
//! Source   python-can 4.6.1 (`interfaces/udp_multicast`)

use super::datagram::{Datagram, frame_of};
use super::waiting::SendQueue;
use super::way::TransportState;
use super::{Transport, TransportError};
use crate::Frame;
use lineshaft_core::drive::BusState;
use socket2::{Domain, Socket, Type};
use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};

/// Maximum size of a received datagram: a channel of python-can has a name of any length.
const LONGEST: usize = 1024;

/// Bus of a multicast group.
#[derive(Debug)]
pub struct UdpBus {
    /// All members share the port of the group. Sending from a separate socket makes it possible to recognize the own frames.
    hears: UdpSocket,
    says: UdpSocket,
    group: SocketAddrV4,
    own: u16,
    way: TransportState,
    waiting: SendQueue<Frame>,
    faults: u64,
}

impl UdpBus {
    /// Joins a group, on loopback.
    ///
    /// # Errors
    /// The system has no room for a socket, or another program has exclusive use of the port.
    pub fn open(group: Ipv4Addr, port: u16) -> io::Result<Self> {
        let group = SocketAddrV4::new(group, port);
        let hears = Socket::new(Domain::IPV4, Type::DGRAM, None)?;
        hears.set_reuse_address(true)?;
        hears.set_reuse_port(true)?;
        // Otherwise datagrams of other groups that any program on this host has joined would be received too.
        hears.set_multicast_all_v4(false)?;
        hears.bind(&group.into())?;
        hears.join_multicast_v4(group.ip(), &Ipv4Addr::LOCALHOST)?;
        let says = Socket::new(Domain::IPV4, Type::DGRAM, None)?;
        says.set_multicast_if_v4(&Ipv4Addr::LOCALHOST)?;
        says.bind(&SocketAddrV4::new(Ipv4Addr::LOCALHOST, 0).into())?;
        let (hears, says): (UdpSocket, UdpSocket) = (hears.into(), says.into());
        hears.set_nonblocking(true)?;
        says.set_nonblocking(true)?;
        let own = says.local_addr()?.port();
        Ok(Self { hears, says, group, own, way: TransportState::default(), waiting: SendQueue::new(), faults: 0 })
    }
}

impl Transport for UdpBus {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        self.flush()?;
        self.waiting.push(*frame)?;
        self.flush()
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        self.way.check()?;
        while let Some(frame) = self.waiting.first() {
            let sent = self.says.send_to(Datagram::of(frame).bytes(), self.group);
            if self.way.unless_would_block(sent)?.is_none() {
                break;
            }
            self.waiting.drop_first();
        }
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        self.way.check()?;
        let mut bytes = [0; LONGEST];
        while let Some((count, from)) = self.way.unless_would_block(self.hears.recv_from(&mut bytes))? {
            if from.ip() == Ipv4Addr::LOCALHOST && from.port() == self.own {
                continue;
            }
            match frame_of(bytes.get(..count).unwrap_or_default()) {
                Ok(Some(frame)) => return Ok(Some(frame)),
                Ok(None) => {}
                Err(_) => self.faults = self.faults.saturating_add(1),
            }
        }
        Ok(None)
    }

    fn state(&self) -> BusState {
        self.way.state(BusState::Active)
    }

    fn faults(&self) -> u64 {
        self.faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Id;
    use std::thread;
    use std::time::{Duration, Instant};

    fn next(bus: &mut UdpBus) -> Frame {
        let began = Instant::now();
        loop {
            match bus.receive().unwrap() {
                Some(frame) => return frame,
                None => thread::sleep(Duration::from_millis(1)),
            }
            assert!(began.elapsed() < Duration::from_secs(10), "nothing comes");
        }
    }

    #[test]
    fn frame_is_received_by_all_members_except_sender() {
        let group = Ipv4Addr::new(239, 74, 163, 77);
        // A port that is free now, and that no other test uses.
        let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let mut buses = [(); 3].map(|()| UdpBus::open(group, port).unwrap());
        let frame = |number: u8| Frame::data(Id::new(0x180 + u16::from(number)).unwrap(), &[number; 8]).unwrap();
        for number in 0..3 {
            buses[usize::from(number)].send(&frame(number)).unwrap();
        }
        for (number, bus) in (0..).zip(&mut buses) {
            let others: Vec<_> = (0..3).filter(|other| *other != number).map(frame).collect();
            assert_eq!([next(bus), next(bus)], others[..]);
            assert_eq!((bus.receive().unwrap(), bus.faults(), bus.state()), (None, 0, BusState::Active));
        }
        let [first, second, _] = &mut buses;
        first.says.send_to(b"no frame", first.group).unwrap();
        second.says.send_to(b"no frame", second.group).unwrap();
        second.send(&frame(1)).unwrap();
        assert_eq!((next(first), first.faults()), (frame(1), 1), "its own are passed over, whatever they are");
    }
}
