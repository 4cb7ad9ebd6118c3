//! Unwraps counts of any width, number of steps and number of turns.

use serde::{Deserialize, Serialize};

/// Range at which the counts of a source wrap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Circle {
    /// At 2^bits counts, 1 to 64 bits.
    Bits(u32),
    /// At that number of counts, 1 to 2^62.
    Steps(i64),
    /// Never.
    Line,
}

impl Circle {
    /// Returns the shortest distance from `last` to `count` (inc). If both directions are equal: the negative one for
    /// bits and the positive one for steps.
    pub fn shortest_distance(self, last: i64, count: i64) -> i64 {
        match self {
            // Shifting the difference to the top and back extends its sign; wrapping is intended.
            Self::Bits(bits) => {
                let spare = 64 - bits.clamp(1, 64);
                count.wrapping_sub(last).wrapping_shl(spare).wrapping_shr(spare)
            }
            Self::Steps(steps) => {
                let steps = steps.clamp(1, 1 << 62);
                // Both are below 2^62, so that their difference is exact.
                let ahead = (count.rem_euclid(steps) - last.rem_euclid(steps)).rem_euclid(steps);
                if ahead > steps - ahead { ahead - steps } else { ahead }
            }
            Self::Line => count.saturating_sub(last),
        }
    }
}

/// Unwraps the counts of one source.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Counter {
    circle: Circle,
    last: Option<(i64, u32)>,
    position: i64,
}

impl Counter {
    /// Returns a counter for a source of 1 to 64 bits.
    pub fn new(bits: u32) -> Self {
        Self::on(Circle::Bits(bits.clamp(1, 64)))
    }

    /// Returns a counter for a source with that range.
    pub fn on(circle: Circle) -> Self {
        Self { circle, last: None, position: 0 }
    }

    /// Returns the range of its source.
    pub fn circle(&self) -> Circle {
        self.circle
    }

    /// Adds the counts of this cycle and returns their change (inc); the first counts are the position itself.
    #[inline]
    pub fn take(&mut self, count: i64, epoch: u32) -> i64 {
        let change = match self.last {
            Some((last, same)) if same == epoch => self.circle.shortest_distance(last, count),
            Some(_) => 0,
            None => {
                self.position = count;
                0
            }
        };
        self.last = Some((count, epoch));
        // Beyond 2^63 the position wraps, as its source would.
        self.position = self.position.wrapping_add(change);
        change
    }

    /// Returns the counts of the last cycle and their epoch; none before the first ones.
    pub fn last(&self) -> Option<(i64, u32)> {
        self.last
    }

    /// Returns the position of raw counts near the last ones (inc).
    pub fn locate(&self, count: i64) -> i64 {
        let (last, _) = self.last.unwrap_or((count, 0));
        self.position.wrapping_add(self.circle.shortest_distance(last, count))
    }

    /// Increases the position by `by` (inc), for a new coordinate. This is no motion.
    pub fn shift(&mut self, by: i64) {
        self.position = self.position.wrapping_add(by);
    }

    /// Adds a change (inc) that was counted elsewhere.
    pub fn advance(&mut self, change: i64) {
        self.position = self.position.wrapping_add(change);
    }

    /// Returns the position (inc).
    pub fn position(&self) -> i64 {
        self.position
    }
}
