//! Objects that the application gets: goal requests, cancel requests, and handles of accepted goals.

use std::sync::Arc;

use lineshaft_msgs::foreign::action_msgs::srv::CancelGoalResponse;
use lineshaft_msgs::{Action, SendGoalResponse};
use tokio::sync::watch;

use super::goals::{End, GoalId, GoalStatusEntry, Selection, Stamp};
use super::server::{Shared, goal_info};
use crate::layer::publisher::PublishError;
use crate::layer::service::Reply;

/// Goal that is to be accepted or rejected; it is rejected when dropped.
pub struct GoalRequest<A: Action> {
    id: GoalId,
    shared: Arc<Shared<A>>,
    goal: A::Goal,
    /// Reply; `None` once the request is decided.
    reply: Option<Reply<SendGoalResponse>>,
}

impl<A: Action> GoalRequest<A> {
    pub(super) fn new(shared: Arc<Shared<A>>, id: GoalId, goal: A::Goal, reply: Reply<SendGoalResponse>) -> Self {
        Self { id, shared, goal, reply: Some(reply) }
    }

    /// Returns the identifier.
    pub fn id(&self) -> GoalId {
        self.id
    }

    /// Returns the goal of the client.
    pub fn goal(&self) -> &A::Goal {
        &self.goal
    }

    /// Accepts the goal; [`GoalHandle::execute`] starts it.
    pub fn accept(mut self) -> GoalHandle<A> {
        let stamp = self.shared.clock.now();
        let mut goals = self.shared.goals();
        let canceled = goals.accept(self.id, Stamp::from(&stamp));
        self.shared.show(&goals);
        drop(goals);
        if let Some(reply) = self.reply.take() {
            reply.send_soon(SendGoalResponse { accepted: true, stamp });
        }
        GoalHandle { id: self.id, shared: self.shared.clone(), goal: self.goal.clone(), canceled, ended: false }
    }

    /// Rejects the goal. ROS has no field for the reason.
    pub fn reject(mut self) {
        self.reject_once();
    }

    /// Rejects the goal; returns false if it was decided before.
    fn reject_once(&mut self) -> bool {
        let Some(reply) = self.reply.take() else { return false };
        self.shared.goals().withdraw(self.id);
        reply.send_soon(SendGoalResponse { accepted: false, stamp: self.shared.clock.now() });
        true
    }
}

impl<A: Action> Drop for GoalRequest<A> {
    fn drop(&mut self) {
        if self.reject_once() {
            tracing::warn!("{}: goal {} was dropped undecided, which rejects it", self.shared.name, self.id);
        }
    }
}

/// Accepted goal. It is aborted if it is dropped before its end.
pub struct GoalHandle<A: Action> {
    id: GoalId,
    shared: Arc<Shared<A>>,
    goal: A::Goal,
    canceled: watch::Receiver<bool>,
    ended: bool,
}

impl<A: Action> GoalHandle<A> {
    /// Returns the identifier.
    pub fn id(&self) -> GoalId {
        self.id
    }

    /// Returns the goal of the client.
    pub fn goal(&self) -> &A::Goal {
        &self.goal
    }

    /// Sets the goal to executing; further calls have no effect.
    pub fn execute(&self) {
        let mut goals = self.shared.goals();
        if goals.execute(self.id) {
            self.shared.show(&goals);
        }
    }

    /// Publishes feedback. Never blocks; the caller chooses the rate.
    pub fn feedback(&self, feedback: &A::Feedback) -> Result<(), PublishError> {
        self.shared.feedback(self.id, feedback)
    }

    /// Returns true if a client has canceled the goal: it has to stop, and then to end with [`canceled`](Self::canceled).
    pub fn is_cancel_requested(&self) -> bool {
        *self.canceled.borrow()
    }

    /// Completes when a client cancels the goal, at once if it is already canceled.
    pub async fn cancel_requested(&self) {
        let mut canceled = self.canceled.clone();
        if canceled.wait_for(|canceled| *canceled).await.is_err() {
            // The goal has already ended, so it can no longer be canceled.
            std::future::pending::<()>().await;
        }
    }

    /// Ends the goal as succeeded.
    pub fn succeed(mut self, result: A::Result) {
        self.end(End::Succeeded, result);
    }

    /// Ends the goal as aborted.
    pub fn abort(mut self, result: A::Result) {
        self.end(End::Aborted, result);
    }

