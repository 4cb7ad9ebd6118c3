//! Touch probes: with motion to a mark, without motion, and their end.

use super::motion::{BufferMode, Move, MoveMode};
use crate::modulo::Direction;
use crate::object::Object;
use crate::position::Length;
use serde::{Deserialize, Serialize};

/// Edge of a latch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProbeEdge {
    /// From 0 to 1.
    #[default]
    Rising,
    /// From 1 to 0.
    Falling,
    /// The first of both.
    Both,
    /// The index pulse of the encoder of the axis, instead of an edge; a missing pulse is an error (INDEX).
    Index,
}

/// A search for a mark and a move to a distance from it (touch probe to position). Velocity, acceleration and
/// deceleration of 0 mean the defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Index of the axis.
    pub axis: u16,
    /// Whether `target` is a distance from the command position, not a position.
    pub relative: bool,
    /// End of the search without a mark (inc).
    pub target: Length,
    /// Velocity (inc/s).
    pub velocity: f64,
    /// Acceleration (inc/s^2).
    pub acceleration: f64,
    /// Deceleration (inc/s^2).
    pub deceleration: f64,
    /// Jerk (inc/s^3), as in [`Move`].
    pub jerk: f64,
    /// The input, encoder or axis that latches.
    pub source: Object,
    /// Edge of the latch.
    pub edge: ProbeEdge,
    /// End of the goal, relative to the position of the axis at the latch (inc); negative in negative direction.
    pub distance: Length,
}

impl Probe {
    /// Returns the search motion.
    pub fn search(&self) -> Move {
        Move {
            axis: self.axis,
            mode: if self.relative { MoveMode::Relative } else { MoveMode::Absolute },
            target: self.target,
            velocity: self.velocity,
            acceleration: self.acceleration,
            deceleration: self.deceleration,
            jerk: self.jerk,
            direction: Direction::Shortest,
            buffer_mode: BufferMode::Aborting,
        }
    }
}

/// A passive touch probe: records the position of one axis at a latch, without motion (MC_TouchProbe).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchProbe {
    /// Index of the axis.
    pub axis: u16,
    /// The input, encoder or axis that latches.
    pub source: Object,
    /// Edge of the latch.
    pub edge: ProbeEdge,
    /// Whether every latch is recorded until the probe is aborted; otherwise only the first one.
    pub continuous: bool,
    /// First and last position of the axis (inc) between which a latch is recorded, both included; `None`: anywhere.
    pub window: Option<[Length; 2]>,
}

/// The end of touch probes of one axis (MC_AbortTrigger).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AbortTrigger {
    /// Index of the axis.
    pub axis: u16,
    /// Object that latches; `None`: all touch probes of the axis.
    pub source: Option<Object>,
}
