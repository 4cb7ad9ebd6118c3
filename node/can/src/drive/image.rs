//! Packs values into the bytes of a PDO and unpacks them.
//!
//! Law      fields are packed without gaps from bit 0, little endian, signed values in two's complement
//! Reads    a frame that is at least as long as its fields
//! Refuses  shorter frames, which change nothing
//! Source   CiA 301

use super::layout::{Field, Pdo};
use crate::{Frame, Id};

/// Process image of a PDO, for sending and receiving. It allocates no memory after its creation.
#[derive(Clone, Debug)]
pub struct Image<W> {
    id: Id,
    length: u8,
    fields: Vec<Field<W>>,
    bits: u64,
}

impl<W: Copy> Image<W> {
    /// Creates an image with all bits 0.
    pub fn of(pdo: &Pdo<W>) -> Self {
        Self { id: pdo.id, length: pdo.bytes(), fields: pdo.fields.clone(), bits: 0 }
    }

    /// Returns the identifier.
    pub fn id(&self) -> Id {
        self.id
    }

    /// Stores a frame; returns false if it is too short.
    pub fn update(&mut self, frame: &Frame) -> bool {
        let bytes = frame.bytes();
        if bytes.len() < usize::from(self.length) || frame.is_remote() {
            return false;
        }
        let mut all = [0; 8];
        for (to, from) in all.iter_mut().zip(bytes) {
            *to = *from;
        }
        self.bits = u64::from_le_bytes(all);
        true
    }

    /// Returns each value, sign-extended.
    pub fn values(&self) -> impl Iterator<Item = (W, i64)> {
        let mut at = 0;
        self.fields.iter().map(move |field| {
            let unused = 64 - field.bits.clamp(1, 64);
            // Shifts the field up to the sign bit and back, to extend the sign.
            let value = (self.bits >> at << unused).cast_signed() >> unused;
            at += field.bits;
            (field.word, value)
        })
    }

    /// Returns the frame with these values, each truncated to its length.
    pub fn frame(&self, value: impl Fn(W) -> i64) -> Frame {
        let (mut bits, mut at) = (0, 0);
        for field in &self.fields {
            let mask = u64::MAX >> (64 - field.bits.clamp(1, 64));
            bits |= (value(field.word).cast_unsigned() & mask) << at;
            at += field.bits;
        }
        let bytes = bits.to_le_bytes();
        let bytes = bytes.get(..usize::from(self.length)).unwrap_or(&bytes);
        // A PDO has at most 8 bytes.
        Frame::data(self.id, bytes).unwrap_or(Frame::of(self.id, bits.to_le_bytes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::layout::Transmission;
    use crate::drive::objects;
    use proptest::prelude::*;

    fn image(bits: &[u32]) -> Image<usize> {
        let field = |(word, bits): (usize, &u32)| Field { word, object: objects::STATUS_WORD, bits: *bits };
        let fields = bits.iter().enumerate().map(field).collect();
        let id = Id::new(0x183).expect("11 bits");
        Image::of(&Pdo { number: 1, id, transmission: Transmission::EachSync, is_mapped: true, fields })
    }

    /// Status 1637h, position -2, mode 8.
    #[test]
    fn frame_is_unpacked_by_fields() {
        let mut image = image(&[16, 32, 8]);
        let frame = Frame::data(image.id(), &[0x37, 0x16, 0xFE, 0xFF, 0xFF, 0xFF, 8]).unwrap();
        assert!(image.update(&frame));
        assert_eq!(image.values().collect::<Vec<_>>(), [(0, 0x1637), (1, -2), (2, 8)]);
        assert_eq!(image.frame(|word| [0x1637, -2, 8][word]), frame);
        assert!(!image.update(&Frame::data(image.id(), &[0; 6]).unwrap()), "too short");
        assert!(!image.update(&Frame::remote(image.id(), 8).unwrap()));
        assert_eq!(image.values().nth(1), Some((1, -2)), "it changes nothing");
    }

    proptest! {
        #[test]
        fn packed_values_are_unpacked_unchanged(values: [i64; 4], bits in prop::sample::select(vec![[1_u32, 7, 8, 16], [8, 8, 16, 32], [3, 13, 40, 8]])) {
            let mut image = image(&bits);
            let frame = image.frame(|word| values[word]);
            prop_assert!(image.update(&frame));
            for ((word, value), bits) in image.values().zip(bits) {
                prop_assert_eq!(value, values[word] << (64 - bits) >> (64 - bits));
            }
        }
    }
}
