//! Length-prefixed messages on a stream.

use std::io::{self, Read, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Maximum length of a message in bytes; far more than a table of 10^6 points needs.
pub(crate) const LONGEST: usize = 256 << 20;

/// Returns the message as it is sent over the stream.
pub(crate) fn encode(message: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut frame = postcard::to_extend(message, vec![0; 4]).map_err(io::Error::other)?;
    let length = frame.len() - 4;
    if length > LONGEST {
        let sentence = format!("a message of {length} bytes, at most {LONGEST} are allowed");
        return Err(io::Error::new(io::ErrorKind::InvalidInput, sentence));
    }
    // `LONGEST` fits in 32 bits.
    frame[..4].copy_from_slice(&(length as u32).to_le_bytes());
    Ok(frame)
}

pub(crate) fn write(stream: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    stream.write_all(&encode(message)?)
}

/// Reads the next message. Returns an error of kind `UnexpectedEof` at the end of the stream.
pub(crate) fn read<M: DeserializeOwned>(stream: &mut impl Read, buffer: &mut Vec<u8>) -> io::Result<M> {
    let mut length = [0; 4];
    stream.read_exact(&mut length)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST {
        return Err(io::Error::new(io::ErrorKind::InvalidData, format!("a message of {length} bytes")));
    }
    buffer.resize(length, 0);
    stream.read_exact(buffer)?;
    let message = postcard::from_bytes(buffer).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
    // The memory of a long message is released.
    if buffer.capacity() > 1 << 20 {
        *buffer = Vec::new();
    }
    Ok(message)
}

#[cfg(test)]
mod tests {
    use bytes::Bytes;

    use super::super::protocol::Order;
    use super::*;

    #[test]
    fn messages_follow_each_other() {
        let orders = [Order::Close(7), Order::Write(1, Bytes::from(vec![9; 3_000_000])), Order::Probe(u64::MAX)];
        let mut stream = Vec::new();
        orders.iter().for_each(|order| write(&mut stream, order).unwrap());
        let (mut stream, mut buffer) = (stream.as_slice(), Vec::new());
        for order in &orders {
            assert_eq!(&read::<Order>(&mut stream, &mut buffer).unwrap(), order);
        }
        assert!(buffer.capacity() <= 1 << 20);
        let end = read::<Order>(&mut stream, &mut buffer).unwrap_err();
        assert_eq!(end.kind(), io::ErrorKind::UnexpectedEof);
    }

    #[test]
    fn what_is_no_message_is_refused() {
        let read = |mut bytes: &[u8]| super::read::<Order>(&mut bytes, &mut Vec::new()).unwrap_err().kind();
        assert_eq!(read(&u32::MAX.to_le_bytes()), io::ErrorKind::InvalidData, "nothing is allocated for it");
        assert_eq!(read(&[2, 0, 0, 0, 250, 250]), io::ErrorKind::InvalidData);
        assert_eq!(read(&[9, 0, 0, 0, 1]), io::ErrorKind::UnexpectedEof);
    }
}
