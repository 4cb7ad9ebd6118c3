//! The armed touch probes of an axis.

use crate::command::ProbeEdge;
use crate::modulo::Modulo;
use crate::object::Object;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Largest number of touch probes of one axis that are armed at the same time, each for another trigger.
pub(in crate::axis) const MAX_TOUCH_PROBES: usize = 4;

/// Positions between which a touch probe records, both included.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Window {
    pub(in crate::axis) first: Position,
    pub(in crate::axis) last: Position,
}

impl Window {
    pub(in crate::axis) fn holds(&self, place: Position, turn: Option<Modulo>) -> bool {
        match turn {
            None => (self.first..=self.last).contains(&place),
            Some(turn) => turn.is_between(self.first, self.last, place),
        }
    }
}

/// An armed touch probe.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Armed {
    /// Number of its command.
    pub(in crate::axis) sequence: u64,
    pub(in crate::axis) source: Object,
    pub(in crate::axis) edge: ProbeEdge,
    /// Whether it records until it is aborted. Otherwise the first record ends it.
    pub(in crate::axis) continuous: bool,
    pub(in crate::axis) window: Option<Window>,
}

/// The touch probes of an axis.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::axis) struct TouchProbes {
    /// Number of armed touch probes, which every full cycle reads.
    pub(in crate::axis) count: u8,
    pub(in crate::axis) armed: [Option<Armed>; MAX_TOUCH_PROBES],
    /// Whether the coordinate of the windows is no longer that of the axis.
    pub(in crate::axis) is_outdated: bool,
    /// Number of records of this cycle that are not published yet, and the last of them.
    #[serde(skip)]
    pub(in crate::axis) recorded: (u32, Position),
}

impl TouchProbes {
    pub(in crate::axis) fn put(&mut self, place: usize, armed: Option<Armed>) -> Option<Armed> {
        let slot = self.armed.get_mut(place)?;
        let before = std::mem::replace(slot, armed);
        self.count = self.armed.iter().flatten().count() as u8;
        before
    }

    /// Returns true if a touch probe with a window is armed.
    pub(in crate::axis) fn have_window(&self) -> bool {
        self.armed.iter().flatten().any(|armed| armed.window.is_some())
    }

    /// Whether nothing is left to end or to publish.
    pub(in crate::axis) fn are_settled(&self) -> bool {
        !self.is_outdated && self.recorded.0 == 0
    }

    /// Notes that the coordinate of the axis is no longer that of the windows.
    pub(in crate::axis) fn note_new_coordinate(&mut self) {
        self.is_outdated |= self.have_window();
    }

    /// Whether the state is possible; a state from outside may contain any values.
    pub(in crate::axis) fn are_sound(&self) -> bool {
        let is_legal = |window: Window| window.first.is_legal() && window.last.is_legal();
        let is_counted = usize::from(self.count) == self.armed.iter().flatten().count();
        is_counted && self.armed.iter().flatten().all(|armed| armed.window.is_none_or(is_legal))
    }
}
