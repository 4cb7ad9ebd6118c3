//! `~/joint_trajectory`: trajectories without an answer. Refusals are reported on `/rosout` and in `~/events`.

use super::super::topic_commands::message_refused;
use super::joints::Joints;
use super::{PreparedTrajectory, TrajectoryReceiver, convert};
use crate::layer::Subscription;
use lineshaft_core::command::Action;
use lineshaft_core::object::AxisSet;
use lineshaft_msgs::foreign::control_msgs::action::FollowJointTrajectoryGoal;
use lineshaft_msgs::foreign::trajectory_msgs::msg::JointTrajectory;
use std::sync::Arc;
use tokio::task::{JoinSet, spawn_blocking};

/// Request of a message.
enum Asked {
    /// Trajectory with the tolerances of the parameters.
    Trajectory(PreparedTrajectory),
    /// Message without points, which stops these axes.
    Stop(AxisSet),
}

pub(super) async fn serve(mut topic: Subscription<JointTrajectory>, taker: TrajectoryReceiver) {
    let name = topic.topic().to_string();
    // Trajectories that the machine has not read yet.
    let mut open = JoinSet::new();
    while let Some(message) = topic.next().await {
        while open.try_join_next().is_some() {}
        let reader = taker.clone();
        // A long message takes time and is read in a separate thread; in sequence, so that the newest one takes effect.
        let Ok(asked) = spawn_blocking(move || read_message(&reader, message)).await else { continue };
        if let Err(sentence) = asked.and_then(|asked| submit_request(&taker, &name, asked, &mut open)) {
            taker.hub.refuse(message_refused(&name, &sentence));
        }
    }
}

/// Reads a message. An inactive controller accepts a stop as well.
fn read_message(taker: &TrajectoryReceiver, message: JointTrajectory) -> Result<Asked, String> {
    if message.points.is_empty() {
        return stopped(&taker.joints, &message).map(Asked::Stop);
    }
    let goal = FollowJointTrajectoryGoal { trajectory: message, ..FollowJointTrajectoryGoal::default() };
    taker.read(&goal).map(Asked::Trajectory)
}

/// Submits the request of a message.
fn submit_request(taker: &TrajectoryReceiver, topic: &str, asked: Asked, open: &mut JoinSet<()>) -> Result<(), String> {
    match asked {
        Asked::Stop(axes) => {
            taker.hub.submit_without_answer(Action::Halt(axes)).map(drop).map_err(|busy| busy.to_string())
        }
        Asked::Trajectory(started) => {
            let answers = taker.hand_over(started, Some(topic))?.map_err(|busy| busy.to_string())?;
            if taker.controllers.has_manager() {
                let (controllers, place) = (Arc::clone(&taker.controllers), taker.place);
                open.spawn(async move {
                    let sequence = answers.sequence;
                    // The machine reports a refusal itself.
                    let _ = answers.accepted().await;
                    controllers.record_read(place, sequence);
                });
            }
            Ok(())
        }
    }
}

/// Returns the axes that a message without points stops: the named ones, or all.
fn stopped(joints: &Joints, message: &JointTrajectory) -> Result<AxisSet, String> {
    if message.joint_names.is_empty() {
        return Ok(joints.axes.iter().copied().collect());
    }
    let places = convert::places(joints, &message.joint_names).map_err(|wrong| wrong.to_string())?;
    Ok(places.iter().filter_map(|&place| joints.axes.get(place).copied()).collect())
}
