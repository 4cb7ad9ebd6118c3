//! Registration marks of one side in a cycle.

use crate::drive::MAX_LATCHES;
use crate::position::Position;

/// Marks of one side in a cycle: distance to the present position (inc) and time (ns).
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Seen {
    pub(in crate::axis) marks: [(Position, u64); MAX_LATCHES],
    pub(in crate::axis) count: usize,
}

impl Seen {
    pub(in crate::axis) fn new() -> Self {
        Self { marks: [(Position::ZERO, 0); MAX_LATCHES], count: 0 }
    }

    pub(in crate::axis) fn push(&mut self, before: Position, instant_ns: u64) {
        if let Some(free) = self.marks.get_mut(self.count) {
            *free = (before, instant_ns);
            self.count += 1;
        }
    }

    pub(in crate::axis) fn sorted(&mut self) -> &[(Position, u64)] {
        let marks = self.marks.get_mut(..self.count).unwrap_or(&mut []);
        marks.sort_unstable_by_key(|(_, instant)| *instant);
        marks
    }
}
