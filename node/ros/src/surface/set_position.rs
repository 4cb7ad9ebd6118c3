//! `~/set_position`: the present position of an axis gets a new value; answered when the machine has accepted or refused it.

use super::hub::Hub;
use super::{one_command, table};
use crate::layer::{CreateError, Node};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{Amount, SetPositionRequest, Units};
use lineshaft_msgs::srv::{SetPositionRequest as Asked, SetPositionResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::SET_POSITION.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), resolve, response));
    Ok(())
}

fn resolve(config: &MachineConfig, Asked { axis, position, units }: Asked) -> Result<Action, String> {
    let request = |units| SetPositionRequest { axis, position: Amount::Number(position), units };
    let resolved = Units::from_number(units).and_then(|units| config.resolve_set_position(&request(units)));
    resolved.map_err(|error| error.to_string())
}

fn response(outcome: Result<(), String>) -> SetPositionResponse {
    SetPositionResponse { success: outcome.is_ok(), message: outcome.err().unwrap_or_default() }
}
