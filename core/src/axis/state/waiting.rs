//! Commands that wait for their end on an axis.
//!
//! Law      each waiting command ends once, with the event `done`. Commands that end together end in the order in which
//!          they came
//! Refuses  more than [`MAX_WAITING`] for one axis

use super::alarm::Numbers;
use crate::code::Code;
use crate::event::{Event, EventQueue};
use crate::object::Object;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Largest number of commands that wait for one axis at a time: ten clients with 25 requests each, and a few more.
pub const MAX_WAITING: usize = 256;

/// The condition for which a command waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::axis) enum Until {
    /// The axis can be moved.
    Enabled,
    /// The axis is off.
    Disabled,
    /// The axis is at rest.
    Standstill,
    /// The axis has no error and no lock.
    Healthy,
}

/// Commands that wait for their end, the oldest first. It has fixed memory, so that an axis is copied without
/// allocation.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(try_from = "Vec<(u64, Until)>", into = "Vec<(u64, Until)>")]
pub(in crate::axis) struct Waiting {
    places: [(u64, Until); MAX_WAITING],
    count: usize,
}

impl Default for Waiting {
    fn default() -> Self {
        Self { places: [(0, Until::Standstill); MAX_WAITING], count: 0 }
    }
}

impl From<Waiting> for Vec<(u64, Until)> {
    fn from(waiting: Waiting) -> Self {
        waiting.all().to_vec()
    }
}

impl TryFrom<Vec<(u64, Until)>> for Waiting {
    type Error = String;

    fn try_from(all: Vec<(u64, Until)>) -> Result<Self, String> {
        let mut waiting = Self::default();
        for (sequence, until) in &all {
            if !waiting.add(*sequence, *until) {
                return Err(format!("{} commands wait for one axis; at most {MAX_WAITING} do", all.len()));
            }
        }
        Ok(waiting)
    }
}

impl Waiting {
    fn all(&self) -> &[(u64, Until)] {
        self.places.get(..self.count).unwrap_or_default()
    }

    pub(in crate::axis) fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(in crate::axis) fn has_room(&self) -> bool {
        self.count < MAX_WAITING
    }

    pub(in crate::axis) fn waits_for(&self, until: Until) -> bool {
        self.all().iter().any(|(_, waits)| *waits == until)
    }

    /// Adds a command. Returns false without room.
    pub(in crate::axis) fn add(&mut self, sequence: u64, until: Until) -> bool {
        let Some(place) = self.places.get_mut(self.count) else { return false };
        *place = (sequence, until);
        self.count += 1;
        true
    }

    /// Ends all commands that wait for `until`, with `code`.
    pub(in crate::axis) fn end(
        &mut self,
        events: &mut EventQueue,
        axis: u16,
        until: Until,
        code: Code,
        position: Position,
    ) {
        self.end_with(events, until, Event::done(Object::Axis(axis), 0, code, position));
    }

    /// Ends them with an event to which only the command is added.
    pub(in crate::axis) fn end_with(&mut self, events: &mut EventQueue, until: Until, done: Event) {
        let mut kept = 0;
        for from in 0..self.count {
            let (sequence, waits) = self.places[from];
            if waits == until {
                events.push(done.of_command(sequence));
            } else {
                self.places[kept] = (sequence, waits);
                kept += 1;
            }
        }
        self.count = kept;
    }

    /// As [`fail`](Self::fail), with found value and allowed value.
    pub(in crate::axis) fn fail_with(
        &mut self,
        events: &mut EventQueue,
        axis: u16,
        code: Code,
        until: Until,
        (found, allowed): Numbers,
    ) {
        let done = Event::done(Object::Axis(axis), 0, code, Position::ZERO);
        self.end_with(events, until, done.with(found, allowed));
    }

    /// Ends all commands that wait for `until` without success.
    pub(in crate::axis) fn fail(&mut self, events: &mut EventQueue, axis: u16, code: Code, until: Until) {
        self.end(events, axis, until, code, Position::ZERO);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ended_commands_keep_the_order_of_the_rest() {
        let (mut waiting, mut events) = (Waiting::default(), EventQueue::new(16));
        for (sequence, until) in (1..).zip([Until::Standstill, Until::Enabled, Until::Standstill, Until::Healthy]) {
            assert!(waiting.add(sequence, until));
        }
        waiting.fail(&mut events, 0, Code::DISABLED, Until::Standstill);
        let ended: Vec<_> = events.as_slice().iter().map(|event| event.command).collect();
        assert_eq!((ended, waiting.all()), (vec![1, 3], &[(2, Until::Enabled), (4, Until::Healthy)][..]));
        assert!(waiting.waits_for(Until::Healthy) && !waiting.waits_for(Until::Standstill));
    }

    #[test]
    fn state_lists_only_waiting_commands_within_capacity() {
        let mut waiting = Waiting::default();
        while waiting.add(7, Until::Disabled) {}
        assert!(!waiting.has_room());
        let told: Vec<_> = waiting.into();
        assert_eq!(told, [(7, Until::Disabled); 256]);
        assert_eq!(Waiting::try_from(told.clone()).unwrap().all(), told);
        let error = Waiting::try_from([told, vec![(8, Until::Enabled)]].concat()).unwrap_err();
        assert_eq!(error, "257 commands wait for one axis; at most 256 do");
        assert!(Waiting::try_from(Vec::new()).unwrap().is_empty());
    }
}
