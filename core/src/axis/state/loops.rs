//! State of the loops that are closed here, of their feedback and of their supervision.

use super::effort_loops::EffortLoops;
use super::position_loop::PositionLoop;
use super::recovery::Recovery;
use super::velocity_feedback::VelocityFeedback;
use crate::regulator::Compensator;
use serde::{Deserialize, Serialize};

/// State of the loops that are closed here.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct Loops {
    compensation: Compensator,
    position: PositionLoop,
    effort: EffortLoops,
    velocity_feedback: VelocityFeedback,
    recovery: Recovery,
}

impl Loops {
    /// Returns loops that have not run yet, for a drive with that delay (cycles).
    pub(in crate::axis) fn new(delay: u32) -> Self {
        Self {
            compensation: Compensator::new(delay),
            position: PositionLoop::default(),
            effort: EffortLoops::default(),
            velocity_feedback: VelocityFeedback::default(),
            recovery: Recovery::default(),
        }
    }

    #[inline]
    pub(in crate::axis) fn compensation(&self) -> &Compensator {
        &self.compensation
    }

    #[inline]
    pub(in crate::axis) fn compensation_mut(&mut self) -> &mut Compensator {
        &mut self.compensation
    }

    #[inline]
    pub(in crate::axis) fn position(&self) -> &PositionLoop {
        &self.position
    }

    #[inline]
    pub(in crate::axis) fn position_mut(&mut self) -> &mut PositionLoop {
        &mut self.position
    }

    /// Returns the loops inside the position loop.
    #[inline]
    pub(in crate::axis) fn effort(&self) -> &EffortLoops {
        &self.effort
    }

    #[inline]
    pub(in crate::axis) fn effort_mut(&mut self) -> &mut EffortLoops {
        &mut self.effort
    }

    /// Returns the encoder of the velocity loop.
    #[inline]
    pub(in crate::axis) fn velocity_feedback(&self) -> &VelocityFeedback {
        &self.velocity_feedback
    }

    #[inline]
    pub(in crate::axis) fn velocity_feedback_mut(&mut self) -> &mut VelocityFeedback {
        &mut self.velocity_feedback
    }

    /// Returns the supervision of the loops.
    #[inline]
    pub(in crate::axis) fn recovery(&self) -> &Recovery {
        &self.recovery
    }

    #[inline]
    pub(in crate::axis) fn recovery_mut(&mut self) -> &mut Recovery {
        &mut self.recovery
    }
}
