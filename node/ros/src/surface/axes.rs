//! `~/enable`, `~/disable`, `~/halt`, `~/quick_stop`, `~/reset_errors`: each answers when its axes have finished the command, or failed.

use super::host::Busy;
use super::hub::{Answers, Hub};
use super::table::{self, Served};
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_core::command::Action;
use lineshaft_core::event::{Event, Kind};
use lineshaft_core::object::AxisSet;
use lineshaft_core::text;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandResponse};
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;

/// Longer than any drive may take to enable and any axis to stop: without an answer the machine has stopped running.
const PATIENCE: Duration = Duration::from_secs(60);

/// Command for a set of axes.
type Command = fn(AxisSet) -> Action;

/// Service, command, and past participle for the answer.
const SERVICES: [(Served<AxesCommand>, Command, &str); 5] = [
    (table::ENABLE, Action::Enable, "enabled"),
    (table::DISABLE, Action::Disable, "disabled"),
    (table::HALT, Action::Halt, "halted"),
    (table::QUICK_STOP, Action::QuickStop, "stopped"),
    (table::RESET_ERRORS, Action::ResetErrors, "reset"),
];

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    for (served, action, done) in SERVICES {
        let server = served.server(node)?;
        tasks.spawn(serve(server, Arc::clone(hub), action, done));
    }
    Ok(())
}

async fn serve(mut server: ServiceServer<AxesCommand>, hub: Arc<Hub>, action: Command, done: &'static str) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let axes = match hub.host.config().find_axes(&message.axes) {
            Ok(axes) => axes,
            Err(error) => {
                hub.refuse(format!("{service}: {error}"));
                reply.send_soon(AxesCommandResponse { success: false, message: error.to_string() });
                continue;
            }
        };
        // Submitted here in sequence, so that commands keep the order of their requests.
        let given = hub.submit(action(axes));
        let hub = Arc::clone(&hub);
        open.spawn(async move {
            let response = match perform(&hub, given, axes.len(), done).await {
                Ok(message) => AxesCommandResponse { success: true, message },
                Err(message) => AxesCommandResponse { success: false, message },
            };
            // A client that has left is not an error of the machine; the layer logs it.
            let _ = reply.send(response).await;
        });
    }
}

fn summary(count: usize, done: &str) -> String {
    if count == 1 { format!("1 axis {done}") } else { format!("{count} axes {done}") }
}

/// Waits until each axis has reported the end of the command. Returns a summary, or the reason for a failure.
pub(super) async fn perform(
    hub: &Hub,
    given: Result<Answers, Busy>,
    axes: usize,
    done: &str,
) -> Result<String, String> {
    match tokio::time::timeout(PATIENCE, ends(hub, given, axes)).await {
        Ok(ended) => ended.map(|()| summary(axes, done)),
        Err(_) => Err(format!("no end within {} s; see ~/axis_states", PATIENCE.as_secs())),
    }
}

/// Waits until each axis has reported the end of the command.
async fn ends(hub: &Hub, given: Result<Answers, Busy>, axes: usize) -> Result<(), String> {
    let sentence = |event: &Event| text::message(event, hub.host.config());
    let mut answers = given.map_err(|busy| busy.to_string())?;
    let (mut is_accepted, mut ended, mut failures) = (false, 0, Vec::new());
    while ended < axes || !is_accepted {
        let Some(answer) = answers.next().await else { return Err("the machine has stopped".to_owned()) };
        match answer.event.kind {
            Kind::Refused => return Err(sentence(&answer.event)),
            Kind::Accepted => is_accepted = true,
            Kind::Done => {
                ended += 1;
                if !answer.event.code.is_none() {
                    failures.push(sentence(&answer.event));
                }
            }
            _ => {}
        }
    }
    if failures.is_empty() { Ok(()) } else { Err(failures.join("; ")) }
}
