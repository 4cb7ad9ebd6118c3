//! Unwrapping of counts: no width, no number of steps and no number of turns leaves a trace.

use serde::{Deserialize, Serialize};

/// Where the counts of a source begin anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Circle {
    /// After 2^bits counts, 1 to 64 bits.
    Bits(u32),
    /// After that many counts, 1 to 2^62.
    Steps(i64),
    /// Nowhere: the counts are a line.
    Line,
}

impl Circle {
    /// The shortest way from `last` to `count` (inc); of two that are as short, the negative one of bits and the positive one of
    /// steps.
    pub fn way(self, last: i64, count: i64) -> i64 {
        match self {
            // Shifting the difference to the top and back extends its sign; wrapping is the point.
            Self::Bits(bits) => {
                let spare = 64 - bits.clamp(1, 64);
                count.wrapping_sub(last).wrapping_shl(spare).wrapping_shr(spare)
            }
            Self::Steps(steps) => {
                let steps = steps.clamp(1, 1 << 62);
                // Both below 2^62, so that their difference is exact.
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
    /// A source of counts of 1 to 64 bits.
    pub fn new(bits: u32) -> Self {
        Self::on(Circle::Bits(bits.clamp(1, 64)))
    }

    /// A source whose counts begin anew there.
    pub fn on(circle: Circle) -> Self {
        Self { circle, last: None, position: 0 }
    }

    /// Where the counts of its source begin anew.
    pub fn circle(&self) -> Circle {
        self.circle
    }

    /// Takes the counts of this cycle and returns their change (inc); the first counts are the position itself.
    #[inline]
    pub fn take(&mut self, count: i64, epoch: u32) -> i64 {
        let change = match self.last {
            Some((last, same)) if same == epoch => self.circle.way(last, count),
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

    /// The counts of the last cycle and their epoch; none before the first ones.
    pub fn last(&self) -> Option<(i64, u32)> {
        self.last
    }

    /// The position of raw counts near the last ones (inc).
    pub fn locate(&self, count: i64) -> i64 {
        let (last, _) = self.last.unwrap_or((count, 0));
        self.position.wrapping_add(self.circle.way(last, count))
    }

    /// Sets the coordinate anew: what it counts is `by` more from now on (inc). That is no motion.
    pub fn shift(&mut self, by: i64) {
        self.position = self.position.wrapping_add(by);
    }

    /// Moved by so much (inc), as someone else has counted.
    pub fn advance(&mut self, change: i64) {
        self.position = self.position.wrapping_add(change);
    }

    /// The position so far (inc).
    pub fn position(&self) -> i64 {
        self.position
    }
}
