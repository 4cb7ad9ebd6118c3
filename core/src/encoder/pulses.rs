//! Supervision of the pulses of an incremental encoder by its index.
//!
//! Law      at each index pulse the count since the last one is one turn; where the encoder has turned back in between
//!          it is a turn either way or 0, whichever is nearest: what is more or less adds up, and beyond the tolerance
//!          pulses are lost or too many. An index that is overdue is judged as if it came now: nobody waits for one that
//!          stays away. An index that comes again without one count has lost them
//! Reads    position and change of the cycle, the position of its index pulse
//! Source   WF-MON-02, WF-MON-07, W12

use serde::{Deserialize, Serialize};

/// What is supervised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PulseCheck {
    /// Increments between two index pulses, above 0.
    pub every: i64,
    /// Most that may add up (inc), from 0 on.
    pub tolerance: i64,
}

/// The last index pulse.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Mark {
    position: i64,
    /// Direction in which it was passed.
    forward: bool,
    /// The encoder has moved against that direction since: the next pulse may be the same one.
    turned: bool,
}

/// How an encoder moved in a cycle.
#[derive(Clone, Copy)]
struct Way {
    position: i64,
    change: i64,
}

impl Way {
    /// Did it go that way? Without a net change it went neither.
    fn goes(self, forward: bool) -> bool {
        if forward { self.change > 0 } else { self.change < 0 }
    }

    /// Was a mark in the cycle passed once, on a straight way? One that lies elsewhere was passed before the encoder
    /// turned back, all within the cycle. One that it stood on was not reached by leaving it.
    fn passes(self, mark: i64) -> bool {
        let (ahead, before) =
            (self.position.wrapping_sub(mark), self.change.wrapping_sub(self.position.wrapping_sub(mark)));
        // `ahead` is what it moved behind the mark, `before` what it moved up to it.
        match self.change {
            0 => ahead == 0,
            1.. => ahead >= 0 && before > 0,
            _ => ahead <= 0 && before < 0,
        }
    }
}

/// What the index has shown so far.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Pulses {
    /// Nothing is known before the first one.
    last: Option<Mark>,
    deviation: i64,
}

impl Pulses {
    /// One cycle; too much of a deviation (inc) is told once, and the supervision begins anew with the next index pulse.
    pub fn step(&mut self, check: &PulseCheck, position: i64, change: i64, mark: Option<i64>) -> Option<i64> {
        let PulseCheck { every, tolerance } = *check;
        let every = every.max(1);
        let way = Way { position, change };
        if let Some(last) = &mut self.last {
            last.turned |= way.goes(!last.forward) || mark.is_some_and(|mark| !way.passes(mark));
        }
        let off = match (self.last, mark) {
            (Some(last), Some(mark)) => {
                self.deviation = self.deviation.saturating_add(last.deviation(mark, change, every));
                self.deviation
            }
            (Some(last), None) => self.deviation.saturating_add(last.overdue(position, every)),
            (None, _) => 0,
        };
        if off.saturating_abs() > tolerance {
            *self = Self::default();
            return Some(off);
        }
        if let Some(mark) = mark {
            let forward = if change == 0 { self.last.is_none_or(|last| last.forward) } else { change > 0 };
            // Passed and left again within the cycle, it may come again whichever way the encoder goes on.
            self.last = Some(Mark { position: mark, forward, turned: !way.passes(mark) });
        }
        None
    }

    /// Every position is `by` (inc) more from now on.
    pub fn shift(&mut self, by: i64) {
        if let Some(last) = &mut self.last {
            last.position = last.position.wrapping_add(by);
        }
    }

    /// What has added up so far (inc).
    pub fn deviation(&self) -> i64 {
        self.deviation
    }
}

impl Mark {
    /// How far `position` lies behind it, in its direction.
    fn ahead(&self, position: i64) -> i64 {
        let way = position.wrapping_sub(self.position);
        if self.forward { way } else { 0_i64.wrapping_sub(way) }
    }

    /// What the way to the next index pulse has too much.
    fn deviation(&self, mark: i64, change: i64, every: i64) -> i64 {
        let way = mark.wrapping_sub(self.position);
        // In a cycle of several turns only the last pulse of them is told.
        let expected = if self.turned || change.saturating_abs() >= every {
            let turns = way.saturating_add(every / 2).div_euclid(every);
            turns.saturating_mul(every)
        } else if self.forward {
            every
        } else {
            -every
        };
        way.saturating_sub(expected)
    }

    /// What the way to an index pulse that came now would have too much; 0 before one is due.
    fn overdue(&self, position: i64, every: i64) -> i64 {
        let ahead = self.ahead(position);
        // Behind it lies the same index, and the one before it where the encoder turned on it.
        let late = if ahead >= 0 { ahead - every } else { (0_i64.saturating_sub(ahead)).saturating_sub(every) };
        let along = if ahead >= 0 { late } else { -late };
        match late {
            ..=0 => 0,
            _ if self.forward => along,
            _ => -along,
        }
    }
}
