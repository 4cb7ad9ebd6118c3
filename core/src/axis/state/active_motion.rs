//! The generator of the command position, and the only functions that replace it.

use super::generator::{Coupling, Generator};
use super::planned_motion::PlannedMotion;
use crate::command::Level;
use crate::position::Position;
use crate::profile::Motion;
use crate::sync::Disengage;
use crate::sync::follower::Follower;
use serde::{Deserialize, Serialize};

/// The active motion of an axis.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(in crate::axis) struct ActiveMotion {
    generator: Generator,
}

impl Default for ActiveMotion {
    /// Returns an axis at rest.
    fn default() -> Self {
        Self { generator: Generator::Rest }
    }
}

impl ActiveMotion {
    #[inline]
    pub(in crate::axis) fn generator(&self) -> &Generator {
        &self.generator
    }

    /// Begins any motion. State and source of the command change with it: see `Axis::begin_motion`.
    #[inline]
    pub(in crate::axis) fn begin(&mut self, generator: Generator) {
        self.generator = generator;
    }

    /// Ends the motion: the position stays.
    #[inline]
    pub(in crate::axis) fn rest(&mut self) {
        self.generator = Generator::Rest;
    }

    /// Continues with a planned motion.
    #[inline]
    pub(in crate::axis) fn plan(&mut self, planned: PlannedMotion) {
        self.generator = Generator::Plan(planned);
    }

    /// Continues as follower of the trajectory of the goal.
    #[inline]
    pub(in crate::axis) fn track(&mut self, follower: Follower) {
        self.generator = Generator::Track(follower);
    }

    /// Runs a drive without position loop at a velocity (inc/s).
    #[inline]
    pub(in crate::axis) fn run_open(&mut self, velocity: f64) {
        self.generator = Generator::Open { velocity };
    }

    /// Opens the position loop: the loops inside it run at this value (-1 to 1).
    #[inline]
    pub(in crate::axis) fn run_out_an(&mut self, value: f64, level: Level) {
        self.generator = Generator::OutAn { value, level };
    }

    /// Lets a drive without position loop coast from that cycle on, if it runs.
    pub(in crate::axis) fn coast(&mut self, since: u64) {
        if matches!(self.generator, Generator::Open { .. }) {
            self.generator = Generator::Coast { since };
        }
    }

    /// Returns the follower; none if there is no leader.
    #[inline]
    pub(in crate::axis) fn follower(&self) -> Option<&Follower> {
        self.generator.follower()
    }

    /// Returns the follower, to advance it; none if there is no leader.
    #[inline]
    pub(in crate::axis) fn follower_mut(&mut self) -> Option<&mut Follower> {
        match &mut self.generator {
            Generator::Follow(coupling) => Some(&mut coupling.follower),
            Generator::Track(follower) => Some(follower),
            _ => None,
        }
    }

    /// Returns the follower of a coupling, to advance it.
    pub(in crate::axis) fn coupled_mut(&mut self) -> Option<&mut Follower> {
        match &mut self.generator {
            Generator::Follow(coupling) => Some(&mut coupling.follower),
            _ => None,
        }
    }

    /// Sets whether the slave of the active cam rests at its end.
    pub(in crate::axis) fn rest_at_end(&mut self, rests: bool) {
        if let Generator::Follow(Coupling { disengage, follower, .. }) = &mut self.generator {
            follower.rest_at_end(rests && *disengage == Disengage::Stop);
        }
    }

    /// Starts the planned motion one cycle earlier and returns its motion of `cycle`; none without one.
    pub(in crate::axis) fn begin_earlier(&mut self, cycle: u64) -> Option<Motion> {
        let Generator::Plan(course) = &mut self.generator else { return None };
        course.begin_earlier();
        Some(course.at(cycle))
    }

    /// Moves the plan, or the target of the follower, by a superimposed motion.
    pub(in crate::axis) fn superimpose(&mut self, change: Position) {
        match &mut self.generator {
            Generator::Plan(course) => course.shift(change),
            _ => {
                if let Some(follower) = self.follower_mut() {
                    follower.shift(change);
                }
            }
        }
    }

    /// Shifts the positions of the motion with the coordinate; the axis does not move. A cam and a trajectory are not
    /// shifted, because the coordinate does not change while they are active.
    pub(in crate::axis) fn shift(&mut self, by: Position) {
        match &mut self.generator {
            Generator::Plan(course) => course.shift(by),
            Generator::Follow(Coupling { follower, .. }) => follower.shift(by),
            Generator::Rest | Generator::Track(_) | Generator::Open { .. } => {}
            Generator::OutAn { .. } | Generator::Coast { .. } => {}
        }
    }
}
