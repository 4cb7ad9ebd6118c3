//! The store of all leads.
//!
//! Law      a lead has the values of its source at t_k as far as the cycle has advanced: encoders, then actual
//!          positions and simulated masters, then sinks, then the command of each axis after its motion. The virtual
//!          master comes before all axes, or after the axis that it follows. A follower reads its lead after that, as
//!          leaders come first.
//!          A sum of several leads is calculated when it is read, from the present values of its members
//! Reads    indices by [`Leader`]; a new kind of lead needs a case there and a list here
//! Refuses  nothing: a leader that does not exist is a lost lead
//! Source   MACS-ENC-10, MACS-SYNC-01

use super::sum::{Sum, times_position};
use crate::encoder::Lead;
use crate::object::Leader;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Leads of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OfAxis {
    /// Its command position.
    pub command: Lead,
    /// Its actual position.
    pub actual: Lead,
    /// Its simulated master.
    pub simulated: Lead,
}

/// All leads, as far as this cycle has advanced.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Leads {
    /// Leads of the axes, by axis.
    pub of_axes: Vec<OfAxis>,
    /// Leads of the encoders, by encoder.
    pub encoders: Vec<Lead>,
    /// Leads of the sinks of functions, by slot.
    pub sinks: Vec<Lead>,
    /// The virtual master of the machine.
    pub virtual_master: Lead,
    /// Position of its mark of this cycle, if there was one.
    pub virtual_mark: Option<Position>,
    /// Sums of several leads; fixed by the cell.
    pub sums: Vec<Sum>,
}

impl Leads {
    /// Returns the number of axes.
    #[inline]
    pub fn axes(&self) -> usize {
        self.of_axes.len()
    }

    /// Whether the leads are of the same machine.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        let shape = |leads: &Self| (leads.of_axes.len(), leads.encoders.len(), leads.sinks.len());
        shape(self) == shape(other) && self.sums == other.sums
    }

    /// Copies the leads of the same machine without allocation.
    pub fn copy_from(&mut self, other: &Self) {
        // The sums are equal in the same machine.
        let Self { of_axes, encoders, sinks, virtual_master, virtual_mark, sums: _ } = other;
        self.of_axes.clone_from(of_axes);
        self.encoders.clone_from(encoders);
        self.sinks.clone_from(sinks);
        (self.virtual_master, self.virtual_mark) = (*virtual_master, *virtual_mark);
    }

    /// Returns the values of a leader that is no sum, if it exists.
    #[inline]
    pub fn simple(&self, leader: Leader) -> Option<&Lead> {
        let of_axis = |axis: u16| self.of_axes.get(usize::from(axis));
        match leader {
            Leader::AxisCommand(axis) => of_axis(axis).map(|of| &of.command),
            Leader::AxisActual(axis) => of_axis(axis).map(|of| &of.actual),
            Leader::Simulated(axis) => of_axis(axis).map(|of| &of.simulated),
            Leader::Encoder(encoder) => self.encoders.get(usize::from(encoder)),
            Leader::Sink(slot) => self.sinks.get(usize::from(slot)),
            Leader::Virtual => Some(&self.virtual_master),
            Leader::Sum(_) => None,
        }
    }

    fn sum(&self, leader: Leader) -> Option<&Sum> {
        match leader {
            Leader::Sum(place) => self.sums.get(usize::from(place)),
            _ => None,
        }
    }

    #[cold]
    fn added(&self, leader: Leader) -> Option<Lead> {
        self.sum(leader).map(|sum| sum.of(self))
    }

    /// Returns the values of a leader, if it exists.
    #[inline]
    pub fn find(&self, leader: Leader) -> Option<Lead> {
        self.simple(leader).copied().or_else(|| self.added(leader))
    }

    /// Returns the values of a leader; a lost lead if it does not exist.
    #[inline]
    pub fn get(&self, leader: Leader) -> Lead {
        // Sums cost time only for their followers.
        match self.simple(leader) {
            Some(lead) => *lead,
            None => self.added(leader).unwrap_or_default(),
        }
    }

    /// Returns the increase of a leader if the leaders for which `holds` is true increase by `by`: it is one of them,
    /// or has them as members.
    pub fn share(&self, leader: Leader, by: Position, holds: impl Fn(Leader) -> bool) -> Position {
        let times = self.sum(leader).map_or_else(|| i64::from(holds(leader)), |sum| sum.times(&holds));
        times_position(by, times)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::position::Position;

    #[test]
    fn each_leader_has_a_place_of_its_own_and_what_does_not_exist_is_lost() {
        let lead = |number: i64| Lead { position: Position::whole(number), valid: true, ..Lead::default() };
        let of_axis = |axis: i64| OfAxis { command: lead(axis), actual: lead(axis + 1), simulated: lead(axis + 2) };
        let sums = vec![Sum::default().with(Leader::Encoder(0), true).with(Leader::AxisCommand(1), false)];
        let of_axes = vec![of_axis(10), of_axis(20)];
        let leads = Leads {
            of_axes,
            encoders: vec![lead(30)],
            sinks: vec![lead(40)],
            virtual_master: lead(50),
            virtual_mark: None,
            sums,
        };
        let seen = |leader| leads.get(leader).position.floor();
        for (axis, base) in [(0, 10), (1, 20)] {
            let all = [Leader::AxisCommand(axis), Leader::AxisActual(axis), Leader::Simulated(axis)];
            assert_eq!(all.map(seen), [base, base + 1, base + 2]);
        }
        let others = [Leader::Encoder(0), Leader::Sink(0), Leader::Virtual, Leader::Sum(0)];
        assert_eq!(others.map(seen), [30, 40, 50, 30 - 20]);
        for none in [
            Leader::AxisCommand(2),
            Leader::AxisActual(u16::MAX),
            Leader::Simulated(2),
            Leader::Encoder(1),
            Leader::Sink(1),
            Leader::Sum(1),
        ] {
            assert_eq!((leads.find(none), leads.get(none).valid), (None, false), "{none:?}");
        }
    }
    #[test]
    fn change_of_a_member_changes_the_sum_with_its_sign() {
        let (x, actual) = (Leader::AxisCommand(1), Leader::AxisActual(1));
        let sums = vec![Sum::default().with(x, false), Sum::default().with(x, true).with(actual, false)];
        let leads = Leads { sums, ..Leads::default() };
        let share = |leader| leads.share(leader, Position::whole(7), |leader| [x, actual].contains(&leader)).floor();
        let all = [x, Leader::AxisCommand(0), Leader::Sum(0), Leader::Sum(1), Leader::Sum(2)];
        assert_eq!(all.map(share), [7, 0, -7, 0, 0]);
    }

    #[test]
    fn leads_of_other_sums_are_those_of_another_machine() {
        let of = |leader| Leads { sums: vec![Sum::default().with(leader, true)], ..Leads::default() };
        assert!(of(Leader::Sink(0)).has_shape_of(&of(Leader::Sink(0))));
        assert!(!of(Leader::Sink(0)).has_shape_of(&of(Leader::Sink(1))));
        assert!(!of(Leader::Sink(0)).has_shape_of(&Leads::default()));
    }
}
