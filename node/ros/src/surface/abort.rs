//! `~/abort`: the Esc command of MACS for the whole machine; answered when every axis is at rest, or has failed to stop. It uses a standard
//! type, so that an operator panel needs no package of this program.

use super::axes::wait_and_summarize;
use super::hub::Hub;
use super::table;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_core::command::Action;
use lineshaft_msgs::foreign::std_srvs::srv::{Trigger, TriggerResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::ABORT.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve(mut server: ServiceServer<Trigger>, hub: Arc<Hub>) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let axes = hub.host.config().axes.len();
    while let Some(Request { reply, .. }) = server.next().await {
        while open.try_join_next().is_some() {}
        // Submitted here in sequence, so that commands keep the order of their requests.
        let given = hub.submit(Action::Abort);
        let hub = Arc::clone(&hub);
        open.spawn(async move {
            let response =
                match wait_and_summarize(&hub, given, axes, "stopped and locked; ~/reset_errors unlocks").await {
                    Ok(message) => TriggerResponse { success: true, message },
                    Err(message) => TriggerResponse { success: false, message },
                };
            // A client that has left is not an error of the machine; the layer logs it.
            let _ = reply.send(response).await;
        });
    }
}
