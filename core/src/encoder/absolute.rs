//! Code words of absolute encoders.
//!
//! Law      count = value of the word - omitted, 0 <= count < steps * turns; one step is one increment
//! Reads    words in binary or reflected Gray code
//! Writes   a count
//! Refuses  an invalid word; a step beyond the allowed one
//! Source   MACS-ENC-01, -08, A-11; WF-ABS-01, -04, WF-MD-04, -05, -16, W14

use serde::{Deserialize, Serialize};

/// Code of the words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum WordCode {
    /// Binary number.
    #[default]
    Binary,
    /// Reflected Gray code: one bit changes from step to step.
    Gray,
}

/// Parity of the number of ones of a word, including the parity track.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Parity {
    /// The number of ones is even.
    Even,
    /// The number of ones is odd.
    Odd,
}

/// Properties of an absolute encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Absolute {
    /// Steps per turn, from 2 on.
    pub steps: u32,
    /// Number of turns, from 1 on.
    pub turns: u32,
    /// Code of its words.
    pub code: WordCode,
    /// Parity track in addition to the tracks of the value, as the highest bit (WF-ABS-04).
    pub parity: Option<Parity>,
    /// Value of its first word: lower values do not occur, as in an excess code.
    pub omitted: u32,
    /// Whether its first word follows its last one. Otherwise its travel ends there.
    pub overflow: bool,
    /// Whether bad words are replaced by extrapolated ones, at most 100 in succession.
    pub corrects: bool,
    /// Largest step from cycle to cycle (inc).
    pub max_step: Option<i64>,
}

/// Reason why a word is bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bad {
    /// The word could not be read, or is invalid.
    NoWord,
    /// The difference from the last word exceeds the possible motion of the encoder.
    Step,
}

impl Absolute {
    /// Returns a single-turn encoder in binary code that wraps.
    pub const fn single_turn(steps: u32) -> Self {
        Self {
            steps,
            turns: 1,
            code: WordCode::Binary,
            parity: None,
            omitted: 0,
            overflow: true,
            corrects: false,
            max_step: None,
        }
    }

    /// Returns the number of its words, 2 to 2^62.
    pub fn words(&self) -> i64 {
        // Below 2^64; clamped to the largest range.
        let words = u64::from(self.steps.max(2)) * u64::from(self.turns.max(1));
        words.min(1 << 62).cast_signed()
    }

    /// Whether its properties are valid.
    pub fn is_sound(&self) -> bool {
        let words = u64::from(self.steps) * u64::from(self.turns);
        let last = words.saturating_add(self.omitted.into());
        self.steps >= 2 && self.turns >= 1 && last <= 1 << 62 && self.max_step.is_none_or(|step| step > 0)
    }

    /// Returns the number of tracks of its values (bits), 1 to 62.
    fn tracks(&self) -> u32 {
        // Below 2^63, as `words` and `omitted` are at most 2^62 each.
        let last = self.words().cast_unsigned() + u64::from(self.omitted) - 1;
        u64::BITS - last.leading_zeros()
    }

    /// Returns the parity track of a word without it, if there is one.
    fn parity_track(&self, word: u64) -> u64 {
        let is_set = match self.parity {
            None => false,
            Some(Parity::Even) => !word.count_ones().is_multiple_of(2),
            Some(Parity::Odd) => word.count_ones().is_multiple_of(2),
        };
        // Valid encoders have at most 62 tracks; others must not overflow either.
        u64::from(is_set) << self.tracks().min(62)
    }

    /// Returns the count of a word; none for an invalid word.
    pub fn decode(&self, word: i64) -> Option<i64> {
        let word = u64::try_from(word).ok()?;
        let tracks = (1_u64 << self.tracks().min(62)) - 1;
        let word = match self.parity {
            None => word,
            Some(_) if word & !tracks == self.parity_track(word & tracks) => word & tracks,
            Some(_) => return None,
        };
        let value = match self.code {
            WordCode::Binary => word,
            WordCode::Gray => from_gray(word),
        };
        let count = i64::try_from(value.checked_sub(self.omitted.into())?).ok()?;
        (count < self.words()).then_some(count)
    }

    /// Returns the word of a count, which wraps at the range of the encoder.
    pub fn encode(&self, count: i64) -> i64 {
        let value = count.rem_euclid(self.words()).cast_unsigned() + u64::from(self.omitted);
        let word = match self.code {
            WordCode::Binary => value,
            WordCode::Gray => value ^ value >> 1,
        };
        (word | self.parity_track(word)).cast_signed()
    }

    /// Returns the largest accepted step (inc): half a turn if bad words are corrected (MACS-ENC-08), and the
    /// configured one.
    pub fn largest_step(&self) -> Option<i64> {
        let half = self.corrects.then_some(i64::from(self.steps / 2));
        match (half, self.max_step) {
            (Some(half), Some(step)) => Some(half.min(step)),
            (half, step) => half.or(step),
        }
    }
}

