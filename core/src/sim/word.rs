//! What a simulated encoder says: words of any form, and what may go wrong with them.
//!
//! Law      word = code of (count); bits that are disturbed are turned over, a broken line reads all ones; from some count on it may count
//!          another number for each: none where it is dead
//! Source   MACS-ENC-01, -08, WF-ABS-01, WF-MON-01

use crate::encoder::Form;

/// How a simulated source tells its counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Word {
    form: Form,
    /// Bits that are turned over, in so many words to come.
    disturbed: (i64, u32),
    broken: bool,
    pace: Pace,
}

/// How many counts it tells for each.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pace {
    factor: i64,
    /// The last count, and what it was told as.
    last: (i64, i64),
}

impl Pace {
    fn told(self, count: i64) -> i64 {
        self.last.1.wrapping_add(count.wrapping_sub(self.last.0).wrapping_mul(self.factor))
    }
}

impl Word {
    pub(super) fn new(form: Form) -> Self {
        Self { form, disturbed: (0, 0), broken: false, pace: Pace { factor: 1, last: (0, 0) } }
    }

    /// Tells so many counts for each from now on.
    pub(super) fn count_by(&mut self, factor: i64) {
        self.pace.factor = factor;
    }

    /// Turns bits over in the next `words` words.
    pub(super) fn disturb(&mut self, bits: i64, words: u32) {
        self.disturbed = (bits, words);
    }

    /// Cuts the line for good.
    pub(super) fn cut(&mut self) {
        self.broken = true;
    }

    pub(super) fn is_broken(&self) -> bool {
        self.broken
    }

    pub(super) fn is_absolute(&self) -> bool {
        matches!(self.form, Form::Absolute(_))
    }

    /// The word of a count, undisturbed.
    pub(super) fn of(&self, count: i64) -> i64 {
        match self.form {
            Form::Incremental(bits) => {
                let spare = 64 - bits.clamp(1, 64);
                count.wrapping_shl(spare).wrapping_shr(spare)
            }
            // Beyond its ends one without overflow begins anew all the same.
            Form::Absolute(encoder) => encoder.encode(count),
        }
    }

    /// The word that is told now.
    pub(super) fn tell(&mut self, count: i64) -> i64 {
        let (bits, left) = self.disturbed;
        self.disturbed.1 = left.saturating_sub(1);
        let told = self.pace.told(count);
        self.pace.last = (count, told);
        match (self.broken, left) {
            (true, _) => -1,
            (false, 0) => self.of(told),
            (false, _) => self.of(told) ^ bits,
        }
    }

    /// The count near `count` that a word stands for, which a drive is asked to go to.
    pub(super) fn near(&self, count: i64, word: i64) -> i64 {
        count.wrapping_add(self.form.circle().way(self.count(self.of(count)), self.count(word)))
    }

    /// The count that a word stands for; a word that stands for none is the count.
    pub(super) fn count(&self, word: i64) -> i64 {
        match self.form {
            Form::Incremental(_) => word,
            Form::Absolute(encoder) => encoder.decode(encoder_word(encoder.words(), word)).unwrap_or(word),
        }
    }
}

/// A setpoint beyond the seam, as a word.
fn encoder_word(words: i64, word: i64) -> i64 {
    word.rem_euclid(words)
}
