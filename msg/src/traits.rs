//! Traits of messages, services and actions: their names, hashes and types.

use std::fmt::Debug;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// A struct on the wire: a message, or a part of a service or an action.
pub trait Message: Clone + Debug + Default + PartialEq + Serialize + DeserializeOwned + Send + Sync + 'static {
    /// Name in ROS 2, such as `lineshaft_msgs/msg/AxisState` or `lineshaft_msgs/srv/SetPosition_Request`.
    const NAME: &'static str;
    /// Type hash (RIHS01, REP 2016): `RIHS01_` and 64 hex digits.
    const HASH: &'static str;
    /// Text for bags in the schema encoding `ros2msg`: the lines of the struct, then those of each message that it
    /// needs, after a line of 80 `=` and a line `MSG: package/Type`.
    const SCHEMA: &'static str;
}

/// A request and its response.
pub trait Service: 'static {
    /// Request of the client.
    type Request: Clone + Debug + Default + PartialEq + Serialize + DeserializeOwned + Send + Sync + 'static;
    /// Response of the server.
    type Response: Clone + Debug + Default + PartialEq + Serialize + DeserializeOwned + Send + Sync + 'static;
    /// Name in ROS 2, such as `lineshaft_msgs/srv/SetPosition`.
    const NAME: &'static str;
    /// Type hash of the service as a whole, which includes its events. DDS endpoints have the hashes of its parts.
    const HASH: &'static str;
    /// Type hash of the request.
    const REQUEST_HASH: &'static str;
    /// Type hash of the response.
    const RESPONSE_HASH: &'static str;
}

/// A goal that takes time, its feedback and its result.
///
/// On the wire an action is the services [`SendGoal`](crate::SendGoal), [`GetResult`](crate::GetResult) and
/// [`CancelGoal`](crate::foreign::action_msgs::srv::CancelGoal), and the topics of
/// [`FeedbackMessage`](crate::FeedbackMessage) and
/// [`GoalStatusArray`](crate::foreign::action_msgs::msg::GoalStatusArray).
pub trait Action: 'static {
    /// Goal of the client.
    type Goal: Message;
    /// Result at the end.
    type Result: Message;
    /// Progress.
    type Feedback: Message;
    /// Name in ROS 2, such as `lineshaft_msgs/action/MoveAxis`.
    const NAME: &'static str;
    /// Type hash of the action as a whole.
    const HASH: &'static str;
    /// Name of the service that accepts goals, `.._SendGoal`.
    const SEND_GOAL_NAME: &'static str;
    /// Type hash of that service.
    const SEND_GOAL_HASH: &'static str;
    /// Type hash of [`SendGoalRequest`](crate::SendGoalRequest).
    const SEND_GOAL_REQUEST_HASH: &'static str;
    /// Type hash of [`SendGoalResponse`](crate::SendGoalResponse).
    const SEND_GOAL_RESPONSE_HASH: &'static str;
    /// Name of the service that returns results, `.._GetResult`.
    const GET_RESULT_NAME: &'static str;
    /// Type hash of that service.
    const GET_RESULT_HASH: &'static str;
    /// Type hash of [`GetResultRequest`](crate::GetResultRequest).
    const GET_RESULT_REQUEST_HASH: &'static str;
    /// Type hash of [`GetResultResponse`](crate::GetResultResponse).
    const GET_RESULT_RESPONSE_HASH: &'static str;
    /// Type hash of [`FeedbackMessage`](crate::FeedbackMessage).
    const FEEDBACK_MESSAGE_HASH: &'static str;
}
