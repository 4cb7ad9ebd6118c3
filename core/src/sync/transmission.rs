//! What stands between a lead and its follower.
//!
//! Law      a change of the lead becomes a change of the follower; what is left of it below the grid of positions is kept
//! Refuses  nothing: it was checked when it was made
//! Source   MACS-SYNC-02

use super::gear::Gear;
use crate::encoder::Lead;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// A follower adds up what its transmission makes of its lead. A table will be another case.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub enum Transmission {
    /// An exact ratio.
    Gear(Gear),
}

impl Transmission {
    /// Could it have come about?
    pub fn is_sound(&self) -> bool {
        match self {
            Self::Gear(gear) => gear.is_sound(),
        }
    }

    /// The follower's change in this cycle.
    #[inline]
    pub fn step(&mut self, lead: Lead) -> Position {
        match self {
            Self::Gear(gear) => gear.step(lead.change),
        }
    }

    /// The same, and the transmission behind it, where that is quickly told.
    #[inline]
    pub fn stepped(self, lead: Lead) -> Option<(Position, Self)> {
        match self {
            Self::Gear(gear) => gear.stepped(lead.change).map(|(change, gear)| (change, Self::Gear(gear))),
        }
    }

    /// Change of the follower by that of its lead where it stands, without its sign.
    #[inline]
    pub fn slope(&self) -> f64 {
        match self {
            Self::Gear(gear) => gear.ratio().to_f64().abs(),
        }
    }
}
