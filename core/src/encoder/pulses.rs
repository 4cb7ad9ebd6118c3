//! Supervises the pulses of an incremental encoder by its index.
//!
//! Law      at each index pulse the count since the last one must be one turn. If the encoder has reversed in between,
//!          it must be a turn in either direction or 0, whichever is nearest. Deviations add up, and beyond the
//!          tolerance pulses are missing or surplus. An overdue index is checked as if it came now, so that a missing
//!          one is detected. An index that comes again without any count means that counts are missing
//! Reads    position and change of the cycle, the position of its index pulse
//! Source   WF-MON-02, WF-MON-07, W12

use serde::{Deserialize, Serialize};

/// Settings of the supervision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PulseCheck {
    /// Increments between two index pulses, above 0.
    pub every: i64,
    /// Largest sum of deviations (inc), from 0 on.
    pub tolerance: i64,
}

/// The last index pulse.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Mark {
    position: i64,
    /// Whether it was passed in positive direction.
    forward: bool,
    /// Whether the encoder has moved against that direction since: the next pulse may be the same one.
    turned: bool,
}

/// Motion of an encoder in a cycle.
#[derive(Clone, Copy)]
struct CycleMotion {
    position: i64,
    change: i64,
}

impl CycleMotion {
    /// Whether it moved in that direction. Without a net change it moved in neither.
    fn moves_in(self, forward: bool) -> bool {
        if forward { self.change > 0 } else { self.change < 0 }
    }

    /// Whether a mark of the cycle was passed once, by motion in one direction. Any other mark was passed before the
    /// encoder reversed within the cycle. A mark from which the motion started was not reached by leaving it.
    fn passes(self, mark: i64) -> bool {
        let (ahead, before) =
            (self.position.wrapping_sub(mark), self.change.wrapping_sub(self.position.wrapping_sub(mark)));
        // `ahead` is the distance moved after the mark, `before` that up to it.
        match self.change {
            0 => ahead == 0,
            1.. => ahead >= 0 && before > 0,
            _ => ahead <= 0 && before < 0,
        }
    }
}

/// State of the supervision.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Pulses {
    /// None before the first index pulse.
    last: Option<Mark>,
    deviation: i64,
}

impl Pulses {
    /// Advances by one cycle. Too large a deviation (inc) is reported once, and the supervision starts again with the
    /// next index pulse.
    pub fn step(&mut self, check: &PulseCheck, position: i64, change: i64, mark: Option<i64>) -> Option<i64> {
        let PulseCheck { every, tolerance } = *check;
        let every = every.max(1);
        let way = CycleMotion { position, change };
        if let Some(last) = &mut self.last {
            last.turned |= way.moves_in(!last.forward) || mark.is_some_and(|mark| !way.passes(mark));
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
            // A mark that was passed and left again within the cycle may come again in either direction.
            self.last = Some(Mark { position: mark, forward, turned: !way.passes(mark) });
        }
        None
    }

    /// Increases all positions by `by` (inc).
    pub fn shift(&mut self, by: i64) {
        if let Some(last) = &mut self.last {
            last.position = last.position.wrapping_add(by);
        }
    }

    /// Returns the sum of deviations so far (inc).
    pub fn deviation(&self) -> i64 {
        self.deviation
    }
}

impl Mark {
    /// Returns the distance of `position` after it, in its direction.
    fn ahead(&self, position: i64) -> i64 {
        let way = position.wrapping_sub(self.position);
        if self.forward { way } else { 0_i64.wrapping_sub(way) }
    }

    /// Returns the surplus distance to the next index pulse.
    fn deviation(&self, mark: i64, change: i64, every: i64) -> i64 {
        let way = mark.wrapping_sub(self.position);
        // In a cycle of several turns only the last pulse is reported.
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

    /// Returns the surplus distance to an index pulse that came now; 0 before one is due.
    fn overdue(&self, position: i64, every: i64) -> i64 {
        let ahead = self.ahead(position);
        // After a reversal the next mark is the same index, or the one before it if the encoder reversed on it.
        let late = if ahead >= 0 { ahead - every } else { (0_i64.saturating_sub(ahead)).saturating_sub(every) };
        let along = if ahead >= 0 { late } else { -late };
        match late {
            ..=0 => 0,
            _ if self.forward => along,
            _ => -along,
        }
    }
}
