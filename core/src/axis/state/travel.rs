//! Direction of travel, and state at the software limits.

use super::at_limits::AtLimits;
use serde::{Deserialize, Serialize};

/// Direction of travel, and state at the software limits.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[repr(C)]
pub(in crate::axis) struct Travel {
    /// Sign of the last motion, for direction CURRENT.
    last_direction: f64,
    at_limits: AtLimits,
}

impl Travel {
    /// Returns the velocity of the last motion, whose sign is its direction; 0 before the first one.
    #[inline]
    pub(in crate::axis) fn last_direction(&self) -> f64 {
        self.last_direction
    }

    /// Notes the direction of a motion with that velocity; at rest the last direction stays.
    #[inline]
    pub(in crate::axis) fn note_direction(&mut self, velocity: f64) {
        if velocity != 0.0 {
            self.last_direction = velocity;
        }
    }

    /// Mirrors the direction: the counting direction was changed.
    #[inline]
    pub(in crate::axis) fn mirror(&mut self) {
        self.last_direction = 0.0 - self.last_direction;
    }

    #[inline]
    pub(in crate::axis) fn at_limits(&self) -> &AtLimits {
        &self.at_limits
    }

    #[inline]
    pub(in crate::axis) fn at_limits_mut(&mut self) -> &mut AtLimits {
        &mut self.at_limits
    }
}
