//! `~/joint_trajectory`: trajectories without an answer. What is refused stands on `/rosout` and in `~/events`.

use super::joints::Joints;
use super::{convert, read};
use crate::layer::Subscription;
use crate::surface::hub::Hub;
use lineshaft_core::command::Action;
use lineshaft_core::object::AxisSet;
use lineshaft_msgs::foreign::control_msgs::action::FollowJointTrajectoryGoal;
use lineshaft_msgs::foreign::trajectory_msgs::msg::JointTrajectory;
use std::sync::Arc;
use tokio::task::spawn_blocking;

pub(super) async fn serve(mut topic: Subscription<JointTrajectory>, hub: Arc<Hub>, joints: Arc<Joints>) {
    let name = topic.topic().to_string();
    while let Some(message) = topic.next().await {
        let (reader, of) = (Arc::clone(&hub), Arc::clone(&joints));
        // A long one takes its time, on a thread of its own; one after the other, so that the newest one counts.
        let Ok(read) = spawn_blocking(move || action(&reader, &of, message)).await else { continue };
        let given = read.and_then(|action| hub.submit_unheard(action).map_err(|busy| busy.to_string()));
        if let Err(sentence) = given {
            hub.refuse(format!("{name}: message refused: {sentence}"));
        }
    }
}

/// What a message asks for: its trajectory with the tolerances of the parameters, or, without points, that its joints stop.
fn action(hub: &Hub, joints: &Joints, message: JointTrajectory) -> Result<Action, String> {
    if message.points.is_empty() {
        return stopped(joints, &message).map(Action::Halt);
    }
    let goal = FollowJointTrajectoryGoal { trajectory: message, ..FollowJointTrajectoryGoal::default() };
    Ok(Action::Trajectory(read(hub, joints, &goal)?.begin(hub.now_ns())))
}

/// The axes that a message without points stops: those that it names, or all.
fn stopped(joints: &Joints, message: &JointTrajectory) -> Result<AxisSet, String> {
    if message.joint_names.is_empty() {
        return Ok(joints.axes.iter().copied().collect());
    }
    let places = convert::places(joints, &message.joint_names).map_err(|wrong| wrong.to_string())?;
    Ok(places.iter().filter_map(|&place| joints.axes.get(place).copied()).collect())
}
