//! `~/set_output`: outputs of section io, all of a request in one cycle; answered when the machine has accepted or refused it.

use super::hub::{Answers, Hub};
use super::table;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Kind;
use lineshaft_core::text;
use lineshaft_msgs::srv::{SetOutput, SetOutputRequest as Asked, SetOutputResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::SET_OUTPUT.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve(mut server: ServiceServer<SetOutput>, hub: Arc<Hub>) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let given =
            resolve(hub.host.config(), message).inspect_err(|sentence| hub.refuse(format!("{service}: {sentence}")));
        // Handed over here, one after the other: commands keep the order of their requests.
        match given.and_then(|command| hub.submit(command).map_err(|busy| busy.to_string())) {
            Ok(answers) => {
                let hub = Arc::clone(&hub);
                open.spawn(async move {
                    let response = answer(&hub, answers).await;
                    // A client that has gone is no fault of the machine; the layer logs it.
                    let _ = reply.send(response).await;
                });
            }
            Err(message) => reply.send_soon(SetOutputResponse { success: false, message }),
        }
    }
}

fn resolve(config: &MachineConfig, Asked { outputs, values }: Asked) -> Result<Action, String> {
    if outputs.len() != values.len() {
        return Err(format!("outputs holds {}, values {}; as many of both are needed", outputs.len(), values.len()));
    }
    let given: Vec<_> = std::iter::zip(outputs, values).collect();
    config.resolve_set_output(&given).map_err(|error| error.to_string())
}

/// Waits for what the machine says to a command.
async fn answer(hub: &Hub, mut answers: Answers) -> SetOutputResponse {
    while let Some(answer) = answers.next().await {
        match answer.event.kind {
            Kind::Accepted => return SetOutputResponse { success: true, message: String::new() },
            Kind::Refused => {
                let message = text::sentence(&answer.event, hub.host.config());
                return SetOutputResponse { success: false, message };
            }
            _ => {}
        }
    }
    SetOutputResponse { success: false, message: "the machine has stopped".to_owned() }
}
