//! Goals of a slot: orders for which a client waits, and their ends.

use super::{Phase, Slot};
use crate::code::Code;
use crate::function::goal::{Goal, GoalEnd};
use crate::function::program::Progress;
use crate::function::wires::Wires;

impl Slot {
    /// Returns an error if a goal cannot begin an order now.
    pub(crate) fn check_goal(&self, wires: &Wires) -> Result<(), Code> {
        match () {
            () if !wires.kind.description().takes_goals => Err(Code::FUNCTION_NO_GOALS),
            () if self.goal.is_some() || self.is_active() && self.function.progress() == Progress::Moves => {
                Err(Code::FUNCTION_BUSY)
            }
            () => Ok(()),
        }
    }

    /// Accepts a checked goal; the rest of a previous order is dropped.
    pub(crate) fn take_goal(&mut self, sequence: u64) {
        self.function.drop_order();
        self.goal = Some(Goal::new(sequence));
    }

    /// Returns true if a goal runs; its axis has handled the START by then.
    pub(crate) fn follows_goal(&self) -> bool {
        self.goal.is_some() && self.phase == Phase::Active
    }

    /// Cancels its goal, if it has that sequence number.
    pub(crate) fn cancel_goal(&mut self, sequence: u64) -> bool {
        let Some(goal) = self.goal.as_mut().filter(|goal| goal.sequence == sequence) else { return false };
        if goal.cancel() {
            self.end_goal(Code::CANCELLED);
        }
        true
    }

    /// Ends its goal for another reason than its order, which is dropped.
    pub(crate) fn abort_goal(&mut self, code: Code) {
        if self.goal.is_some() {
            self.end_goal(code);
            self.function.drop_order();
        }
    }

    fn end_goal(&mut self, code: Code) {
        if let Some(Goal { sequence, .. }) = self.goal.take() {
            let left = self.function.shown().first().copied().unwrap_or(0);
            self.ended = Some(GoalEnd { sequence, code, left });
        }
    }

    /// Returns true if a goal runs, or has ended and was not reported.
    #[inline]
    pub(crate) fn has_goal(&self) -> bool {
        self.goal.is_some() || self.ended.is_some()
    }

    /// Takes the end of its goal, once.
    pub(crate) fn take_end(&mut self) -> Option<GoalEnd> {
        self.ended.take()
    }

    /// Advances the goal by the result of the call.
    #[cold]
    pub(super) fn advance_goal(&mut self) {
        let Some(goal) = &mut self.goal else { return };
        if let Some(code) = goal.advance(self.function.progress()) {
            self.end_goal(code);
            if code == Code::CANCELLED {
                self.function.drop_order();
            }
        }
    }
}
