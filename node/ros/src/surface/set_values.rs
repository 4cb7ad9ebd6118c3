//! `~/set_output` and `~/set_memory`: set outputs of section io and cells of section memory, all of a request in one cycle; answered when
//! the machine has accepted or refused it.

use super::hub::Hub;
use super::{one_command, table};
use crate::layer::{CreateError, Node};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_msgs::srv::{SetMemoryRequest, SetMemoryResponse, SetOutputRequest, SetOutputResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let outputs = table::SET_OUTPUT.server(node)?;
    let cells = table::SET_MEMORY.server(node)?;
    tasks.spawn(one_command::serve(outputs, Arc::clone(hub), set_output, |outcome| {
        let (success, message) = response(outcome);
        SetOutputResponse { success, message }
    }));
    tasks.spawn(one_command::serve(cells, Arc::clone(hub), set_memory, |outcome| {
        let (success, message) = response(outcome);
        SetMemoryResponse { success, message }
    }));
    Ok(())
}

fn set_output(
    config: &MachineConfig,
    SetOutputRequest { outputs, values }: SetOutputRequest,
) -> Result<Action, String> {
    let given = pairs("outputs", outputs, values)?;
    config.resolve_set_output(&given).map_err(|error| error.to_string())
}

fn set_memory(config: &MachineConfig, SetMemoryRequest { cells, values }: SetMemoryRequest) -> Result<Action, String> {
    let given = pairs("cells", cells, values)?;
    config.resolve_set_memory(&given).map_err(|error| error.to_string())
}

fn pairs(what: &str, names: Vec<String>, values: Vec<f64>) -> Result<Vec<(String, f64)>, String> {
    if names.len() != values.len() {
        return Err(format!("{what} holds {}, values {}; as many of both are needed", names.len(), values.len()));
    }
    Ok(std::iter::zip(names, values).collect())
}

fn response(outcome: Result<(), String>) -> (bool, String) {
    (outcome.is_ok(), outcome.err().unwrap_or_default())
}
