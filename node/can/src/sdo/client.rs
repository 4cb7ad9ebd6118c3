//! SDO client of one device.

use super::crc::crc;
use crate::{Frame, Id};
use lineshaft_cia402::object::Object;
use lineshaft_cia402::sdo::{Abort, SdoError, Transfer};

/// Bytes of a segment.
const SEGMENT: usize = 7;
/// Segments per block that this client requests.
const BLOCK: u8 = 127;
/// Size from which a download uses block transfer if it is allowed, in bytes.
const LEAST_FOR_BLOCKS: usize = 32;
/// Maximum number of acknowledgements of a block without progress.
const MOST_REPEATS: u8 = 8;

/// Next step of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    /// First frame of a segmented or expedited download.
    Download,
    /// Segment of a download, starting at byte `at`.
    Segment {
        at: usize,
        toggle: bool,
    },
    /// First frame of a block download.
    BlockDownload,
    /// Segments of a block that starts at byte `start`; `next` counts from 0, up to `size`.
    Block {
        start: usize,
        next: u8,
        size: u8,
    },
    /// End of a block download.
    BlockEnd,
    /// First frame of an upload.
    Upload,
    /// Next segment of an upload.
    Fetch {
        toggle: bool,
    },
    /// First frame of a block upload.
    BlockUpload,
    /// Reception of the segments of a block: `next` counts from 1. `is_last`: the last segment of the transfer was received.
    Receive {
        next: u8,
        is_last: bool,
    },
    /// All segments are acknowledged; the end of the transfer follows.
    ReceiveEnd,
}

/// Transfer in progress.
#[derive(Clone, Debug)]
struct TransferState {
    object: Object,
    data: Vec<u8>,
    /// Size that the device has announced.
    announced_size: Option<usize>,
    /// Whether both sides calculate the checksum.
    uses_crc: bool,
    /// Consecutive acknowledgements of a block without progress.
    repeats: u8,
    /// Time of the last request to or answer of the device, in ns.
    since_ns: u64,
}

/// Client of the SDO server of one device.
#[derive(Clone, Debug)]
pub struct Client {
    request: Id,
    response: Id,
    timeout_ns: u64,
    state: State,
    /// Whether a frame of the present state is to be sent.
    sends: bool,
    /// Frame that ends a transfer; it is sent first.
    last: Option<Frame>,
    work: Option<TransferState>,
    /// Number of unexpected answers.
    strays: u32,
}

impl Client {
    /// Creates a client with the identifiers of requests and responses, and the timeout for each answer, in ns.
    pub fn new(request: Id, response: Id, timeout_ns: u64) -> Self {
        Self { request, response, timeout_ns, state: State::Idle, sends: false, last: None, work: None, strays: 0 }
    }

    /// Returns the number of unexpected answers: late ones, or those of a second device with the same node ID.
    pub fn strays(&self) -> u32 {
        self.strays
    }

    /// Returns true if no transfer is in progress.
    pub fn is_idle(&self) -> bool {
        self.work.is_none()
    }

    /// Returns the number of transferred bytes, and the total number if it is known.
    pub fn progress(&self) -> Option<(usize, Option<usize>)> {
        let TransferState { data, announced_size: told, .. } = self.work.as_ref()?;
        let (most, sent) = (data.len(), |at: usize| (at.min(data.len()), Some(data.len())));
        Some(match self.state {
            State::Download | State::BlockDownload => sent(0),
            State::Segment { at, .. } => sent(at),
            State::Block { start, next, .. } => sent(start.saturating_add(usize::from(next) * SEGMENT)),
            State::BlockEnd => sent(most),
            _ => (most, *told),
        })
    }

    /// Starts to read an object into the buffer `room`. Its capacity must exceed the object by 7 bytes, for the padding of the last
    /// segment.
    ///
    /// # Errors
    /// Returns the buffer if a transfer is in progress.
    pub fn upload(&mut self, object: Object, mut room: Vec<u8>, in_blocks: bool, now_ns: u64) -> Result<(), Vec<u8>> {
        room.clear();
        self.begin(object, room, if in_blocks { State::BlockUpload } else { State::Upload }, now_ns)
    }

    /// Starts to write an object; a long one by block transfer if it is allowed.
    ///
    /// # Errors
    /// Returns the data if a transfer is in progress.
    pub fn download(&mut self, object: Object, data: Vec<u8>, in_blocks: bool, now_ns: u64) -> Result<(), Vec<u8>> {
        let blocks = in_blocks && data.len() >= LEAST_FOR_BLOCKS;
        self.begin(object, data, if blocks { State::BlockDownload } else { State::Download }, now_ns)
    }

