//! The latch for which a goal searches.

use crate::command::ProbeEdge;
use crate::object::Object;
use crate::position::Position;
use crate::profile::{Limits, Shape};
use serde::{Deserialize, Serialize};

/// The latch for which a goal searches, and its end after that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct Search {
    pub(in crate::axis) source: Object,
    pub(in crate::axis) edge: ProbeEdge,
    /// Distance from the latched position.
    pub(in crate::axis) distance: Position,
    pub(in crate::axis) limits: Limits,
    /// Position at the start.
    pub(in crate::axis) from: Position,
    /// Whether the first latch has come.
    pub(in crate::axis) is_over: bool,
}

impl Search {
    /// Whether its latch is still missing.
    pub(in crate::axis) fn is_on(&self) -> bool {
        !self.is_over
    }

    /// Whether a profile exists for its limits.
    pub(in crate::axis) fn is_sound(&self) -> bool {
        let Limits { velocity, acceleration, deceleration, shape } = self.limits;
        let jerks = match shape {
            Shape::Jerk(jerks) => [jerks.rise, jerks.fall, jerks.brake_rise, jerks.brake_fall],
            _ => [1.0; 4],
        };
        [velocity, acceleration, deceleration].into_iter().chain(jerks).all(|rate| rate > 0.0 && rate.is_finite())
    }
}
