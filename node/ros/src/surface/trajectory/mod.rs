//! `~/follow_joint_trajectory` and `~/joint_trajectory`, one pair for all axes with a drive or for each group of the cell.
//!
//! Law      a goal is checked in itself here and rejected with a sentence, or becomes one trajectory of the machine, which
//!          judges state, limits and tolerances and tells one end. Action and topic share the axes: the newer one counts
//! Reads    the parameters of [`settings`] when a goal comes
//! Refuses  see [`convert::Wrong`]
//! Source   joint_trajectory_controller of ros2_controllers (Jazzy); docs/interfaces.md lists the differences

mod action;
mod convert;
mod ending;
mod joints;
mod settings;
mod topic;

use super::group::Group;
use super::hub::Hub;
use super::table;
use crate::layer::{CreateError, Node};
use joints::Joints;
use lineshaft_core::trajectory::Trajectory;
use lineshaft_msgs::foreign::control_msgs::action::FollowJointTrajectoryGoal;
use std::sync::Arc;
use tokio::task::JoinSet;

/// Opens action and topic for each of `groups`; for all axes with a drive where there are none.
pub(super) fn start(node: &Node, hub: &Arc<Hub>, groups: &[Group], tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let all = Joints::all(hub.host.config(), hub.host.joint_names(), hub.host.directory(), groups);
    settings::declare(&hub.own, hub.host.config(), hub.host.joint_names(), &all);
    for joints in all {
        let joints = Arc::new(joints);
        let action =
            table::FOLLOW_JOINT_TRAJECTORY.server_as(node, &joints.name_of(&table::FOLLOW_JOINT_TRAJECTORY.0))?;
        let topic = table::JOINT_TRAJECTORY.subscription_as(node, &joints.name_of(&table::JOINT_TRAJECTORY.0))?;
        tasks.spawn(action::serve(action, Arc::clone(hub), Arc::clone(&joints)));
        tasks.spawn(topic::serve(topic, Arc::clone(hub), joints));
    }
    Ok(())
}

/// The trajectory that a goal asks for, as if it began at its stamp: [`Started::begin`] turns it into what begins now.
/// A long one takes its time.
///
/// # Errors
/// What is wrong with the goal in itself, in one sentence.
fn read(hub: &Hub, joints: &Joints, goal: &FollowJointTrajectoryGoal) -> Result<Started, String> {
    let settings = settings::Settings::read(&hub.own, joints);
    let request = convert::request(joints, &settings, goal, hub.now_ns()).map_err(|wrong| wrong.to_string())?;
    let trajectory = hub.host.config().resolve_trajectory(&request).map_err(|error| error.to_string())?;
    Ok(Started { trajectory, stamp_ns: convert::stamp_ns(&goal.trajectory.header.stamp) })
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
mod tests;
