//! The order of the axes: a leader before its followers, else as in the file.
//!
//! An axis follows what it is coupled to, and may at any time follow the master of its reference selector: that counts as if
//! it did, so that no selector ever closes a loop or waits for another order.

use super::Machine;
use crate::axis::Axis;
use crate::config::MachineConfig;
use crate::object::{AxisSet, Leader, MAX_AXES, Object};

/// What a leader reads that reads others.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    /// Axes, by their commands.
    axes: AxisSet,
    /// The virtual master, too.
    reads_virtual: bool,
}

/// Through which axes' commands leaders close a loop that read others: fixed by the cell.
#[derive(Debug, Default)]
pub(super) struct Ways {
    sinks: Vec<Way>,
    sums: Vec<Way>,
}

impl Ways {
    pub(super) fn of(config: &MachineConfig) -> Self {
        let all = |count: usize, leader: fn(u16) -> Leader| {
            let way = |leader| Way { axes: config.commanded(leader), reads_virtual: config.reads_virtual(leader) };
            (0..count as u16).map(|place| way(leader(place))).collect()
        };
        Self { sinks: all(config.slots.len(), Leader::Sink), sums: all(config.masters.len(), Leader::Sum) }
    }

    /// The axes that a leader reads, where the virtual master follows that one.
    fn commanded(&self, leader: Leader, of_virtual: Option<u16>) -> AxisSet {
        let followed = || of_virtual.map_or(AxisSet::EMPTY, AxisSet::one);
        let way = |ways: &[Way], place: u16| {
            let Way { axes, reads_virtual } = ways.get(usize::from(place)).copied().unwrap_or_default();
            if reads_virtual { axes.with(&followed()) } else { axes }
        };
        match leader {
            Leader::AxisCommand(axis) => AxisSet::one(axis),
            Leader::Virtual => followed(),
            Leader::Sink(slot) => way(&self.sinks, slot),
            Leader::Sum(place) => way(&self.sums, place),
            Leader::AxisActual(_) | Leader::Encoder(_) | Leader::Simulated(_) => AxisSet::EMPTY,
        }
    }
}

impl Machine {
    /// The axes that `axis` follows or may follow, where the virtual master follows that one: at present, by its reference selector,
    /// by the function whose sink it is.
    fn leaders(&self, axis: u16, of_virtual: Option<u16>) -> impl Iterator<Item = AxisSet> {
        let function = self.config.writer(Object::Axis(axis)).map(Leader::Sink);
        let axis = self.state.axes.get(usize::from(axis));
        let of = |leader: fn(&Axis) -> Option<Leader>| axis.and_then(leader);
        let leaders = [of(Axis::leader), of(Axis::engaging_leader), of(Axis::master), function];
        leaders.into_iter().flatten().map(move |leader| self.ways.commanded(leader, of_virtual))
    }

    /// Would axis `follower` follow itself through `leader`? Counted are the couplings that there are, and those that may come.
    pub(super) fn closes_loop(&self, follower: u16, leader: Leader) -> bool {
        let of_virtual = self.state.virtual_master.axis();
        let leaders = self.ways.commanded(leader, of_virtual);
        leaders.contains(follower) || self.led_by(leaders, of_virtual).contains(follower)
    }

    /// Whom these axes follow, themselves or through others, where the virtual master follows that one.
    pub(super) fn led_by(&self, axes: AxisSet, of_virtual: Option<u16>) -> AxisSet {
        let (mut reached, mut next) = (AxisSet::EMPTY, axes);
        // Each axis is looked at once, and those that are asked for at most twice.
        while let Some(axis) = next.pop() {
            for leaders in self.leaders(axis, of_virtual) {
                next = next.with(&leaders.without(&reached));
                reached = reached.with(&leaders);
            }
        }
        reached
    }

    /// The axes that follow `axis` at present, or wait to: its command or its actual position, in a sum of masters, through a function.
    pub fn followers(&self, axis: u16) -> AxisSet {
        let of_virtual = self.state.virtual_master.axis();
        let reads = |leader: Leader| {
            leader == Leader::AxisActual(axis) || self.ways.commanded(leader, of_virtual).contains(axis)
        };
        let follows = |(index, other): (u16, &Axis)| {
            let function = self.config.writer(Object::Axis(index)).filter(|_| other.is_led_by_function());
            let leaders = [other.leader(), other.engaging_leader(), function.map(Leader::Sink)];
            (index != axis && leaders.into_iter().flatten().any(reads)).then_some(index)
        };
        (0..).zip(&self.state.axes).filter_map(follows).collect()
    }

    /// Sorts the axes by those that they follow, which have no loop.
    pub(super) fn sort_axes(&mut self) {
        let of_virtual = self.state.virtual_master.axis();
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
                next = self.leaders(axis, of_virtual).find_map(|leaders| leaders.without(&placed).pop());
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
