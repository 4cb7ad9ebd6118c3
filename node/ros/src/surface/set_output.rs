//! `~/set_output`: outputs of section io, all of a request in one cycle; answered when the machine has accepted or refused it.

use super::hub::Hub;
use super::{one_command, table};
use crate::layer::{CreateError, Node};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_msgs::srv::{SetOutputRequest as Asked, SetOutputResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::SET_OUTPUT.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), resolve, response));
    Ok(())
}

fn resolve(config: &MachineConfig, Asked { outputs, values }: Asked) -> Result<Action, String> {
    if outputs.len() != values.len() {
        return Err(format!("outputs holds {}, values {}; as many of both are needed", outputs.len(), values.len()));
    }
    let given: Vec<_> = std::iter::zip(outputs, values).collect();
    config.resolve_set_output(&given).map_err(|error| error.to_string())
}

fn response(outcome: Result<(), String>) -> SetOutputResponse {
    SetOutputResponse { success: outcome.is_ok(), message: outcome.err().unwrap_or_default() }
}
