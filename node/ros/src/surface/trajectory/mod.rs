//! `~/follow_joint_trajectory`, `~/joint_trajectory`, `~/controller_state` and `~/query_state`, for all axes with a drive or for each group
//! of the cell.
//!
//! Law      the goal itself is checked here. It is rejected with a message, or becomes one trajectory of the machine, which checks state,
//!          limits and tolerances and reports one end. Action and topic share the axes: the newer trajectory takes effect
//! Reads    the parameters of [`settings`] when a goal arrives
//! Refuses  see [`convert::GoalError`]
//! Source   joint_trajectory_controller of ros2_controllers (Jazzy); docs/interfaces.md lists the differences

mod action;
mod controller_state;
mod convert;
mod ending;
mod integrate;
mod joints;
mod points;
mod query_state;
mod settings;
mod topic;

use super::controllers::Controllers;
use super::host::SubmitError;
use super::hub::{CommandEvents, Hub};
use super::table;
use crate::layer::{CreateError, Node};
use convert::GoalError;
pub(super) use joints::Joints;
use lineshaft_core::command::Action;
use lineshaft_core::request::TrajectoryRequest;
use lineshaft_core::trajectory::Trajectory;
use lineshaft_msgs::foreign::control_msgs::action::FollowJointTrajectoryGoal;
use points::Points;
use settings::Settings;
use std::sync::Arc;
use tokio::task::JoinSet;

/// Creates action, topics and service for each of `controllers`.
pub(super) fn start(
    node: &Node,
    hub: &Arc<Hub>,
    controllers: &Arc<Controllers>,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    settings::declare(
        &hub.own,
        hub.host.config(),
        hub.host.joint_names(),
        controllers.all().iter().map(|one| &*one.joints),
    );
    for (place, controller) in controllers.all().iter().enumerate() {
        let joints = &controller.joints;
        let action =
            table::FOLLOW_JOINT_TRAJECTORY.server_as(node, &joints.name_of(&table::FOLLOW_JOINT_TRAJECTORY.0))?;
        let topic = table::JOINT_TRAJECTORY.subscription_as(node, &joints.name_of(&table::JOINT_TRAJECTORY.0))?;
        let taker = TrajectoryReceiver {
            hub: Arc::clone(hub),
            controllers: Arc::clone(controllers),
            place,
            joints: Arc::clone(joints),
        };
        tasks.spawn(action::serve(action, taker.clone()));
        tasks.spawn(topic::serve(topic, taker.clone()));
        let query = table::QUERY_STATE.server_as(node, &joints.name_of(&table::QUERY_STATE.0))?;
        tasks.spawn(query_state::serve(query, taker));
        let state = table::CONTROLLER_STATE.publisher_as(node, &joints.name_of(&table::CONTROLLER_STATE.0))?;
        tasks.spawn(controller_state::publish(state, Arc::clone(hub), Arc::clone(joints)));
    }
    Ok(())
}

/// Receiver of the trajectories of one controller.
#[derive(Clone)]
struct TrajectoryReceiver {
    hub: Arc<Hub>,
    controllers: Arc<Controllers>,
    /// Index of the controller.
    place: usize,
    joints: Arc<Joints>,
}

impl TrajectoryReceiver {
    /// Reads a goal, if the controller is active.
    ///
    /// # Errors
    /// The controller is inactive, or the goal itself is invalid; as a message.
    fn read(&self, goal: &FollowJointTrajectoryGoal) -> Result<PreparedTrajectory, String> {
        self.controllers.check(self.place)?;
        read(&self.hub, &self.joints, goal)
    }

    /// Submits a trajectory, if the controller is still active. `topic` is the topic if it comes from a message.
    ///
    /// # Errors
    /// The controller is inactive. Inner error: the machine accepts no further commands at present.
    fn hand_over(
        &self,
        started: PreparedTrajectory,
        topic: Option<&str>,
    ) -> Result<Result<CommandEvents, SubmitError>, String> {
        let submit = || {
            let action = Action::Trajectory(started.begin(self.hub.now_ns()));
            match topic {
                Some(topic) => self.hub.submit_message(topic, action),
                None => self.hub.submit(action),
            }
        };
        let number = |given: &Result<CommandEvents, SubmitError>| given.as_ref().ok().map(|answers| answers.sequence);
        self.controllers.while_active(self.place, submit, number)
    }
}

/// Returns the trajectory of a goal as if it started at its stamp: [`PreparedTrajectory::begin`] converts it to a trajectory that starts now. Takes
/// time for a long goal.
///
/// # Errors
/// The goal itself is invalid; as a message.
fn read(hub: &Hub, joints: &Joints, goal: &FollowJointTrajectoryGoal) -> Result<PreparedTrajectory, String> {
    let settings = Settings::read(&hub.own, joints);
    let request = request(hub, joints, &settings, goal).map_err(|wrong| wrong.to_string())?;
    let trajectory = hub.host.config().resolve_trajectory(&request).map_err(|error| error.to_string())?;
    Ok(PreparedTrajectory { trajectory, stamp_ns: convert::stamp_ns(&goal.trajectory.header.stamp) })
}

fn request(
    hub: &Hub,
    joints: &Joints,
    settings: &Settings,
    goal: &FollowJointTrajectoryGoal,
) -> Result<TrajectoryRequest, GoalError> {
    if !integrate::has_points_to_integrate(goal) {
        return convert::request(joints, settings, goal, hub.now_ns());
    }
    if !settings.integration {
        return Err(GoalError::Integration);
    }
    let mut goal = goal.clone();
    let command = Points::of(joints, &hub.host.snapshot().board).command;
    integrate::integrate(joints, &mut goal, &command)?;
    convert::request(joints, settings, &goal, hub.now_ns())
}

/// Trajectory that is ready to be submitted, with its start time.
struct PreparedTrajectory {
    trajectory: Trajectory,
    /// Nanoseconds since the Unix epoch; `None`: at once.
    stamp_ns: Option<i64>,
}

impl PreparedTrajectory {
    /// Returns the trajectory for a machine whose next cycle is at `now_ns`: the time for reading it is not added to its start.
    fn begin(self, now_ns: i64) -> Arc<Trajectory> {
        Arc::new(self.trajectory.starting(self.stamp_ns.map_or(0, |stamp| stamp.saturating_sub(now_ns))))
    }
}

#[cfg(test)]
pub(super) mod tests;
