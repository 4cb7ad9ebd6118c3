//! Everything that can lead, in one store.
//!
//! Law      a lead is what its source was at t_k, as far as the cycle has come: encoders, then actual positions and simulated masters, then sinks,
//!          then each axis' command once it has moved. A follower reads its lead behind that, as leaders come first
//! Reads    places by [`Leader`]; a new kind of lead is a case of that, and a list here
//! Refuses  nothing: what does not exist is a lead that is lost
//! Source   MACS-ENC-10, MACS-SYNC-01

use crate::encoder::Lead;
use crate::object::Leader;
use serde::{Deserialize, Serialize};

/// What an axis gives others to follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OfAxis {
    /// Its command position.
    pub command: Lead,
    /// Its actual position.
    pub actual: Lead,
    /// Its simulated master.
    pub simulated: Lead,
}

/// Everything that can lead, as far as this cycle has come.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Leads {
    /// By axis.
    pub of_axes: Vec<OfAxis>,
    /// By encoder.
    pub encoders: Vec<Lead>,
    /// By slot.
    pub sinks: Vec<Lead>,
}

impl Leads {
    /// How many axes there are.
    #[inline]
    pub fn axes(&self) -> usize {
        self.of_axes.len()
    }

    /// Is it one of the same machine?
    pub fn has_shape_of(&self, other: &Self) -> bool {
        let shape = |leads: &Self| (leads.of_axes.len(), leads.encoders.len(), leads.sinks.len());
        shape(self) == shape(other)
    }

    /// Copies others of the same machine, without taking memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.of_axes.clone_from(&other.of_axes);
        self.encoders.clone_from(&other.encoders);
        self.sinks.clone_from(&other.sinks);
    }

    /// The leader's values, where there is such a leader.
    #[inline]
    pub fn find(&self, leader: Leader) -> Option<&Lead> {
        let of_axis = |axis: u16| self.of_axes.get(usize::from(axis));
        match leader {
            Leader::AxisCommand(axis) => of_axis(axis).map(|of| &of.command),
            Leader::AxisActual(axis) => of_axis(axis).map(|of| &of.actual),
            Leader::Simulated(axis) => of_axis(axis).map(|of| &of.simulated),
            Leader::Encoder(encoder) => self.encoders.get(usize::from(encoder)),
            Leader::Sink(slot) => self.sinks.get(usize::from(slot)),
        }
    }

    /// The leader's values; a lost lead for one that does not exist.
    #[inline]
    pub fn get(&self, leader: Leader) -> Lead {
        self.find(leader).copied().unwrap_or_default()
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
        let leads = Leads { of_axes: vec![of_axis(10), of_axis(20)], encoders: vec![lead(30)], sinks: vec![lead(40)] };
        let seen = |leader| leads.get(leader).position.floor();
        for (axis, base) in [(0, 10), (1, 20)] {
            let all = [Leader::AxisCommand(axis), Leader::AxisActual(axis), Leader::Simulated(axis)];
            assert_eq!(all.map(seen), [base, base + 1, base + 2]);
        }
        assert_eq!([Leader::Encoder(0), Leader::Sink(0)].map(seen), [30, 40]);
        for none in [
            Leader::AxisCommand(2),
            Leader::AxisActual(u16::MAX),
            Leader::Simulated(2),
            Leader::Encoder(1),
            Leader::Sink(1),
        ] {
            assert_eq!((leads.find(none), leads.get(none).valid), (None, false), "{none:?}");
        }
    }
}
