//! Frames as datagrams in the format of the bus `udp_multicast` of python-can.
//!
//! Law      a datagram is one frame: a MessagePack map with up to 11 keys in any order. A missing key has the default of python-can; of a
//!          repeated key the last value is used
//! Reads    integers and texts of all widths, a time stamp of any number type, a channel of any type
//! Refuses  all that python-can refuses too: another key, a value of another type, a length other than that of the data, a remote frame
//!          with data, an identifier that is too large, bytes after the map
//! Source   python-can 4.6.1 (`interfaces/udp_multicast`, `message.py`), MessagePack specification

use crate::{Frame, Id};

/// Size of the longest datagram that is sent: 154 bytes with 8 bytes of data.
pub(super) const LONGEST: usize = 160;

/// Datagram of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Datagram {
    bytes: [u8; LONGEST],
    length: usize,
}

impl Datagram {
    /// Writes all keys, in the order of python-can, so that a strict reader needs no defaults.
    pub(super) fn of(frame: &Frame) -> Self {
        let mut datagram = Self { bytes: [0; LONGEST], length: 0 };
        datagram.put(&[0x8B]);
        datagram.key("timestamp").put(&[0]);
        datagram.key("arbitration_id").integer(frame.id().get());
        datagram.key("is_extended_id").put(&[FALSE]);
        datagram.key("is_remote_frame").put(&[if frame.is_remote() { TRUE } else { FALSE }]);
        datagram.key("is_error_frame").put(&[FALSE]);
        datagram.key("channel").put(&[NIL]);
        datagram.key("dlc").integer(frame.length().into());
        let data = frame.bytes();
        datagram.key("data").put(&[0xC4, data.len() as u8]);
        datagram.put(data);
        for key in ["is_fd", "bitrate_switch", "error_state_indicator"] {
            datagram.key(key).put(&[FALSE]);
        }
        datagram
    }

    fn put(&mut self, bytes: &[u8]) {
        // The longest datagram of a frame fits, as the tests check.
        if let Some(place) = self.bytes.get_mut(self.length..self.length + bytes.len()) {
            place.copy_from_slice(bytes);
            self.length += bytes.len();
        }
    }

    /// Writes a text of up to 31 bytes.
    fn key(&mut self, key: &str) -> &mut Self {
        self.put(&[0xA0 | key.len() as u8]);
        self.put(key.as_bytes());
        self
    }

    /// Writes an integer in its shortest form.
    fn integer(&mut self, value: u16) {
        match value.to_be_bytes() {
            [0, low @ 0..=0x7F] => self.put(&[low]),
            [0, low] => self.put(&[0xCC, low]),
            [high, low] => self.put(&[0xCD, high, low]),
        }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

const NIL: u8 = 0xC0;
const FALSE: u8 = 0xC2;
const TRUE: u8 = 0xC3;

/// MessagePack value.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Value<'a> {
    Nil,
    Bool(bool),
    Integer(i128),
    Float,
    Text(&'a [u8]),
    Bytes(&'a [u8]),
}

/// Reads values from the front of a datagram.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn unsigned(&mut self, bytes: usize) -> Option<u64> {
        Some(self.take(bytes)?.iter().fold(0, |value, byte| value << 8 | u64::from(*byte)))
    }

    fn signed(&mut self, bytes: usize) -> Option<i64> {
        let unused = 64 - 8 * bytes as u32;
        Some((self.unsigned(bytes)? << unused).cast_signed() >> unused)
    }

    /// Reads bytes after their number, which has `width` bytes.
    fn counted(&mut self, width: usize) -> Option<&'a [u8]> {
        let count = self.unsigned(width)?;
        self.take(usize::try_from(count).ok()?)
    }

    /// Reads the number of entries of a map.
    fn map(&mut self) -> Option<u64> {
        match self.unsigned(1)? {
            kind @ 0x80..=0x8F => Some(kind & 0xF),
            0xDE => self.unsigned(2),
            0xDF => self.unsigned(4),
            _ => None,
        }
    }

