//! Session for manual access to a bus: one transfer after another, with reception of all other frames.
//!
//! Law      each call ends with an answer, or after the time that an answer may take. The last reported NMT state of each node is stored
//! Refuses  objects longer than [`LONGEST`]; requests that a device refuses or does not answer; a lost bus connection
//! Source   CiA 301

use crate::lss::{Identity, LssError};
use crate::sdo::Client;
use crate::transport::{Transport, TransportError};
use crate::{Frame, NmtCommand, NmtState, NodeId, SignOfLife};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::{Abort, SdoError};
use std::collections::BTreeMap;
use std::thread;
use std::time::{Duration, Instant};

/// Maximum size of an object that is read, in bytes.
pub const LONGEST: usize = 16 << 20;
/// Bytes of a segment, by which the last one may exceed the object.
const FILL: usize = 7;
/// Time between two polls of the bus.
const POLL_PERIOD: Duration = Duration::from_micros(200);
/// Longest time for which the send queue may be full.
const FULL_TIMEOUT: Duration = Duration::from_secs(2);
/// Time that the last frame may need until it is on the bus.
const DRAIN_TIME: Duration = Duration::from_millis(30);

/// Reason why a request failed.
#[derive(Debug, thiserror::Error)]
pub enum CommissionError {
    /// The device refuses, or does not answer.
    #[error("{0}: {1}")]
    Sdo(NodeId, SdoError),
    /// The object is longer than [`LONGEST`].
    #[error("{0}: {1} has more than {LONGEST} bytes (16 MiB), which are not read")]
    Long(NodeId, Object),
    /// The bus accepts no frames, or the connection to it is lost.
    #[error("{0}")]
    Way(#[from] TransportError),
    /// The drive is enabled.
    #[error("{node} is {state} (6041h is {status:04X}h); switch it off first")]
    Enabled {
        /// Node of the drive.
        node: NodeId,
        /// State of the drive, as text.
        state: &'static str,
        /// Status word.
        status: u16,
    },
    /// No device has the identity.
    #[error(
        "no device answers to vendor {:08X}h, product {:08X}h, revision {:08X}h, serial {:08X}h", .0[0], .0[1], .0[2], .0[3]
    )]
    Nobody(Identity),
    /// A device in LSS configuration state refuses the command.
    #[error("{0}")]
    Lss(LssError),
    /// A device in LSS configuration state does not answer; timeout in ms.
    #[error("the device has not answered for {0} ms")]
    SilentLss(u64),
    /// The search has lost the device.
    #[error(
        "the search lost the device that it had begun with: frames or answers were lost; try again, or with a longer --timeout"
    )]
    LostInSearch,
    /// The configuration is for another device.
    #[error("{node} is another device: its {what} is {found:08X}h, the file is for {expected:08X}h")]
    Other {
        /// Node of the device.
        node: NodeId,
        /// Name of the value: vendor or product code.
        what: &'static str,
        /// Value of the device.
        found: u32,
        /// Value of the file.
        expected: u32,
    },
}

impl CommissionError {
    /// Returns true if the device has refused, which means that it is present.
    pub fn is_refusal(&self) -> bool {
        matches!(self, Self::Sdo(_, SdoError::Refused(..)))
    }
}

/// Progress of a transfer: number of transferred bytes, and total number if it is known.
pub type Progress<'a> = &'a mut dyn FnMut(usize, Option<usize>);

/// Bus with the timeout for an answer.
pub struct Session {
    transport: Box<dyn Transport>,
    began: Instant,
    timeout: Duration,
    states: BTreeMap<NodeId, NmtState>,
}

impl Session {
    /// Creates a session on an open transport.
    pub fn new(transport: Box<dyn Transport>, timeout: Duration) -> Self {
        Self { transport, began: Instant::now(), timeout, states: BTreeMap::new() }
    }

