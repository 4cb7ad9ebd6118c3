//! Counts of 32 bits that never run out.
//!
//! Law      the change from one word to the next is the shorter way around; a coordinate that was set anew is another epoch, and its change
//!          is no motion
//! Reads    position actual values (6064h)
//! Source   CiA 402-2; contract section 8 (`epoch`)

/// Counts all changes of a word of 32 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counter {
    word: Option<i32>,
    count: i64,
    epoch: u32,
}

impl Counter {
    /// Takes a word; by how much it has changed.
    pub fn take(&mut self, word: i32) -> i64 {
        let change = self.word.map(|last| i64::from(word.wrapping_sub(last)));
        self.word = Some(word);
        match change {
            // 2^63 counts are not reached by steps of 2^31.
            Some(change) => self.count = self.count.wrapping_add(change),
            None => self.count = i64::from(word),
        }
        change.unwrap_or_default()
    }

    /// The next word is that of another coordinate.
    pub fn begin_anew(&mut self) {
        if self.word.take().is_some() {
            self.epoch = self.epoch.wrapping_add(1);
        }
    }

    /// The count at another word of the same coordinate, the shorter way around; none before the first word.
    pub fn locate(self, word: i32) -> Option<i64> {
        self.word.map(|last| self.count.wrapping_add(i64::from(word.wrapping_sub(last))))
    }

    /// All of it.
    pub fn count(self) -> i64 {
        self.count
    }

    /// Grows with each new coordinate.
    pub fn epoch(self) -> u32 {
        self.epoch
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_that_wraps_is_counted_on() {
        let mut counter = Counter::default();
        assert_eq!((counter.take(i32::MAX - 1), counter.count()), (0, i64::from(i32::MAX) - 1));
        assert_eq!((counter.take(i32::MIN + 1), counter.count()), (3, i64::from(i32::MAX) + 2));
        assert_eq!((counter.take(i32::MAX), counter.count()), (-2, i64::from(i32::MAX)));
        assert_eq!(counter.epoch(), 0);
        assert_eq!(counter.locate(i32::MIN), Some(i64::from(i32::MAX) + 1));
    }

    #[test]
    fn a_new_coordinate_is_no_motion() {
        let mut counter = Counter::default();
        counter.begin_anew();
        assert_eq!(counter.epoch(), 0, "nothing was counted before");
        counter.take(500);
        counter.begin_anew();
        assert_eq!((counter.take(0), counter.count(), counter.epoch()), (0, 0, 1));
    }
}
