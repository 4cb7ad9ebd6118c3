//! The order of the axes: a leader before its followers, else as in the file.

use super::Machine;
use crate::object::{AxisSet, Leader};

impl Machine {
    /// Would axis `follower` follow itself through `leader`? Counted are the couplings there are and those that were asked for
    /// in this cycle: whichever of them is refused in the end, no loop can be left.
    pub(super) fn closes_loop(&self, follower: u16, leader: Leader) -> bool {
        let Leader::AxisCommand(first) = leader else { return false };
        let mut reached = AxisSet::one(first);
        loop {
            let before = reached;
            for axis in before.iter() {
                let index = usize::from(axis);
                let asked = self.couplings.get(index).copied().flatten();
                let present = self.state.axes.get(index).and_then(|axis| axis.leader());
                for leader in [asked, present].into_iter().flatten() {
                    if let Leader::AxisCommand(next) = leader {
                        reached.insert(next);
                    }
                }
            }
            if reached == before {
                return reached.contains(follower);
            }
        }
    }

    /// Sorts the axes by [`couplings`](Self::couplings), which have no loop.
    pub(super) fn sort_axes(&mut self) {
        let mut placed = AxisSet::EMPTY;
        let mut count = 0;
        for index in 0..self.state.axes.len() as u16 {
            // From the axis up to the first leader that stands already: that many places, filled from the back.
            let chain = |axis: u16| match self.couplings.get(usize::from(axis)).copied().flatten() {
                Some(Leader::AxisCommand(leader)) => Some(leader),
                _ => None,
            };
            let mut length = 0;
            let mut next = Some(index);
            while let Some(axis) = next.filter(|&axis| !placed.contains(axis) && length < self.state.axes.len()) {
                length += 1;
                next = chain(axis);
            }
            let mut next = Some(index);
            for place in (count..count + length).rev() {
                if let (Some(axis), Some(slot)) = (next, self.state.order.get_mut(place)) {
                    *slot = axis;
                    placed.insert(axis);
                    next = chain(axis);
                }
            }
            count += length;
        }
    }
}
