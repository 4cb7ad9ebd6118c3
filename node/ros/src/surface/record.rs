//! `~/record`: controls the recorder of the running machine.

use super::hub::Hub;
use super::table;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_msgs::srv::{Record, RecordResponse};
use std::sync::Arc;
use tokio::sync::oneshot;
use tokio::task::JoinSet;

/// Maximum length of a path, in bytes: limit of the system (PATH_MAX of Linux, which includes a zero byte). A refusal here is not logged.
const MAX_PATH: usize = 4095;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::RECORD.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve(mut server: ServiceServer<Record>, hub: Arc<Hub>) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        if let Some(refusal) = refusal(&message.path) {
            hub.refuse(format!("{service}: {refusal}"));
            reply.send_soon(RecordResponse { message: refusal, ..RecordResponse::default() });
            continue;
        }
        let (answer, answered) = oneshot::channel();
        hub.host.record(message, answer);
        open.spawn(async move {
            let gone =
                |_| RecordResponse { message: "the machine has stopped".to_owned(), ..RecordResponse::default() };
            // A client that has left is not an error of the machine; the layer logs it.
            let _ = reply.send(answered.await.unwrap_or_else(gone)).await;
        });
    }
}

/// Returns what is wrong with a path, before the system is called.
fn refusal(path: &str) -> Option<String> {
    let length = path.len();
    (length > MAX_PATH).then(|| format!("the path is {length} bytes long; {MAX_PATH} are allowed"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_as_long_as_the_system_takes() {
        assert_eq!(refusal(&"x".repeat(4095)), None);
        assert_eq!(refusal(&"x".repeat(4096)).unwrap(), "the path is 4096 bytes long; 4095 are allowed");
    }
}
