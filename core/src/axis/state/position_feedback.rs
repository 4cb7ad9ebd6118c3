//! The actual position of an axis, and the counts from which it follows.

use crate::encoder::{Lead, Reader};
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// The actual position of an axis, and its reader.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C)]
pub(in crate::axis) struct PositionFeedback {
    actual: Lead,
    counter: Reader,
    /// Counts of its coordinate minus raw count, both in the direction of the drive.
    origin: i64,
}

impl PositionFeedback {
    /// Returns the state before the first reading. The position of a virtual axis is always valid.
    pub(in crate::axis) fn new(counter: Reader, is_virtual: bool) -> Self {
        Self { actual: Lead { valid: is_virtual, ..Lead::default() }, counter, origin: 0 }
    }

    /// Returns the actual position as its followers see it.
    #[inline]
    pub(in crate::axis) fn lead(&self) -> Lead {
        self.actual
    }

    #[inline]
    pub(in crate::axis) fn position(&self) -> Position {
        self.actual.position
    }

    /// Returns the change of the position in this cycle.
    #[inline]
    pub(in crate::axis) fn change(&self) -> Position {
        self.actual.change
    }

    /// Returns the actual velocity (inc/s).
    #[inline]
    pub(in crate::axis) fn velocity(&self) -> f64 {
        self.actual.velocity
    }

    /// Whether the position is valid.
    #[inline]
    pub(in crate::axis) fn is_valid(&self) -> bool {
        self.actual.valid
    }

    #[inline]
    pub(in crate::axis) fn counter(&self) -> &Reader {
        &self.counter
    }

    #[inline]
    pub(in crate::axis) fn counter_mut(&mut self) -> &mut Reader {
        &mut self.counter
    }

    /// Returns counts of the coordinate minus raw count, both in the direction of the drive.
    #[inline]
    pub(in crate::axis) fn origin(&self) -> i64 {
        self.origin
    }

    /// Sets the origin from the raw count that belongs to the counter of this cycle.
    #[inline]
    pub(in crate::axis) fn set_origin_at(&mut self, count: i64) {
        self.origin = self.counter.position().wrapping_sub(count);
    }

    /// Sets the actual position of this cycle.
    #[inline]
    pub(in crate::axis) fn show(&mut self, actual: Lead) {
        self.actual = actual;
    }

    /// Adds a motion that its counts do not show (inc, inc/s).
    pub(in crate::axis) fn add_motion(&mut self, change: Position, velocity: f64) {
        self.actual.change += change;
        self.actual.velocity += velocity;
    }

    /// Mirrors the position: the counting direction was changed.
    #[inline]
    pub(in crate::axis) fn mirror(&mut self) {
        self.actual.position = -self.actual.position;
    }

    /// Moves the coordinate by `by`, and its counts by `counts` in the direction of the drive; the axis does not move.
    pub(in crate::axis) fn shift(&mut self, by: Position, counts: i64) {
        self.counter.shift(counts);
        self.origin = self.origin.wrapping_add(counts);
        self.actual.position += by;
    }
}
