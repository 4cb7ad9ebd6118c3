//! `~/set_position`: gives the present position of an axis a new value; `~/set_position_relative`: adds an offset to it; answered when the
//! machine has accepted or refused it.

use super::hub::Hub;
use super::{one_command, table};
use crate::layer::{CreateError, Node};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{Amount, RequestError, SetPositionRequest, Units};
use lineshaft_msgs::srv::{SetPositionRequest as Asked, SetPositionResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::SET_POSITION.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), set, response));
    let server = table::SET_POSITION_RELATIVE.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), shift, response));
    Ok(())
}

fn set(config: &MachineConfig, asked: Asked) -> Result<Action, String> {
    let resolved = request(asked).and_then(|request| config.resolve_set_position(&request));
    resolved.map_err(|error| error.to_string())
}

fn shift(config: &MachineConfig, asked: Asked) -> Result<Action, String> {
    let resolved = request(asked).and_then(|request| config.resolve_shift_position(&request));
    resolved.map_err(|error| error.to_string())
}

fn request(Asked { axis, position, units }: Asked) -> Result<SetPositionRequest, RequestError> {
    Ok(SetPositionRequest { axis, position: Amount::Number(position), units: Units::from_number(units)? })
}

fn response(outcome: Result<(), String>) -> SetPositionResponse {
    SetPositionResponse { success: outcome.is_ok(), message: outcome.err().unwrap_or_default() }
}