    /// Reads a value; arrays, maps and extensions are not allowed in a frame.
    fn value(&mut self) -> Option<Value<'a>> {
        let kind = self.take(1)?[0];
        Some(match kind {
            0..=0x7F => Value::Integer(kind.into()),
            0xA0..=0xBF => Value::Text(self.take((kind & 0x1F).into())?),
            NIL => Value::Nil,
            FALSE => Value::Bool(false),
            TRUE => Value::Bool(true),
            0xC4..=0xC6 => Value::Bytes(self.counted(1 << (kind - 0xC4))?),
            0xCA | 0xCB => self.take(4 << (kind - 0xCA)).map(|_| Value::Float)?,
            0xCC..=0xCF => Value::Integer(self.unsigned(1 << (kind - 0xCC))?.into()),
            0xD0..=0xD3 => Value::Integer(self.signed(1 << (kind - 0xD0))?.into()),
            0xD9..=0xDB => Value::Text(self.counted(1 << (kind - 0xD9))?),
            0xE0.. => Value::Integer(kind.cast_signed().into()),
            _ => return None,
        })
    }
}

/// Content of a datagram before its checks, initialized with the defaults of python-can.
struct Message<'a> {
    id: i128,
    is_extended: bool,
    is_remote: bool,
    is_error: bool,
    is_fd: bool,
    length: Option<i128>,
    data: &'a [u8],
}

/// Returns the frame of a datagram; `None` for frames that CANopen does not use (extended identifier, FD, error frame).
///
/// # Errors
/// The datagram is not a valid frame.
pub(super) fn frame_of(datagram: &[u8]) -> Result<Option<Frame>, InvalidDatagram> {
    read(datagram).and_then(|message| message.frame()).ok_or(InvalidDatagram)
}

/// Error: the datagram is not a valid frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct InvalidDatagram;

fn read(datagram: &[u8]) -> Option<Message<'_>> {
    let mut reader = Reader(datagram);
    let mut message =
        Message { id: 0, is_extended: true, is_remote: false, is_error: false, is_fd: false, length: None, data: &[] };
    for _ in 0..reader.map()? {
        let Value::Text(key) = reader.value()? else { return None };
        match (key, reader.value()?) {
            (b"timestamp", Value::Integer(_) | Value::Float) | (b"channel", _) => {}
            (b"bitrate_switch" | b"error_state_indicator", Value::Bool(_)) => {}
            (b"arbitration_id", Value::Integer(id)) => message.id = id,
            (b"is_extended_id", Value::Bool(is)) => message.is_extended = is,
            (b"is_remote_frame", Value::Bool(is)) => message.is_remote = is,
            (b"is_error_frame", Value::Bool(is)) => message.is_error = is,
            (b"is_fd", Value::Bool(is)) => message.is_fd = is,
            (b"dlc", Value::Integer(length)) => message.length = Some(length),
            (b"dlc", Value::Nil) => message.length = None,
            (b"data", Value::Bytes(data)) => message.data = data,
            (b"data", Value::Nil) => message.data = &[],
            _ => return None,
        }
    }
    reader.0.is_empty().then_some(message)
}

impl Message<'_> {
    /// Outer `None`: invalid frame. Inner `None`: frame that CANopen does not use.
    fn frame(&self) -> Option<Option<Frame>> {
        let largest = if self.is_extended { 0x1FFF_FFFF } else { 0x7FF };
        let longest = if self.is_fd { 64 } else { 8 };
        let length = self.length.unwrap_or(self.data.len() as i128);
        let is_right_length = if self.is_remote { self.data.is_empty() } else { length == self.data.len() as i128 };
        if !(0..=largest).contains(&self.id) || !(0..=longest).contains(&length) || !is_right_length {
            return None;
        }
        if self.is_remote && (self.is_error || self.is_fd) {
            return None;
        }
        if self.is_extended || self.is_error || self.is_fd {
            return Some(None);
        }
        let id = Id::new(self.id as u16).ok()?;
        let frame = if self.is_remote { Frame::remote(id, length as u8) } else { Frame::data(id, self.data) };
        frame.ok().map(Some)
    }
}

#[cfg(test)]
mod tests;
