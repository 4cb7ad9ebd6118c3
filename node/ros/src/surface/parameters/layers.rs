//! `~/save_parameters`, `~/reset_parameters`, `~/delete_parameters`: layers of the parameters.

use super::give;
use crate::layer::{CreateError, Node, Reply, Request, ServiceServer};
use crate::surface::hub::Hub;
use crate::surface::table;
use lineshaft_core::command::Action;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::Layer;
use lineshaft_msgs::srv::{
    AxesCommand, AxesCommandResponse, ResetParameters, ResetParametersRequest, ResetParametersResponse,
};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::oneshot;
use tokio::task::JoinSet;

/// Longer than a healthy disk takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// Command of the machine whose result is to be stored.
#[derive(Clone, Copy)]
struct Stored {
    action: fn(AxisSet) -> Action,
    /// Past participle for the answer.
    done: &'static str,
    /// Effect that remains although it is not stored.
    kept: &'static str,
}

const SAVE: Stored = Stored {
    action: Action::SaveParameters,
    done: "saved",
    kept: "the machine keeps the parameters until its power goes, but they are not stored",
};
const DELETE: Stored = Stored {
    action: Action::DeleteParameters,
    done: "back at the cell",
    kept: "what the cell says is in force, but what was saved is still stored",
};

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    for (served, command) in [(table::SAVE_PARAMETERS, SAVE), (table::DELETE_PARAMETERS, DELETE)] {
        let server = served.server(node)?;
        tasks.spawn(serve_stored(server, Arc::clone(hub), command));
    }
    let server = table::RESET_PARAMETERS.server(node)?;
    tasks.spawn(serve_reset(server, Arc::clone(hub)));
    Ok(())
}

async fn serve_stored(mut server: ServiceServer<AxesCommand>, hub: Arc<Hub>, command: Stored) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let respond = |success, message| AxesCommandResponse { success, message };
        let axes = match hub.host.config().find_axes(&message.axes) {
            Ok(axes) => axes,
            Err(error) => {
                hub.refuse(format!("{service}: {error}"));
                reply.send_soon(respond(false, error.to_string()));
                continue;
            }
        };
        // Submitted here, so that commands keep the order of their requests.
        match give(&hub, (command.action)(axes)) {
            Ok(answers) => {
                let hub = Arc::clone(&hub);
                open.spawn(async move {
                    let outcome = match answers.accepted().await {
                        Ok(()) => store(&hub, command, axes).await,
                        Err(sentence) => Err(sentence),
                    };
                    answer(reply, outcome, respond).await;
                });
            }
            Err(sentence) => reply.send_soon(respond(false, sentence)),
        }
    }
}

/// Waits until the new layer User is stored.
async fn store(hub: &Hub, command: Stored, axes: AxisSet) -> Result<String, String> {
    let (answer, answered) = oneshot::channel();
    hub.host.store_parameters(answer);
    match tokio::time::timeout(PATIENCE, answered).await {
        Ok(Ok(Ok(()))) => Ok(summary(axes, command.done)),
        Ok(Ok(Err(sentence))) => Err(format!("{}: {sentence}", command.kept)),
        Ok(Err(_)) => Err(format!("{}: the machine has stopped", command.kept)),
        Err(_) => Err(format!("{}: the disk has not answered within {} s", command.kept, PATIENCE.as_secs())),
    }
}

async fn serve_reset(mut server: ServiceServer<ResetParameters>, hub: Arc<Hub>) {
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let respond = |success, message| ResetParametersResponse { success, message };
        let axes = hub.host.config().find_axes(&message.axes).map_err(|error| error.to_string());
        let asked = axes.and_then(|axes| Ok((axes, layer(message.layer)?)));
        let (axes, layer) = match asked {
            Ok(asked) => asked,
            Err(sentence) => {
                hub.refuse(format!("{service}: {sentence}"));
                reply.send_soon(respond(false, sentence));
                continue;
            }
        };
        match give(&hub, Action::ResetParameters { axes, layer }) {
            Ok(answers) => {
                open.spawn(async move {
                    let outcome = answers.accepted().await.map(|()| summary(axes, "reset"));
                    answer(reply, outcome, respond).await;
                });
            }
            Err(sentence) => reply.send_soon(respond(false, sentence)),
        }
    }
}

/// Returns the layer with this number in the interface.
fn layer(number: u8) -> Result<Layer, String> {
    match number {
        ResetParametersRequest::USER => Ok(Layer::User),
        ResetParametersRequest::INIT => Ok(Layer::Init),
        other => Err(format!("layer is {other}; 0 USER, 1 INIT are allowed")),
    }
}

async fn answer<P: serde::Serialize>(
    reply: Reply<P>,
    outcome: Result<String, String>,
    respond: impl FnOnce(bool, String) -> P,
) {
    let success = outcome.is_ok();
    // A client that has left is not an error of the machine; the layer logs it.
    let _ = reply.send(respond(success, outcome.unwrap_or_else(|sentence| sentence))).await;
}

fn summary(axes: AxisSet, done: &str) -> String {
    match axes.len() {
        1 => format!("parameters of 1 axis {done}"),
        count => format!("parameters of {count} axes {done}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_have_the_numbers_of_the_interface() {
        assert_eq!((layer(0), layer(1)), (Ok(Layer::User), Ok(Layer::Init)));
        assert_eq!(layer(2), Err("layer is 2; 0 USER, 1 INIT are allowed".to_owned()));
    }
}
