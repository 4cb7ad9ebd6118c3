//! State of a coupling by marks of a cam.

use super::seen_marks::Seen;
use crate::position::Position;
use crate::sync::marker::FROM_MARK;
use serde::{Deserialize, Serialize};

/// Largest number of waiting marks, and of periods between sensor and cam.
pub(in crate::axis) const MOST_WAITING: usize = 8;

/// State of a coupling by marks of a cam.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::axis) struct CamMarks {
    /// Travel since each mark that waits for its period, the oldest first.
    waiting: [Position; MOST_WAITING],
    count: u8,
    /// Position of the side of the cam in the cycle before.
    pub(in crate::axis) seen: Option<CamPosition>,
    /// Period of the cam (inc); 0 before the first cycle.
    pub(in crate::axis) period: i64,
    /// Correction of the master in the cycle before.
    pub given: Position,
    /// Whether the master still waits for its first mark.
    pub holds: bool,
}

/// Position of the side of a cam in its period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct CamPosition {
    /// Distance after its own mark, from 0 to a period (inc).
    pub(in crate::axis) past: f64,
    /// Period, and distance of the sensor (inc).
    pub(in crate::axis) by: (i64, i64),
}

impl CamPosition {
    /// Returns the distance after the mark of the cam (inc) if the side has passed that mark in moving by `change` from
    /// `before`. Each mark is passed once, whatever the rounding of the distances.
    pub(in crate::axis) fn passed(self, before: Option<Self>, change: f64) -> Option<Position> {
        let period = self.by.0 as f64;
        let before = before.filter(|before| before.by == self.by)?;
        let periods = libm::rint((before.past + change - self.past) / period);
        let past = if periods < 0.0 { self.past - period } else { self.past };
        (periods != 0.0).then(|| Position::from_f64(past))
    }
}

/// The cam in this cycle as one of the two sides of marker synchronization.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct CamSide {
    /// Distance between marks (inc of their side).
    pub(in crate::axis) period: i64,
    /// Distance by which a mark waits for its period (inc), in direction `sense`, 1 or -1.
    pub(in crate::axis) wait: i64,
    pub(in crate::axis) sense: f64,
    /// Motion of the side of the cam, and the position of its own mark if it was passed in this cycle.
    pub(in crate::axis) change: Position,
    pub(in crate::axis) mark: Option<Position>,
}

impl CamMarks {
    pub(in crate::axis) fn new(start: i64) -> Self {
        Self { holds: start == FROM_MARK, ..Self::default() }
    }

    /// Returns the marks of a side that moves by `change`, each after its waiting distance, and the number of marks for
    /// which there was no room. A mark that has moved back across its sensor is dropped.
    pub(in crate::axis) fn delayed(
        &mut self,
        mut seen: Seen,
        change: Position,
        side: &CamSide,
        now_ns: u64,
    ) -> (Seen, u32) {
        let wait = Position::whole(side.wait);
        if wait == Position::ZERO {
            self.count = 0;
            return (seen, 0);
        }
        let along = |way: Position| if side.sense < 0.0 { -way } else { way };
        let mut passed = Seen::new();
        let mut kept = [Position::ZERO; MOST_WAITING];
        let (mut count, mut lost) = (0, 0);
        let waiting = self.waiting.iter().take(self.count.into()).map(|way| *way + change);
        for way in waiting.chain(seen.sorted().iter().map(|(before, _)| *before)) {
            let over = along(way) - wait;
            if over >= Position::ZERO {
                passed.push(along(over), now_ns);
            } else if along(way) < Position::ZERO {
                continue;
            } else if let Some(free) = kept.get_mut(count) {
                *free = way;
                count += 1;
            } else {
                lost += 1;
            }
        }
        (self.waiting, self.count) = (kept, count as u8);
        (passed, lost)
    }

    /// Returns the period of the cam (inc) if it is known.
    pub(in crate::axis) fn period(&self) -> Option<i64> {
        Some(self.period).filter(|period| *period > 0)
    }

    /// Forgets the position and the waiting marks.
    pub(in crate::axis) fn forget(&mut self) {
        (self.count, self.seen) = (0, None);
    }

    pub(in crate::axis) fn is_sound(&self) -> bool {
        usize::from(self.count) <= MOST_WAITING
            && self.waiting.iter().all(|way| way.is_legal())
            && self.given.is_legal()
            && self.seen.is_none_or(|seat| seat.past.is_finite())
    }
}
