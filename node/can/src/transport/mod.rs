//! Transports of CAN frames over different kinds of buses, with one interface.
//!
//! Law      no call blocks: frames that cannot be sent at once are queued up to a fixed number. A lost transport stays lost
//! Refuses  frames for which the queue has no room; they are not sent later

mod address;
mod can_frame;
mod datagram;
mod line;
mod open;
mod piece;
mod pty;
pub mod slcan;
mod socket_can;
mod tty;
mod udp;
mod waiting;
mod way;

pub use address::{Address, AddressError};
pub use line::{SlcanError, SlcanLine};
pub use open::{BAUD_RATES, OpenError, OpenFailure, Options, open};
pub use pty::{PtyError, slcan_pty};
pub use socket_can::SocketCan;
pub use udp::UdpBus;
pub use way::Loss;

use crate::Frame;
use lineshaft_core::drive::BusState;

/// Reason why a transport failed.
#[derive(Debug, thiserror::Error)]
pub enum TransportError {
    /// The queue is full, because the bus or the adapter is slower than the sender.
    #[error("the bus takes no more frames: {0} of them wait")]
    Full(usize),
    /// The adapter or the interface is removed or broken.
    #[error("the way to the bus is lost: {0}")]
    Lost(Loss),
}

/// Transport of CAN frames. It allocates no memory after its creation.
pub trait Transport: Send {
    /// Sends a frame, or queues it after those that wait.
    ///
    /// # Errors
    /// The queue is full, and the frame is not sent; or the transport is lost.
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError>;

    /// Sends queued frames.
    ///
    /// # Errors
    /// The transport is lost.
    fn flush(&mut self) -> Result<(), TransportError>;

    /// Returns the next received frame, if there is one.
    ///
    /// # Errors
    /// The transport is lost.
    fn receive(&mut self) -> Result<Option<Frame>, TransportError>;

    /// Returns the state of the bus according to the data received so far; off if the transport is lost.
    fn state(&self) -> BusState {
        BusState::Active
    }

    /// Returns the number of faults so far: frames that an adapter has refused, frames that a controller has lost, invalid datagrams.
    fn faults(&self) -> u64 {
        0
    }

    /// Returns the last error counters of the controller, transmit and receive; `None` if it does not report them.
    fn errors(&self) -> Option<(u8, u8)> {
        None
    }

    /// Closes the transport, as far as that is possible without waiting.
    fn close(&mut self) {}
}

impl<T: Transport + ?Sized> Transport for Box<T> {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        (**self).send(frame)
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        (**self).flush()
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        (**self).receive()
    }

    fn state(&self) -> BusState {
        (**self).state()
    }

    fn faults(&self) -> u64 {
        (**self).faults()
    }

    fn errors(&self) -> Option<(u8, u8)> {
        (**self).errors()
    }

    fn close(&mut self) {
        (**self).close();
    }
}
