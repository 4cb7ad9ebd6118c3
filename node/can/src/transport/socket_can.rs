//! A CAN interface of Linux.
//!
//! Law      what the interface does not take now waits and is tried again; what waits when the bus goes off is dropped, so that no old
//!          command comes late. The controller tells how the bus does
//! Reads    frames with an 11-bit identifier; the kernel keeps the others away
//! Refuses  an interface that is down or gone: the way is lost
//! Source   Linux `Documentation/networking/can.rst`; `net/can/raw.c`

use super::can_frame::{ERRORS, Heard, SIZE, bytes_of, heard};
use super::waiting::Waiting;
use super::way::Way;
use super::{Obstacle, Transport, TransportError};
use crate::Frame;
use ::socketcan::{CanAddr, CanFilter, CanSocket, Socket, SocketOptions};
use lineshaft_core::drive::BusState;
use rustix::io::Errno;
use std::io::{self, Read, Write};

/// The flag of an extended identifier, in an identifier and in the mask of a filter.
const EXTENDED: u32 = 1 << 31;

/// A socket on an interface.
#[derive(Debug)]
pub struct SocketCan {
    socket: CanSocket,
    way: Way,
    waiting: Waiting<[u8; SIZE]>,
    state: BusState,
    faults: u64,
    errors: Option<(u8, u8)>,
}

impl SocketCan {
    /// Opens an interface, which is up and has its bit rate.
    ///
    /// # Errors
    /// The kernel knows no CAN; there is no such interface; it is down.
    pub fn open(interface: &str) -> Result<Self, Obstacle> {
        // All interfaces first: that a kernel knows no CAN at all has another cure than that it knows no such interface.
        CanSocket::open_addr(&CanAddr::new(0)).map_err(|error| obstacle(error, interface))?;
        let opened = || {
            let socket = CanSocket::open(interface)?;
            socket.set_nonblocking(true)?;
            socket.set_error_filter(ERRORS)?;
            socket.set_filters(&[CanFilter::new(0, EXTENDED)])?;
            // One that is down tells it as the error that is pending.
            let pending = socket.as_raw_socket().take_error()?;
            pending.map_or(Ok(socket), Err)
        };
        let socket = opened().map_err(|error| obstacle(error, interface))?;
        let (way, waiting, state) = (Way::default(), Waiting::new(), BusState::Active);
        Ok(Self { socket, way, waiting, state, faults: 0, errors: None })
    }

    fn controller_tells(&mut self, state: Option<BusState>, has_lost: bool) {
        self.faults = self.faults.saturating_add(has_lost.into());
        self.state = state.unwrap_or(self.state);
        if self.state == BusState::Off {
            self.waiting.drop_all();
        }
    }
}

fn obstacle(error: io::Error, interface: &str) -> Obstacle {
    let interface = interface.to_owned();
    match Errno::from_io_error(&error) {
        Some(Errno::AFNOSUPPORT | Errno::PROTONOSUPPORT) => Obstacle::NoCan,
        Some(Errno::NODEV | Errno::NXIO) => Obstacle::NoInterface(interface),
        Some(Errno::NETDOWN) => Obstacle::InterfaceDown(interface),
        _ => Obstacle::System(error),
    }
}

impl Transport for SocketCan {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        self.flush()?;
        self.waiting.push(bytes_of(frame))?;
        self.flush()
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        self.way.check()?;
        while let Some(bytes) = self.waiting.first() {
            if self.way.unless_later(self.socket.write(bytes))?.is_none() {
                break;
            }
            self.waiting.drop_first();
        }
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        self.way.check()?;
        let mut bytes = [0; SIZE];
        while let Some(count) = self.way.unless_later(self.socket.read(&mut bytes))? {
            match heard(&bytes) {
                _ if count != SIZE => self.faults = self.faults.saturating_add(1),
                Heard::Frame(frame) => return Ok(Some(frame)),
                Heard::Controller { state, has_lost, errors } => {
                    self.errors = errors.or(self.errors);
                    self.controller_tells(state, has_lost);
                }
                Heard::Other => {}
            }
        }
        Ok(None)
    }

    fn state(&self) -> BusState {
        self.way.state(self.state)
    }

    fn faults(&self) -> u64 {
        self.faults
    }

    fn errors(&self) -> Option<(u8, u8)> {
        self.errors
    }
}

#[cfg(test)]
mod tests;
