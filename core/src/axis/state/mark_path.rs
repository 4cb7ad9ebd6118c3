//! State of a coupling by registration marks.

use super::cam_marks::CamMarks;
use super::smooth::{Curve, fallback};
use super::spread::Spread;
use crate::parameter::{MarkSignal, Marks};
use crate::position::Position;
use crate::sync::SyncMode;
use crate::sync::marker::Marker;
use serde::{Deserialize, Serialize};

/// State of a coupling by marks.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct MarkPath {
    pub(in crate::axis) mode: SyncMode,
    pub(in crate::axis) marker: Marker,
    pub(in crate::axis) cam: CamMarks,
    pub(in crate::axis) master: MarkSignal,
    pub(in crate::axis) slave: MarkSignal,
    /// SYNCMSTART at the start of the coupling.
    pub(in crate::axis) start: i64,
    /// Filtered velocity of the master (inc per cycle).
    pub(in crate::axis) velocity: f64,
    pub(in crate::axis) spread: Spread,
    /// Whether the offset does not act yet.
    pub(in crate::axis) offset_waits: bool,
    /// First correction, and sum of all corrections.
    pub(in crate::axis) first: Position,
    pub(in crate::axis) ordered: Position,
    /// Whether extra marks of master and slave have been reported and continue.
    pub(in crate::axis) extra: [bool; 2],
    /// Active smooth start.
    pub(in crate::axis) curve: Option<Curve>,
}

impl MarkPath {
    /// Returns the state for a master that moves by `velocity` (inc) in a cycle.
    pub(in crate::axis) fn new(mode: SyncMode, marks: &Marks, velocity: f64) -> Self {
        let cam = if mode == SyncMode::Marker { CamMarks::default() } else { CamMarks::new(marks.start) };
        Self {
            mode,
            marker: Marker::default(),
            cam,
            master: MarkSignal::decode(marks.master_type),
            slave: MarkSignal::decode(marks.slave_type),
            start: marks.start,
            velocity,
            spread: Spread::default(),
            offset_waits: true,
            first: Position::ZERO,
            ordered: Position::ZERO,
            extra: [false; 2],
            curve: None,
        }
    }

    /// Begins after a smooth start has waited, with the velocity of the master (inc per cycle), on a curve or on its
    /// replacement.
    pub(in crate::axis) fn begin_smooth(&mut self, start: i64, velocity: f64, curve: Option<Curve>) {
        (self.start, self.velocity, self.curve) = (start, velocity, curve);
        if curve.is_none() {
            self.fall_back();
        }
    }

    /// Changes to the start that replaces a smooth start.
    fn fall_back(&mut self) {
        (self.start, self.curve) = (fallback(self.start), None);
    }

    /// Advances a smooth start in a cycle in which the master moves by `change` (inc). If the curve is aborted, returns
    /// its SYNCMSTART. After its end the curve is removed.
    pub(in crate::axis) fn leaves_curve(&mut self, change: f64, cycle_ms: f64, is_under_way: bool) -> Option<i64> {
        let Some(curve) = self.curve.as_mut().filter(|_| is_under_way) else {
            self.curve = None;
            return None;
        };
        let leaves = !curve.step(change, cycle_ms);
        let start = self.start;
        leaves.then(|| {
            self.fall_back();
            start
        })
    }

    pub(in crate::axis) fn is_sound(&self) -> bool {
        self.marker.is_sound()
            && self.first.is_legal()
            && self.ordered.is_legal()
            && self.velocity.is_finite()
            && self.spread.is_sound()
            && self.cam.is_sound()
            && self.curve.is_none_or(|curve| curve.is_sound())
    }

    /// Returns the part of corrections that has not been moved yet.
    pub(in crate::axis) fn remaining_corrections(&self) -> Position {
        self.spread.left()
    }

    /// Returns the active offset if `wanted` is set.
    pub(in crate::axis) fn offset(&self, wanted: i64) -> i64 {
        if self.offset_waits { 0 } else { wanted }
    }
}