/// Converts reflected Gray code to a number.
fn from_gray(mut word: u64) -> u64 {
    for shift in [1, 2, 4, 8, 16, 32] {
        word ^= word >> shift;
    }
    word
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GRAY: Absolute = Absolute {
        steps: 16,
        turns: 1,
        code: WordCode::Gray,
        parity: None,
        omitted: 0,
        overflow: true,
        corrects: false,
        max_step: None,
    };

    /// The table of reflected Gray code from textbooks; from 15 to 16 only track 5 changes.
    ///
    /// Proves: WF-ABS-01, WF-ABS-05
    #[test]
    fn gray_words_are_those_of_the_table() {
        let table = [
            0b0000, 0b0001, 0b0011, 0b0010, 0b0110, 0b0111, 0b0101, 0b0100, 0b1100, 0b1101, 0b1111, 0b1110, 0b1010,
            0b1011, 0b1001, 0b1000,
        ];
        for (count, word) in table.into_iter().enumerate() {
            assert_eq!(GRAY.decode(word), Some(count as i64), "{word:04b}");
            assert_eq!(GRAY.encode(count as i64), word, "{count}");
        }
        let wide = Absolute { steps: 32, ..GRAY };
        assert_eq!(wide.encode(15) ^ wide.encode(16), 0b10000);
        // Tracks that are not connected read 0 and change nothing.
        assert_eq!(Absolute { steps: 4096, ..GRAY }.decode(0b1001), Some(14));
    }

    /// 360 steps in the middle of 512: the excess code omits 76 words at each end, and one bit changes from its last to
    /// its first word, too.
    #[test]
    fn an_excess_code_leaves_words_out() {
        let excess = Absolute { steps: 360, omitted: 76, ..GRAY };
        assert_eq!(excess.decode(excess.encode(0)), Some(0));
        assert_eq!((excess.encode(359) ^ excess.encode(0)).count_ones(), 1);
        assert_eq!(excess.decode(75 ^ 75 >> 1), None);
        assert_eq!(excess.decode(436 ^ 436 >> 1), None);
    }

    #[test]
    fn words_that_an_encoder_does_not_have_are_none() {
        let binary = Absolute { turns: 4, ..Absolute::single_turn(1000) };
        assert_eq!((binary.decode(3999), binary.decode(4000), binary.decode(-1)), (Some(3999), None, None));
        assert_eq!(binary.decode(i64::MIN), None);
    }

    /// 15 steps need 4 tracks; the fifth one is that of parity. Any single wrong track is detected.
    ///
    /// Proves: WF-ABS-04
    #[test]
    fn a_track_of_parity_shows_every_single_wrong_track() {
        for (parity, zero) in [(Parity::Even, 0), (Parity::Odd, 0b10000)] {
            for code in [WordCode::Binary, WordCode::Gray] {
                let encoder = Absolute { steps: 15, code, parity: Some(parity), ..GRAY };
                assert_eq!(encoder.encode(0), zero);
                for count in 0..15 {
                    let word = encoder.encode(count);
                    assert_eq!(encoder.decode(word), Some(count));
                    assert_eq!(word.count_ones() % 2, u32::from(parity == Parity::Odd));
                    (0..64).for_each(|bit| assert_eq!(encoder.decode(word ^ 1 << bit), None, "{count}, bit {bit}"));
                }
            }
        }
        let largest = Absolute { parity: Some(Parity::Odd), ..Absolute::single_turn(1 << 31) };
        let largest = Absolute { turns: 1 << 31, ..largest };
        assert!(largest.is_sound());
        for count in [0, 1, (1 << 62) - 1] {
            assert_eq!(largest.decode(largest.encode(count)), Some(count));
        }
    }

    proptest! {
        #[test]
        fn every_count_comes_back_and_gray_steps_change_one_bit(
            steps in 2_u32..=u32::MAX, turns in 1_u32..=u32::MAX, omitted in 0_u32..1 << 20, count in any::<i64>(),
            gray in any::<bool>(), parity in prop::option::of(prop_oneof![Just(Parity::Even), Just(Parity::Odd)]),
        ) {
            let code = if gray { WordCode::Gray } else { WordCode::Binary };
            let encoder = Absolute { turns, code, parity, omitted, ..Absolute::single_turn(steps) };
            prop_assume!(encoder.is_sound());
            let within = count.rem_euclid(encoder.words());
            prop_assert_eq!(encoder.decode(encoder.encode(count)), Some(within));
            if gray && parity.is_none() && within + 1 < encoder.words() {
                prop_assert_eq!((encoder.encode(within) ^ encoder.encode(within + 1)).count_ones(), 1);
            }
        }
    }
}
