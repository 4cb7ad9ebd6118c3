//! The command of an axis: the motion of this cycle, and the streamed setpoints.

use super::streamed::Streamed;
use crate::position::Position;
use crate::profile::Motion;
use serde::{Deserialize, Serialize};

/// The motion of this cycle, and the state of the streamed setpoints.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[repr(C)]
pub(in crate::axis) struct CommandState {
    streamed: Streamed,
    motion: Motion,
}

impl CommandState {
    /// Returns the commanded motion of this cycle.
    #[inline]
    pub(in crate::axis) fn motion(&self) -> Motion {
        self.motion
    }

    #[inline]
    pub(in crate::axis) fn position(&self) -> Position {
        self.motion.position
    }

    /// Returns the commanded velocity (inc/s).
    #[inline]
    pub(in crate::axis) fn velocity(&self) -> f64 {
        self.motion.velocity
    }

    /// Returns the commanded acceleration (inc/s^2).
    #[inline]
    pub(in crate::axis) fn acceleration(&self) -> f64 {
        self.motion.acceleration
    }

    /// Executes a motion in this cycle.
    #[inline]
    pub(in crate::axis) fn execute(&mut self, motion: Motion) {
        self.motion = motion;
    }

    /// Rests at a position in this cycle.
    #[inline]
    pub(in crate::axis) fn rest_at(&mut self, position: Position) {
        self.motion = Motion::at_rest(position);
    }

    /// Runs a drive without position loop at a velocity (inc/s) from this cycle on.
    #[inline]
    pub(in crate::axis) fn run_at(&mut self, velocity: f64) {
        self.motion.velocity = velocity;
    }

    /// Shifts the position with the coordinate; the axis does not move.
    #[inline]
    pub(in crate::axis) fn shift(&mut self, by: Position) {
        self.motion.position += by;
    }

    #[inline]
    pub(in crate::axis) fn streamed(&self) -> &Streamed {
        &self.streamed
    }

    #[inline]
    pub(in crate::axis) fn streamed_mut(&mut self) -> &mut Streamed {
        &mut self.streamed
    }
}
