//! What stands between a lead and its follower.
//!
//! Law      a change of the lead becomes a change of the follower; what is left of it below the grid of positions is kept
//! Reads    of a cam, the tables of the machine
//! Refuses  nothing: it was checked when it was made
//! Source   MACS-SYNC-02, PLCopen (MC_GearIn, MC_CamIn)

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
}

impl Transmission {
    /// Could it have come about?
    pub fn is_sound(&self) -> bool {
        match self {
            Self::Gear(gear) => gear.is_sound(),
            Self::Cam(cam) => cam.is_sound(),
        }
    }

    /// The follower's change in this cycle.
    #[inline]
    pub fn step(&mut self, lead: Lead, tables: &[Arc<Table>]) -> Position {
        match self {
            Self::Gear(gear) => gear.step(lead.change),
            Self::Cam(cam) => cam.step(lead.change, tables),
        }
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
        }
    }

    /// Does a lead that goes forwards count as one that goes backwards (MACS-DIR-04)?
    pub fn is_turned(&self) -> bool {
        match self {
            Self::Gear(gear) => gear.ratio().numerator() < 0,
            Self::Cam(cam) => cam.is_turned(),
        }
    }

    /// The cam that it is.
    #[inline]
    pub fn cam(&self) -> Option<&Cam> {
        match self {
            Self::Gear(_) => None,
            Self::Cam(cam) => Some(cam),
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
