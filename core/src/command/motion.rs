//! Motion of one axis: goals and their mode, queries of a trajectory, and the open position loop.

use crate::modulo::Direction;
use crate::position::Length;
use crate::state::Reference;
use serde::{Deserialize, Serialize};

/// Meaning of [`Move::target`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MoveMode {
    /// A position; on a modulo axis within its turn, by [`Direction`].
    Absolute,
    /// A distance from the command position.
    Relative,
    /// A distance from the target of the active goal, or from the command position without one.
    Additive,
    /// A velocity, without end.
    Velocity,
    /// A distance that is superimposed on the present motion; at rest as [`MoveMode::Relative`].
    Superimposed,
}

impl MoveMode {
    /// Returns the value of `reference` during the motion.
    pub fn reference(self) -> Reference {
        match self {
            MoveMode::Absolute => Reference::PositionAbsolute,
            MoveMode::Relative | MoveMode::Additive | MoveMode::Superimposed => Reference::PositionRelative,
            MoveMode::Velocity => Reference::Speed,
        }
    }
}

/// Relation of a goal to the previous ones (PLCopen buffer mode).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BufferMode {
    /// Aborts the active goal.
    #[default]
    Aborting,
    /// Begins when the previous goal is done.
    Buffered,
    /// Blends at the end of the previous goal with the lower velocity of both.
    BlendingLow,
    /// Blends with the velocity of the previous goal.
    BlendingPrevious,
    /// Blends with its own velocity.
    BlendingNext,
    /// Blends with the higher velocity of both.
    BlendingHigh,
}

/// A positioning or velocity goal of one axis. Velocity, acceleration and deceleration of 0 mean the defaults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Move {
    /// Index of the axis.
    pub axis: u16,
    /// Meaning of the target.
    pub mode: MoveMode,
    /// Position or distance (inc); unused in mode velocity.
    pub target: Length,
    /// Velocity (inc/s); signed in mode velocity, where 0 is 0.
    pub velocity: f64,
    /// Acceleration (inc/s^2).
    pub acceleration: f64,
    /// Deceleration (inc/s^2).
    pub deceleration: f64,
    /// Jerk (inc/s^3), for profile jerk; the other profiles do not use it, but it is checked against `max_jerk`.
    pub jerk: f64,
    /// Direction of an absolute target on a modulo axis.
    pub direction: Direction,
    /// Relation to the previous goals.
    pub buffer_mode: BufferMode,
}

/// A query for the setpoint of a trajectory of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct QueryTrajectory {
    /// Index of the axis.
    pub axis: u16,
    /// Time of the query, in the time of the machine: the number of a cycle times the cycle time (ns).
    pub at_ns: u64,
}

/// Loop below the position loop that receives a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Level {
    /// The next loop, depending on `ampmode`: the value is a velocity, or with `ampmode` 2 an effort.
    #[default]
    Setpoint,
    /// No loop: the value is the effort.
    Effort,
}

impl Level {
    /// Names in requests.
    pub const NAMES: &'static [(&'static str, Self)] = &[("setpoint", Self::Setpoint), ("effort", Self::Effort)];
}

/// A value for the loops below the position loop of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutAn {
    /// Index of the axis.
    pub axis: u16,
    /// Value, -1 to 1: fraction of `max_velocity` or of `max_effort`.
    pub value: f64,
    /// Loop that receives the value.
    pub level: Level,
}
