//! Counts that a scenario puts in the place of those of a source, as far as the plant sees them.
//!
//! Law      way(0) = count(0); way(k) = way(k-1) + the shortest way from count(k-1) to count(k). Index pulses and printed marks lie on
//!          that way. Where it begins and where it ends nothing is passed: that is no motion
//! Source   contract section 5

use super::word::Word;

/// Counts that are given for a cycle, and the way that they have gone.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DrivenCount {
    /// Of the next cycle.
    given: Option<i64>,
    /// From the count of the last cycle to that of this one; none where the source tells its own.
    way: Option<(i64, i64)>,
    /// Place of count 0 when the way began: a slip of the source's own counts later on does not move the given ones.
    origin: i64,
    /// The way has begun, or ended, in this cycle.
    is_elsewhere: bool,
}

impl DrivenCount {
    /// Gives the counts of the next cycle, as the source would tell them.
    pub(super) fn give(&mut self, raw: i64) {
        self.given = Some(raw);
    }

    /// Takes them, once in each cycle; `origin` is the place of count 0 of the source's own counts.
    pub(super) fn step(&mut self, word: &Word, origin: i64) {
        if self.way.is_none() {
            self.origin = origin;
        }
        let next = match (self.given.take(), self.way) {
            (Some(raw), Some((_, last))) => Some((last, word.near(last, raw))),
            (Some(raw), None) => Some(word.count(raw)).map(|first| (first, first)),
            (None, _) => None,
        };
        self.is_elsewhere = next.is_some() != self.way.is_some();
        self.way = next;
    }

    /// The way of this cycle; none where the source tells its own counts.
    pub(super) fn way(&self) -> Option<(i64, i64)> {
        self.way
    }

    /// Place of count 0 of the given counts.
    pub(super) fn origin(&self) -> i64 {
        self.origin
    }

    /// Whether the source is somewhere else in this cycle without having moved there.
    pub(super) fn is_elsewhere(&self) -> bool {
        self.is_elsewhere
    }
}
