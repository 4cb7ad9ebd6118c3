//! Services whose requests are one command each, answered when the machine has accepted or refused it.

use super::hub::Hub;
use super::refusing::refusal_with_message;
use super::{one_command, table};
use crate::layer::{CreateError, Node};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{self, Amount, RequestError, Units};
use lineshaft_msgs::srv::{
    AbortTriggerRequest, AbortTriggerResponse, GearOutRequest, GearOutResponse, SetMemoryRequest, SetMemoryResponse,
    SetOutputRequest, SetOutputResponse, SetPositionRequest, SetPositionResponse, TouchProbeRequest,
    TouchProbeResponse,
};
use std::sync::Arc;
use tokio::task::JoinSet;

refusal_with_message! {
    AbortTriggerRequest, AbortTriggerResponse;
    GearOutRequest, GearOutResponse;
    SetMemoryRequest, SetMemoryResponse;
    SetOutputRequest, SetOutputResponse;
    SetPositionRequest, SetPositionResponse;
    TouchProbeRequest, TouchProbeResponse;
}

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    tasks.spawn(one_command::serve(table::SET_POSITION.server(node)?, Arc::clone(hub), set_position));
    tasks.spawn(one_command::serve(table::SET_POSITION_RELATIVE.server(node)?, Arc::clone(hub), shift_position));
    tasks.spawn(one_command::serve(table::GEAR_OUT.server(node)?, Arc::clone(hub), gear_out));
    tasks.spawn(one_command::serve(table::TOUCH_PROBE.server(node)?, Arc::clone(hub), touch_probe));
    tasks.spawn(one_command::serve(table::ABORT_TRIGGER.server(node)?, Arc::clone(hub), abort_trigger));
    tasks.spawn(one_command::serve(table::SET_OUTPUT.server(node)?, Arc::clone(hub), set_output));
    tasks.spawn(one_command::serve(table::SET_MEMORY.server(node)?, Arc::clone(hub), set_memory));
    Ok(())
}

fn set_position(config: &MachineConfig, asked: SetPositionRequest) -> Result<Action, RequestError> {
    new_position(config, asked, false)
}

fn shift_position(config: &MachineConfig, asked: SetPositionRequest) -> Result<Action, RequestError> {
    new_position(config, asked, true)
}

fn new_position(config: &MachineConfig, asked: SetPositionRequest, relative: bool) -> Result<Action, RequestError> {
    let SetPositionRequest { axis, position, units } = asked;
    let (position, units) = (Amount::Number(position), Units::from_number(units)?);
    config.resolve_set_position(&request::SetPositionRequest { axis, position, units, relative })
}

fn gear_out(config: &MachineConfig, asked: GearOutRequest) -> Result<Action, RequestError> {
    let GearOutRequest { axis, at, increments, disengage } = asked;
    config.resolve_gear_out(&request::GearOutRequest { axis, at, increments, disengage }).map(Action::GearOut)
}

fn touch_probe(config: &MachineConfig, asked: TouchProbeRequest) -> Result<Action, RequestError> {
    let TouchProbeRequest { axis, event, edge, continuous, units, window_only, first_position, last_position } = asked;
    let request = request::TouchProbeRequest {
        axis,
        event,
        edge,
        continuous,
        units: Units::from_number(units)?,
        window_only,
        first_position: Amount::Number(first_position),
        last_position: Amount::Number(last_position),
    };
    config.resolve_touch_probe(&request).map(Action::TouchProbe)
}

fn abort_trigger(config: &MachineConfig, asked: AbortTriggerRequest) -> Result<Action, RequestError> {
    let AbortTriggerRequest { axis, event } = asked;
    config.resolve_abort_trigger(&request::AbortTriggerRequest { axis, event }).map(Action::AbortTrigger)
}

fn set_output(config: &MachineConfig, asked: SetOutputRequest) -> Result<Action, String> {
    let given = pairs("outputs", asked.outputs, asked.values)?;
    config.resolve_set_output(&given).map_err(|error| error.to_string())
}

fn set_memory(config: &MachineConfig, asked: SetMemoryRequest) -> Result<Action, String> {
    let given = pairs("cells", asked.cells, asked.values)?;
    config.resolve_set_memory(&given).map_err(|error| error.to_string())
}

fn pairs(what: &str, names: Vec<String>, values: Vec<f64>) -> Result<Vec<(String, f64)>, String> {
    if names.len() != values.len() {
        return Err(format!("{what} holds {}, values {}; as many of both are needed", names.len(), values.len()));
    }
    Ok(std::iter::zip(names, values).collect())
}
