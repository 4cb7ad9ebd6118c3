//! Objects that others than the master ask for, beside the cycles.
//!
//! Law      requests stand in one line for each bus, and each is answered once, by the service: its turn, the transfer and nothing else
//!          takes time. Whoever has waited for too long takes a request back, and then it is never begun
//! Refuses  what finds no room in the line; a write that must not meet a drive under power, where the drive says that it is (6041h)
//! Source   CiA 301; CiA 402-2 (states)

use super::port::Port;
use crate::NodeId;
use crate::commission::words;
use crate::sdo::{Abort, Object, SdoError};
use lineshaft_core::drive::DriveState;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

/// Longest object (bytes): a block of 127 segments.
pub const LONGEST: usize = 889;
/// Requests that may wait for one bus.
pub const MOST_WAITING: usize = 16;
/// How much time of each look at the bus they have before drives that wait have their turn; one of them always gets its.
const SHARE: Duration = Duration::from_millis(50);
const STATUS: Object = Object { index: 0x6041, sub: 0 };

/// Why an object was not read or written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Denied {
    /// The device.
    #[error(transparent)]
    Transfer(#[from] SdoError),
    /// More bytes than are taken.
    #[error("{0} has more than {LONGEST} bytes; `lineshaft can sdo read` takes longer ones")]
    Long(Object),
    /// The drive is under power, and the object is in one of its PDOs.
    #[error("{0} is mapped in a PDO and the drive is under power ({state}); switch the axis off first", state = words::drive_state(*.1))]
    Power(Object, DriveState),
    /// Nobody knows whether the drive is under power.
    #[error("{0} is mapped in a PDO, and whether the drive is under power is not known: {1}")]
    NoState(Object, SdoError),
    /// There is no bus.
    #[error("the way to the bus is lost: {0}")]
    Lost(String),
    /// The line is full.
    #[error("{MOST_WAITING} requests wait for the bus already; try again")]
    Full,
    /// The bus is closed.
    #[error("the bus is closed")]
    Closed,
}

/// What is done with an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Access {
    /// It is read.
    Read,
    /// It is written.
    Write {
        /// With these bytes.
        data: Vec<u8>,
        /// Only while the drive is not under power.
        without_power: bool,
    },
}

/// Who gets the bytes that were read; none of a write.
type Answer = Box<dyn FnOnce(Result<Vec<u8>, Denied>) + Send>;

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

/// A request that stands in the line, or did.
#[derive(Debug)]
pub struct Ticket(Arc<AtomicU8>);

impl Ticket {
    /// Takes the request back; false where it is begun already.
    pub fn take_back(&self) -> bool {
        take_turn(&self.0, IS_TAKEN_BACK)
    }
}

fn take_turn(turn: &AtomicU8, next: u8) -> bool {
    turn.compare_exchange(WAITS, next, Ordering::AcqRel, Ordering::Acquire).is_ok()
}

/// Where objects of the nodes of a bus are asked for, from any thread.
#[derive(Clone)]
pub struct Objects(SyncSender<Request>);

impl fmt::Debug for Objects {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Objects")
    }
}

impl Objects {
    /// Has an object read or written once it is its turn; waits for nothing. The answer is given by the thread of the service, or is dropped
    /// where that ends.
    ///
    /// # Errors
    /// The line is full, or nobody serves it any more; nothing is done then.
    pub fn ask(
        &self,
        node: NodeId,
        object: Object,
        access: Access,
        answer: impl FnOnce(Result<Vec<u8>, Denied>) + Send + 'static,
    ) -> Result<Ticket, Denied> {
        use std::sync::mpsc::TrySendError;
        let turn = Arc::new(AtomicU8::new(WAITS));
        let request = Request { node, object, access, answer: Box::new(answer), turn: Arc::clone(&turn) };
        self.0.try_send(request).map_err(|error| match error {
            TrySendError::Full(_) => Denied::Full,
            TrySendError::Disconnected(_) => Denied::Closed,
        })?;
        Ok(Ticket(turn))
    }
}

/// The end of the line that the service has.
pub(super) struct Line(Receiver<Request>);

/// A line, and where one gets into it.
pub(super) fn line() -> (Objects, Line) {
    let (send, receive) = sync_channel(MOST_WAITING);
    (Objects(send), Line(receive))
}

impl Line {
    /// Serves those who have come, for a while. `lost`: why there is no way to the bus.
    pub(super) fn serve(&self, port: &mut Port, lost: Option<&str>) {
        let begin = Instant::now();
        while begin.elapsed() < SHARE {
            let Some(Request { node, object, access, answer, .. }) = self.next() else { return };
            answer(match lost {
                Some(why) => Err(Denied::Lost(why.to_owned())),
                None => perform(port, node, object, access),
            });
        }
    }

    /// Tells all who stand there that the bus is closed.
    pub(super) fn turn_away(&self) {
        while let Some(request) = self.next() {
            (request.answer)(Err(Denied::Closed));
        }
    }

    /// The next one that nobody has taken back.
    fn next(&self) -> Option<Request> {
        std::iter::from_fn(|| self.0.try_recv().ok()).find(|request| take_turn(&request.turn, IS_BEGUN))
    }
}

fn perform(port: &mut Port, node: NodeId, object: Object, access: Access) -> Result<Vec<u8>, Denied> {
    match access {
        Access::Read => match port.read_long(node, object, LONGEST) {
            Ok(bytes) if bytes.len() <= LONGEST => Ok(bytes),
            Ok(_) | Err(SdoError::Wrong(_, Abort::MEMORY)) => Err(Denied::Long(object)),
            Err(error) => Err(error.into()),
        },
        Access::Write { data, without_power } => {
            if without_power {
                let state = port.read(node, STATUS).map_err(|error| Denied::NoState(object, error))?;
                refuse_power(object, &state)?;
            }
            Ok(port.write(node, object, &data).map(|()| Vec::new())?)
        }
    }
}

fn refuse_power(object: Object, status: &[u8]) -> Result<(), Denied> {
    let [low, high] = *status else { return Err(Denied::NoState(object, SdoError::Wrong(STATUS, Abort::LENGTH))) };
    match DriveState::from_status(u16::from_le_bytes([low, high])) {
        state @ (DriveState::Enabled | DriveState::QuickStop | DriveState::FaultReaction) => {
            Err(Denied::Power(object, state))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
