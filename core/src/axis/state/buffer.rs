//! The goals that wait for the active goal of an axis.

use super::alarm::Numbers;
use crate::code::Code;
use crate::command::Move;
use crate::event::{Event, EventQueue};
use crate::object::Object;
use crate::position::Position;
use crate::profile::Limits;
use serde::{Deserialize, Serialize};

/// Largest number of waiting goals.
const MAX_WAITING: usize = 8;

/// A waiting goal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Next {
    /// Number of its command.
    pub(in crate::axis) sequence: u64,
    pub(in crate::axis) request: Move,
    pub(in crate::axis) limits: Limits,
}

/// The waiting goals, the next one first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Buffer([Option<Next>; MAX_WAITING]);

impl Buffer {
    pub(in crate::axis) fn is_empty(&self) -> bool {
        self.0[0].is_none()
    }

    pub(in crate::axis) fn first(&self) -> Option<&Next> {
        self.0[0].as_ref()
    }

    pub(in crate::axis) fn iter(&self) -> impl Iterator<Item = &Next> {
        self.0.iter().map_while(Option::as_ref)
    }

    /// Returns the limits of each waiting goal.
    pub(in crate::axis) fn limits(&self) -> impl Iterator<Item = Limits> {
        self.iter().map(|next| next.limits)
    }

    pub(in crate::axis) fn push(&mut self, next: Next) -> bool {
        let place = self.0.iter_mut().find(|place| place.is_none());
        place.is_some_and(|place| place.replace(next).is_none())
    }

    pub(in crate::axis) fn pop(&mut self) -> Option<Next> {
        let first = self.0[0].take();
        self.0.rotate_left(1);
        first
    }

    /// Whether the goal of that command is waiting.
    pub(in crate::axis) fn holds(&self, sequence: u64) -> bool {
        self.iter().any(|next| next.sequence == sequence)
    }

    /// Removes the goal of that command.
    pub(in crate::axis) fn remove(&mut self, sequence: u64) -> bool {
        let place = self.0.iter().position(|next| next.is_some_and(|next| next.sequence == sequence));
        if let Some(place) = place {
            self.0[place] = None;
            self.0[place..].rotate_left(1);
        }
        place.is_some()
    }

    /// Ends all waiting goals.
    pub(in crate::axis) fn end(
        &mut self,
        events: &mut EventQueue,
        axis: u16,
        code: Code,
        position: Position,
        numbers: Numbers,
    ) {
        while let Some(next) = self.pop() {
            let done = Event::done(Object::Axis(axis), next.sequence, code, position);
            events.push(done.with(numbers.0, numbers.1));
        }
    }

    /// Whether all waiting goals have rates for which a profile exists.
    pub(in crate::axis) fn is_sound(&self) -> bool {
        let sound = |next: &Next| next.limits.is_sound() && next.request.velocity.is_finite();
        // No gaps: a goal after a gap would never begin.
        self.0.iter().skip_while(|next| next.is_some()).all(Option::is_none) && self.iter().all(sound)
    }
}
