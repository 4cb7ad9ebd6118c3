//! Services whose requests are single commands, answered when the machine has accepted or refused them.

use super::hub::Hub;
use super::refusing::OutcomeResponse;
use crate::layer::{Request, ServiceServer};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_msgs::Service;
use std::fmt::Display;
use std::sync::Arc;
use tokio::task::JoinSet;

/// Serves until the node has ended. `resolve` returns the command of a request, or an error.
pub(super) async fn serve<S: Service, E: Display + 'static>(
    server: ServiceServer<S>,
    hub: Arc<Hub>,
    resolve: fn(&MachineConfig, S::Request) -> Result<Action, E>,
) where
    S::Response: OutcomeResponse,
{
    let resolve =
        move |config: &MachineConfig, request| ((), resolve(config, request).map_err(|error| error.to_string()));
    serve_with(server, hub, resolve, |_: &Hub, (), outcome| S::Response::of(outcome)).await;
}

/// Serves until the node has ended. `resolve` in addition returns data of the request that the response needs.
pub(super) async fn serve_with<S: Service, K: Send + 'static>(
    mut server: ServiceServer<S>,
    hub: Arc<Hub>,
    resolve: impl Fn(&MachineConfig, S::Request) -> (K, Result<Action, String>),
    response: impl Fn(&Hub, K, Result<(), String>) -> S::Response + Copy + Send + 'static,
) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let (kept, given) = resolve(hub.host.config(), message);
        let given = given.inspect_err(|sentence| hub.refuse(format!("{service}: {sentence}")));
        // Submitted here in sequence, so that commands keep the order of their requests.
        match given.and_then(|command| hub.submit(command).map_err(|busy| busy.to_string())) {
            Ok(answers) => {
                let hub = Arc::clone(&hub);
                open.spawn(async move {
                    let outcome = answers.accepted().await;
                    // A client that has left is not an error of the machine; the layer logs it.
                    let _ = reply.send(response(&hub, kept, outcome)).await;
                });
            }
            Err(sentence) => reply.send_soon(response(&hub, kept, Err(sentence))),
        }
    }
}
