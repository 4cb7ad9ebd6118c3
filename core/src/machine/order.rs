//! Execution order of the axes: a leader before its followers, otherwise in file order.
//!
//! An axis follows the leader that it is coupled to, and may at any time follow the master of its reference selector.
//! The latter counts as a coupling, so that no selector ever closes a loop or waits for another order.

use super::Machine;
use crate::axis::Axis;
use crate::config::MachineConfig;
use crate::object::{AxisSet, Leader, MAX_AXES, Object};

/// What a sink or a sum of masters reads.
#[derive(Clone, Copy, Debug, Default)]
struct Dependency {
    /// Axes whose commands it reads.
    axes: AxisSet,
    /// Whether it also reads the virtual master.
    reads_virtual: bool,
}

/// Axes whose commands are read by leaders that read other leaders: fixed by the cell.
#[derive(Debug, Default)]
pub(super) struct Dependencies {
    sinks: Vec<Dependency>,
    sums: Vec<Dependency>,
}

impl Dependencies {
    pub(super) fn of(config: &MachineConfig) -> Self {
        let all = |count: usize, leader: fn(u16) -> Leader| {
            let way = |leader| Dependency {
                axes: config.commanded_axes(leader),
                reads_virtual: config.reads_virtual(leader),
            };
            (0..count as u16).map(|place| way(leader(place))).collect()
        };
        Self { sinks: all(config.slots.len(), Leader::Sink), sums: all(config.masters.len(), Leader::Sum) }
    }

    /// Returns the axes that a leader reads, if the virtual master follows axis `of_virtual`.
    fn commanded(&self, leader: Leader, of_virtual: Option<u16>) -> AxisSet {
        let followed = || of_virtual.map_or(AxisSet::EMPTY, AxisSet::one);
        let way = |ways: &[Dependency], place: u16| {
            let Dependency { axes, reads_virtual } = ways.get(usize::from(place)).copied().unwrap_or_default();
            if reads_virtual { axes.union(&followed()) } else { axes }
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
    /// Returns the axes that `axis` follows or may follow, if the virtual master follows axis `of_virtual`: at present,
    /// by its reference selector, by the function whose sink it is.
    fn leaders(&self, axis: u16, of_virtual: Option<u16>) -> impl Iterator<Item = AxisSet> {
        let function = self.config.writer(Object::Axis(axis)).map(Leader::Sink);
        let axis = self.state.axes.get(usize::from(axis));
        let of = |leader: fn(&Axis) -> Option<Leader>| axis.and_then(leader);
        let leaders = [of(Axis::leader), of(Axis::engaging_leader), of(Axis::master), function];
        leaders.into_iter().flatten().map(move |leader| self.ways.commanded(leader, of_virtual))
    }

    /// Returns true if axis `follower` would follow itself through `leader`. Present couplings count, and those that
    /// may start.
    pub(super) fn closes_loop(&self, follower: u16, leader: Leader) -> bool {
        let of_virtual = self.state.virtual_master.axis();
        let leaders = self.ways.commanded(leader, of_virtual);
        leaders.contains(follower) || self.leaders_of(leaders, of_virtual).contains(follower)
    }

    /// Returns the axes that these axes follow, directly or through others, if the virtual master follows axis
    /// `of_virtual`.
    pub(super) fn leaders_of(&self, axes: AxisSet, of_virtual: Option<u16>) -> AxisSet {
        let (mut reached, mut next) = (AxisSet::EMPTY, axes);
        // Each axis is visited once, and the start axes at most twice.
        while let Some(axis) = next.pop() {
            for leaders in self.leaders(axis, of_virtual) {
                next = next.union(&leaders.difference(&reached));
                reached = reached.union(&leaders);
            }
        }
        reached
    }

    /// Returns the axes that follow `axis` at present, or wait to do so: by its command or its actual position, in a
    /// sum of masters, through a function.
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

    /// Sorts the axes by their dependencies, which contain no loop.
    pub(super) fn sort_axes(&mut self) {
        let of_virtual = self.state.virtual_master.axis();
        let count = self.state.axes.len();
        // Missing axes count as placed, so none is waited for.
        let (mut placed, mut done) = (AxisSet::first(MAX_AXES).difference(&AxisSet::first(count)), 0);
        for index in 0..count as u16 {
            // Goes from the axis up to a leader whose own leaders are all placed; the unused places serve as a stack.
            let mut top = count;
            let mut next = Some(index).filter(|&axis| !placed.contains(axis));
            loop {
                if let Some(axis) = next.filter(|_| done < top) {
                    top -= 1;
                    self.set_place(top, axis);
                }
                let Some(&axis) = self.state.order.get(top) else { break };
                next = self.leaders(axis, of_virtual).find_map(|leaders| leaders.difference(&placed).pop());
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
