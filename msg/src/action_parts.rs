//! Structs and services that ROS 2 derives from every action; only their goal, result and feedback differ.

use std::marker::PhantomData;

use serde::{Deserialize, Serialize};

use crate::foreign::builtin_interfaces::msg::Time;
use crate::foreign::unique_identifier_msgs::msg::UUID;
use crate::{Action, Service};

/// Requests the acceptance of a goal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SendGoalRequest<G> {
    /// Identifier chosen by the client.
    pub goal_id: UUID,
    /// The goal.
    pub goal: G,
}

/// Whether the goal was accepted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SendGoalResponse {
    /// False: rejected.
    pub accepted: bool,
    /// Time of the acceptance.
    pub stamp: Time,
}

/// Requests the result of a goal; answered when the goal has ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GetResultRequest {
    /// Identifier of the goal.
    pub goal_id: UUID,
}

/// The result of a goal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GetResultResponse<R> {
    /// A constant of [`GoalStatus`](crate::foreign::action_msgs::msg::GoalStatus): 4..6, or 0 for an unknown goal.
    pub status: i8,
    /// The result.
    pub result: R,
}

/// Progress of a goal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FeedbackMessage<F> {
    /// Identifier of the goal.
    pub goal_id: UUID,
    /// The feedback.
    pub feedback: F,
}

/// The service of action `A` that accepts goals.
#[derive(Clone, Copy, Debug)]
pub struct SendGoal<A>(PhantomData<A>);

impl<A: Action> Service for SendGoal<A> {
    type Request = SendGoalRequest<A::Goal>;
    type Response = SendGoalResponse;
    const NAME: &'static str = A::SEND_GOAL_NAME;
    const HASH: &'static str = A::SEND_GOAL_HASH;
    const REQUEST_HASH: &'static str = A::SEND_GOAL_REQUEST_HASH;
    const RESPONSE_HASH: &'static str = A::SEND_GOAL_RESPONSE_HASH;
}

/// The service of action `A` that returns results.
#[derive(Clone, Copy, Debug)]
pub struct GetResult<A>(PhantomData<A>);

impl<A: Action> Service for GetResult<A> {
    type Request = GetResultRequest;
    type Response = GetResultResponse<A::Result>;
    const NAME: &'static str = A::GET_RESULT_NAME;
    const HASH: &'static str = A::GET_RESULT_HASH;
    const REQUEST_HASH: &'static str = A::GET_RESULT_REQUEST_HASH;
    const RESPONSE_HASH: &'static str = A::GET_RESULT_RESPONSE_HASH;
}
