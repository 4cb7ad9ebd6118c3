//! A command that waits to leave a coupling.

use crate::command::DisengageAt;
use crate::modulo::Modulo;
use crate::position::Position;
use crate::sync::Disengage;
use serde::{Deserialize, Serialize};

/// A command to leave a coupling.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Leaving {
    /// Number of its command.
    pub(in crate::axis) sequence: u64,
    pub(in crate::axis) at: DisengageAt,
    /// Modulo of the leader, if its position counts.
    pub(in crate::axis) turn: Option<Modulo>,
    pub(in crate::axis) disengage: Disengage,
    /// Position of the leader, or of the axis, in the cycle before.
    pub(in crate::axis) seen: Position,
}

impl Leaving {
    /// Whether the state is possible; a state from outside may contain any values.
    pub(in crate::axis) fn is_sound(&self) -> bool {
        let place = match self.at {
            DisengageAt::Now => 0,
            DisengageAt::Leader(place) | DisengageAt::Axis(place) => place,
        };
        Position::whole(place).is_legal() && self.turn.is_none_or(Modulo::is_sound)
    }
}
