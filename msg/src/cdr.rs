//! CDR, the encoding of messages on the wire and in bags (plain CDR, XCDR1).
//!
//! Writing uses the crate `cdr-encoding`, which the DDS layer also uses. The reader is our own and strict, because a
//! control node must not act on bytes that it only partly understands: input that `cdr-encoding` accepts (strings
//! without their terminating zero, bytes that are left over) is rejected here. Numbers are not checked: the caller has
//! to reject NaN.

mod error;
mod reader;

use byteorder::LittleEndian;
use serde::Serialize;
use serde::de::DeserializeOwned;

pub use error::{DecodeError, Problem};

use reader::Reader;

/// Byte order of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Endian {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

/// Maximum bytes after the last field: senders pad to a multiple of four.
pub const MAX_PADDING: usize = 3;

/// Encapsulation header of little endian CDR.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// Returns the value in little endian CDR, without encapsulation header.
///
/// # Panics
/// If `T` serializes a sequence without a known length, or fails itself; no type of this crate does.
pub fn encode<T: Serialize>(value: &T) -> Vec<u8> {
    append(Vec::new(), value)
}

/// Returns the value in little endian CDR after the four bytes `00 01 00 00`, as in a bag.
///
/// # Panics
/// As [`encode`].
pub fn encode_with_header<T: Serialize>(value: &T) -> Vec<u8> {
    append(HEADER.to_vec(), value)
}

/// Appends the output of [`encode_with_header`] to `bytes`, without a buffer of its own.
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

/// Appends a value. Alignment counts from the first byte of the value, whatever precedes it.
fn put<T: Serialize>(bytes: &mut Vec<u8>, value: &T) {
    cdr_encoding::to_writer::<_, LittleEndian, _>(bytes, value)
        .expect("a Vec takes every byte, and messages know the lengths of their sequences");
}

/// Reads a value from CDR without encapsulation header.
///
/// Rejects: too few bytes, more than [`MAX_PADDING`] bytes left over, a bool that is neither 0 nor 1, a string that is
/// not UTF-8 or does not end in a zero, a sequence longer than the remaining bytes, a string or array beyond its bound.
/// Memory for the value is allocated as its bytes are read, never because of an announced length.
pub fn decode<T: DeserializeOwned>(bytes: &[u8], endian: Endian) -> Result<T, DecodeError> {
    let mut reader = Reader::new(bytes, endian);
    let value = T::deserialize(&mut reader).and_then(|value| match reader.left() {
        0..=MAX_PADDING => Ok(value),
        left => Err(DecodeError::new(Problem::LeftOver { left })),
    });
    // The reader is at the position of the error.
    value.map_err(|error| error.of(reader.type_name(), reader.at()))
}

/// Reads a value after its encapsulation header, as in a bag; the header defines the byte order.
///
/// Rejects the same as [`decode`], and a header that is neither little nor big endian plain CDR.
pub fn decode_with_header<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, DecodeError> {
    match bytes {
        [0, 0, _, _, body @ ..] => decode(body, Endian::Big),
        [0, 1, _, _, body @ ..] => decode(body, Endian::Little),
        _ => Err(DecodeError::new(Problem::Header { start: bytes.iter().take(4).copied().collect() })),
    }
}

#[cfg(test)]
mod tests;
