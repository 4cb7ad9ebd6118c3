//! A bus that is spoken to by hand: one transfer after the other, with all that is heard meanwhile.
//!
//! Law      each call ends: with an answer, or after the time that an answer may take. Who has shown which state is remembered
//! Refuses  objects longer than [`LONGEST`]; what a device refuses or does not answer; a way that is lost
//! Source   CiA 301

use crate::lss::{Identity, LssError};
use crate::sdo::{Abort, Client, Object, SdoError};
use crate::transport::{Transport, TransportError};
use crate::{Frame, Life, NmtCommand, NmtState, NodeId};
use std::collections::BTreeMap;
use std::thread;
use std::time::{Duration, Instant};

/// Bytes of the longest object that is read.
pub const LONGEST: usize = 16 << 20;
/// What the last segment is filled up with.
const FILL: usize = 7;
/// Between two looks at the bus.
const LOOK: Duration = Duration::from_micros(200);
/// How long a queue before the bus may be full.
const FULL: Duration = Duration::from_secs(2);
/// How long what was sent last may need until it is on the bus.
const LEAVE: Duration = Duration::from_millis(30);

/// Why something that was asked for has not been done.
#[derive(Debug, thiserror::Error)]
pub enum CommissionError {
    /// The device refuses, or does not answer.
    #[error("{0}: {1}")]
    Sdo(NodeId, SdoError),
    /// More bytes than are read.
    #[error("{0}: {1} has more than {LONGEST} bytes (16 MiB), which are not read")]
    Long(NodeId, Object),
    /// The bus takes nothing, or is lost.
    #[error("{0}")]
    Way(#[from] TransportError),
    /// A drive whose motor has current.
    #[error("{node} is {state} (6041h is {status:04X}h); switch it off first")]
    Enabled {
        /// Which one.
        node: NodeId,
        /// Its state in words.
        state: &'static str,
        /// Its status word.
        status: u16,
    },
    /// No device of an identity.
    #[error(
        "no device answers to vendor {:08X}h, product {:08X}h, revision {:08X}h, serial {:08X}h", .0[0], .0[1], .0[2], .0[3]
    )]
    Nobody(Identity),
    /// A device in configuration does not do it.
    #[error("{0}")]
    Lss(LssError),
    /// It does not answer.
    #[error("the device has not answered for {0} ms")]
    SilentLss(u64),
    /// A search that has come to nothing.
    #[error(
        "the search lost the device that it had begun with: frames or answers were lost; try again, or with a longer --timeout"
    )]
    LostInSearch,
    /// A configuration for another device.
    #[error("{node} is another device: its {what} is {found:08X}h, the file is for {expected:08X}h")]
    Other {
        /// Which one.
        node: NodeId,
        /// Vendor or product code.
        what: &'static str,
        /// What the device says.
        found: u32,
        /// What the file says.
        expected: u32,
    },
}

impl CommissionError {
    /// Has the device refused, so that it is there?
    pub fn is_refusal(&self) -> bool {
        matches!(self, Self::Sdo(_, SdoError::Refused(..)))
    }
}

/// How far a transfer is: bytes, and of how many where that is known.
pub type Progress<'a> = &'a mut dyn FnMut(usize, Option<usize>);

/// A bus, and how long an answer may take.
pub struct Session {
    transport: Box<dyn Transport>,
    began: Instant,
    timeout: Duration,
    states: BTreeMap<NodeId, NmtState>,
}

impl Session {
    /// Speaks over a way that is open.
    pub fn new(transport: Box<dyn Transport>, timeout: Duration) -> Self {
        Self { transport, began: Instant::now(), timeout, states: BTreeMap::new() }
    }

