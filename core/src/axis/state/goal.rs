//! The active goal of an axis.

use super::probe_search::Search;
use super::tracker::Tracker;
use crate::code::Code;
use crate::position::Position;
use serde::{Deserialize, Serialize};

/// Smallest velocity, acceleration and deceleration of a goal, in increments. With less a move would practically never
/// end.
pub(in crate::axis) const LEAST_RATE: f64 = 1e-6;

/// The active goal of the axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Goal {
    /// Number of the command that started it.
    pub sequence: u64,
    /// Code with which it ends once the axis is at rest. None: it ends at its target.
    pub ending: Option<Code>,
    /// End before rounding to whole increments; none for a goal without end.
    pub target: Option<Position>,
    /// The latch that it searches for, or has found.
    pub search: Option<Search>,
    /// Its trajectory.
    pub track: Option<Tracker>,
    /// The trajectory that the axis follows until its own begins; the goal of that one has ended.
    pub before: Option<Tracker>,
}
