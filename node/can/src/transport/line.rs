//! slcan over a non-blocking byte stream: serial line, pseudo terminal or TCP.

use super::piece::Piece;
use super::slcan::{AdapterMessage, BEL, CLOSE, CR, Decoder, Line, OPEN};
use super::waiting::SendQueue;
use super::way::{Loss, TransportState};
use super::{Transport, TransportError};
use crate::Frame;
use lineshaft_core::drive::BusState;
use std::io::{self, ErrorKind, Read, Write};
use std::thread;
use std::time::{Duration, Instant};

/// Time of silence after which the previous output of the adapter counts as finished.
const SILENCE: Duration = Duration::from_millis(250);
/// Longest time to wait for silence after the close command, in case the adapter never becomes silent.
const SILENCE_TIMEOUT: Duration = Duration::from_secs(2);
/// Time for the answer to a command. Some adapters send no answer.
const ANSWER_TIMEOUT: Duration = Duration::from_millis(100);

/// Reason why the channel of an adapter could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum SlcanError {
    /// The adapter answers the bit rate command with BEL.
    #[error("the adapter refuses the bit rate")]
    BitRate,
    /// The adapter answers the open command with BEL.
    #[error("the adapter refuses to open its channel")]
    Channel,
    /// The stream does not accept the few bytes at once, or is lost.
    #[error("the adapter cannot be spoken to: {0}")]
    Stream(#[from] io::Error),
}

/// slcan adapter at the remote end of a stream.
#[derive(Debug)]
pub struct SlcanLine<S> {
    stream: S,
    way: TransportState,
    decoder: Decoder,
    /// Queued lines, and the number of sent bytes of the first one.
    waiting: SendQueue<Line>,
    gone: usize,
    piece: Piece,
    refused: u64,
}

impl<S: Read + Write> SlcanLine<S> {
    /// Creates the transport for an adapter whose channel is open, or will be opened with [`open`](Self::open).
    pub fn new(stream: S) -> Self {
        Self {
            stream,
            way: TransportState::default(),
            decoder: Decoder::default(),
            waiting: SendQueue::new(),
            gone: 0,
            piece: Piece::new(),
            refused: 0,
        }
    }

    /// Sets the bit rate and opens the channel. An empty line first ends a partial command that a previous user may have left. The answers
    /// take about half a second.
    ///
    /// # Errors
    /// The adapter refuses a command; the stream does not accept the few bytes at once, or is lost.
    pub fn open(&mut self, bit_rate: &[u8]) -> Result<(), SlcanError> {
        self.send_command(b"\r")?;
        // An adapter whose channel is already closed refuses this; the refusal does not affect the next commands.
        self.send_command(CLOSE)?;
        let began = Instant::now();
        while began.elapsed() < SILENCE_TIMEOUT && self.read_byte(SILENCE)?.is_some() {}
        if self.is_refused(bit_rate)? {
            return Err(SlcanError::BitRate);
        }
        if self.is_refused(OPEN)? {
            return Err(SlcanError::Channel);
        }
        Ok(())
    }

    fn send_command(&mut self, command: &[u8]) -> io::Result<()> {
        self.stream.write_all(command)?;
        self.stream.flush()
    }

    /// Returns true if the answer is BEL; an empty line or no answer means success.
    fn is_refused(&mut self, command: &[u8]) -> io::Result<bool> {
        self.send_command(command)?;
        loop {
            match self.read_byte(ANSWER_TIMEOUT)? {
                Some(BEL) => return Ok(true),
                Some(CR) | None => return Ok(false),
                Some(_) => {}
            }
        }
    }

