//! Process data of a simulated encoder in any form, and their faults.
//!
//! Law      word = code of (count); disturbed bits are inverted, a broken line reads all ones; a factor may change the
//!          counts from some time on: 0 for a dead encoder
//! Source   MACS-ENC-01, -08, WF-ABS-01, WF-MON-01

use crate::encoder::Form;

/// Encoding of the counts of a simulated source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Word {
    form: Form,
    /// Bits to invert, and the number of words.
    disturbed: (i64, u32),
    broken: bool,
    pace: CountFactor,
}

/// Factor of the counts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CountFactor {
    factor: i64,
    /// The last count, and its reported value.
    last: (i64, i64),
}

impl CountFactor {
    fn told(self, count: i64) -> i64 {
        self.last.1.wrapping_add(count.wrapping_sub(self.last.0).wrapping_mul(self.factor))
    }
}

impl Word {
    pub(super) fn new(form: Form) -> Self {
        Self { form, disturbed: (0, 0), broken: false, pace: CountFactor { factor: 1, last: (0, 0) } }
    }

    /// Sets the factor of the counts.
    pub(super) fn count_by(&mut self, factor: i64) {
        self.pace.factor = factor;
    }

    /// Inverts bits in the next `words` words.
    pub(super) fn disturb(&mut self, bits: i64, words: u32) {
        self.disturbed = (bits, words);
    }

    /// Cuts the line permanently.
    pub(super) fn cut(&mut self) {
        self.broken = true;
    }

    pub(super) fn is_broken(&self) -> bool {
        self.broken
    }

    pub(super) fn is_absolute(&self) -> bool {
        matches!(self.form, Form::Absolute(_))
    }

    /// Returns the word of a count, undisturbed.
    pub(super) fn of(&self, count: i64) -> i64 {
        match self.form {
            Form::Incremental(bits) => {
                let spare = 64 - bits.clamp(1, 64);
                count.wrapping_shl(spare).wrapping_shr(spare)
            }
            // An encoder without overflow also restarts beyond its ends.
            Form::Absolute(encoder) => encoder.encode(count),
        }
    }

    /// Returns the present word.
    pub(super) fn next_word(&mut self, count: i64) -> i64 {
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

    /// Returns the count near `count` for a word, which is the setpoint of a drive.
    pub(super) fn count_near(&self, count: i64, word: i64) -> i64 {
        count.wrapping_add(self.form.circle().shortest_distance(self.count(self.of(count)), self.count(word)))
    }

    /// Returns the count of a word; an invalid word is returned unchanged.
    pub(super) fn count(&self, word: i64) -> i64 {
        match self.form {
            Form::Incremental(_) => word,
            Form::Absolute(encoder) => encoder.decode(encoder_word(encoder.words(), word)).unwrap_or(word),
        }
    }
}

/// Converts a setpoint across the wrap to a word.
fn encoder_word(words: i64, word: i64) -> i64 {
    word.rem_euclid(words)
}
