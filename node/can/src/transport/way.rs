//! State of a transport: whether it is lost.
//!
//! Law      a lost transport stays lost, for the same reason; opening it again creates another transport

use super::TransportError;
use lineshaft_core::drive::BusState;
use rustix::io::Errno;
use std::io::{self, ErrorKind};

/// Reason why a transport is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Loss {
    /// The adapter has closed the stream, or was unplugged.
    #[error("the adapter has closed the line")]
    Ended,
    /// Error number of the system.
    #[error("{}", io::Error::from_raw_os_error(*.0))]
    System(i32),
    /// Another error.
    #[error("{0}")]
    Other(ErrorKind),
}

impl From<io::Error> for Loss {
    fn from(error: io::Error) -> Self {
        error.raw_os_error().map_or(Self::Other(error.kind()), Self::System)
    }
}

/// Reason why the transport is lost, if it is.
#[derive(Debug, Default)]
pub(super) struct TransportState(Option<Loss>);

impl TransportState {
    /// Returns an error if the transport is lost.
    pub(super) fn check(&self) -> Result<(), TransportError> {
        self.0.map_or(Ok(()), |loss| Err(TransportError::Lost(loss)))
    }

    /// Marks the transport as lost.
    pub(super) fn mark_lost(&mut self, loss: Loss) -> TransportError {
        TransportError::Lost(*self.0.get_or_insert(loss))
    }

    /// Returns the result of an operation; `None` if it would block. Any other error marks the transport as lost.
    pub(super) fn unless_would_block<T>(&mut self, result: io::Result<T>) -> Result<Option<T>, TransportError> {
        match result {
            Ok(done) => Ok(Some(done)),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(None),
            // A CAN interface returns this error if its queue is full.
            Err(error) if Errno::from_io_error(&error) == Some(Errno::NOBUFS) => Ok(None),
            Err(error) => Err(self.mark_lost(error.into())),
        }
    }

    /// Returns `state`, or off if the transport is lost.
    pub(super) fn state(&self, state: BusState) -> BusState {
        if self.0.is_some() { BusState::Off } else { state }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_stays_lost_for_its_first_reason() {
        let mut way = TransportState::default();
        way.check().unwrap();
        for later in [ErrorKind::WouldBlock.into(), io::Error::from_raw_os_error(Errno::NOBUFS.raw_os_error())] {
            assert_eq!(way.unless_would_block::<()>(Err(later)).unwrap(), None);
        }
        assert_eq!(way.state(BusState::Degraded), BusState::Degraded);
        let first = way.unless_would_block::<()>(Err(io::Error::from_raw_os_error(19))).unwrap_err().to_string();
        assert_eq!(first, "the way to the bus is lost: No such device (os error 19)");
        assert_eq!(way.mark_lost(Loss::Ended).to_string(), first);
        assert_eq!(way.check().unwrap_err().to_string(), first);
        assert_eq!(way.state(BusState::Degraded), BusState::Off);
    }
}
