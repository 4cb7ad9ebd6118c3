//! The order of the axes: a leader before its followers, else as in the file.
//!
//! An axis follows what it is coupled to, and may at any time follow the master of its reference selector: that counts as if
//! it did, so that no selector ever closes a loop or waits for another order.

use super::Machine;
use crate::axis::Axis;
use crate::object::{AxisSet, Leader, Object};

impl Machine {
    /// The axes that `axis` follows or may follow: at present, by its reference selector, by the function
    /// whose sink it is.
    fn leaders(&self, axis: u16) -> impl Iterator<Item = u16> {
        let function = self.config.writer(Object::Axis(axis)).map(Leader::Sink);
        let axis = self.state.axes.get(usize::from(axis));
        let of = |leader: fn(&Axis) -> Option<Leader>| axis.and_then(leader);
        let leaders = [of(Axis::leader), of(Axis::engaging_leader), of(Axis::master), function];
        leaders.into_iter().flatten().filter_map(|leader| self.commanded(leader))
    }

    /// Through which axis' command a leader closes a loop: what a sink reads of a command counts.
    fn commanded(&self, leader: Leader) -> Option<u16> {
        match leader {
            Leader::Sink(slot) => self.config.commanded_by(slot),
            other => other.commanded(),
        }
    }

    /// Would axis `follower` follow itself through `leader`? Counted are the couplings that there are, and those that may come.
    pub(super) fn closes_loop(&self, follower: u16, leader: Leader) -> bool {
        let Some(first) = self.commanded(leader) else { return false };
        let (mut reached, mut next) = (AxisSet::one(first), AxisSet::one(first));
        // Each axis is looked at once.
        while let Some(axis) = next.pop() {
            for leader in self.leaders(axis) {
                if !reached.contains(leader) {
                    reached.insert(leader);
                    next.insert(leader);
                }
            }
        }
        reached.contains(follower)
    }

    /// Sorts the axes by those that they follow, which have no loop.
    pub(super) fn sort_axes(&mut self) {
        let count = self.state.axes.len();
        let (mut placed, mut done) = (AxisSet::EMPTY, 0);
        for index in 0..count as u16 {
            // From the axis up to a leader whose own leaders all stand: a stack, in the places that are free yet.
            let mut top = count;
            let mut next = Some(index).filter(|&axis| !placed.contains(axis));
            loop {
                if let Some(axis) = next.filter(|_| done < top) {
                    top -= 1;
                    self.set_place(top, axis);
                }
                let Some(&axis) = self.state.order.get(top) else { break };
                next = self.leaders(axis).find(|&leader| !placed.contains(leader) && usize::from(leader) < count);
                if next.is_some() && done < top {
                    continue;
                }
                next = None;
                top += 1;
                if !placed.contains(axis) {
                    placed.insert(axis);
                    self.set_place(done, axis);
                    done += 1;
                }
            }
        }
    }

    fn set_place(&mut self, place: usize, axis: u16) {
        if let Some(slot) = self.state.order.get_mut(place) {
            *slot = axis;
        }
    }
}
