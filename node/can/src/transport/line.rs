//! slcan over a stream of bytes that never waits: a serial line, a pseudo terminal, TCP.

use super::slcan::{CLOSE, Decoder, Line, OPEN, Said};
use super::{Transport, TransportError};
use crate::Frame;
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};

/// Frames that may wait for the line.
const ROOM: usize = 256;
/// Bytes that are read at once.
const PIECE: usize = 512;

/// An adapter at the other end of a stream.
#[derive(Debug)]
pub struct SlcanLine<S> {
    stream: S,
    decoder: Decoder,
    /// Lines that wait, and how much of the first one has gone.
    waiting: VecDeque<Line>,
    gone: usize,
    /// Bytes that were read: those from `at` to `end` have not been looked at.
    piece: [u8; PIECE],
    at: usize,
    end: usize,
    refused: u64,
}

impl<S: Read + Write> SlcanLine<S> {
    /// An adapter whose channel is open already, or will be by [`open`](Self::open).
    pub fn new(stream: S) -> Self {
        Self {
            stream,
            decoder: Decoder::default(),
            waiting: VecDeque::with_capacity(ROOM),
            gone: 0,
            piece: [0; PIECE],
            at: 0,
            end: 0,
            refused: 0,
        }
    }

    /// Sets the bit rate, by its command, and opens the channel. An empty line first ends what somebody else has left in the adapter.
    ///
    /// # Errors
    /// The stream does not take the few bytes at once, or is lost.
    pub fn open(&mut self, bit_rate: &[u8]) -> io::Result<()> {
        for command in [b"\r".as_slice(), CLOSE, bit_rate, OPEN] {
            self.stream.write_all(command)?;
        }
        self.stream.flush()
    }

    /// Closes the channel.
    ///
    /// # Errors
    /// The stream does not take the bytes at once, or is lost.
    pub fn close(&mut self) -> io::Result<()> {
        self.stream.write_all(CLOSE)?;
        self.stream.flush()
    }

    /// Commands and frames that the adapter has refused. One is usual: closing a channel that is closed.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Looks at what was read, up to the end of a frame.
    fn next_frame(&mut self) -> Option<Frame> {
        while let Some(&byte) = self.piece.get(self.at..self.end)?.first() {
            self.at += 1;
            match self.decoder.take(byte) {
                Some(Said::Frame(frame)) => return Some(frame),
                Some(Said::Refused) => self.refused = self.refused.saturating_add(1),
                None => {}
            }
        }
        None
    }
}

/// Nothing at present; none where the stream has ended, or is lost.
fn unless_later<T>(result: io::Result<T>) -> io::Result<Option<T>> {
    match result {
        Ok(done) => Ok(Some(done)),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(None),
        Err(error) => Err(error),
    }
}

fn ended() -> io::Error {
    io::Error::new(ErrorKind::UnexpectedEof, "the adapter has closed the line")
}

impl<S: Read + Write + Send> Transport for SlcanLine<S> {
    fn send(&mut self, frame: &Frame) -> Result<(), TransportError> {
        self.flush()?;
        if self.waiting.len() >= ROOM {
            return Err(TransportError::Full(self.waiting.len()));
        }
        self.waiting.push_back(Line::of(frame));
        self.flush()
    }

    fn flush(&mut self) -> Result<(), TransportError> {
        while let Some(line) = self.waiting.front() {
            let rest = line.bytes().get(self.gone..).unwrap_or_default();
            match unless_later(self.stream.write(rest))? {
                Some(0) => return Err(ended().into()),
                Some(count) if count < rest.len() => self.gone += count,
                Some(_) => {
                    self.waiting.pop_front();
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
            match unless_later(self.stream.read(&mut self.piece))? {
                Some(0) => return Err(ended().into()),
                Some(count) => (self.at, self.end) = (0, count),
                None => {
                    (self.at, self.end) = (0, 0);
                    return Ok(None);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Id;

    /// A stream that takes and gives a few bytes at a time.
    #[derive(Debug, Default)]
    struct Wire {
        /// Bytes that it takes until it says later; none: as many as come.
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
    fn what_the_line_does_not_take_goes_later_in_its_order() {
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
    fn a_full_queue_refuses_and_keeps_what_it_has() {
        let mut line = SlcanLine::new(Wire { takes: Some(0), ..Wire::default() });
        for number in 0..ROOM {
            line.send(&frame(number as u16, &[])).unwrap();
        }
        let error = line.send(&frame(0x7FF, &[])).unwrap_err();
        assert_eq!(error.to_string(), "the bus takes no more frames: 256 of them wait");
        line.stream.takes = None;
        line.flush().unwrap();
        assert!(line.stream.sent.ends_with(b"t0FE0\rt0FF0\r") && line.waiting.is_empty());
        assert!(line.waiting.capacity() >= ROOM, "and no memory was taken or given back");
    }

    #[test]
    fn frames_come_from_pieces_of_any_size() {
        let mut line = SlcanLine::new(Wire::default());
        for piece in [&b"z\rt1812"[..], b"ABCD\rt1", b"8220102\r\x07"] {
            line.stream.comes.push_back(piece.to_vec());
        }
        let all: Vec<_> = std::iter::from_fn(|| line.receive().unwrap()).collect();
        assert_eq!(all, [frame(0x181, &[0xAB, 0xCD]), frame(0x182, &[1, 2])]);
        assert_eq!((line.receive().unwrap(), line.refused()), (None, 1));
        line.stream.has_ended = true;
        let error = line.receive().unwrap_err().to_string();
        assert_eq!(error, "the way to the bus is lost: the adapter has closed the line");
    }

    #[test]
    fn the_channel_is_opened_by_the_sequence_that_adapters_know() {
        let mut line = SlcanLine::new(Wire::default());
        line.open(super::super::slcan::bit_rate(1000).unwrap()).unwrap();
        line.close().unwrap();
        assert_eq!(line.stream.sent, b"\rC\rS8\rO\rC\r");
    }
}
