//! The generator of the command position of an axis.
//!
//! Law      a plan, a follower of a leader (a lead of the machine, or the trajectory of the goal), open loop, or
//!          nothing

use super::planned_motion::PlannedMotion;
use crate::command::Level;
use crate::object::Leader;
use crate::sync::Disengage;
use crate::sync::follower::Follower;
use serde::{Deserialize, Serialize};

/// The source of the command position.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "a box would take memory in the cycle")]
pub(in crate::axis) enum Generator {
    /// None: the position stays.
    Rest,
    /// A profile.
    Plan(PlannedMotion),
    /// A coupling to a leader.
    Follow(Coupling),
    /// The trajectory of its goal is the leader.
    Track(Follower),
    /// Open loop: the drive runs at this speed (inc/s), and the command is the actual position.
    Open { velocity: f64 },
    /// OUTAN: the loops inside the position loop run at this value (-1 to 1), and the command is the actual position.
    OutAn { value: f64, level: Level },
    /// Open loop, switched off in cycle `since`, until the drive is at rest.
    Coast { since: u64 },
}

impl Generator {
    pub(in crate::axis) fn is_sound(&self) -> bool {
        match self {
            Generator::Rest | Generator::Coast { .. } => true,
            Generator::Plan(course) => course.is_sound(),
            Generator::Follow(_) | Generator::Track(_) => self.follower().is_some_and(Follower::is_sound),
            Generator::Open { velocity } => velocity.is_finite(),
            Generator::OutAn { value, .. } => value.abs() <= 1.0,
        }
    }

    /// Whether OUTAN commands an effort, without the velocity loop.
    pub(in crate::axis) fn asks_effort(&self) -> bool {
        matches!(self, Generator::OutAn { level: Level::Effort, .. })
    }

    /// Returns the follower; none if there is no leader.
    #[inline]
    pub(in crate::axis) fn follower(&self) -> Option<&Follower> {
        match self {
            Generator::Follow(coupling) => Some(&coupling.follower),
            Generator::Track(follower) => Some(follower),
            _ => None,
        }
    }
}

/// A coupling of one axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Coupling {
    /// Leader of the coupling.
    pub leader: Leader,
    /// Action at the end of the coupling.
    pub disengage: Disengage,
    /// Error up to which the slave counts as accurate (inc), fixed at the start (MACS-STO-09). Negative: the error is
    /// shown with its sign.
    pub accuracy: i64,
    /// Whether it keeps a pair of positions of leader and axis.
    pub at_places: bool,
    pub follower: Follower,
}
