//! `~/follow_joint_trajectory`, `~/joint_trajectory`, `~/controller_state` and `~/query_state`, for all axes with a drive or for each group of the cell.
//!
//! Law      a goal is checked in itself here and rejected with a sentence, or becomes one trajectory of the machine, which
//!          judges state, limits and tolerances and tells one end. Action and topic share the axes: the newer one counts
//! Reads    the parameters of [`settings`] when a goal comes
//! Refuses  see [`convert::Wrong`]
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
use super::host::Busy;
use super::hub::{Answers, Hub};
use super::table;
use crate::layer::{CreateError, Node};
use convert::Wrong;
pub(super) use joints::Joints;
use lineshaft_core::command::Action;
use lineshaft_core::request::TrajectoryRequest;
use lineshaft_core::trajectory::Trajectory;
use lineshaft_msgs::foreign::control_msgs::action::FollowJointTrajectoryGoal;
use points::Points;
use settings::Settings;
use std::sync::Arc;
use tokio::task::JoinSet;

/// Opens action, topics and service for each of `controllers`.
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
        let taker =
            Taker { hub: Arc::clone(hub), controllers: Arc::clone(controllers), place, joints: Arc::clone(joints) };
        tasks.spawn(action::serve(action, taker.clone()));
        tasks.spawn(topic::serve(topic, taker.clone()));
        let query = table::QUERY_STATE.server_as(node, &joints.name_of(&table::QUERY_STATE.0))?;
        tasks.spawn(query_state::serve(query, taker));
        let state = table::CONTROLLER_STATE.publisher_as(node, &joints.name_of(&table::CONTROLLER_STATE.0))?;
        tasks.spawn(controller_state::publish(state, Arc::clone(hub), Arc::clone(joints)));
    }
    Ok(())
}

/// What takes the trajectories of one controller.
#[derive(Clone)]
struct Taker {
    hub: Arc<Hub>,
    controllers: Arc<Controllers>,
    /// Place of the controller.
    place: usize,
    joints: Arc<Joints>,
}

impl Taker {
    /// Reads a goal, if the controller is active.
    ///
    /// # Errors
    /// The controller is inactive, or what is wrong with the goal in itself, in one sentence.
    fn read(&self, goal: &FollowJointTrajectoryGoal) -> Result<Started, String> {
        self.controllers.check(self.place)?;
        read(&self.hub, &self.joints, goal)
    }

    /// Hands a trajectory over, if the controller is still active; `topic` is the one of which it is a message.
    ///
    /// # Errors
    /// It is inactive. Within: the machine takes no more commands now.
    fn hand_over(&self, started: Started, topic: Option<&str>) -> Result<Result<Answers, Busy>, String> {
        let submit = || {
            let action = Action::Trajectory(started.begin(self.hub.now_ns()));
            match topic {
                Some(topic) => self.hub.submit_message(topic, action),
                None => self.hub.submit(action),
            }
        };
        let number = |given: &Result<Answers, Busy>| given.as_ref().ok().map(|answers| answers.sequence);
        self.controllers.while_active(self.place, submit, number)
    }
}

/// The trajectory that a goal asks for, as if it began at its stamp: [`Started::begin`] turns it into what begins now.
/// A long one takes its time.
///
/// # Errors
/// What is wrong with the goal in itself, in one sentence.
fn read(hub: &Hub, joints: &Joints, goal: &FollowJointTrajectoryGoal) -> Result<Started, String> {
    let settings = Settings::read(&hub.own, joints);
    let request = request(hub, joints, &settings, goal).map_err(|wrong| wrong.to_string())?;
    let trajectory = hub.host.config().resolve_trajectory(&request).map_err(|error| error.to_string())?;
    Ok(Started { trajectory, stamp_ns: convert::stamp_ns(&goal.trajectory.header.stamp) })
}

fn request(
    hub: &Hub,
    joints: &Joints,
    settings: &Settings,
    goal: &FollowJointTrajectoryGoal,
) -> Result<TrajectoryRequest, Wrong> {
    if !integrate::is_asked_for(goal) {
        return convert::request(joints, settings, goal, hub.now_ns());
    }
    if !settings.integration {
        return Err(Wrong::Integration);
    }
    let mut goal = goal.clone();
    let command = Points::of(joints, &hub.host.snapshot().board).command;
    integrate::integrate(joints, &mut goal, &command)?;
    convert::request(joints, settings, &goal, hub.now_ns())
}

/// A trajectory that waits to be handed over, and when it begins.
struct Started {
    trajectory: Trajectory,
    /// Nanoseconds since the Unix epoch; none: at once.
    stamp_ns: Option<i64>,
}

impl Started {
    /// The trajectory for a machine whose next cycle is at `now_ns`: what reading it took is not added to its start.
    fn begin(self, now_ns: i64) -> Arc<Trajectory> {
        Arc::new(self.trajectory.starting(self.stamp_ns.map_or(0, |stamp| stamp.saturating_sub(now_ns))))
    }
}

#[cfg(test)]
pub(super) mod tests;
