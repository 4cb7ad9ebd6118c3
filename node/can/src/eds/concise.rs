//! Concise DCF, the form of a device configuration in object 1F22h.
//!
//! Law      number of entries (u32), then for each entry: index (u16), subindex (u8), number of bytes (u32), the bytes; all little-endian
//! Refuses  bytes that end too early, bytes after the last entry, numbers of entries or bytes above 32 bits
//! Source   CiA 302-3, object 1F22h

use lineshaft_cia402::object::Object;

/// Reason why decoding or encoding failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConciseError {
    /// The bytes end within an entry.
    #[error("the concise DCF ends within entry {entry} of {entries}")]
    Short {
        /// Number of the entry, from 1; 0 for the number of entries itself.
        entry: u32,
        /// Number of entries according to the first number.
        entries: u32,
    },
    /// There are bytes after the last entry.
    #[error("{bytes} bytes stand behind the {entries} entries of the concise DCF")]
    Long {
        /// Number of extra bytes.
        bytes: usize,
        /// Number of entries.
        entries: u32,
    },
    /// The size of an object exceeds 32 bits.
    #[error("{0}: its data are longer than 4294967295 bytes")]
    Data(Object),
    /// The number of entries exceeds 32 bits.
    #[error("a concise DCF has at most 4294967295 entries")]
    Entries,
}

/// Returns the bytes of the entries.
///
/// # Errors
/// There are too many entries, or one is too long.
pub fn encode(entries: &[(Object, Vec<u8>)]) -> Result<Vec<u8>, ConciseError> {
    let mut bytes = u32::try_from(entries.len()).map_err(|_| ConciseError::Entries)?.to_le_bytes().to_vec();
    for (object, data) in entries {
        let size = u32::try_from(data.len()).map_err(|_| ConciseError::Data(*object))?;
        bytes.extend_from_slice(&object.index.to_le_bytes());
        bytes.push(object.sub);
        bytes.extend_from_slice(&size.to_le_bytes());
        bytes.extend_from_slice(data);
    }
    Ok(bytes)
}

/// Returns the entries of the bytes. Memory is allocated only for bytes that are present, not by the numbers in them.
///
/// # Errors
/// There are too few or too many bytes.
pub fn decode(bytes: &[u8]) -> Result<Vec<(Object, Vec<u8>)>, ConciseError> {
    let (count, mut rest) = bytes.split_first_chunk::<4>().ok_or(ConciseError::Short { entry: 0, entries: 0 })?;
    let entries = u32::from_le_bytes(*count);
    let mut decoded = Vec::new();
    for entry in 1..=entries {
        let short = ConciseError::Short { entry, entries };
        let (head, behind) = rest.split_first_chunk::<7>().ok_or(short)?;
        let [low, high, sub, a, b, c, d] = *head;
        let size = usize::try_from(u32::from_le_bytes([a, b, c, d])).map_err(|_| short)?;
        let (data, behind) = behind.split_at_checked(size).ok_or(short)?;
        decoded.push((Object { index: u16::from_le_bytes([low, high]), sub }, data.to_vec()));
        rest = behind;
    }
    if rest.is_empty() { Ok(decoded) } else { Err(ConciseError::Long { bytes: rest.len(), entries }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Two entries: 1017h = 100 (u16), 1400h:02 = 1 (u8).
    const TWO: [u8; 21] = [2, 0, 0, 0, 0x17, 0x10, 0, 2, 0, 0, 0, 0x64, 0, 0x00, 0x14, 2, 1, 0, 0, 0, 1];

    fn two() -> Vec<(Object, Vec<u8>)> {
        vec![(Object { index: 0x1017, sub: 0 }, vec![0x64, 0]), (Object { index: 0x1400, sub: 2 }, vec![1])]
    }

    #[test]
    fn entries_are_encoded_in_sequence() {
        assert_eq!(encode(&two()).unwrap(), TWO);
        assert_eq!(decode(&TWO), Ok(two()));
        assert_eq!(decode(&[0, 0, 0, 0]), Ok(vec![]));
    }

    #[test]
    fn wrong_lengths_are_refused() {
        for length in 0..TWO.len() {
            assert!(matches!(decode(&TWO[..length]), Err(ConciseError::Short { .. })), "{length}");
        }
        let long = [&TWO[..], &[0]].concat();
        let error = decode(&long).unwrap_err().to_string();
        assert_eq!(error, "1 bytes stand behind the 2 entries of the concise DCF");
        let error = decode(&TWO[..20]).unwrap_err().to_string();
        assert_eq!(error, "the concise DCF ends within entry 2 of 2");
    }

    #[test]
    fn large_counts_allocate_no_memory() {
        assert_eq!(decode(&[0xFF; 4]), Err(ConciseError::Short { entry: 1, entries: u32::MAX }));
        assert_eq!(
            decode(&[&[1, 0, 0, 0][..], &[0xFF; 7]].concat()),
            Err(ConciseError::Short { entry: 1, entries: 1 })
        );
    }

    proptest! {
        #[test]
        fn entries_are_decoded_as_encoded(entries in proptest::collection::vec(
            (any::<u16>(), any::<u8>(), proptest::collection::vec(any::<u8>(), 0..20)), 0..20,
        )) {
            let entries: Vec<_> = entries.into_iter().map(|(index, sub, data)| (Object { index, sub }, data)).collect();
            prop_assert_eq!(decode(&encode(&entries).unwrap()), Ok(entries));
        }

        #[test]
        fn any_bytes_are_decoded_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            if let Ok(entries) = decode(&bytes) {
                prop_assert_eq!(encode(&entries).unwrap(), bytes);
            }
        }
    }
}
