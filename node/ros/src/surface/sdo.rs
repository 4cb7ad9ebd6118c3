//! `~/sdo_read` and `~/sdo_write`: objects of CAN devices, answered when the device has answered, or when no answer can arrive any more.

use super::host::{Host, PendingAnswer};
use super::hub::Hub;
use super::refusing::RefusalResponse;
use super::table;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_msgs::Service;
use std::sync::Arc;
use tokio::task::JoinSet;

/// Requests an object, or returns an error message.
type Ask<S> = fn(&dyn Host, &<S as Service>::Request) -> Result<PendingAnswer<<S as Service>::Response>, String>;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let (read, write) = (table::SDO_READ.server(node)?, table::SDO_WRITE.server(node)?);
    tasks.spawn(serve(read, Arc::clone(hub), |host, request| host.read_object(request)));
    tasks.spawn(serve(write, Arc::clone(hub), |host, request| host.write_object(request)));
    Ok(())
}

async fn serve<S: Service>(mut server: ServiceServer<S>, hub: Arc<Hub>, ask: Ask<S>)
where
    S::Response: RefusalResponse<S::Request>,
{
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        // From here on the requests are in the queue of their bus, in their order.
        match ask(hub.host.as_ref(), &message) {
            Ok(answer) => {
                open.spawn(async move {
                    // A client that has left is not an error of the machine; the layer logs it.
                    let _ = reply.send(answer.await).await;
                });
            }
            Err(sentence) => {
                hub.refuse(format!("{service}: {sentence}"));
                reply.send_soon(S::Response::refusing(&message, sentence));
            }
        }
    }
}
