//! SDO requests of other clients while cycles run.
//!
//! Law      each bus has a queue of requests. The service handles them one after another and answers each once. A client that has waited
//!          too long cancels its request, which is then never started
//! Refuses  a request for which the queue has no room; a write that requires a drive without power, if the drive reports enabled, quick
//!          stop or fault reaction (6041h)
//! Source   CiA 301; CiA 402-2 (states)

use super::port::Port;
use crate::NodeId;
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::{Abort, SdoError};
use lineshaft_cia402::texts;
use lineshaft_core::drive::DriveState;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

/// Maximum size of an object, in bytes: a block of 127 segments.
pub const LONGEST: usize = 889;
/// Maximum number of waiting requests of one bus.
pub const MOST_WAITING: usize = 16;
/// Time for requests in each turn of the service, before waiting drives are handled. At least one request is handled.
const TURN_TIME: Duration = Duration::from_millis(50);
const STATUS: Object = Object { index: 0x6041, sub: 0 };

/// Reason why an object was not read or written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ObjectAccessError {
    /// The transfer failed.
    #[error(transparent)]
    Transfer(#[from] SdoError),
    /// The object is longer than the maximum.
    #[error("{0} has more than {LONGEST} bytes; `lineshaft can sdo read` takes longer ones")]
    Long(Object),
    /// The drive is under power (enabled, quick stop or fault reaction), and the object is in one of its PDOs.
    #[error("{0} is mapped in a PDO and the drive is under power ({state}); switch the axis off first", state = texts::drive_state(*.1))]
    Power(Object, DriveState),
    /// It is unknown whether the drive is under power.
    #[error("{0} is mapped in a PDO, and whether the drive is under power is not known: {1}")]
    NoState(Object, SdoError),
    /// The bus connection is lost.
    #[error("the way to the bus is lost: {0}")]
    Lost(String),
    /// The queue is full.
    #[error("{MOST_WAITING} requests wait for the bus already; try again")]
    Full,
    /// The bus is closed.
    #[error("the bus is closed")]
    Closed,
}

/// Operation on an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Access {
    /// The object is read.
    Read,
    /// The object is written.
    Write {
        /// Bytes of the value.
        data: Vec<u8>,
        /// Whether the write requires that the drive is not under power.
        without_power: bool,
    },
}

/// Receiver of the bytes that were read; empty after a write.
type Answer = Box<dyn FnOnce(Result<Vec<u8>, ObjectAccessError>) + Send>;

struct Request {
    node: NodeId,
    object: Object,
    access: Access,
    answer: Answer,
    turn: Arc<AtomicU8>,
}

const WAITS: u8 = 0;
const IS_BEGUN: u8 = 1;
const IS_TAKEN_BACK: u8 = 2;

/// Handle of a request in the queue.
#[derive(Debug)]
pub struct RequestHandle(Arc<AtomicU8>);

impl RequestHandle {
    /// Cancels the request. Returns false if it has already been started.
    pub fn cancel(&self) -> bool {
        take_turn(&self.0, IS_TAKEN_BACK)
    }
}

fn take_turn(turn: &AtomicU8, next: u8) -> bool {
    turn.compare_exchange(WAITS, next, Ordering::AcqRel, Ordering::Acquire).is_ok()
}

/// Queue for requests to the nodes of a bus, for use from any thread.
#[derive(Clone)]
pub struct SdoRequestQueue(SyncSender<Request>);

impl fmt::Debug for SdoRequestQueue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Objects")
    }
}

impl SdoRequestQueue {
    /// Queues a read or write of an object; does not block. The service thread calls `answer`. If the service ends, `answer` is dropped.
    ///
    /// # Errors
    /// The queue is full, or the service has ended; `answer` is not called then.
    pub fn submit(
        &self,
        node: NodeId,
        object: Object,
        access: Access,
        answer: impl FnOnce(Result<Vec<u8>, ObjectAccessError>) + Send + 'static,
    ) -> Result<RequestHandle, ObjectAccessError> {
        use std::sync::mpsc::TrySendError;
        let turn = Arc::new(AtomicU8::new(WAITS));
        let request = Request { node, object, access, answer: Box::new(answer), turn: Arc::clone(&turn) };
        self.0.try_send(request).map_err(|error| match error {
            TrySendError::Full(_) => ObjectAccessError::Full,
            TrySendError::Disconnected(_) => ObjectAccessError::Closed,
        })?;
        Ok(RequestHandle(turn))
    }
}

/// Receiving end of the queue, which belongs to the service.
pub(super) struct SdoRequestReceiver(Receiver<Request>);

/// Creates a queue with both ends.
pub(super) fn line() -> (SdoRequestQueue, SdoRequestReceiver) {
    let (send, receive) = sync_channel(MOST_WAITING);
    (SdoRequestQueue(send), SdoRequestReceiver(receive))
}

impl SdoRequestReceiver {
    /// Handles waiting requests for a limited time. `lost`: the reason why the bus connection is lost.
    pub(super) fn serve(&self, port: &mut Port, lost: Option<&str>) {
        let begin = Instant::now();
        while begin.elapsed() < TURN_TIME {
            let Some(Request { node, object, access, answer, .. }) = self.next() else { return };
            answer(match lost {
                Some(why) => Err(ObjectAccessError::Lost(why.to_owned())),
                None => perform(port, node, object, access),
            });
        }
    }

    /// Answers all waiting requests with the error that the bus is closed.
    pub(super) fn reject_all(&self) {
        while let Some(request) = self.next() {
            (request.answer)(Err(ObjectAccessError::Closed));
        }
    }

    /// Returns the next request that was not cancelled.
    fn next(&self) -> Option<Request> {
        std::iter::from_fn(|| self.0.try_recv().ok()).find(|request| take_turn(&request.turn, IS_BEGUN))
    }
}

fn perform(port: &mut Port, node: NodeId, object: Object, access: Access) -> Result<Vec<u8>, ObjectAccessError> {
    match access {
        Access::Read => match port.read_long(node, object, LONGEST) {
            Ok(bytes) if bytes.len() <= LONGEST => Ok(bytes),
            Ok(_) | Err(SdoError::Wrong(_, Abort::MEMORY)) => Err(ObjectAccessError::Long(object)),
            Err(error) => Err(error.into()),
        },
        Access::Write { data, without_power } => {
            if without_power {
                let state = port.read(node, STATUS).map_err(|error| ObjectAccessError::NoState(object, error))?;
                refuse_power(object, &state)?;
            }
            Ok(port.write(node, object, &data).map(|()| Vec::new())?)
        }
    }
}

fn refuse_power(object: Object, status: &[u8]) -> Result<(), ObjectAccessError> {
    let [low, high] = *status else {
        return Err(ObjectAccessError::NoState(object, SdoError::Wrong(STATUS, Abort::LENGTH)));
    };
    match DriveState::from_status(u16::from_le_bytes([low, high])) {
        state @ (DriveState::Enabled | DriveState::QuickStop | DriveState::FaultReaction) => {
            Err(ObjectAccessError::Power(object, state))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
