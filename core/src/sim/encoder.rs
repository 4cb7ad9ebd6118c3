//! Simulated encoder of section `encoders`.
//!
//! Law      count = travel of the drive that turns it + slip; its index is at each multiple of `every`; counts of a
//!          scenario replace this travel for index pulses and marks
//! Source   MACS-ENC-12, WF-INC-01, WF-MON-01, -02

use super::driven::ScenarioCount;
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
    /// Index of the drive that turns it.
    drive: Option<usize>,
    /// Position in this cycle and in the previous one.
    way: i64,
    before: i64,
    /// Surplus counts.
    slip: i64,
    index_lost: bool,
    epoch: u32,
    driven: ScenarioCount,
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
            driven: ScenarioCount::default(),
        }
    }

    pub(super) fn drive(&self) -> Option<usize> {
        self.drive
    }

    /// Turns the encoder to the position of its drive.
    pub(super) fn turn_to(&mut self, way: i64) {
        self.way = way;
    }

    /// Returns its position, without slip.
    pub(super) fn way(&self) -> i64 {
        self.driven.travel().map_or(self.way, |(_, to)| to)
    }

    /// Sets the counts of the next cycle, in the form of its process data.
    pub(super) fn replace_count(&mut self, raw: i64) {
        self.driven.give(raw);
    }

    /// Returns true if its position has changed in this cycle without motion.
    pub(super) fn is_elsewhere(&self) -> bool {
        self.driven.has_jumped()
    }

    /// Adds `by` counts: an encoder without a drive is turned, otherwise it slips.
    pub(super) fn jump(&mut self, by: i64) {
        match self.drive {
            None => self.way = self.way.wrapping_add(by),
            Some(_) => self.slip = self.slip.wrapping_add(by),
        }
    }

    /// Adds `by` counts without turning the encoder.
    pub(super) fn slip(&mut self, by: i64) {
        self.slip = self.slip.wrapping_add(by);
    }

    /// Restarts the encoder after a loss of power: it counts from 0 again.
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
        // Given counts are the reported ones, including any slip.
        let (from, to, slip) = match self.driven.travel() {
            Some((from, to)) => (from, to, 0),
            None => (before, self.way, self.slip),
        };
        let passed = self.fixtures.index_passed(from, to).filter(|_| !self.index_lost);
        EncoderInput {
            count: self.word.next_word(self.way.wrapping_add(self.slip)),
            epoch: self.epoch,
            // An incremental encoder detects a broken line by its tracks; a serial one sends invalid data.
            valid: !self.word.is_broken(),
            index: passed.map(|place| self.word.of(place.wrapping_add(slip))),
        }
    }
}

/// The default form: counts without encoding.
impl Default for Word {
    fn default() -> Self {
        Self::new(Form::Incremental(64))
    }
}
