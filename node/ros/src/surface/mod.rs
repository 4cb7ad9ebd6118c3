//! Surface: the ROS 2 interface of the machine (contract section 7).
//!
//! It reads snapshots and events, and submits commands. It does not access the machine directly, and cannot delay a cycle.

pub mod host;

mod abort;
mod axes;
mod commands;
mod controllers;
mod cycle_statistics;
mod diagnostics;
mod functions;
mod goal;
mod gripper;
mod group;
mod history;
mod home;
mod home_axis;
mod hub;
mod joint_names;
#[cfg(any(test, feature = "fuzz"))]
mod laws;
mod leaders;
mod lifecycle;
mod loggers;
pub mod messages;
mod move_axis;
mod names;
mod one_command;
mod parameters;
mod phase;
mod probe_axis;
mod record;
mod refusing;
mod robot_description;
mod sdo;
mod signals;
mod states;
mod streams;
mod synchronize;
pub mod table;
mod time;
mod topic_commands;
mod trajectory;
mod tune;
mod urdf;
mod vocabulary;

pub use group::{GripperSettings, Group, TrajectorySettings};
pub use hub::is_logged_on_rosout;
pub use joint_names::JointNames;
#[cfg(any(test, feature = "fuzz"))]
pub use laws::any_goal;
pub use names::check_names;
pub use parameters::start_commands;
pub use states::{StateReceiver, StateSender, states};
pub use topic_commands::TopicCommands;

use crate::layer::{CreateError, Node};
use controllers::Controllers;
use host::{Host, StampedEvent};
use hub::Hub;
use lineshaft_msgs::action::{HomeAxis, MoveAxis, Phase, ProbeAxis, Synchronize};
use std::sync::Arc;
use tokio::sync::mpsc::UnboundedReceiver;
use tokio::task::JoinSet;

/// Surface of a running machine. Dropping it removes the node from the graph.
pub struct Surface {
    // Declared before the node, because its tasks hold endpoints of the node.
    tasks: JoinSet<()>,
    hub: Arc<Hub>,
    _node: Node,
}

impl Surface {
    /// Creates all topics, services and actions on `node`. `events` are all events of the machine, in order; `states` are the cycles of the
    /// state topics; `groups` are the groups of axes that execute trajectories together, empty for all axes with a drive.
    ///
    /// # Errors
    /// An endpoint cannot be created, or a parameter override of the node is invalid.
    pub fn start(
        node: Node,
        host: Arc<dyn Host>,
        events: UnboundedReceiver<StampedEvent>,
        states: StateReceiver,
        groups: &[Group],
    ) -> Result<Self, CreateError> {
        let mut tasks = JoinSet::new();
        let hub = Hub::start(&node, Arc::clone(&host), events, &mut tasks)?;
        time::start(&node, &hub, &mut tasks)?;
        loggers::start(&node, &mut tasks)?;
        states::start(&node, &host, states, &mut tasks)?;
        cycle_statistics::start(&node, &hub, &mut tasks)?;
        let life = lifecycle::start(&node, &hub, &mut tasks)?;
        diagnostics::start(&node, &hub, Arc::clone(&life), &mut tasks)?;
        axes::start(&node, &hub, &mut tasks)?;
        abort::start(&node, &hub, &mut tasks)?;
        goal::start::<MoveAxis>(&node, &hub, &mut tasks)?;
        goal::start::<ProbeAxis>(&node, &hub, &mut tasks)?;
        goal::start::<HomeAxis>(&node, &hub, &mut tasks)?;
        goal::start::<Synchronize>(&node, &hub, &mut tasks)?;
        goal::start::<Phase>(&node, &hub, &mut tasks)?;
        home::start(&node, &hub, &mut tasks)?;
        commands::start(&node, &hub, &mut tasks)?;
        sdo::start(&node, &hub, &mut tasks)?;
        functions::start(&node, &hub, &mut tasks)?;
        record::start(&node, &hub, &mut tasks)?;
        robot_description::start(&node, &hub, &mut tasks)?;
        streams::start(&node, &hub, &mut tasks)?;
        vocabulary::start(&node, &hub, &mut tasks)?;
        let joints = trajectory::Joints::all(host.config(), host.joint_names(), host.directory(), groups);
        let controllers = Controllers::new(host.controller_manager(), node.name().name(), joints);
        let controllers = Arc::new(controllers);
        trajectory::start(&node, &hub, &controllers, &mut tasks)?;
        gripper::start(&node, &hub, groups, &controllers, &mut tasks)?;
        controllers::start(&node, &hub, &controllers, &life, &mut tasks)?;
        tune::start(&node, &hub, &mut tasks)?;
        // Last: it publishes the parameters that the others have declared, and refuses overrides that match none.
        parameters::start(&node, &hub, &mut tasks)?;
        Ok(Self { tasks, hub, _node: node })
    }

    /// Returns true if a task has panicked, so that its requests are no longer answered.
    pub fn has_failed(&mut self) -> bool {
        std::iter::from_fn(|| self.tasks.try_join_next()).any(|ended| ended.is_err())
    }

    /// Returns a function that takes and releases all locks that requests need.
    pub fn pulse(&self) -> impl Fn() + Send + Sync + 'static {
        let hub = Arc::clone(&self.hub);
        move || hub.check_locks()
    }
}

#[cfg(test)]
mod tests;
