//! `~/set_position`: the present position of an axis gets a new value; answered when the machine has accepted or refused it.

use super::hub::{Answers, Hub};
use super::table;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Kind;
use lineshaft_core::request::{Amount, RequestError, SetPositionRequest, Units};
use lineshaft_core::text;
use lineshaft_msgs::srv::{SetPosition, SetPositionRequest as Asked, SetPositionResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::SET_POSITION.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve(mut server: ServiceServer<SetPosition>, hub: Arc<Hub>) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let given = resolve(hub.host.config(), message).map_err(|error| {
            hub.refuse(format!("{service}: {error}"));
            error.to_string()
        });
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
            Err(message) => reply.send_soon(SetPositionResponse { success: false, message }),
        }
    }
}

fn resolve(config: &MachineConfig, Asked { axis, position, units }: Asked) -> Result<Action, RequestError> {
    let units = Units::from_number(units)?;
    let request = SetPositionRequest { axis, position: Amount::Number(position), units };
    config.resolve_set_position(&request)
}

/// Waits for what the machine says to a command.
async fn answer(hub: &Hub, mut answers: Answers) -> SetPositionResponse {
    while let Some(answer) = answers.next().await {
        match answer.event.kind {
            Kind::Accepted => return SetPositionResponse { success: true, message: String::new() },
            Kind::Refused => {
                let message = text::sentence(&answer.event, hub.host.config());
                return SetPositionResponse { success: false, message };
            }
            _ => {}
        }
    }
    SetPositionResponse { success: false, message: "the machine has stopped".to_owned() }
}