    /// Returns the time since the session began.
    pub fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    pub(super) fn now_ns(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    pub(super) fn timeout_ns(&self) -> u64 {
        u64::try_from(self.timeout.as_nanos()).unwrap_or(u64::MAX)
    }

    /// Returns the last NMT state that a device has reported, if any.
    pub fn state(&self, node: NodeId) -> Option<NmtState> {
        self.states.get(&node).copied()
    }

    /// Sends a frame. Waits while the send queue is full.
    pub(super) fn send(&mut self, frame: &Frame) -> Result<(), CommissionError> {
        let began = Instant::now();
        loop {
            match self.transport.send(frame) {
                Err(TransportError::Full(_)) if began.elapsed() < FULL_TIMEOUT => thread::sleep(POLL_PERIOD),
                done => return Ok(done?),
            }
        }
    }

    /// Returns the next received frame, if there is one. Sends queued frames as well.
    ///
    /// # Errors
    /// The bus connection is lost.
    pub fn receive(&mut self) -> Result<Option<Frame>, CommissionError> {
        self.transport.flush()?;
        let Some(frame) = self.transport.receive()? else { return Ok(None) };
        let of = u8::try_from(frame.id().get() & 0x7F).ok().and_then(NodeId::new);
        if let Some(node) = of.filter(|node| node.heartbeat() == frame.id())
            && let Some(life) = SignOfLife::of(&frame)
        {
            self.states.insert(node, life.state);
        }
        Ok(Some(frame))
    }

    /// Passes each received frame to `on`, with the time since the session began, until `on` returns false.
    ///
    /// # Errors
    /// The bus connection is lost.
    pub fn listen(&mut self, mut on: impl FnMut(Duration, Option<&Frame>) -> bool) -> Result<(), CommissionError> {
        loop {
            let frame = self.receive()?;
            if !on(self.elapsed(), frame.as_ref()) {
                return Ok(());
            }
            if frame.is_none() {
                thread::sleep(POLL_PERIOD);
            }
        }
    }

    /// Listens for the given time, or until a device reports a state for which `is_wanted` returns true. Returns this state.
    ///
    /// # Errors
    /// The bus connection is lost.
    pub fn wait_for_state(
        &mut self,
        node: NodeId,
        time: Duration,
        is_wanted: impl Fn(NmtState) -> bool,
    ) -> Result<Option<NmtState>, CommissionError> {
        let began = Instant::now();
        let mut heard = None;
        self.listen(|_, frame| {
            let of_node = frame.filter(|frame| frame.id() == node.heartbeat());
            heard = of_node.and_then(SignOfLife::of).map(|life| life.state).filter(|state| is_wanted(*state));
            heard.is_none() && began.elapsed() < time
        })?;
        Ok(heard)
    }

    /// Sends an NMT command to one node or to all. Does not wait for its effect.
    ///
    /// # Errors
    /// The bus does not accept the frame.
    pub fn nmt(&mut self, command: NmtCommand, node: Option<NodeId>) -> Result<(), CommissionError> {
        // States that were reported before the command no longer apply.
        match node {
            Some(node) => drop(self.states.remove(&node)),
            None => self.states.clear(),
        }
        self.send(&command.frame(node))
    }

    /// Reads an object, on request by block transfer if the device supports it.
    ///
    /// # Errors
    /// The device refuses or does not answer; the bus connection is lost.
    pub fn read_with(
        &mut self,
        node: NodeId,
        object: Object,
        in_blocks: bool,
        progress: Progress<'_>,
    ) -> Result<Vec<u8>, CommissionError> {
        let room = Vec::with_capacity(LONGEST + FILL);
        // A new client has no other transfer in progress.
        let begin = |client: &mut Client, now_ns| drop(client.upload(object, room, in_blocks, now_ns));
        match self.transfer(node, self.timeout_ns(), begin, progress) {
            Err(CommissionError::Sdo(node, SdoError::Wrong(object, Abort::MEMORY))) => {
                Err(CommissionError::Long(node, object))
            }
            done => done,
        }
    }

    /// Reads an object of a few bytes.
    ///
    /// # Errors
    /// As for [`read_with`](Self::read_with).
    pub fn read(&mut self, node: NodeId, object: Object) -> Result<Vec<u8>, CommissionError> {
        self.read_with(node, object, false, &mut |_, _| {})
    }

    /// Writes an object. Uses block transfer for a long object if the device supports it.
    ///
    /// # Errors
    /// As for [`read_with`](Self::read_with).
    pub fn write_with(
        &mut self,
        node: NodeId,
        object: Object,
        data: &[u8],
        progress: Progress<'_>,
    ) -> Result<(), CommissionError> {
        let begin = |client: &mut Client, now_ns| drop(client.download(object, data.to_vec(), true, now_ns));
        self.transfer(node, self.timeout_ns(), begin, progress).map(drop)
    }

    /// Writes an object of a few bytes.
    ///
    /// # Errors
    /// As for [`read_with`](Self::read_with).
    pub fn write(&mut self, node: NodeId, object: Object, data: &[u8]) -> Result<(), CommissionError> {
        self.write_with(node, object, data, &mut |_, _| {})
    }

    /// Writes an object with a longer timeout than other objects.
    pub(super) fn write_within(
        &mut self,
        node: NodeId,
        object: Object,
        data: &[u8],
        time: Duration,
    ) -> Result<(), CommissionError> {
        let time_ns = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX).max(self.timeout_ns());
        let begin = |client: &mut Client, now_ns| drop(client.download(object, data.to_vec(), true, now_ns));
        self.transfer(node, time_ns, begin, &mut |_, _| {}).map(drop)
    }

    fn transfer(
        &mut self,
        node: NodeId,
        timeout_ns: u64,
        begin: impl FnOnce(&mut Client, u64),
        progress: Progress<'_>,
    ) -> Result<Vec<u8>, CommissionError> {
        let mut client = Client::new(node.sdo_request(), node.sdo_response(), timeout_ns);
        begin(&mut client, self.now_ns());
        loop {
            while let Some(frame) = client.next_frame() {
                self.send(&frame)?;
            }
            let frame = self.receive()?;
            let now_ns = self.now_ns();
            let done = frame.as_ref().and_then(|frame| client.receive(frame, now_ns));
            if let Some(done) = done.or_else(|| client.tick(now_ns)) {
                // The frames that end the transfer on the bus.
                while let Some(frame) = client.next_frame() {
                    self.send(&frame)?;
                }
                return done.result.map(|()| done.data).map_err(|error| CommissionError::Sdo(node, error));
            }
            if let Some((bytes, of)) = client.progress() {
                progress(bytes, of);
            }
            if frame.is_none() {
                thread::sleep(POLL_PERIOD);
            }
        }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // A queued frame would be lost when the transport is closed.
        let began = Instant::now();
        while began.elapsed() < DRAIN_TIME && self.transport.flush().is_ok() {
            thread::sleep(POLL_PERIOD);
        }
        self.transport.close();
    }
}

#[cfg(test)]
mod tests;
