//! What stands between a lead and its follower.
//!
//! Law      a change of the lead becomes a change of the follower; what is left of it below the grid of positions is kept
//! Reads    of a cam, the tables of the machine
//! Refuses  nothing: it was checked when it was made
//! Source   MACS-SYNC-02, PLCopen (MC_GearIn, MC_GearInPos, MC_CamIn)

use super::approach::Approach;
use super::cam::Cam;
use super::gear::Gear;
use crate::encoder::Lead;
use crate::position::Position;
use crate::table::Table;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A follower adds up what its transmission makes of its lead.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "a box would take memory in the cycle")]
pub enum Transmission {
    /// An exact ratio.
    Gear(Gear),
    /// A table.
    Cam(Cam),
    /// The way to the pair of places from which on it is a gear.
    Approach(Approach),
}

impl Transmission {
    /// Could it have come about?
    pub fn is_sound(&self) -> bool {
        match self {
            Self::Gear(gear) => gear.is_sound(),
            Self::Cam(cam) => cam.is_sound(),
            Self::Approach(approach) => approach.is_sound(),
        }
    }

    /// The follower's change in this cycle.
    #[inline]
    pub fn step(&mut self, lead: Lead, tables: &[Arc<Table>]) -> Position {
        match self {
            Self::Gear(gear) => gear.step(lead.change),
            Self::Cam(cam) => cam.step(lead.change, tables),
            Self::Approach(_) => self.approach(lead.change),
        }
    }

    #[cold]
    fn approach(&mut self, change: Position) -> Position {
        let Self::Approach(approach) = self else { return Position::ZERO };
        let (change, gear) = approach.step(change);
        if let Some(gear) = gear {
            *self = Self::Gear(gear);
        }
        change
    }

    /// So much of the last change (inc of the lead) was none of its own motion.
    pub fn forget(&mut self, added: f64) {
        if let Self::Cam(cam) = self {
            cam.forget(added);
        }
    }

    /// Is it on its way to a pair of places?
    #[inline]
    pub fn approaches(&self) -> bool {
        matches!(self, Self::Approach(_))
    }

    /// Change of the follower by that of its lead where it stands, without its sign.
    #[inline]
    pub fn slope(&self) -> f64 {
        self.signed_slope().abs()
    }

    /// Change of the follower by that of its lead where it stands.
    #[inline]
    pub fn signed_slope(&self) -> f64 {
        match self {
            Self::Gear(gear) => gear.ratio().to_f64(),
            Self::Cam(cam) => cam.slope(),
            Self::Approach(approach) => approach.slope(),
        }
    }

    /// Does a lead that goes forwards count as one that goes backwards (MACS-DIR-04)?
    pub fn is_turned(&self) -> bool {
        match self {
            Self::Gear(gear) => gear.ratio().numerator() < 0,
            Self::Cam(cam) => cam.is_turned(),
            Self::Approach(approach) => approach.is_turned(),
        }
    }

    /// The cam that it is.
    #[inline]
    pub fn cam(&self) -> Option<&Cam> {
        match self {
            Self::Cam(cam) => Some(cam),
            Self::Gear(_) | Self::Approach(_) => None,
        }
    }
}

/// What a transmission is behind a step: no more of it moves about in a cycle than there is.
pub trait Stepped: Into<Transmission> {
    /// Change of the follower by that of its lead where it stands.
    fn slope(&self) -> f64;
}

impl Stepped for Gear {
    #[inline]
    fn slope(&self) -> f64 {
        self.ratio().to_f64()
    }
}

impl Stepped for Cam {
    #[inline]
    fn slope(&self) -> f64 {
        Cam::slope(self)
    }
}

impl From<Gear> for Transmission {
    fn from(gear: Gear) -> Self {
        Self::Gear(gear)
    }
}

impl From<Cam> for Transmission {
    fn from(cam: Cam) -> Self {
        Self::Cam(cam)
    }
}

impl From<Approach> for Transmission {
    fn from(approach: Approach) -> Self {
        Self::Approach(approach)
    }
}
