//! Client of an action: goals, their results, cancel, feedback.

use std::hash::{BuildHasher, Hasher, RandomState};

use lineshaft_msgs::foreign::action_msgs::srv::{CancelGoal, CancelGoalRequest, CancelGoalResponse};
use lineshaft_msgs::foreign::unique_identifier_msgs::msg::UUID;
use lineshaft_msgs::{
    Action, FeedbackMessage, GetResult, GetResultRequest, GetResultResponse, SendGoal, SendGoalRequest,
    SendGoalResponse,
};

use super::service::{ClientError, RequestNumber, ServiceClient};
use crate::layer::action::GoalId;
use crate::layer::endpoint::Context;
use crate::layer::name::FullName;
use crate::link::Reader;
use crate::link::protocol::{EndpointKind, WireType};
use crate::link::qos::Qos;

/// Client of one action.
pub struct ActionClient<A: Action> {
    goals: ServiceClient<SendGoal<A>>,
    results: ServiceClient<GetResult<A>>,
    cancels: ServiceClient<CancelGoal>,
    feedback: Reader,
    name: FullName,
}

impl<A: Action> ActionClient<A> {
    pub(in crate::layer) fn new(context: &Context, name: FullName) -> Self {
        let part = |part: &str| name.action_part(part);
        let wire = WireType::feedback::<A>();
        let (_, feedback) = context.open(EndpointKind::Subscription, &part("feedback"), wire, Qos::STREAM);
        Self {
            goals: ServiceClient::new(context, part("send_goal"), Qos::SERVICE),
            results: ServiceClient::new(context, part("get_result"), Qos::SERVICE),
            cancels: ServiceClient::new(context, part("cancel_goal"), Qos::SERVICE),
            feedback,
            name,
        }
    }

    /// Returns the full name of the action.
    pub fn name(&self) -> &FullName {
        &self.name
    }

    /// Returns the number of servers that are matched now, for each service: goals, results, cancel requests.
    pub fn servers(&self) -> [usize; 3] {
        [self.goals.servers(), self.results.servers(), self.cancels.servers()]
    }

    /// Sends a goal. Returns its identifier, and the number of the request.
    ///
    /// # Errors
    /// [`ClientError::Unsent`].
    pub fn send_goal(&mut self, goal: A::Goal) -> Result<(GoalId, RequestNumber), ClientError> {
        let id = random_id();
        let number = self.goals.send(&SendGoalRequest { goal_id: UUID { uuid: id.0 }, goal })?;
        Ok((id, number))
    }

    /// Waits until the server has accepted or rejected a goal.
    ///
    /// # Errors
    /// As [`ServiceClient::reply`].
    pub async fn accepted(&mut self, number: RequestNumber) -> Result<bool, ClientError> {
        let SendGoalResponse { accepted, .. } = self.goals.reply(number).await?;
        Ok(accepted)
    }

    /// Requests the result of a goal; the server answers when the goal has ended.
    ///
    /// # Errors
    /// [`ClientError::Unsent`].
    pub fn request_result(&mut self, id: GoalId) -> Result<RequestNumber, ClientError> {
        self.results.send(&GetResultRequest { goal_id: UUID { uuid: id.0 } })
    }

    /// Waits for the result of a goal, or for a feedback message of any goal of the action. Nothing is lost if the future is dropped.
    ///
    /// # Errors
    /// As [`ServiceClient::reply`].
    pub async fn result_or_feedback(&mut self, number: RequestNumber) -> Result<Progress<A>, ClientError> {
        loop {
            let taken = tokio::select! {
                reply = self.results.reply(number) => {
                    let GetResultResponse { status, result } = reply?;
                    return Ok(Progress::Ended { status, result });
                }
                taken = self.feedback.next() => taken,
            };
            let Ok(sample) = taken else { continue };
            if let Ok(FeedbackMessage { goal_id, feedback }) = sample.decode::<FeedbackMessage<A::Feedback>>() {
                return Ok(Progress::Feedback { id: GoalId(goal_id.uuid), feedback });
            }
        }
    }

    /// Sends a cancel request for a goal.
    ///
    /// # Errors
    /// [`ClientError::Unsent`].
    pub fn cancel(&mut self, id: GoalId) -> Result<RequestNumber, ClientError> {
        let mut request = CancelGoalRequest::default();
        request.goal_info.goal_id.uuid = id.0;
        self.cancels.send(&request)
    }

    /// Waits for the return code of a cancel request, a constant of [`CancelGoalResponse`].
    ///
    /// # Errors
    /// As [`ServiceClient::reply`].
    pub async fn canceling(&mut self, number: RequestNumber) -> Result<i8, ClientError> {
        let CancelGoalResponse { return_code, .. } = self.cancels.reply(number).await?;
        Ok(return_code)
    }
}

/// Report of a goal.
pub enum Progress<A: Action> {
    /// Feedback message.
    Feedback {
        /// Identifier of the goal.
        id: GoalId,
        /// Feedback.
        feedback: A::Feedback,
    },
    /// The goal has ended.
    Ended {
        /// A constant of `GoalStatus`: 4 succeeded, 5 canceled, 6 aborted, or 0 for a goal that is unknown to the server.
        status: i8,
        /// Result.
        result: A::Result,
    },
}

/// Returns a unique goal identifier: 128 random bits, from the keys that the system gives to hash maps.
fn random_id() -> GoalId {
    let mut id = [0; 16];
    for half in id.chunks_exact_mut(8) {
        half.copy_from_slice(&RandomState::new().build_hasher().finish().to_le_bytes());
    }
    GoalId(id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_goal_has_another_identifier() {
        let ids: HashSet<_> = (0..1000).map(|_| random_id()).collect();
        assert_eq!(ids.len(), 1000);
        assert!(ids.iter().all(|id| id.0[..8] != id.0[8..]));
    }
}