    fn begin(&mut self, object: Object, data: Vec<u8>, state: State, now_ns: u64) -> Result<(), Vec<u8>> {
        if self.work.is_some() {
            return Err(data);
        }
        self.work =
            Some(TransferState { object, data, announced_size: None, uses_crc: false, repeats: 0, since_ns: now_ns });
        (self.state, self.sends) = (state, true);
        Ok(())
    }

    /// Returns the next frame to be sent, if any. A block has up to 127 frames.
    pub fn next_frame(&mut self) -> Option<Frame> {
        if let Some(last) = self.last.take() {
            return Some(last);
        }
        if !self.sends {
            return None;
        }
        self.sends = false;
        let work = self.work.as_ref()?;
        let [low, high, sub] = work.object.mux();
        let size = u32::try_from(work.data.len()).unwrap_or(u32::MAX).to_le_bytes();
        let [s0, s1, s2, s3] = size;
        let bytes = match self.state {
            State::Idle | State::ReceiveEnd => return None,
            State::Download => match *work.data.as_slice() {
                [a] => [0x2F, low, high, sub, a, 0, 0, 0],
                [a, b] => [0x2B, low, high, sub, a, b, 0, 0],
                [a, b, c] => [0x27, low, high, sub, a, b, c, 0],
                [a, b, c, d] => [0x23, low, high, sub, a, b, c, d],
                _ => [0x21, low, high, sub, s0, s1, s2, s3],
            },
            State::Segment { at, toggle } => {
                let (bytes, unused) = segment(&work.data, at);
                let is_last = at.saturating_add(SEGMENT) >= work.data.len();
                with_command(u8::from(toggle) << 4 | unused << 1 | u8::from(is_last), bytes)
            }
            State::BlockDownload => [0xC6, low, high, sub, s0, s1, s2, s3],
            State::Block { start, next, size } => {
                let at = start.saturating_add(usize::from(next) * SEGMENT);
                let (bytes, _) = segment(&work.data, at);
                let is_last = at.saturating_add(SEGMENT) >= work.data.len();
                let next = next.saturating_add(1);
                self.state = State::Block { start, next, size };
                self.sends = !is_last && next < size;
                with_command(u8::from(is_last) << 7 | next, bytes)
            }
            State::BlockEnd => {
                let unused = (SEGMENT - work.data.len() % SEGMENT) % SEGMENT;
                let [c0, c1] = if work.uses_crc { crc(0, &work.data) } else { 0 }.to_le_bytes();
                [0xC1 | (unused as u8) << 2, c0, c1, 0, 0, 0, 0, 0]
            }
            State::Upload => [0x40, low, high, sub, 0, 0, 0, 0],
            State::Fetch { toggle } => [0x60 | u8::from(toggle) << 4, 0, 0, 0, 0, 0, 0, 0],
            State::BlockUpload => [0xA4, low, high, sub, BLOCK, 0, 0, 0],
            // Requests the first block.
            State::Receive { .. } => [0xA3, 0, 0, 0, 0, 0, 0, 0],
        };
        Some(Frame::of(self.request, bytes))
    }

    /// Handles a frame of the device. Returns the result if the transfer has ended.
    pub fn receive(&mut self, frame: &Frame, now_ns: u64) -> Option<Transfer> {
        let bytes: [u8; 8] = frame.bytes().try_into().ok().filter(|_| frame.id() == self.response)?;
        let Some(work) = &mut self.work else {
            self.strays = self.strays.saturating_add(1);
            return None;
        };
        let is_of_object = bytes[1..4] == work.object.mux();
        let is_first =
            matches!(self.state, State::Download | State::BlockDownload | State::Upload | State::BlockUpload);
        // 80h is an abort, because no segment of a block has number 0.
        if bytes[0] == 0x80 {
            let [.., a, b, c, d] = bytes;
            return self.refused(Abort(u32::from_le_bytes([a, b, c, d])), is_of_object);
        }
        // Late answer to an earlier transfer that was abandoned.
        if is_first && !is_of_object {
            self.strays = self.strays.saturating_add(1);
            return None;
        }
        work.since_ns = now_ns;
        match self.take(bytes) {
            Ok(true) => self.end(Ok(())),
            Ok(false) => None,
            Err(abort) => self.give_up(abort),
        }
    }

    /// Handles the timeout. Returns the result if the transfer has ended.
    pub fn tick(&mut self, now_ns: u64) -> Option<Transfer> {
        let work = self.work.as_ref()?;
        if now_ns.saturating_sub(work.since_ns) < self.timeout_ns {
            return None;
        }
        let error = SdoError::Silent(work.object, self.timeout_ns / 1_000_000);
        self.last = Some(self.abort_frame(work.object, Abort::TIMEOUT));
        self.end(Err(error))
    }

