//! `~/vocabulary`: commands in the terms of earlier controllers, answered when the machine has accepted or refused them.

use super::hub::{CommandEvents, Hub};
use super::refusing::OutcomeResponse;
use super::table;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_msgs::srv::{Vocabulary, VocabularyRequest, VocabularyResponse};
use std::sync::Arc;
use tokio::task::{JoinSet, spawn_blocking};

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::VOCABULARY.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve(mut server: ServiceServer<Vocabulary>, hub: Arc<Hub>) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        // Handled in sequence: commands keep the order of their requests, and many long ones use only one thread.
        match give(&hub, &service, message).await {
            Ok(answers) => {
                open.spawn(async move {
                    // A client that has left is not an error of the machine; the layer logs it.
                    let _ = reply.send(VocabularyResponse::of(answers.accepted().await)).await;
                });
            }
            Err(sentence) => reply.send_soon(VocabularyResponse::of(Err(sentence))),
        }
    }
}

/// Reads a request and submits its command.
async fn give(hub: &Arc<Hub>, service: &str, request: VocabularyRequest) -> Result<CommandEvents, String> {
    let host = Arc::clone(&hub.host);
    let read = move || host.read_vocabulary(&request.axis, &request.verb, &request.arguments);
    let command = match spawn_blocking(read).await {
        Ok(command) => command.inspect_err(|sentence| hub.refuse(format!("{service}: {sentence}")))?,
        Err(_) => return Err("the request could not be read".to_owned()),
    };
    hub.submit(command).map_err(|busy| busy.to_string())
}
