//! `~/enable`, `~/disable`, `~/halt`, `~/quick_stop`, `~/reset_errors`: each answers when its axes have finished the command, or failed.

use super::host::SubmitError;
use super::hub::{CommandEvents, Hub};
use super::table::{self, ServiceRow};
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::{Event, Kind};
use lineshaft_core::object::{AxisSet, Object};
use lineshaft_core::text;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandResponse};
use std::sync::Arc;
use std::time::Duration;
use tokio::task::JoinSet;

/// Longer than any drive may take to enable and any axis to stop: without an answer the machine has stopped running.
const PATIENCE: Duration = Duration::from_secs(60);

/// Command for a set of axes.
type Command = fn(AxisSet) -> Action;

/// Texts of an answer.
#[derive(Clone, Copy)]
struct AnswerTexts {
    /// Past participle of the command.
    done: &'static str,
    /// State of a virtual axis, if the command does not change it.
    unchanged: Option<&'static str>,
}

impl AnswerTexts {
    const fn of(done: &'static str) -> Self {
        Self { done, unchanged: None }
    }
}

const DISABLED: AnswerTexts = AnswerTexts { done: "disabled", unchanged: Some("virtual, always enabled") };

/// Service, command, and texts of the answer.
const SERVICES: [(ServiceRow<AxesCommand>, Command, AnswerTexts); 5] = [
    (table::ENABLE, Action::Enable, AnswerTexts::of("enabled")),
    (table::DISABLE, Action::Disable, DISABLED),
    (table::HALT, Action::Halt, AnswerTexts::of("halted")),
    (table::QUICK_STOP, Action::QuickStop, AnswerTexts::of("stopped")),
    (table::RESET_ERRORS, Action::ResetErrors, AnswerTexts::of("reset")),
];

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    for (served, action, texts) in SERVICES {
        let server = served.server(node)?;
        tasks.spawn(serve(server, Arc::clone(hub), action, texts));
    }
    Ok(())
}

async fn serve(mut server: ServiceServer<AxesCommand>, hub: Arc<Hub>, action: Command, texts: AnswerTexts) {
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
            let response = match wait_and_summarize(&hub, given, axes.len(), texts.done).await {
                Ok(_) => AxesCommandResponse { success: true, message: answer(hub.host.config(), axes, texts) },
                Err(message) => AxesCommandResponse { success: false, message },
            };
            // A client that has left is not an error of the machine; the layer logs it.
            let _ = reply.send(response).await;
        });
    }
}

/// Returns the answer to a command that all axes have executed.
fn answer(config: &MachineConfig, axes: AxisSet, AnswerTexts { done, unchanged }: AnswerTexts) -> String {
    let Some(unchanged) = unchanged else { return summary(axes.len(), done) };
    let is_virtual = |axis: &u16| config.axes.get(usize::from(*axis)).is_some_and(|axis| axis.drive.is_none());
    let virtual_names: Vec<_> = axes.iter().filter(is_virtual).map(|axis| config.name(Object::Axis(axis))).collect();
    let names = virtual_names.join(", ");
    match axes.len() - virtual_names.len() {
        count if virtual_names.is_empty() => summary(count, done),
        0 => format!("{names}: {unchanged}"),
        count => format!("{}; {names}: {unchanged}", summary(count, done)),
    }
}

fn summary(count: usize, done: &str) -> String {
    if count == 1 { format!("1 axis {done}") } else { format!("{count} axes {done}") }
}

/// Waits until each axis has reported the end of the command. Returns a summary, or the reason for a failure.
pub(super) async fn wait_and_summarize(
    hub: &Hub,
    given: Result<CommandEvents, SubmitError>,
    axes: usize,
    done: &str,
) -> Result<String, String> {
    match tokio::time::timeout(PATIENCE, wait_for_ends(hub, given, axes)).await {
        Ok(ended) => ended.map(|()| summary(axes, done)),
        Err(_) => Err(format!("no end within {} s; see ~/axis_states", PATIENCE.as_secs())),
    }
}

/// Waits until each axis has reported the end of the command.
async fn wait_for_ends(hub: &Hub, given: Result<CommandEvents, SubmitError>, axes: usize) -> Result<(), String> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_core::config::AxisConfig;
    use lineshaft_core::drive::Capabilities;
    use lineshaft_core::parameter::AxisParameters;
    use lineshaft_core::unit::Scale;

    #[test]
    fn virtual_axis_is_not_counted_as_disabled() {
        let axis = |name: &str, drive| {
            AxisConfig::new(name.to_owned(), Scale::increments(), drive, AxisParameters::new(1e5, 1e6))
        };
        let drive = Some(Capabilities::all(0));
        let axes = vec![axis("line", None), axis("x", drive), axis("y", drive), axis("second", None)];
        let config = MachineConfig { axes, ..MachineConfig::default() };
        let text = |axes: &[u16], texts| answer(&config, axes.iter().copied().collect(), texts);
        assert_eq!(text(&[0], DISABLED), "line: virtual, always enabled");
        assert_eq!(text(&[1], DISABLED), "1 axis disabled");
        assert_eq!(text(&[0, 1, 2, 3], DISABLED), "2 axes disabled; line, second: virtual, always enabled");
        assert_eq!(text(&[0, 1], AnswerTexts::of("halted")), "2 axes halted");
    }
}
