//! Packs values into the bytes of process data and unpacks them.
//!
//! Law      fields are packed without gaps from bit 0, little endian, signed values in two's complement
//! Reads    bytes that are at least as long as the fields
//! Refuses  fewer bytes, which change nothing
//! Source   CiA 301; ETG.1000.6

use crate::mapping::Field;

/// Bits of a word of the image.
const WORD: u32 = 64;

/// Process image of mapped objects, for sending and receiving. It allocates no memory after its creation.
#[derive(Clone, Debug)]
pub struct Image<W> {
    length: usize,
    fields: Vec<Field<W>>,
    /// Received bytes, in words of 8 bytes.
    words: Vec<u64>,
}

impl<W: Copy> Image<W> {
    /// Creates an image with all bits 0. A field has 1 to 64 bits.
    pub fn of(fields: &[Field<W>]) -> Self {
        let length = fields.iter().map(|field| field.bits).sum::<u32>().div_ceil(8) as usize;
        Self { length, fields: fields.to_vec(), words: vec![0; length.div_ceil(8)] }
    }

    /// Returns the length in bytes.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Stores received bytes; returns false if they are too few.
    pub fn update(&mut self, bytes: &[u8]) -> bool {
        if bytes.len() < self.length {
            return false;
        }
        for (word, bytes) in self.words.iter_mut().zip(bytes.chunks(8)) {
            let mut all = [0; 8];
            for (to, from) in all.iter_mut().zip(bytes) {
                *to = *from;
            }
            *word = u64::from_le_bytes(all);
        }
        true
    }

    /// Returns each value, sign-extended.
    pub fn values(&self) -> impl Iterator<Item = (W, i64)> {
        let (mut bits, mut left, mut words) = (0_u128, 0, self.words.iter());
        self.fields.iter().map(move |field| {
            let length = field.bits.clamp(1, WORD);
            if left < length {
                bits |= words.next().copied().map_or(0, u128::from) << left;
                left += WORD;
            }
            let unused = WORD - length;
            // Shifts the field up to the sign bit and back, to extend the sign.
            let value = ((bits as u64) << unused).cast_signed() >> unused;
            bits >>= length;
            left -= length;
            (field.word, value)
        })
    }

    /// Writes these values, each truncated to its length, to the first bytes of `to`; the rest of `to` is not changed. Writes nothing if
    /// `to` is shorter than the image.
    pub fn pack(&self, value: impl Fn(W) -> i64, to: &mut [u8]) {
        let (mut bits, mut used, mut chunks) = (0_u128, 0, to.get_mut(..self.length).unwrap_or_default().chunks_mut(8));
        let mut write = |bits: u128| {
            for (to, from) in chunks.next().into_iter().flatten().zip((bits as u64).to_le_bytes()) {
                *to = from;
            }
        };
        for field in &self.fields {
            let length = field.bits.clamp(1, WORD);
            let mask = u64::MAX >> (WORD - length);
            bits |= u128::from(value(field.word).cast_unsigned() & mask) << used;
            used += length;
            if used >= WORD {
                write(bits);
                bits >>= WORD;
                used -= WORD;
            }
        }
        if used > 0 {
            write(bits);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects;
    use proptest::prelude::*;

    fn image(bits: &[u32]) -> Image<usize> {
        let field = |(word, bits): (usize, &u32)| Field { word, object: objects::STATUS_WORD, bits: *bits };
        Image::of(&bits.iter().enumerate().map(field).collect::<Vec<_>>())
    }

    /// Status 1637h, position -2, mode 8.
    #[test]
    fn bytes_are_unpacked_by_fields() {
        let mut image = image(&[16, 32, 8]);
        let bytes = [0x37, 0x16, 0xFE, 0xFF, 0xFF, 0xFF, 8];
        assert!(image.update(&bytes));
        assert_eq!(image.values().collect::<Vec<_>>(), [(0, 0x1637), (1, -2), (2, 8)]);
        let mut packed = [0xAA; 9];
        image.pack(|word| [0x1637, -2, 8][word], &mut packed);
        assert_eq!((&packed[..7], &packed[7..]), (bytes.as_slice(), [0xAA; 2].as_slice()));
        assert!(!image.update(&[0; 6]), "too short");
        assert_eq!(image.values().nth(1), Some((1, -2)), "it changes nothing");
    }

    proptest! {
        #[test]
        fn packed_values_are_unpacked_unchanged(values: [i64; 4], bits in prop::sample::select(vec![[1_u32, 7, 8, 16], [8, 8, 16, 32], [3, 13, 40, 8], [16, 64, 5, 64], [64, 64, 1, 1], [63, 63, 63, 63]])) {
            let mut image = image(&bits);
            let mut bytes = vec![0; image.length()];
            image.pack(|word| values[word], &mut bytes);
            prop_assert!(image.update(&bytes));
            for ((word, value), bits) in image.values().zip(bits) {
                prop_assert_eq!(value, values[word] << (64 - bits) >> (64 - bits));
            }
        }
    }
}
