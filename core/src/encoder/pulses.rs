//! Supervision of the pulses of an incremental encoder by its index.
//!
//! Law      at each index pulse the count since the last one is one turn (same direction) or 0 (turned back): what is more or
//!          less adds up, and beyond the tolerance pulses are lost or too many. An index that is overdue is judged as if it
//!          came now: nobody waits for one that stays away
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
    /// How far the encoder has gone on in that direction (inc).
    beyond: i64,
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
        let forward = change >= 0;
        let off = match (self.last, mark) {
            (Some(last), Some(mark)) => {
                self.deviation = self.deviation.saturating_add(last.deviation(mark, forward, change, check));
                self.deviation
            }
            (Some(last), None) => self.deviation.saturating_add(last.overdue(position, every)),
            (None, _) => 0,
        };
        if off.saturating_abs() > tolerance {
            *self = Self::default();
            return Some(off);
        }
        match (mark, &mut self.last) {
            (Some(mark), _) => {
                let ahead = position.wrapping_sub(mark);
                let beyond = if forward { ahead } else { 0_i64.wrapping_sub(ahead) };
                self.last = Some(Mark { position: mark, forward, beyond: beyond.max(0) });
            }
            (None, Some(last)) => last.beyond = last.beyond.max(last.ahead(position)),
            (None, None) => {}
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
    fn deviation(&self, mark: i64, forward: bool, change: i64, check: &PulseCheck) -> i64 {
        let PulseCheck { every, tolerance } = *check;
        let every = every.max(1);
        let way = mark.wrapping_sub(self.position);
        let turn = if forward { every } else { -every };
        let expected = if forward != self.forward {
            // Turned on the index itself, its pulse does not come again: the next one is that of the turn before.
            let on_it = self.beyond <= tolerance && (way - turn).saturating_abs() < way.saturating_abs();
            if on_it { turn } else { 0 }
        } else if change.saturating_abs() >= every {
            // Several turns in a cycle: only the last pulse of them is told.
            let turns = way.saturating_add(way.signum().saturating_mul(every / 2)) / every;
            turns.saturating_mul(every)
        } else {
            turn
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
