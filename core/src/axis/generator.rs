//! What generates the command position of an axis.
//!
//! Law      a plan, a follower of what leads (one of the machine's leads, or the trajectory of the goal), open loop, or nothing

use super::course::Course;
use crate::command::Level;
use crate::object::Leader;
use crate::position::Position;
use crate::sync::Disengage;
use crate::sync::follower::Follower;
use serde::{Deserialize, Serialize};

/// What generates the command position.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "a box would take memory in the cycle")]
pub(super) enum Generator {
    /// Nothing: the position holds.
    Rest,
    /// A profile.
    Plan(Course),
    /// A coupling to a leader.
    Follow(Coupling),
    /// The trajectory of its goal leads.
    Track(Follower),
    /// Open loop: the drive runs at this speed (inc/s), and the command is where it is.
    Open { velocity: f64 },
    /// OUTAN: the loops below the position loop run at this value (-1 to 1), and the command is where the axis is.
    OutAn { value: f64, level: Level },
    /// Open loop: switched off in cycle `since`, until the drive stands.
    Coast { since: u64 },
}

impl Generator {
    pub(super) fn is_sound(&self) -> bool {
        match self {
            Generator::Rest | Generator::Coast { .. } => true,
            Generator::Plan(course) => course.is_sound(),
            Generator::Follow(_) | Generator::Track(_) => self.follower().is_some_and(Follower::is_sound),
            Generator::Open { velocity } => velocity.is_finite(),
            Generator::OutAn { value, .. } => value.abs() <= 1.0,
        }
    }

    /// Moves the places of the motion as a whole: the coordinate is another one, and nothing moves. Not those of a cam or of a trajectory,
    /// in whose motion no coordinate changes.
    pub(super) fn shift(&mut self, by: Position) {
        match self {
            Generator::Plan(course) => course.shift(by),
            Generator::Follow(Coupling { follower, .. }) => follower.shift(by),
            Generator::Rest | Generator::Track(_) | Generator::Open { .. } => {}
            Generator::OutAn { .. } | Generator::Coast { .. } => {}
        }
    }

    /// Does OUTAN give an effort, past the velocity loop?
    pub(super) fn asks_effort(&self) -> bool {
        matches!(self, Generator::OutAn { level: Level::Effort, .. })
    }

    /// How it follows what leads it; none where nothing does.
    #[inline]
    pub(super) fn follower(&self) -> Option<&Follower> {
        match self {
            Generator::Follow(coupling) => Some(&coupling.follower),
            Generator::Track(follower) => Some(follower),
            _ => None,
        }
    }

    /// The same, to change it.
    pub(super) fn follower_mut(&mut self) -> Option<&mut Follower> {
        match self {
            Generator::Follow(coupling) => Some(&mut coupling.follower),
            Generator::Track(follower) => Some(follower),
            _ => None,
        }
    }
}

/// A coupling of one axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Coupling {
    /// What it follows.
    pub leader: Leader,
    /// What becomes of it at the end.
    pub disengage: Disengage,
    /// Error up to which it counts as accurate (inc), which it keeps (MACS-STO-09); negative: the error is shown with its sign.
    pub accuracy: i64,
    /// It keeps a pair of places of leader and axis.
    pub at_places: bool,
    pub follower: Follower,
}
