//! The order of the axes: a leader before its followers, else as in the file.
//!
//! An axis follows what it is coupled to, and may at any time follow the master of its reference selector: that counts as if
//! it did, so that no selector ever closes a loop or waits for another order.

use super::Machine;
use crate::axis::Axis;
use crate::config::MachineConfig;
use crate::object::{AxisSet, Leader, MAX_AXES, Object};

/// Through which axes' commands leaders close a loop that read others: fixed by the cell.
#[derive(Debug, Default)]
pub(super) struct Ways {
    sinks: Vec<AxisSet>,
    sums: Vec<AxisSet>,
}

impl Ways {
    pub(super) fn of(config: &MachineConfig) -> Self {
        let all = |count: usize, leader: fn(u16) -> Leader| {
            (0..count as u16).map(|place| config.commanded(leader(place))).collect()
        };
        Self { sinks: all(config.slots.len(), Leader::Sink), sums: all(config.masters.len(), Leader::Sum) }
    }

    fn commanded(&self, leader: Leader) -> AxisSet {
        let way = |ways: &[AxisSet], place: u16| ways.get(usize::from(place)).copied().unwrap_or_default();
        match leader {
            Leader::AxisCommand(axis) => AxisSet::one(axis),
            Leader::Sink(slot) => way(&self.sinks, slot),
            Leader::Sum(place) => way(&self.sums, place),
            Leader::AxisActual(_) | Leader::Encoder(_) | Leader::Simulated(_) => AxisSet::EMPTY,
        }
    }
}

impl Machine {
    /// The axes that `axis` follows or may follow: at present, by its reference selector, by the function
    /// whose sink it is.
    fn leaders(&self, axis: u16) -> impl Iterator<Item = AxisSet> {
        let function = self.config.writer(Object::Axis(axis)).map(Leader::Sink);
        let axis = self.state.axes.get(usize::from(axis));
        let of = |leader: fn(&Axis) -> Option<Leader>| axis.and_then(leader);
        let leaders = [of(Axis::leader), of(Axis::engaging_leader), of(Axis::master), function];
        leaders.into_iter().flatten().map(|leader| self.ways.commanded(leader))
    }

    /// Would axis `follower` follow itself through `leader`? Counted are the couplings that there are, and those that may come.
    pub(super) fn closes_loop(&self, follower: u16, leader: Leader) -> bool {
        let mut reached = self.ways.commanded(leader);
        let mut next = reached;
        // Each axis is looked at once.
        while let Some(axis) = next.pop() {
            for leaders in self.leaders(axis) {
                next = next.with(&leaders.without(&reached));
                reached = reached.with(&leaders);
            }
        }
        reached.contains(follower)
    }

    /// Sorts the axes by those that they follow, which have no loop.
    pub(super) fn sort_axes(&mut self) {
        let count = self.state.axes.len();
        // Of those that there are not none has to be waited for.
        let (mut placed, mut done) = (AxisSet::first(MAX_AXES).without(&AxisSet::first(count)), 0);
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
                next = self.leaders(axis).find_map(|leaders| leaders.without(&placed).pop());
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
