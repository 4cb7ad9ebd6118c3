//! A simulated encoder of section `encoders`.
//!
//! Law      count = way of the drive that turns it + what it has slipped; its index lies at each multiple of `every` of the way
//!          counts of a scenario in the place of these are the way for index pulses and marks
//! Source   MACS-ENC-12, WF-INC-01, WF-MON-01, -02

use super::driven::DrivenCount;
use super::fixtures::{Fixtures, Index};
use super::word::Word;
use crate::config::EncoderConfig;
use crate::drive::EncoderInput;
use crate::encoder::Form;

/// One encoder.
#[derive(Clone, Debug)]
pub(super) struct SimEncoder {
    word: Word,
    fixtures: Fixtures,
    /// Place of the drive that turns it.
    drive: Option<usize>,
    /// Where it stands, and stood in the cycle before.
    way: i64,
    before: i64,
    /// Counts that it has too many.
    slip: i64,
    index_lost: bool,
    epoch: u32,
    driven: DrivenCount,
}

impl SimEncoder {
    pub(super) fn new(config: &EncoderConfig, drive: Option<usize>) -> Self {
        let index = config.check.map(|check| Index { every: check.every, at: 0 });
        Self {
            word: Word::new(config.form),
            fixtures: Fixtures { index, ..Fixtures::default() },
            drive,
            way: 0,
            before: 0,
            slip: 0,
            index_lost: false,
            epoch: 0,
            driven: DrivenCount::default(),
        }
    }

    pub(super) fn drive(&self) -> Option<usize> {
        self.drive
    }

    /// Turns to where its drive stands.
    pub(super) fn turn_to(&mut self, way: i64) {
        self.way = way;
    }

    /// Where it stands, whatever it has slipped.
    pub(super) fn way(&self) -> i64 {
        self.driven.way().map_or(self.way, |(_, to)| to)
    }

    /// Gives the counts of the next cycle, as it would tell them.
    pub(super) fn replace_count(&mut self, raw: i64) {
        self.driven.give(raw);
    }

    /// Whether it stands somewhere else in this cycle without having been turned.
    pub(super) fn is_elsewhere(&self) -> bool {
        self.driven.is_elsewhere()
    }

    /// Reads `by` more counts: one that nobody turns has been turned, else it slips.
    pub(super) fn jump(&mut self, by: i64) {
        match self.drive {
            None => self.way = self.way.wrapping_add(by),
            Some(_) => self.slip = self.slip.wrapping_add(by),
        }
    }

    /// Reads `by` more counts than it was turned.
    pub(super) fn slip(&mut self, by: i64) {
        self.slip = self.slip.wrapping_add(by);
    }

    /// Its power was away: it counts from 0 again.
    pub(super) fn restart(&mut self) {
        self.epoch = self.epoch.wrapping_add(1);
        self.slip = self.way.wrapping_neg();
    }

    pub(super) fn disturb(&mut self, bits: i64, words: u32) {
        self.word.disturb(bits, words);
    }

    pub(super) fn count_by(&mut self, factor: i64) {
        self.word.count_by(factor);
    }

    pub(super) fn cut(&mut self) {
        self.word.cut();
    }

    pub(super) fn lose_index(&mut self) {
        self.index_lost = true;
    }

    pub(super) fn read(&mut self) -> EncoderInput {
        let before = std::mem::replace(&mut self.before, self.way);
        self.driven.step(&self.word, 0);
        // Given counts are what is told: they have slipped already.
        let (from, to, slip) = match self.driven.way() {
            Some((from, to)) => (from, to, 0),
            None => (before, self.way, self.slip),
        };
        let passed = self.fixtures.index_passed(from, to).filter(|_| !self.index_lost);
        EncoderInput {
            count: self.word.tell(self.way.wrapping_add(self.slip)),
            epoch: self.epoch,
            // An incremental encoder has tracks that tell a broken line; a serial one has words that are none.
            valid: !self.word.is_broken(),
            index: passed.map(|place| self.word.of(place.wrapping_add(slip))),
        }
    }
}

/// Where nothing else is said: counts as they are.
impl Default for Word {
    fn default() -> Self {
        Self::new(Form::Incremental(64))
    }
}