    /// Handles an answer. Returns true if the transfer is complete.
    fn take(&mut self, bytes: [u8; 8]) -> Result<bool, Abort> {
        let Some(work) = &mut self.work else { return Ok(false) };
        let [command, _, _, _, a, b, c, d] = bytes;
        let size = u32::from_le_bytes([a, b, c, d]) as usize;
        match self.state {
            State::Idle => {}
            State::Download => {
                if command != 0x60 {
                    return Err(Abort::COMMAND);
                }
                if (1..=4).contains(&work.data.len()) {
                    return Ok(true);
                }
                (self.state, self.sends) = (State::Segment { at: 0, toggle: false }, true);
            }
            State::Segment { at, toggle } => {
                if command & 0xEF != 0x20 {
                    return Err(Abort::COMMAND);
                }
                if (command & 0x10 != 0) != toggle {
                    return Err(Abort::TOGGLE);
                }
                let at = at.saturating_add(SEGMENT);
                if at >= work.data.len() {
                    return Ok(true);
                }
                (self.state, self.sends) = (State::Segment { at, toggle: !toggle }, true);
            }
            State::BlockDownload => {
                if command & 0xFB != 0xA0 {
                    return Err(Abort::COMMAND);
                }
                work.uses_crc = command & 4 != 0;
                self.begin_block(0, a)?;
            }
            State::Block { start, next, .. } => {
                let [command, acknowledged, size, ..] = bytes;
                if command != 0xA2 {
                    return Err(Abort::COMMAND);
                }
                if acknowledged > next {
                    return Err(Abort::SEQUENCE);
                }
                let start = start.saturating_add(usize::from(acknowledged) * SEGMENT);
                work.repeats = if acknowledged == 0 { work.repeats.saturating_add(1) } else { 0 };
                if work.repeats > MOST_REPEATS {
                    return Err(Abort::SEQUENCE);
                }
                if start >= work.data.len() {
                    (self.state, self.sends) = (State::BlockEnd, true);
                } else {
                    self.begin_block(start, size)?;
                }
            }
            State::BlockEnd => return if command == 0xA1 { Ok(true) } else { Err(Abort::COMMAND) },
            // A server without block transfer answers as to a segmented upload.
            State::BlockUpload if command & 0xF9 == 0xC0 => {
                work.uses_crc = command & 4 != 0;
                work.announce_size((command & 2 != 0).then_some(size))?;
                (self.state, self.sends) = (State::Receive { next: 1, is_last: false }, true);
            }
            State::Upload | State::BlockUpload => match command {
                0x43 | 0x47 | 0x4B | 0x4F | 0x42 => {
                    let unused = if command & 1 == 1 { usize::from(command >> 2 & 3) } else { 0 };
                    append(&mut work.data, &[a, b, c, d][..4 - unused])?;
                    return Ok(true);
                }
                0x40 | 0x41 => {
                    work.announce_size((command == 0x41).then_some(size))?;
                    (self.state, self.sends) = (State::Fetch { toggle: false }, true);
                }
                _ => return Err(Abort::COMMAND),
            },
            State::Fetch { toggle } => {
                if command & 0xE0 != 0 {
                    return Err(Abort::COMMAND);
                }
                if (command & 0x10 != 0) != toggle {
                    return Err(Abort::TOGGLE);
                }
                let unused = usize::from(command >> 1 & 7);
                let [_, segment @ ..] = bytes;
                append(&mut work.data, &segment[..SEGMENT - unused])?;
                if command & 1 == 1 {
                    return work.is_complete();
                }
                (self.state, self.sends) = (State::Fetch { toggle: !toggle }, true);
            }
            State::Receive { .. } => self.take_segment(bytes)?,
            State::ReceiveEnd => {
                let [command, c0, c1, ..] = bytes;
                if command & 0xE3 != 0xC1 {
                    return Err(Abort::COMMAND);
                }
                let unused = usize::from(command >> 2 & 7);
                work.data.truncate(work.data.len().saturating_sub(unused));
                if work.uses_crc && crc(0, &work.data) != u16::from_le_bytes([c0, c1]) {
                    return Err(Abort::CRC);
                }
                work.is_complete()?;
                self.last = Some(Frame::of(self.request, [0xA1, 0, 0, 0, 0, 0, 0, 0]));
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn begin_block(&mut self, start: usize, size: u8) -> Result<(), Abort> {
        if !(1..=BLOCK).contains(&size) {
            return Err(Abort::BLOCK_SIZE);
        }
        (self.state, self.sends) = (State::Block { start, next: 0, size }, true);
        Ok(())
    }

    /// Handles a received segment of a block. A segment out of sequence is dropped and sent again.
    fn take_segment(&mut self, bytes: [u8; 8]) -> Result<(), Abort> {
        let State::Receive { mut next, mut is_last } = self.state else { return Ok(()) };
        let Some(work) = &mut self.work else { return Ok(()) };
        let [lead, segment @ ..] = bytes;
        let (sequence, ends) = (lead & 0x7F, lead & 0x80 != 0);
        if !(1..=BLOCK).contains(&sequence) {
            return Err(Abort::SEQUENCE);
        }
        if sequence == next && !is_last {
            append(&mut work.data, &segment)?;
            (next, is_last) = (next.saturating_add(1), ends);
        }
        self.state = State::Receive { next, is_last };
        if !ends && sequence != BLOCK {
            return Ok(());
        }
        let acknowledged = next - 1;
        work.repeats = if acknowledged == 0 { work.repeats.saturating_add(1) } else { 0 };
        if work.repeats > MOST_REPEATS {
            return Err(Abort::SEQUENCE);
        }
        self.last = Some(Frame::of(self.request, [0xA2, acknowledged, BLOCK, 0, 0, 0, 0, 0]));
        self.state = if is_last { State::ReceiveEnd } else { State::Receive { next: 1, is_last } };
        Ok(())
    }

    /// Handles an abort of the device. If the device does not support block transfer, the segmented transfer is used.
    fn refused(&mut self, abort: Abort, is_of_object: bool) -> Option<Transfer> {
        let knows_no_blocks = abort == Abort::COMMAND && is_of_object;
        match self.state {
            State::BlockDownload if knows_no_blocks => (self.state, self.sends) = (State::Download, true),
            State::BlockUpload if knows_no_blocks => (self.state, self.sends) = (State::Upload, true),
            // Late answer to another transfer.
            State::Download | State::BlockDownload | State::Upload | State::BlockUpload if !is_of_object => {}
            _ => {
                let object = self.work.as_ref()?.object;
                return self.end(Err(SdoError::Refused(object, abort)));
            }
        }
        None
    }

    fn give_up(&mut self, abort: Abort) -> Option<Transfer> {
        let object = self.work.as_ref()?.object;
        self.last = Some(self.abort_frame(object, abort));
        self.end(Err(SdoError::Wrong(object, abort)))
    }

    fn abort_frame(&self, object: Object, abort: Abort) -> Frame {
        let ([low, high, sub], [a, b, c, d]) = (object.mux(), abort.0.to_le_bytes());
        Frame::of(self.request, [0x80, low, high, sub, a, b, c, d])
    }

    fn end(&mut self, result: Result<(), SdoError>) -> Option<Transfer> {
        let TransferState { object, data, .. } = self.work.take()?;
        (self.state, self.sends) = (State::Idle, false);
        Some(Transfer { object, data, result })
    }
}

impl TransferState {
    /// Stores the number of bytes that the device has announced, if any.
    fn announce_size(&mut self, told: Option<usize>) -> Result<(), Abort> {
        self.announced_size = told;
        if told.is_some_and(|told| told > self.data.capacity()) { Err(Abort::MEMORY) } else { Ok(()) }
    }

    /// Checks that the announced number of bytes was received.
    fn is_complete(&self) -> Result<bool, Abort> {
        if self.announced_size.is_none_or(|told| told == self.data.len()) { Ok(true) } else { Err(Abort::LENGTH) }
    }
}

/// Appends without allocation; bytes beyond the capacity are an error.
fn append(data: &mut Vec<u8>, bytes: &[u8]) -> Result<(), Abort> {
    if data.capacity() - data.len() < bytes.len() {
        return Err(Abort::MEMORY);
    }
    data.extend_from_slice(bytes);
    Ok(())
}

/// Returns the bytes of a segment from `at`, and the number of unused ones.
fn segment(data: &[u8], at: usize) -> ([u8; SEGMENT], u8) {
    let rest = data.get(at..).unwrap_or_default();
    let mut bytes = [0; SEGMENT];
    for (place, byte) in bytes.iter_mut().zip(rest) {
        *place = *byte;
    }
    (bytes, SEGMENT.saturating_sub(rest.len()) as u8)
}

fn with_command(lead: u8, [a, b, c, d, e, f, g]: [u8; SEGMENT]) -> [u8; 8] {
    [lead, a, b, c, d, e, f, g]
}

#[cfg(test)]
mod tests;