    /// Ends the goal as canceled. If no client has canceled it, it ends aborted.
    pub fn canceled(mut self, result: A::Result) {
        if !self.is_cancel_requested() {
            tracing::warn!("{}: goal {} ends aborted: nobody has canceled it", self.shared.name, self.id);
        }
        self.end(End::Canceled, result);
    }

    fn end(&mut self, end: End, result: A::Result) {
        self.ended = true;
        self.shared.end(self.id, end, result);
    }
}

impl<A: Action> Drop for GoalHandle<A> {
    fn drop(&mut self) {
        if !self.ended {
            tracing::warn!("{}: goal {} was dropped before its end, which aborts it", self.shared.name, self.id);
            self.end(End::Aborted, A::Result::default());
        }
    }
}

/// Goals that a client requests to cancel; the request is refused when dropped.
pub struct CancelRequest<A: Action> {
    shared: Arc<Shared<A>>,
    selection: Selection,
    /// Goals that this request has canceled already; some may have ended since.
    begun: Vec<GoalStatusEntry>,
    /// Reply; `None` once the request is decided.
    reply: Option<Reply<CancelGoalResponse>>,
}

impl<A: Action> CancelRequest<A> {
    pub(super) fn new(
        shared: Arc<Shared<A>>,
        selection: Selection,
        begun: Vec<GoalStatusEntry>,
        reply: Reply<CancelGoalResponse>,
    ) -> Self {
        Self { shared, selection, begun, reply: Some(reply) }
    }

    /// Returns the goals to be decided, without those that are already canceling.
    pub fn goals(&self) -> &[GoalId] {
        &self.selection.open
    }

    /// Cancels all goals; their handles report it.
    pub fn accept(self) {
        self.accept_some(|_| true);
    }

    /// Cancels some of the goals.
    pub fn accept_some(mut self, accept: impl Fn(GoalId) -> bool) {
        self.decide(accept);
    }

    /// Cancels none of the goals.
    pub fn reject(mut self) {
        self.decide(|_| false);
    }

    /// Decides the request; returns false if it was decided before.
    fn decide(&mut self, accept: impl Fn(GoalId) -> bool) -> bool {
        let Some(reply) = self.reply.take() else { return false };
        let open = self.selection.open.iter().copied();
        let accepted: Vec<_> = open.filter(|id| accept(*id)).chain(self.selection.canceling.iter().copied()).collect();
        let mut goals = self.shared.goals();
        let canceling = goals.cancel(&accepted);
        if !self.selection.open.is_empty() && !canceling.is_empty() {
            self.shared.show(&goals);
        }
        drop(goals);
        let canceling = with_begun(canceling, &self.begun);
        let rejected = accepted.is_empty() && !self.selection.open.is_empty();
        // Accepted, but all of the goals have ended meanwhile.
        let terminated = !accepted.is_empty() && canceling.is_empty();
        let return_code = match (rejected, terminated) {
            (true, _) => CancelGoalResponse::ERROR_REJECTED,
            (_, true) => CancelGoalResponse::ERROR_GOAL_TERMINATED,
            _ => CancelGoalResponse::ERROR_NONE,
        };
        reply.send_soon(CancelGoalResponse {
            return_code,
            goals_canceling: canceling.into_iter().map(goal_info).collect(),
        });
        true
    }
}

/// Returns all goals that a request cancels, including those that it has canceled before and that have ended since.
fn with_begun(mut canceling: Vec<GoalStatusEntry>, begun: &[GoalStatusEntry]) -> Vec<GoalStatusEntry> {
    for goal in begun {
        if canceling.iter().all(|other| other.id != goal.id) {
            canceling.push(*goal);
        }
    }
    canceling
}

impl<A: Action> Drop for CancelRequest<A> {
    fn drop(&mut self) {
        if self.decide(|_| false) {
            tracing::warn!("{}: a cancel request was dropped undecided, which refuses it", self.shared.name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::goals::Status;
    use super::*;

    #[test]
    fn answer_lists_each_goal_once_that_the_request_has_canceled() {
        let goal =
            |id: u8| GoalStatusEntry { id: GoalId([id; 16]), stamp: Stamp::default(), status: Status::Canceling };
        let listed = with_begun(vec![goal(1), goal(2)], &[goal(2), goal(3)]);
        assert_eq!(listed, [goal(1), goal(2), goal(3)]);
    }
}