    /// Since it began.
    pub fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    pub(super) fn now_ns(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    pub(super) fn timeout_ns(&self) -> u64 {
        u64::try_from(self.timeout.as_nanos()).unwrap_or(u64::MAX)
    }

    /// The state that a device has shown last, if any.
    pub fn state(&self, node: NodeId) -> Option<NmtState> {
        self.states.get(&node).copied()
    }

    /// Sends a frame; waits while the bus takes none.
    pub(super) fn send(&mut self, frame: &Frame) -> Result<(), CommissionError> {
        let began = Instant::now();
        loop {
            match self.transport.send(frame) {
                Err(TransportError::Full(_)) if began.elapsed() < FULL => thread::sleep(LOOK),
                done => return Ok(done?),
            }
        }
    }

    /// The next frame, if one has come. What waits to be sent goes on.
    ///
    /// # Errors
    /// The way is lost.
    pub fn receive(&mut self) -> Result<Option<Frame>, CommissionError> {
        self.transport.flush()?;
        let Some(frame) = self.transport.receive()? else { return Ok(None) };
        let of = u8::try_from(frame.id().get() & 0x7F).ok().and_then(NodeId::new);
        if let Some(node) = of.filter(|node| node.heartbeat() == frame.id())
            && let Some(life) = Life::of(&frame)
        {
            self.states.insert(node, life.state);
        }
        Ok(Some(frame))
    }

    /// Hands over each frame that comes, with when (since the session began), until `on` gives false.
    ///
    /// # Errors
    /// The way is lost.
    pub fn listen(&mut self, mut on: impl FnMut(Duration, Option<&Frame>) -> bool) -> Result<(), CommissionError> {
        loop {
            let frame = self.receive()?;
            if !on(self.elapsed(), frame.as_ref()) {
                return Ok(());
            }
            if frame.is_none() {
                thread::sleep(LOOK);
            }
        }
    }

    /// Listens for so long, or until a device has shown a state that `is_wanted`; that one.
    ///
    /// # Errors
    /// The way is lost.
    pub fn hear(
        &mut self,
        node: NodeId,
        time: Duration,
        is_wanted: impl Fn(NmtState) -> bool,
    ) -> Result<Option<NmtState>, CommissionError> {
        let began = Instant::now();
        let mut heard = None;
        self.listen(|_, frame| {
            let of_node = frame.filter(|frame| frame.id() == node.heartbeat());
            heard = of_node.and_then(Life::of).map(|life| life.state).filter(|state| is_wanted(*state));
            heard.is_none() && began.elapsed() < time
        })?;
        Ok(heard)
    }

    /// Tells one device, or all of them, to go into another state. What comes of it is not waited for.
    ///
    /// # Errors
    /// The bus does not take it.
    pub fn nmt(&mut self, command: NmtCommand, node: Option<NodeId>) -> Result<(), CommissionError> {
        // What was shown before does not count any more.
        match node {
            Some(node) => drop(self.states.remove(&node)),
            None => self.states.clear(),
        }
        self.send(&command.frame(node))
    }

    /// Reads an object; in blocks where the device knows them, if that is wanted.
    ///
    /// # Errors
    /// The device refuses or does not answer; the way is lost.
    pub fn read_with(
        &mut self,
        node: NodeId,
        object: Object,
        in_blocks: bool,
        progress: Progress<'_>,
    ) -> Result<Vec<u8>, CommissionError> {
        let room = Vec::with_capacity(LONGEST + FILL);
        // A client of its own has no other transfer under way.
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
    /// Likewise.
    pub fn read(&mut self, node: NodeId, object: Object) -> Result<Vec<u8>, CommissionError> {
        self.read_with(node, object, false, &mut |_, _| {})
    }

    /// Writes an object; a long one in blocks where the device knows them.
    ///
    /// # Errors
    /// Likewise.
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
    /// Likewise.
    pub fn write(&mut self, node: NodeId, object: Object, data: &[u8]) -> Result<(), CommissionError> {
        self.write_with(node, object, data, &mut |_, _| {})
    }

    /// Writes an object for which the device may take longer than for others.
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
                // What ends it on the bus, too.
                while let Some(frame) = client.next_frame() {
                    self.send(&frame)?;
                }
                return done.result.map(|()| done.data).map_err(|error| CommissionError::Sdo(node, error));
            }
            if let Some((bytes, of)) = client.progress() {
                progress(bytes, of);
            }
            if frame.is_none() {
                thread::sleep(LOOK);
            }
        }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // A frame that still waits would be lost with the channel.
        let began = Instant::now();
        while began.elapsed() < LEAVE && self.transport.flush().is_ok() {
            thread::sleep(LOOK);
        }
        self.transport.close();
    }
}

#[cfg(test)]
mod tests;
