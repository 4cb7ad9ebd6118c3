//! State of the active leg of a search for the reference.

use super::methods::{Leg, Until, legs};
use crate::position::Position;
use crate::state::HomingPhase;
use serde::{Deserialize, Serialize};

/// State of the active leg.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Search {
    pub(in crate::axis) leg: u8,
    /// Whether a limit switch has reversed it.
    pub(in crate::axis) turned: bool,
    /// Position at its start.
    pub(in crate::axis) from: Position,
    /// State of its switch in the cycle before.
    pub(in crate::axis) was_on: bool,
}

impl Search {
    pub(in crate::axis) fn leg(&self, method: i64) -> Option<&'static Leg> {
        legs(method).get(usize::from(self.leg))
    }

    pub(in crate::axis) fn is_sound(&self, method: i64) -> bool {
        self.leg(method).is_some()
    }

    pub(in crate::axis) fn phase(&self, method: i64) -> HomingPhase {
        self.leg(method).map_or(HomingPhase::None, phase)
    }
}

/// Returns the phase in which the reference of a method is found.
pub(super) fn last_phase(method: i64) -> HomingPhase {
    legs(method).last().map_or(HomingPhase::None, phase)
}

fn phase(leg: &Leg) -> HomingPhase {
    match leg.until {
        Until::On(_) => HomingPhase::SearchSwitch,
        Until::Off(_) => HomingPhase::LeaveSwitch,
        Until::Index => HomingPhase::SearchIndex,
    }
}
