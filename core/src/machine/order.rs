//! The order of the axes: a leader before its followers, else as in the file.

use super::Machine;
use crate::object::Leader;

impl Machine {
    /// Would axis `follower` follow itself through `leader`, given who follows whom?
    pub(super) fn closes_loop(&self, follower: u16, leader: Leader) -> bool {
        let mut next = Some(leader);
        // No chain is longer than there are axes.
        for _ in 0..=self.axes.len() {
            match next {
                Some(Leader::AxisCommand(axis)) if axis == follower => return true,
                Some(Leader::AxisCommand(axis)) => {
                    next = self.couplings.get(usize::from(axis)).copied().flatten();
                }
                _ => return false,
            }
        }
        true
    }

    /// Sorts the axes by [`couplings`](Self::couplings), which have no loop.
    pub(super) fn sort_axes(&mut self) {
        let mut placed = crate::object::AxisSet::EMPTY;
        let mut count = 0;
        for index in 0..self.axes.len() as u16 {
            // From the axis up to the first leader that stands already: that many places, filled from the back.
            let chain = |axis: u16| match self.couplings.get(usize::from(axis)).copied().flatten() {
                Some(Leader::AxisCommand(leader)) => Some(leader),
                _ => None,
            };
            let mut length = 0;
            let mut next = Some(index);
            while let Some(axis) = next.filter(|&axis| !placed.contains(axis) && length < self.axes.len()) {
                length += 1;
                next = chain(axis);
            }
            let mut next = Some(index);
            for place in (count..count + length).rev() {
                if let (Some(axis), Some(slot)) = (next, self.order.get_mut(place)) {
                    *slot = axis;
                    placed.insert(axis);
                    next = chain(axis);
                }
            }
            count += length;
        }
    }
}
