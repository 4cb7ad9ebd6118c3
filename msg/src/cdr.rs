//! CDR, the byte form of messages on the wire and in bags (plain CDR, XCDR1).
//!
//! Writing uses the crate `cdr-encoding`, which also the DDS layer writes with. Reading is our own and strict: a
//! control node must not act on bytes that it half understands, so what `cdr-encoding` lets pass (strings without
//! their zero, bytes that are left over) is refused here. Numbers are not judged: NaN is for the caller to refuse.

mod error;
mod reader;

use byteorder::LittleEndian;
use serde::Serialize;
use serde::de::DeserializeOwned;

pub use error::{DecodeError, Problem};

use reader::Reader;

/// Order of the bytes in a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Endian {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

/// Most bytes that may follow the last field: senders fill up to a multiple of four.
pub const MAX_PADDING: usize = 3;

/// Encapsulation header of little endian CDR.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// The value in little endian CDR, without encapsulation header.
///
/// # Panics
/// When `T` serializes a sequence whose length it does not know, or fails by itself; no type of this crate does.
pub fn encode<T: Serialize>(value: &T) -> Vec<u8> {
    append(Vec::new(), value)
}

/// The value in little endian CDR behind the four bytes `00 01 00 00`, as a bag holds it.
///
/// # Panics
/// As [`encode`].
pub fn encode_with_header<T: Serialize>(value: &T) -> Vec<u8> {
    append(HEADER.to_vec(), value)
}

/// Puts behind `bytes` what [`encode_with_header`] gives, without memory of its own.
///
/// # Panics
/// As [`encode`].
pub fn append_with_header<T: Serialize>(bytes: &mut Vec<u8>, value: &T) {
    bytes.extend_from_slice(&HEADER);
    put(bytes, value);
}

fn append<T: Serialize>(mut bytes: Vec<u8>, value: &T) -> Vec<u8> {
    put(&mut bytes, value);
    bytes
}

/// Alignment counts from the first byte of the value, whatever stands before it.
fn put<T: Serialize>(bytes: &mut Vec<u8>, value: &T) {
    cdr_encoding::to_writer::<_, LittleEndian, _>(bytes, value)
        .expect("a Vec takes every byte, and messages know the lengths of their sequences");
}

/// Reads a value from CDR without encapsulation header.
///
/// Refused are: too few bytes, more than [`MAX_PADDING`] bytes left over, a bool that is neither 0 nor 1, a string that
/// is no UTF-8 or does not end in a zero, a sequence longer than the bytes that are left, a string or array beyond its
/// bound. Memory for the value is taken as its bytes are read, never because a length announces them.
pub fn decode<T: DeserializeOwned>(bytes: &[u8], endian: Endian) -> Result<T, DecodeError> {
    let mut reader = Reader::new(bytes, endian);
    let value = T::deserialize(&mut reader).and_then(|value| match reader.left() {
        0..=MAX_PADDING => Ok(value),
        left => Err(DecodeError::new(Problem::LeftOver { left })),
    });
    // The reader stands where it was refused.
    value.map_err(|error| error.of(reader.type_name(), reader.at()))
}

/// Reads a value behind its encapsulation header, as a bag holds it; the header says the order of the bytes.
///
/// Refused is what [`decode`] refuses, and a header that is neither little nor big endian plain CDR.
pub fn decode_with_header<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, DecodeError> {
    match bytes {
        [0, 0, _, _, body @ ..] => decode(body, Endian::Big),
        [0, 1, _, _, body @ ..] => decode(body, Endian::Little),
        _ => Err(DecodeError::new(Problem::Header { start: bytes.iter().take(4).copied().collect() })),
    }
}

#[cfg(test)]
mod tests;
