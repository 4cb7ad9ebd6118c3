//! Ways to a bus, each behind the same words: frames go out, frames come in.
//!
//! Law      nothing waits: what cannot go at once stands in a queue of a fixed length, and what has not come is not there
//! Refuses  frames for which the queue has no room; they are not sent later

mod line;
pub mod slcan;

pub use line::SlcanLine;

use crate::Frame;
use std::io;

/// Why a transport does not do its work.
#[derive(Debug, thiserror::Error)]
pub enum TransportError {
    /// Frames wait already, and there is no room for more: the bus, or what is before it, is slower than what sends.
    #[error("the bus takes no more frames: {0} of them wait")]
    Full(usize),
    /// The adapter or the interface is gone, or broken.
    #[error("the way to the bus is lost: {0}")]
    Lost(#[from] io::Error),
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
}
