//! CAN interface of Linux.
//!
//! Law      frames that the interface does not accept are queued and sent later. When the bus goes off, the queue is cleared, so that no
//!          old command is sent late. The state of the bus comes from the controller
//! Reads    frames with an 11-bit identifier; the kernel filters out all others
//! Refuses  an interface that is down or missing: the transport is lost
//! Source   Linux `Documentation/networking/can.rst`; `net/can/raw.c`

use super::can_frame::{ERRORS, ReceivedContent, SIZE, bytes_of, decode};
use super::waiting::SendQueue;
use super::way::TransportState;
use super::{OpenFailure, Transport, TransportError};
use crate::Frame;
use ::socketcan::{CanAddr, CanFilter, CanSocket, Socket, SocketOptions};
use lineshaft_core::drive::BusState;
use rustix::io::Errno;
use std::io::{self, Read, Write};

/// Flag of an extended identifier, in an identifier and in the mask of a filter.
const EXTENDED: u32 = 1 << 31;

/// Socket of an interface.
#[derive(Debug)]
pub struct SocketCan {
    socket: CanSocket,
    way: TransportState,
    waiting: SendQueue<[u8; SIZE]>,
    state: BusState,
    faults: u64,
    errors: Option<(u8, u8)>,
}

impl SocketCan {
    /// Opens an interface, which must be up and have its bit rate.
    ///
    /// # Errors
    /// The kernel does not support CAN; the interface is missing, or is down.
    pub fn open(interface: &str) -> Result<Self, OpenFailure> {
        // First all interfaces: a kernel without CAN needs another message than a missing interface.
        CanSocket::open_addr(&CanAddr::new(0)).map_err(|error| obstacle(error, interface))?;
        let opened = || {
            let socket = CanSocket::open(interface)?;
            socket.set_nonblocking(true)?;
            socket.set_error_filter(ERRORS)?;
            socket.set_filters(&[CanFilter::new(0, EXTENDED)])?;
            // An interface that is down reports this as the pending error.
            let pending = socket.as_raw_socket().take_error()?;
            pending.map_or(Ok(socket), Err)
        };
        let socket = opened().map_err(|error| obstacle(error, interface))?;
        let (way, waiting, state) = (TransportState::default(), SendQueue::new(), BusState::Active);
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

fn obstacle(error: io::Error, interface: &str) -> OpenFailure {
    let interface = interface.to_owned();
    match Errno::from_io_error(&error) {
        Some(Errno::AFNOSUPPORT | Errno::PROTONOSUPPORT) => OpenFailure::NoCan,
        Some(Errno::NODEV | Errno::NXIO) => OpenFailure::NoInterface(interface),
        Some(Errno::NETDOWN) => OpenFailure::InterfaceDown(interface),
        _ => OpenFailure::System(error),
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
            if self.way.unless_would_block(self.socket.write(bytes))?.is_none() {
                break;
            }
            self.waiting.drop_first();
        }
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        self.way.check()?;
        let mut bytes = [0; SIZE];
        while let Some(count) = self.way.unless_would_block(self.socket.read(&mut bytes))? {
            match decode(&bytes) {
                _ if count != SIZE => self.faults = self.faults.saturating_add(1),
                ReceivedContent::Frame(frame) => return Ok(Some(frame)),
                ReceivedContent::Controller { state, has_lost, errors } => {
                    self.errors = errors.or(self.errors);
                    self.controller_tells(state, has_lost);
                }
                ReceivedContent::Other => {}
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
