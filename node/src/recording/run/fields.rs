//! Reads the fields of MCAP records.
//!
//! Law      numbers are little endian; a text is its length (u32) and its bytes; a map is its length in bytes (u32) and
//!          texts, key and value alternating
//! Refuses  fields that exceed their record
//!
//! The crate `mcap` is not used here: its parser allocates memory for lengths given by the file, and some of its
//! subtractions trust them too. A file from outside may have any values.

use super::error::Damage;
use std::collections::BTreeMap;

/// The body of a record, read from its start.
pub(super) struct Fields<'a> {
    rest: &'a [u8],
}

impl<'a> Fields<'a> {
    pub(super) fn new(body: &'a [u8]) -> Self {
        Self { rest: body }
    }

    /// Returns the unread rest.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], Damage> {
        let (taken, rest) = self.rest.split_at_checked(length).ok_or(Damage::Record)?;
        self.rest = rest;
        Ok(taken)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], Damage> {
        let (number, rest) = self.rest.split_first_chunk().ok_or(Damage::Record)?;
        self.rest = rest;
        Ok(*number)
    }

    pub(super) fn u16(&mut self) -> Result<u16, Damage> {
        self.number().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Damage> {
        self.number().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, Damage> {
        self.number().map(u64::from_le_bytes)
    }

    /// Returns bytes that follow their length, which has 64 bits here.
    pub(super) fn bytes(&mut self) -> Result<&'a [u8], Damage> {
        let length = self.u64()?;
        self.take(usize::try_from(length).map_err(|_| Damage::Record)?)
    }

    fn short_bytes(&mut self) -> Result<&'a [u8], Damage> {
        let length = self.u32()?;
        self.take(usize::try_from(length).map_err(|_| Damage::Record)?)
    }

    pub(super) fn text(&mut self) -> Result<&'a str, Damage> {
        std::str::from_utf8(self.short_bytes()?).map_err(|_| Damage::Text)
    }

    pub(super) fn map(&mut self) -> Result<BTreeMap<String, String>, Damage> {
        let mut pairs = Self::new(self.short_bytes()?);
        let mut map = BTreeMap::new();
        while !pairs.rest.is_empty() {
            let (key, value) = (pairs.text()?, pairs.text()?);
            map.insert(key.to_owned(), value.to_owned());
        }
        Ok(map)
    }
}

/// Fields before the data of a message.
#[derive(Clone, Copy, Debug)]
pub(super) struct MessageHead {
    pub channel: u16,
    pub sequence: u32,
    pub log_time: u64,
    pub publish_time: u64,
}

impl MessageHead {
    /// Number of bytes before the data.
    pub(super) const LENGTH: usize = 2 + 4 + 8 + 8;

    pub(super) fn read(body: &[u8]) -> Result<Self, Damage> {
        let mut fields = Fields::new(body);
        Ok(Self {
            channel: fields.u16()?,
            sequence: fields.u32()?,
            log_time: fields.u64()?,
            publish_time: fields.u64()?,
        })
    }
}

/// A chunk of records, still compressed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk<'a> {
    /// Uncompressed size, in bytes.
    pub size: u64,
    /// CRC of the uncompressed records; 0 if unknown.
    pub crc: u32,
    pub compression: &'a str,
    pub packed: &'a [u8],
}

impl<'a> Chunk<'a> {
    pub(super) fn read(body: &'a [u8]) -> Result<Self, Damage> {
        let mut fields = Fields::new(body);
        // Times of its first and its last message.
        let _times = (fields.u64()?, fields.u64()?);
        Ok(Self { size: fields.u64()?, crc: fields.u32()?, compression: fields.text()?, packed: fields.bytes()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
            let _ = MessageHead::read(&bytes);
            let _ = Chunk::read(&bytes);
            let _ = Fields::new(&bytes).map();
            let _ = Fields::new(&bytes).bytes();
        }
    }

    #[test]
    fn a_length_beyond_the_record_is_refused() {
        assert!(matches!(Fields::new(&[0xff, 0xff, 0xff, 0xff, 1]).text(), Err(Damage::Record)));
        assert!(matches!(Fields::new(&[0xff; 8]).bytes(), Err(Damage::Record)));
        assert!(matches!(Fields::new(&[1, 0, 0, 0, 0xff]).text(), Err(Damage::Text)));
        // A map without its last value.
        assert!(matches!(Fields::new(&[5, 0, 0, 0, 1, 0, 0, 0, b'a']).map(), Err(Damage::Record)));
    }
}
