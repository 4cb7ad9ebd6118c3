//! Names and bag schemas as in ROS 2.

use crate::action::{MoveAxis, MoveAxisFeedback, MoveAxisGoal};
use crate::foreign::action_msgs::srv::CancelGoal;
use crate::foreign::sensor_msgs::msg::JointState;
use crate::foreign::std_srvs::srv::TriggerRequest;
use crate::msg::{AxisState, AxisStates};
use crate::srv::{SetPosition, SetPositionRequest};
use crate::{Action, GetResult, Message, SendGoal, Service};

#[test]
fn messages_have_their_names() {
    assert_eq!(AxisState::NAME, "lineshaft_msgs/msg/AxisState");
    assert_eq!(JointState::NAME, "sensor_msgs/msg/JointState");
    assert_eq!(SetPositionRequest::NAME, "lineshaft_msgs/srv/SetPosition_Request");
    assert_eq!(MoveAxisGoal::NAME, "lineshaft_msgs/action/MoveAxis_Goal");
    assert_eq!(MoveAxisFeedback::NAME, "lineshaft_msgs/action/MoveAxis_Feedback");
}

#[test]
fn services_have_their_names() {
    assert_eq!(SetPosition::NAME, "lineshaft_msgs/srv/SetPosition");
    assert_eq!(CancelGoal::NAME, "action_msgs/srv/CancelGoal");
}

#[test]
fn actions_have_the_names_of_their_parts() {
    assert_eq!(MoveAxis::NAME, "lineshaft_msgs/action/MoveAxis");
    assert_eq!(SendGoal::<MoveAxis>::NAME, "lineshaft_msgs/action/MoveAxis_SendGoal");
    assert_eq!(GetResult::<MoveAxis>::NAME, "lineshaft_msgs/action/MoveAxis_GetResult");
}

/// Returns the declarations of a schema, without comments and blank lines.
fn declarations(schema: &str) -> Vec<&str> {
    schema
        .lines()
        .map(|line| line.split('#').next().unwrap_or_default().trim())
        .filter(|line| !line.is_empty())
        .collect()
}

#[test]
fn a_schema_holds_what_the_message_needs_in_order_of_first_mention() {
    let line = "=".repeat(80);
    let header = ["MSG: std_msgs/Header", "builtin_interfaces/Time stamp", "string frame_id"];
    let time = ["MSG: builtin_interfaces/Time", "int32 sec", "uint32 nanosec"];
    let joints =
        ["std_msgs/Header header", "string[] name", "float64[] position", "float64[] velocity", "float64[] effort"];
    let expected = [&joints[..], &[&line], &header, &[&line], &time].concat();
    assert_eq!(declarations(JointState::SCHEMA), expected);

    let axes = ["std_msgs/Header header", "uint64 cycle", "AxisState[] axes"];
    let axis = declarations(AxisState::SCHEMA);
    let expected =
        [&axes[..], &[&line], &header, &[&line], &["MSG: lineshaft_msgs/AxisState"], &axis, &[&line], &time].concat();
    assert_eq!(declarations(AxisStates::SCHEMA), expected);
}

#[test]
fn a_schema_keeps_the_comments_and_ends_its_last_line() {
    assert!(AxisState::SCHEMA.contains("# Actual position [m or rad].\nfloat64 position\n"));
    assert!(AxisState::SCHEMA.ends_with("int64 sync_error_increments\n"));
    assert_eq!(declarations(TriggerRequest::SCHEMA), [""; 0]);
}
