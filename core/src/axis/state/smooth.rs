//! State of a smooth start of a coupling by marks.

use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Time over which the velocity of the master is smoothed (ms).
pub(in crate::axis) const MEAN_TIME: f64 = 50.0;

/// Share of its velocity by which a master may change on the curve.
const MOST_CHANGE: f64 = 0.1;

/// Difference between a smooth start and the start that replaces it.
const FALLS_BACK_BY: i64 = 2;

/// Whether that SYNCMSTART is the smooth one.
pub(in crate::axis) fn is_smooth(start: i64) -> bool {
    start % 1_000 == 7
}

/// Returns the SYNCMSTART that replaces a smooth one.
pub(crate) fn fallback(start: i64) -> i64 {
    start.saturating_sub(FALLS_BACK_BY)
}

/// Smoothed velocity of a master (inc per cycle).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Mean {
    pub(in crate::axis) velocity: f64,
    /// Time since its start (ms), at most MEAN_TIME.
    pub(in crate::axis) since: f64,
}

impl Mean {
    pub(in crate::axis) fn step(&mut self, change: f64, cycle_ms: f64) {
        self.since = (self.since + cycle_ms).min(MEAN_TIME);
        // At first a mean of all values.
        self.velocity += (change - self.velocity) * (cycle_ms / self.since).min(1.0);
    }

    fn is_sound(&self) -> bool {
        self.velocity.is_finite() && (0.0..=MEAN_TIME).contains(&self.since)
    }

    /// Whether it is slower than an increment in that time.
    pub(in crate::axis) fn is_at_rest(&self, cycle_ms: f64) -> bool {
        self.velocity.abs() * MEAN_TIME < cycle_ms
    }
}

/// An active curve.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Curve {
    pub(in crate::axis) mean: Mean,
    /// Velocity of the master at the start (inc per cycle).
    pub(in crate::axis) velocity: f64,
}

impl Curve {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.mean.is_sound() && self.velocity.is_finite()
    }

    /// Advances in a cycle in which the master moves by `change` (inc). Returns false if its velocity has changed too
    /// much.
    pub(in crate::axis) fn step(&mut self, change: f64, cycle_ms: f64) -> bool {
        self.mean.step(change, cycle_ms);
        (self.mean.velocity - self.velocity).abs() <= self.velocity.abs() * MOST_CHANGE
    }
}

/// State of waiting for a smooth start.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Smooth {
    pub(in crate::axis) start: i64,
    /// Distances of master and axis since their last marks.
    pub(in crate::axis) master: Option<Position>,
    pub(in crate::axis) slave: Option<Position>,
    pub(in crate::axis) mean: Mean,
    /// Travel of the master during the wait (inc), without sign.
    pub(in crate::axis) waited: f64,
}

impl Smooth {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        let ways = [self.master, self.slave].into_iter().flatten().all(Position::is_legal);
        ways && self.mean.is_sound() && self.waited >= 0.0 && self.waited.is_finite() && is_smooth(self.start)
    }
}