    /// Returns the next byte if one arrives within `time`.
    fn read_byte(&mut self, time: Duration) -> io::Result<Option<u8>> {
        let began = Instant::now();
        let mut byte = [0];
        loop {
            match self.stream.read(&mut byte) {
                Ok(0) => return Err(io::Error::other(Loss::Ended)),
                Ok(_) => return Ok(Some(byte[0])),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
                Err(error) => return Err(error),
            }
            if began.elapsed() >= time {
                return Ok(None);
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Decodes the bytes of the present piece up to the end of a frame.
    fn next_frame(&mut self) -> Option<Frame> {
        while let Some(byte) = self.piece.next() {
            match self.decoder.take(byte) {
                Some(AdapterMessage::Frame(frame)) => return Some(frame),
                Some(AdapterMessage::Refused) => self.refused = self.refused.saturating_add(1),
                None => {}
            }
        }
        None
    }
}

impl<S: Read + Write + Send> Transport for SlcanLine<S> {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        self.flush()?;
        self.waiting.push(Line::of(frame))?;
        self.flush()
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        self.way.check()?;
        while let Some(line) = self.waiting.first() {
            let rest = line.bytes().get(self.gone..).unwrap_or_default();
            match self.way.unless_would_block(self.stream.write(rest))? {
                Some(0) => return Err(self.way.mark_lost(Loss::Ended)),
                Some(count) if count < rest.len() => self.gone += count,
                Some(_) => {
                    self.waiting.drop_first();
                    self.gone = 0;
                }
                None => break,
            }
        }
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<Frame>, TransportError> {
        loop {
            if let Some(frame) = self.next_frame() {
                return Ok(Some(frame));
            }
            self.way.check()?;
            if !self.piece.read(&mut self.stream, &mut self.way)? {
                return Ok(None);
            }
        }
    }

    fn state(&self) -> BusState {
        self.way.state(BusState::Active)
    }

    fn faults(&self) -> u64 {
        self.refused
    }

    fn close(&mut self) {
        // A partly sent frame is ended with CR, so that the adapter ignores it.
        let command: &[u8] = if self.gone > 0 { b"\rC\r" } else { CLOSE };
        // The error of an adapter that was removed cannot be handled.
        let _ = self.send_command(command);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Id;
    use std::collections::VecDeque;

    /// A stream that accepts and returns a few bytes at a time.
    #[derive(Debug, Default)]
    struct Wire {
        /// Bytes that it accepts before it returns WouldBlock; `None`: no limit.
        takes: Option<usize>,
        sent: Vec<u8>,
        comes: VecDeque<Vec<u8>>,
        has_ended: bool,
    }

    impl Write for Wire {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let count = self.takes.unwrap_or(bytes.len()).min(bytes.len());
            if count == 0 {
                return Err(ErrorKind::WouldBlock.into());
            }
            self.takes = self.takes.map(|takes| takes - count);
            self.sent.extend_from_slice(&bytes[..count]);
            Ok(count)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Read for Wire {
        fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
            match self.comes.pop_front() {
                Some(bytes) => {
                    room[..bytes.len()].copy_from_slice(&bytes);
                    Ok(bytes.len())
                }
                None if self.has_ended => Ok(0),
                None => Err(ErrorKind::WouldBlock.into()),
            }
        }
    }

    fn frame(id: u16, bytes: &[u8]) -> Frame {
        Frame::data(Id::new(id).unwrap(), bytes).unwrap()
    }

    #[test]
    fn queued_lines_are_sent_later_in_order() {
        let mut line = SlcanLine::new(Wire { takes: Some(7), ..Wire::default() });
        line.send(&frame(0x201, &[1])).unwrap();
        line.send(&frame(0x202, &[2])).unwrap();
        assert_eq!(line.stream.sent, b"t201101");
        line.stream.takes = Some(3);
        line.flush().unwrap();
        assert_eq!(line.stream.sent, b"t201101\rt2");
        line.stream.takes = None;
        line.send(&frame(0x080, &[])).unwrap();
        assert_eq!(line.stream.sent, b"t201101\rt202102\rt0800\r");
    }

    #[test]
    fn frames_come_from_pieces_of_any_size() {
        let mut line = SlcanLine::new(Wire::default());
        for piece in [&b"z\rt1812"[..], b"ABCD\rt1", b"8220102\r\x07"] {
            line.stream.comes.push_back(piece.to_vec());
        }
        let all: Vec<_> = std::iter::from_fn(|| line.receive().unwrap()).collect();
        assert_eq!(all, [frame(0x181, &[0xAB, 0xCD]), frame(0x182, &[1, 2])]);
        assert_eq!((line.receive().unwrap(), line.faults()), (None, 1));
        line.stream.has_ended = true;
        let error = line.receive().unwrap_err().to_string();
        assert_eq!(error, "the way to the bus is lost: the adapter has closed the line");
        assert_eq!((line.send(&frame(0, &[])).unwrap_err().to_string(), line.state()), (error, BusState::Off));
    }

    /// Simulated adapter with these answers to the commands after its silence.
    #[derive(Debug)]
    struct Adapter {
        answers: VecDeque<&'static [u8]>,
        heard: Vec<u8>,
        says: VecDeque<u8>,
    }

    impl Adapter {
        fn line(answers: [&'static [u8]; 4]) -> SlcanLine<Self> {
            SlcanLine::new(Self { answers: answers.into(), heard: Vec::new(), says: VecDeque::new() })
        }
    }

    impl Write for Adapter {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.heard.extend_from_slice(bytes);
            self.says.extend(self.answers.pop_front().unwrap_or_default());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Read for Adapter {
        fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
            room[0] = self.says.pop_front().ok_or(ErrorKind::WouldBlock)?;
            Ok(1)
        }
    }

    #[test]
    fn the_channel_is_opened_by_the_sequence_that_adapters_know() {
        let rate = super::super::slcan::bit_rate(1000).unwrap();
        let answers: [[&[u8]; 4]; 3] =
            [[b"\r", b"\x07", b"\r", b"\r"], [b"t123", b"\x07\x07", b"\r", b"t1230\r"], [b"", b"", b"", b""]];
        for answers in answers {
            let mut line = Adapter::line(answers);
            line.open(rate).unwrap();
            line.close();
            assert_eq!((&line.stream.heard[..], line.faults()), (&b"\rC\rS8\rO\rC\r"[..], 0));
        }
        let refused = |answers| Adapter::line(answers).open(rate).unwrap_err().to_string();
        assert_eq!(refused([b"\r", b"\r", b"\x07", b"\r"]), "the adapter refuses the bit rate");
        assert_eq!(refused([b"\r", b"\r", b"\r", b"\x07"]), "the adapter refuses to open its channel");
    }
}
