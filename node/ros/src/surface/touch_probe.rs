//! `~/touch_probe` and `~/abort_trigger`: record positions at probe edges; answered when the machine has accepted or refused it.

use super::hub::Hub;
use super::{one_command, table};
use crate::layer::{CreateError, Node};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::request::{AbortTriggerRequest, Amount, RequestError, TouchProbeRequest, Units};
use lineshaft_msgs::srv::{
    AbortTriggerRequest as AskedToAbort, AbortTriggerResponse, TouchProbeRequest as Asked, TouchProbeResponse,
};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::TOUCH_PROBE.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), arm, |outcome| {
        let (success, message) = answer(outcome);
        TouchProbeResponse { success, message }
    }));
    let server = table::ABORT_TRIGGER.server(node)?;
    tasks.spawn(one_command::serve(server, Arc::clone(hub), abort, |outcome| {
        let (success, message) = answer(outcome);
        AbortTriggerResponse { success, message }
    }));
    Ok(())
}

fn arm(config: &MachineConfig, asked: Asked) -> Result<Action, String> {
    resolve(config, asked).map_err(|error| error.to_string())
}

fn resolve(config: &MachineConfig, asked: Asked) -> Result<Action, RequestError> {
    let Asked { axis, event, edge, continuous, units, window_only, first_position, last_position } = asked;
    let units = Units::from_number(units)?;
    let [first_position, last_position] = [first_position, last_position].map(Amount::Number);
    let request =
        TouchProbeRequest { axis, event, edge, continuous, units, window_only, first_position, last_position };
    config.resolve_touch_probe(&request).map(Action::TouchProbe)
}

fn abort(config: &MachineConfig, AskedToAbort { axis, event }: AskedToAbort) -> Result<Action, String> {
    let resolved = config.resolve_abort_trigger(&AbortTriggerRequest { axis, event });
    resolved.map(Action::AbortTrigger).map_err(|error| error.to_string())
}

fn answer(outcome: Result<(), String>) -> (bool, String) {
    (outcome.is_ok(), outcome.err().unwrap_or_default())
}
