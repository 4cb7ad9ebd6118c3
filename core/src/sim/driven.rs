//! Counts of a scenario that replace those of a source in the plant.
//!
//! Law      way(0) = count(0); way(k) = way(k-1) + the shortest distance from count(k-1) to count(k). Index pulses and
//!          printed marks are on that path. The change to the counts of the scenario and back is no motion, and passes
//!          nothing
//! Source   contract section 5

use super::word::Word;

/// Counts given for a cycle, and their accumulated travel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ScenarioCount {
    /// Counts of the next cycle.
    given: Option<i64>,
    /// Counts of the last cycle and of this one; `None` while the source uses its own counts.
    way: Option<(i64, i64)>,
    /// Position of count 0 when the counts were first given: a later slip of the own counts of the source does not
    /// shift the given ones.
    origin: i64,
    /// Whether the given counts began or ended in this cycle.
    is_elsewhere: bool,
}

impl ScenarioCount {
    /// Sets the counts of the next cycle, in the form of the source.
    pub(super) fn give(&mut self, raw: i64) {
        self.given = Some(raw);
    }

    /// Applies the given counts, once per cycle; `origin` is the position of count 0 of the own counts of the source.
    pub(super) fn step(&mut self, word: &Word, origin: i64) {
        if self.way.is_none() {
            self.origin = origin;
        }
        let next = match (self.given.take(), self.way) {
            (Some(raw), Some((_, last))) => Some((last, word.count_near(last, raw))),
            (Some(raw), None) => Some(word.count(raw)).map(|first| (first, first)),
            (None, _) => None,
        };
        self.is_elsewhere = next.is_some() != self.way.is_some();
        self.way = next;
    }

    /// Returns the travel of this cycle; `None` while the source uses its own counts.
    pub(super) fn travel(&self) -> Option<(i64, i64)> {
        self.way
    }

    /// Returns the position of count 0 of the given counts.
    pub(super) fn origin(&self) -> i64 {
        self.origin
    }

    /// Returns true if the position of the source has changed in this cycle without motion.
    pub(super) fn has_jumped(&self) -> bool {
        self.is_elsewhere
    }
}
