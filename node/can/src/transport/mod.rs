//! Ways to a bus, each behind the same words: frames go out, frames come in.
//!
//! Law      nothing waits: what cannot go at once stands in a queue of a fixed length, and what has not come is not there. A way that is
//!          lost stays lost
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
pub use open::{BAUD_RATES, Obstacle, OpenError, Options, open};
pub use pty::{PtyError, slcan_pty};
pub use socket_can::SocketCan;
pub use udp::UdpBus;
pub use way::Loss;

use crate::Frame;
use lineshaft_core::drive::BusState;

/// Why a transport does not do its work.
#[derive(Debug, thiserror::Error)]
pub enum TransportError {
    /// Frames wait already, and there is no room for more: the bus, or what is before it, is slower than what sends.
    #[error("the bus takes no more frames: {0} of them wait")]
    Full(usize),
    /// The adapter or the interface is gone, or broken.
    #[error("the way to the bus is lost: {0}")]
    Lost(Loss),
}

/// A way to a bus. It takes no memory once it is made.
pub trait Transport: Send {
    /// Sends a frame, or lets it wait behind those that wait.
    ///
    /// # Errors
    /// There is no room, and the frame is not sent; or the way is lost.
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError>;

    /// Goes on with what waits.
    ///
    /// # Errors
    /// The way is lost.
    fn flush(&mut self) -> Result<(), TransportError>;

    /// The next frame that has come, if one has.
    ///
    /// # Errors
    /// The way is lost.
    fn receive(&mut self) -> Result<Option<Frame>, TransportError>;

    /// How the bus does, by what has been received so far; off where the way is lost.
    fn state(&self) -> BusState {
        BusState::Active
    }

    /// Signs of trouble so far: frames that an adapter has refused, frames that a controller has lost, datagrams that are no frames.
    fn faults(&self) -> u64 {
        0
    }

    /// Error counters of the controller, transmit and receive, as it has told them last; none where it tells none.
    fn errors(&self) -> Option<(u8, u8)> {
        None
    }

    /// Takes leave of the bus, as far as that is possible at once.
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
