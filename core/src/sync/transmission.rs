//! The transmission between a lead and its follower.
//!
//! Law      a change of the lead becomes a change of the follower; the remainder below the resolution of positions is
//!          kept
//! Reads    for a cam, the tables of the machine
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

/// Converts the motion of a lead to that of a follower, which adds up the changes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "a box would take memory in the cycle")]
pub enum Transmission {
    /// An exact ratio.
    Gear(Gear),
    /// A table.
    Cam(Cam),
    /// The approach to the pair of positions from which on it is a gear.
    Approach(Approach),
}

impl Transmission {
    /// Whether the state is possible.
    pub fn is_sound(&self) -> bool {
        match self {
            Self::Gear(gear) => gear.is_sound(),
            Self::Cam(cam) => cam.is_sound(),
            Self::Approach(approach) => approach.is_sound(),
        }
    }

    /// Returns the change of the follower in this cycle.
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

    /// Notes which part of the last change (inc of the lead) was not its own motion.
    pub fn forget(&mut self, added: f64) {
        if let Self::Cam(cam) = self {
            cam.forget(added);
        }
    }

    /// Whether it approaches a pair of positions.
    #[inline]
    pub fn approaches(&self) -> bool {
        matches!(self, Self::Approach(_))
    }

    /// Returns the change of the follower per change of its lead at the present position, without sign.
    #[inline]
    pub fn slope(&self) -> f64 {
        self.signed_slope().abs()
    }

    /// Returns the change of the follower per change of its lead at the present position.
    #[inline]
    pub fn signed_slope(&self) -> f64 {
        match self {
            Self::Gear(gear) => gear.ratio().to_f64(),
            Self::Cam(cam) => cam.slope(),
            Self::Approach(approach) => approach.slope(),
        }
    }

    /// Whether forward motion of the lead counts as backward (MACS-DIR-04).
    pub fn is_mirrored(&self) -> bool {
        match self {
            Self::Gear(gear) => gear.ratio().numerator() < 0,
            Self::Cam(cam) => cam.is_turned(),
            Self::Approach(approach) => approach.is_turned(),
        }
    }

    /// Returns the cam, if it is one.
    #[inline]
    pub fn cam(&self) -> Option<&Cam> {
        match self {
            Self::Cam(cam) => Some(cam),
            Self::Gear(_) | Self::Approach(_) => None,
        }
    }
}

/// A transmission after a step, which avoids copies of the whole enum in a cycle.
pub trait Stepped: Into<Transmission> {
    /// Change of the follower per change of its lead at the present position.
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
