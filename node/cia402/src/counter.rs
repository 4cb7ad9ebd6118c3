//! Extends a position word of 16 or 32 bits to 64 bits.
//!
//! Law      the change from one word to the next is the shorter distance around the word. A change of the coordinate system starts a new
//!          epoch and is not counted as motion
//! Reads    position actual values (6064h)
//! Source   CiA 402-2; contract section 8 (`epoch`)

/// Accumulated changes of a position word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionCounter {
    /// Number of upper bits that the word does not use.
    unused_bits: u32,
    word: Option<i32>,
    count: i64,
    epoch: u32,
}

impl Default for PositionCounter {
    fn default() -> Self {
        Self::of_bits(i32::BITS)
    }
}

impl PositionCounter {
    /// Creates a counter for words of 1 to 32 bits.
    pub fn of_bits(bits: u32) -> Self {
        Self { unused_bits: i32::BITS - bits.clamp(1, i32::BITS), word: None, count: 0, epoch: 0 }
    }

    /// Returns the signed difference between two words, the shorter distance around the word.
    fn wrapped_difference(self, from: i32, to: i32) -> i64 {
        i64::from(to.wrapping_sub(from) << self.unused_bits >> self.unused_bits)
    }

    /// Adds the change to a new word and returns it.
    pub fn update(&mut self, word: i32) -> i64 {
        let change = self.word.map(|last| self.wrapped_difference(last, word));
        self.word = Some(word);
        match change {
            // Cannot overflow in practice: steps of at most 2^31 counts do not reach 2^63.
            Some(change) => self.count = self.count.wrapping_add(change),
            None => self.count = i64::from(word),
        }
        change.unwrap_or_default()
    }

    /// Starts a new epoch: the next word belongs to another coordinate system.
    pub fn start_epoch(&mut self) {
        if self.word.take().is_some() {
            self.epoch = self.epoch.wrapping_add(1);
        }
    }

    /// Returns the count at another word of the same coordinate system, by the shorter distance; `None` before the first word.
    pub fn count_at(self, word: i32) -> Option<i64> {
        self.word.map(|last| self.count.wrapping_add(self.wrapped_difference(last, word)))
    }

    /// Returns the accumulated count.
    pub fn count(self) -> i64 {
        self.count
    }

    /// Returns the epoch, which is incremented with each new coordinate system.
    pub fn epoch(self) -> u32 {
        self.epoch
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn position_word_wraps_without_jump() {
        let mut counter = PositionCounter::default();
        assert_eq!((counter.update(i32::MAX - 1), counter.count()), (0, i64::from(i32::MAX) - 1));
        assert_eq!((counter.update(i32::MIN + 1), counter.count()), (3, i64::from(i32::MAX) + 2));
        assert_eq!((counter.update(i32::MAX), counter.count()), (-2, i64::from(i32::MAX)));
        assert_eq!(counter.epoch(), 0);
        assert_eq!(counter.count_at(i32::MIN), Some(i64::from(i32::MAX) + 1));
    }

    /// Proves: MACS-CAN-12
    #[test]
    fn word_of_16_bits_wraps_at_16_bits() {
        let mut counter = PositionCounter::of_bits(16);
        assert_eq!((counter.update(0x7FFF), counter.count()), (0, 0x7FFF));
        assert_eq!((counter.update(-0x8000), counter.count()), (1, 0x8000));
        assert_eq!((counter.update(0x7FFE), counter.count()), (-2, 0x7FFE));
        assert_eq!(counter.count_at(-0x7FFF), Some(0x8001));
    }

    #[test]
    fn new_coordinate_system_is_not_motion() {
        let mut counter = PositionCounter::default();
        counter.start_epoch();
        assert_eq!(counter.epoch(), 0, "nothing was counted before");
        counter.update(500);
        counter.start_epoch();
        assert_eq!((counter.update(0), counter.count(), counter.epoch()), (0, 0, 1));
    }
}
