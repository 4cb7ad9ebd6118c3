//! `~/gear_out`: ends a coupling at a position; answered when the machine has accepted or refused it.

use super::hub::Hub;
use super::{one_command, table};
use crate::layer::{CreateError, Node};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::GearOutRequest;
use lineshaft_msgs::srv::{GearOutRequest as Asked, GearOutResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::GEAR_OUT.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), resolve, response));
    Ok(())
}

fn resolve(config: &MachineConfig, Asked { axis, at, increments, disengage }: Asked) -> Result<Action, String> {
    let resolved = config.resolve_gear_out(&GearOutRequest { axis, at, increments, disengage });
    resolved.map(Action::GearOut).map_err(|error| error.to_string())
}

fn response(outcome: Result<(), String>) -> GearOutResponse {
    GearOutResponse { success: outcome.is_ok(), message: outcome.err().unwrap_or_default() }
}
