//! Service data objects (SDO): requests to a drive next to process data, and their results, independent of the frames of a bus.
//!
//! Source   CiA 301; ETG.1000.6 (CoE), with the same abort codes

mod abort;

pub use abort::Abort;

use crate::object::Object;

/// SDO request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SdoRequest {
    /// Object.
    pub object: Object,
    /// Bytes to be written, or the buffer for those that are read.
    pub data: Vec<u8>,
    /// Whether the request is a write.
    pub writes: bool,
}

/// Reason why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SdoError {
    /// The device has aborted the transfer.
    #[error("{0}: the device refuses: {1}")]
    Refused(Object, Abort),
    /// The answer of the device was invalid, and the transfer was aborted.
    #[error("{0}: the device answers wrongly: {1}")]
    Wrong(Object, Abort),
    /// The device has not answered; timeout in ms.
    #[error("{0}: the device has not answered for {1} ms")]
    Silent(Object, u64),
    /// Another transfer with the device is in progress.
    #[error("{0}: another transfer with the device is under way")]
    Busy(Object),
}

/// Result of a transfer. It returns the buffer to the caller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transfer {
    /// Object.
    pub object: Object,
    /// Bytes that were read, or that were to be written.
    pub data: Vec<u8>,
    /// Reason of the failure, if the transfer failed.
    pub result: Result<(), SdoError>,
}
