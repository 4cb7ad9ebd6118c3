//! ROS 2 parameters: `x.<key>` for each row of the catalogue that applies to axis x, `machine.<key>` for the machine, `<function>.<field>`
//! for a function, and the node's own parameters without an object.
//!
//! The machine owns the parameters: a request becomes a command, and values come from the newest image. A number is in the unit of the
//! row's bare numbers (contract section 2).

mod catalogue;
mod describe;
mod events;
mod functions;
mod layers;
mod list;
pub(super) mod own;
mod read;
mod set;
mod start;
mod text;
mod view;

#[cfg(test)]
pub(super) mod fake;

pub(super) use self::own::type_name;
pub use self::start::start_commands;

use self::catalogue::Catalogue;
use super::hub::{CommandEvents, Hub};
use super::table;
use crate::layer::{CreateError, Node};
use lineshaft_core::command::Action;
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let catalogue = Arc::new(Catalogue::new(hub.host.config()));
    let changes = table::PARAMETER_EVENTS.publisher(node)?;
    // The last topic was created.
    own::declare_qos(&hub.own, node)?;
    hub.own.check()?;
    read::start(node, hub, &catalogue, tasks)?;
    set::start(node, hub, &catalogue, tasks)?;
    events::start(node, changes, hub, &catalogue, tasks);
    layers::start(node, hub, tasks)?;
    text::start(node, hub, tasks)
}

/// Submits a command. Returns its pending answers.
fn give(hub: &Arc<Hub>, action: Action) -> Result<CommandEvents, String> {
    hub.submit(action).map_err(|busy| busy.to_string())
}
