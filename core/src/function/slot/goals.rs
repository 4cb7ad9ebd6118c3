//! Goals of a slot: orders that a client waits for, and how they end.

use super::{Phase, Slot};
use crate::code::Code;
use crate::function::goal::{Goal, GoalEnd};
use crate::function::program::Progress;
use crate::function::wires::Wires;

impl Slot {
    /// May a goal begin an order?
    pub(crate) fn check_goal(&self, wires: &Wires) -> Result<(), Code> {
        match () {
            () if !wires.kind.description().takes_goals => Err(Code::FUNCTION_NO_GOALS),
            () if self.goal.is_some() || self.is_active() && self.function.progress() == Progress::Moves => {
                Err(Code::FUNCTION_BUSY)
            }
            () => Ok(()),
        }
    }

    /// Takes a goal that was checked; what an order before it has left is dropped.
    pub(crate) fn take_goal(&mut self, sequence: u64) {
        self.function.drop_order();
        self.goal = Some(Goal::new(sequence));
    }

    /// Is a goal of it under way, whose axis has heard of the START by now?
    pub(crate) fn follows_goal(&self) -> bool {
        self.goal.is_some() && self.phase == Phase::Active
    }

    /// Cancels its goal, if it is that one.
    pub(crate) fn cancel_goal(&mut self, sequence: u64) -> bool {
        let Some(goal) = self.goal.as_mut().filter(|goal| goal.sequence == sequence) else { return false };
        if goal.cancel() {
            self.end_goal(Code::CANCELLED);
        }
        true
    }

    /// Its goal ends by something else than its order, which is dropped.
    pub(crate) fn fail_goal(&mut self, code: Code) {
        if self.goal.is_some() {
            self.end_goal(code);
            self.function.drop_order();
        }
    }

    fn end_goal(&mut self, code: Code) {
        if let Some(Goal { sequence, .. }) = self.goal.take() {
            let left = self.function.shown().and_then(|shown| shown.first().copied()).unwrap_or(0);
            self.ended = Some(GoalEnd { sequence, code, left });
        }
    }

    /// Has it a goal, or one that has ended?
    #[inline]
    pub(crate) fn has_goal(&self) -> bool {
        self.goal.is_some() || self.ended.is_some()
    }

    /// How its goal has ended, once.
    pub(crate) fn take_end(&mut self) -> Option<GoalEnd> {
        self.ended.take()
    }

    /// What the call means to its goal.
    #[cold]
    pub(super) fn follow_goal(&mut self) {
        let Some(goal) = &mut self.goal else { return };
        if let Some(code) = goal.take(self.function.progress()) {
            self.end_goal(code);
            if code == Code::CANCELLED {
                self.function.drop_order();
            }
        }
    }
}
