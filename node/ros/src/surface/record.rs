//! `~/record`: the recorder of the running machine.

use super::hub::Hub;
use crate::layer::{CreateError, Node, Qos, Request, ServiceServer};
use lineshaft_msgs::srv::{Record, RecordResponse};
use std::sync::Arc;
use tokio::sync::oneshot;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = node.service::<Record>("~/record", Qos::SERVICE)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve(mut server: ServiceServer<Record>, hub: Arc<Hub>) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let (answer, answered) = oneshot::channel();
        hub.host.record(message, answer);
        open.spawn(async move {
            let gone =
                |_| RecordResponse { message: "the machine has stopped".to_owned(), ..RecordResponse::default() };
            // A client that has gone is no fault of the machine; the layer logs it.
            let _ = reply.send(answered.await.unwrap_or_else(gone)).await;
        });
    }
}
