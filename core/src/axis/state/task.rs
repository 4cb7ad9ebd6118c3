//! The task for which an axis moves: its goal, or the function that it follows.

use super::alarm::Numbers;
use super::goal::Goal;
use super::moved_by::MovedBy;
use crate::code::Code;
use crate::object::Leader;
use serde::{Deserialize, Serialize};

/// The trajectory that an axis has left, the reason, and its numbers.
pub(in crate::axis) type LeftTrack = (u64, Code, Numbers);

/// The goal of an axis, and the function that it follows.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::axis) struct Task {
    goal: Option<Goal>,
    /// The function that moves it whenever it is on.
    function: Option<MovedBy>,
    /// The trajectory that it has left in this cycle, and the reason.
    #[serde(skip)]
    left: Option<LeftTrack>,
}

impl Task {
    #[inline]
    pub(in crate::axis) fn goal(&self) -> &Option<Goal> {
        &self.goal
    }

    #[inline]
    pub(in crate::axis) fn goal_mut(&mut self) -> Option<&mut Goal> {
        self.goal.as_mut()
    }

    /// Begins a goal; the goal before has ended.
    #[inline]
    pub(in crate::axis) fn begin(&mut self, goal: Goal) {
        self.goal = Some(goal);
    }

    /// Ends the goal and returns it.
    #[inline]
    pub(in crate::axis) fn take_goal(&mut self) -> Option<Goal> {
        self.goal.take()
    }

    /// Returns the function that moves the axis whenever it is on.
    #[inline]
    pub(in crate::axis) fn function(&self) -> Option<MovedBy> {
        self.function
    }

    /// Lets a function move the axis from now on.
    #[inline]
    pub(in crate::axis) fn follow(&mut self, by: MovedBy) {
        self.function = Some(by);
    }

    /// Takes the axis from its function.
    #[inline]
    pub(in crate::axis) fn leave_function(&mut self) {
        self.function = None;
    }

    /// Takes the axis from the function with that sink. Returns true if it has moved the axis.
    #[inline]
    pub(in crate::axis) fn leave_sink(&mut self, sink: Leader) -> bool {
        self.function.take_if(|by| by.sink == sink).is_some()
    }

    /// Returns the trajectory that it has left in this cycle, and the reason.
    #[inline]
    pub(in crate::axis) fn left(&self) -> Option<LeftTrack> {
        self.left
    }

    /// Notes that it has left the trajectory of that command.
    #[inline]
    pub(in crate::axis) fn leave_track(&mut self, left: LeftTrack) {
        self.left = Some(left);
    }

    /// Clears the note that it has left a trajectory.
    #[inline]
    pub(in crate::axis) fn forget_left(&mut self) {
        self.left = None;
    }
}
