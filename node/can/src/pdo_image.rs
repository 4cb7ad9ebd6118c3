//! Process image of a PDO: its values, and its frames.
//!
//! Reads    a frame that is at least as long as its fields
//! Refuses  shorter frames and remote frames, which change nothing
//! Source   CiA 301

use crate::layout::Pdo;
use crate::{Frame, Id};
use lineshaft_cia402::image::Image;

/// Process image of a PDO, for sending and receiving. It allocates no memory after its creation.
#[derive(Clone, Debug)]
pub struct PdoImage<W> {
    id: Id,
    image: Image<W>,
}

impl<W: Copy> PdoImage<W> {
    /// Creates an image with all bits 0.
    pub fn of(pdo: &Pdo<W>) -> Self {
        Self { id: pdo.id, image: Image::of(&pdo.fields) }
    }

    /// Returns the identifier.
    pub fn id(&self) -> Id {
        self.id
    }

    /// Stores a frame; returns false if it is too short.
    pub fn update(&mut self, frame: &Frame) -> bool {
        !frame.is_remote() && self.image.update(frame.bytes())
    }

    /// Returns each value, sign-extended.
    pub fn values(&self) -> impl Iterator<Item = (W, i64)> {
        self.image.values()
    }

    /// Returns the frame with these values, each truncated to its length.
    pub fn frame(&self, value: impl Fn(W) -> i64) -> Frame {
        let mut all = [0; 8];
        self.image.pack(value, &mut all);
        let bytes = all.get(..self.image.length()).unwrap_or(&all);
        // A PDO has at most 8 bytes.
        Frame::data(self.id, bytes).unwrap_or(Frame::of(self.id, all))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Transmission;
    use lineshaft_cia402::mapping::Field;
    use lineshaft_cia402::objects;

    /// Status 1637h, position -2, mode 8.
    #[test]
    fn frame_is_unpacked_by_fields() {
        let field = |(word, bits): (usize, u32)| Field { word, object: objects::STATUS_WORD, bits };
        let fields = [16, 32, 8].into_iter().enumerate().map(field).collect();
        let id = Id::new(0x183).expect("11 bits");
        let pdo = Pdo { number: 1, id, transmission: Transmission::EachSync, is_mapped: true, fields };
        let mut image = PdoImage::of(&pdo);
        let frame = Frame::data(image.id(), &[0x37, 0x16, 0xFE, 0xFF, 0xFF, 0xFF, 8]).unwrap();
        assert!(image.update(&frame));
        assert_eq!(image.values().collect::<Vec<_>>(), [(0, 0x1637), (1, -2), (2, 8)]);
        assert_eq!(image.frame(|word| [0x1637, -2, 8][word]), frame);
        assert!(!image.update(&Frame::data(image.id(), &[0; 6]).unwrap()), "too short");
        assert!(!image.update(&Frame::remote(image.id(), 8).unwrap()));
        assert_eq!(image.values().nth(1), Some((1, -2)), "it changes nothing");
    }
}
