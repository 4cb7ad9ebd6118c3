//! Goals of function slots: an order of a client, from its acceptance to its end.
//!
//! Law      the call after its acceptance begins the order like a rising E1; E1 counts as 1 until the goal ends. The
//!          goal succeeds in the call in which the order reaches its end; a stop by E2 before that ends the goal, too.
//!          A cancelled goal stops the function like E2 and ends at rest, and the distance to go is dropped: the next
//!          goal is a new order
//! Reads    the progress of the order after each call
//! Source   Lineshaft: contract section 7; AMK-EPOS-24, -25 for the definition of an order

use super::program::{GoalRequest, Progress};
use crate::code::{Class, Code};
use crate::event::{Event, Number};
use crate::object::Object;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Phase of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// The next call begins it.
    Waits,
    Runs,
    /// It was cancelled.
    Stops,
}

/// A goal of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Goal {
    /// Sequence number of its command.
    pub sequence: u64,
    phase: Phase,
}

impl Goal {
    /// Creates an accepted goal.
    pub(super) fn new(sequence: u64) -> Self {
        Self { sequence, phase: Phase::Waits }
    }

    /// Returns the request for the next call.
    pub(super) fn request(&self) -> GoalRequest {
        match self.phase {
            Phase::Waits => GoalRequest::Begin,
            Phase::Runs => GoalRequest::Hold,
            Phase::Stops => GoalRequest::Stop,
        }
    }

    /// Takes the progress after a call. Returns the final code, or `None` if the goal continues.
    pub(super) fn advance(&mut self, progress: Progress) -> Option<Code> {
        let next = if self.phase == Phase::Waits { Phase::Runs } else { self.phase };
        match (std::mem::replace(&mut self.phase, next), progress) {
            (_, Progress::Moves) => None,
            // An order that reaches its end while it is being stopped has succeeded.
            (Phase::Runs | Phase::Stops, Progress::Rests) => Some(Code::NONE),
            (Phase::Stops, Progress::Stopped) => Some(Code::CANCELLED),
            // A rising E2 had priority over its beginning.
            (Phase::Waits, _) | (Phase::Runs, Progress::Stopped) => Some(Code::FUNCTION_STOPPED),
        }
    }

    /// Cancels the goal. Returns true if it had not begun.
    pub(super) fn cancel(&mut self) -> bool {
        std::mem::replace(&mut self.phase, Phase::Stops) == Phase::Waits
    }
}

/// The end of a goal that the slot has not reported yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct GoalEnd {
    /// Sequence number of its command.
    pub(super) sequence: u64,
    pub(super) code: Code,
    /// Distance to go, in increments.
    pub(super) left: i64,
}

impl GoalEnd {
    /// Returns the event of the end, with the position of the sink.
    pub(crate) fn event(self, slot: u16, sink: i64) -> Event {
        let event = Event::done(Object::Function(slot), self.sequence, self.code, Position::whole(sink));
        // An error code belongs to the axis, and has no number of the function.
        let is_own = self.code.row().is_none_or(|row| row.class == Class::NoError);
        event.with(if is_own { Number::Position(self.left) } else { Number::None }, Number::None)
    }
}
