//! A goal: an order that a client gives a function, from its acceptance to its end.
//!
//! Law      the call behind its acceptance begins the order as a rising E1 does; E1 stands until it ends. It succeeds in the call in which the
//!          order has come to its end; a stop by E2 with something left ends it, too. Cancelled, it stops the function as E2 does, ends at
//!          rest, and what is left is dropped: the next goal is a new order
//! Reads    how the order stands behind each call
//! Source   Lineshaft's own: contract section 7; AMK-EPOS-24, -25 for what an order is

use super::program::{Asked, Progress};
use crate::code::{Class, Code};
use crate::event::{Event, Number};
use crate::object::Object;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Where a goal stands.
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
    /// Number of its command.
    pub sequence: u64,
    phase: Phase,
}

impl Goal {
    /// One that has been accepted.
    pub(super) fn new(sequence: u64) -> Self {
        Self { sequence, phase: Phase::Waits }
    }

    /// What it asks of the next call.
    pub(super) fn asks(&self) -> Asked {
        match self.phase {
            Phase::Waits => Asked::Begin,
            Phase::Runs => Asked::Hold,
            Phase::Stops => Asked::Stop,
        }
    }

    /// How it ended with a call; none where it goes on.
    pub(super) fn take(&mut self, progress: Progress) -> Option<Code> {
        let next = if self.phase == Phase::Waits { Phase::Runs } else { self.phase };
        match (std::mem::replace(&mut self.phase, next), progress) {
            (_, Progress::Moves) => None,
            // What comes to its end while it is stopped has come there.
            (Phase::Runs | Phase::Stops, Progress::Rests) => Some(Code::NONE),
            (Phase::Stops, Progress::Stopped) => Some(Code::CANCELLED),
            // A rising E2 has won against its beginning.
            (Phase::Waits, _) | (Phase::Runs, Progress::Stopped) => Some(Code::FUNCTION_STOPPED),
        }
    }

    /// Its client does not want it any more; true where it never began.
    pub(super) fn cancel(&mut self) -> bool {
        std::mem::replace(&mut self.phase, Phase::Stops) == Phase::Waits
    }
}

/// How a goal ended that a slot still has to tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct GoalEnd {
    /// Number of its command.
    pub(super) sequence: u64,
    pub(super) code: Code,
    /// What was left (inc).
    pub(super) left: i64,
}

impl GoalEnd {
    /// What is told of it, with the place of the sink.
    pub(crate) fn event(self, slot: u16, sink: i64) -> Event {
        let event = Event::done(Object::Function(slot), self.sequence, self.code, Position::whole(sink));
        // An error is one of the axis, and has no number of the function.
        let is_own = self.code.row().is_none_or(|row| row.class == Class::NoError);
        event.with(if is_own { Number::Position(self.left) } else { Number::None }, Number::None)
    }
}
