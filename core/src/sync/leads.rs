//! Everything that can lead, in one store.
//!
//! Law      a lead is what its source was at t_k, as far as the cycle has come: encoders, then actual positions and simulated masters,
//!          then each axis' command once it has moved. A follower reads its lead behind that, as leaders come first
//! Reads    places by [`Leader`]; a new kind of lead is a case of that, and a range of places here
//! Refuses  nothing: what does not exist is a lead that is lost
//! Source   MACS-ENC-10, MACS-SYNC-01

use crate::encoder::Lead;
use crate::object::Leader;
use serde::{Deserialize, Serialize};

/// What each axis has: its command, its actual position, its simulated master. They stand together.
const OF_AXIS: usize = 3;

/// Everything that can lead, as far as this cycle has come.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Leads {
    axes: u16,
    encoders: u16,
    /// Those of the axes, then the encoders.
    values: Vec<Lead>,
}

impl Leads {
    /// Leads of so many axes, which have no drive yet, and encoders that have not been read.
    pub fn new(axes: usize, encoders: usize) -> Self {
        let values = vec![Lead::default(); axes * OF_AXIS + encoders];
        let mut leads = Self { axes: axes as u16, encoders: encoders as u16, values };
        for axis in 0..leads.axes {
            leads.set(Leader::AxisCommand(axis), Lead { valid: true, ..Lead::default() });
        }
        leads
    }

    /// How many axes there are.
    #[inline]
    pub fn axes(&self) -> usize {
        self.axes.into()
    }

    /// Is it one of the same machine?
    pub fn has_shape_of(&self, other: &Self) -> bool {
        let shape = |leads: &Self| (leads.axes, leads.encoders, leads.values.len());
        shape(self) == shape(other)
    }

    /// Copies others of the same machine, without taking memory.
    pub fn copy_from(&mut self, other: &Self) {
        (self.axes, self.encoders) = (other.axes, other.encoders);
        self.values.clone_from(&other.values);
    }

    /// Where a lead stands; beyond the last one for what does not exist.
    #[inline]
    fn place(&self, leader: Leader) -> usize {
        let of_axis = |axis: u16, which: usize| match axis < self.axes {
            true => usize::from(axis) * OF_AXIS + which,
            false => usize::MAX,
        };
        match leader {
            Leader::AxisCommand(axis) => of_axis(axis, 0),
            Leader::AxisActual(axis) => of_axis(axis, 1),
            Leader::Simulated(axis) => of_axis(axis, 2),
            Leader::Encoder(encoder) => self.axes() * OF_AXIS + usize::from(encoder),
        }
    }

    /// The leader's values; a lost lead for one that does not exist.
    #[inline]
    pub fn get(&self, leader: Leader) -> Lead {
        self.find(leader).unwrap_or_default()
    }

    /// The leader's values, where there is such a leader.
    #[inline]
    pub fn find(&self, leader: Leader) -> Option<Lead> {
        self.values.get(self.place(leader)).copied()
    }

    /// The place of a leader, to write it; none for one that does not exist.
    #[inline]
    pub fn get_mut(&mut self, leader: Leader) -> Option<&mut Lead> {
        let place = self.place(leader);
        self.values.get_mut(place)
    }

    /// Writes a leader that exists.
    #[inline]
    pub fn set(&mut self, leader: Leader, lead: Lead) {
        if let Some(place) = self.get_mut(leader) {
            *place = lead;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::position::Position;

    #[test]
    fn each_leader_has_a_place_of_its_own_and_what_does_not_exist_is_lost() {
        let all = |axes: u16, encoders: u16| {
            let of_axis = |axis| [Leader::AxisCommand(axis), Leader::AxisActual(axis), Leader::Simulated(axis)];
            (0..axes).flat_map(of_axis).chain((0..encoders).map(Leader::Encoder)).collect::<Vec<_>>()
        };
        let mut leads = Leads::new(2, 3);
        let lead = |number: usize| Lead { position: Position::whole(number as i64), valid: true, ..Lead::default() };
        for (number, leader) in all(2, 3).into_iter().enumerate() {
            leads.set(leader, lead(number));
        }
        for (number, leader) in all(2, 3).into_iter().enumerate() {
            assert_eq!(leads.get(leader), lead(number), "{leader:?}");
        }
        let before = leads.clone();
        for none in all(4, 0).into_iter().skip(6).chain([Leader::Encoder(3), Leader::Encoder(u16::MAX)]) {
            leads.set(none, lead(9));
            assert_eq!((leads.get(none), leads.get_mut(none)), (Lead::default(), None), "{none:?}");
        }
        assert_eq!(leads, before);
    }
}
