//! `~/home`: starts homing of several axes, and answers at once when each has accepted or refused; `~/events` and `~/axis_states` report
//! the end.

use super::hub::Hub;
use super::table;
use crate::layer::{CreateError, Node, Request, ServiceServer};
use lineshaft_core::command::{Action, HomeAxis, HomingMethod};
use lineshaft_core::object::AxisSet;
use lineshaft_msgs::srv::{AxesCommand, AxesCommandResponse};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    let server = table::HOME.server(node)?;
    tasks.spawn(serve(server, Arc::clone(hub)));
    Ok(())
}

async fn serve(mut server: ServiceServer<AxesCommand>, hub: Arc<Hub>) {
    // Waiting requests end with the service.
    let mut open = JoinSet::new();
    let service = server.name().to_string();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let axes = match axes_of_request(&hub, &message.axes) {
            Ok(axes) => axes,
            Err(sentence) => {
                hub.refuse(format!("{service}: {sentence}"));
                reply.send_soon(AxesCommandResponse { success: false, message: sentence });
                continue;
            }
        };
        // Submitted here in sequence, so that the commands of two requests keep their order.
        let asked: Vec<_> = axes.iter().map(|axis| (axis, hub.submit(home(axis)))).collect();
        let hub = Arc::clone(&hub);
        open.spawn(async move {
            let (mut homing, mut failures) = (Vec::new(), Vec::new());
            for (axis, answers) in asked {
                let accepted = match answers {
                    Ok(answers) => answers.accepted().await,
                    Err(busy) => Err(busy.to_string()),
                };
                match accepted {
                    Ok(()) => homing.push(name(&hub, axis)),
                    Err(sentence) => failures.push(sentence),
                }
            }
            // A failure that concerns all axes is reported once.
            failures.dedup();
            // A client that has left is not an error of the machine; the layer logs it.
            let _ = reply.send(response(&homing, &failures)).await;
        });
    }
}

fn home(axis: u16) -> Action {
    Action::HomeAxis(HomeAxis { axis, method: HomingMethod::Configured })
}

/// Returns the axes of a request: the named ones, or all with a homing method.
fn axes_of_request(hub: &Hub, names: &[String]) -> Result<AxisSet, String> {
    let config = hub.host.config();
    if !names.is_empty() {
        return config.find_axes(names).map_err(|error| error.to_string());
    }
    let parameters = hub.host.parameters();
    let with_a_method = |axis: &u16| {
        let in_force = parameters.effective.get(usize::from(*axis));
        in_force.is_some_and(|parameters| parameters.homing.method != 0)
    };
    let axes = AxisSet::first(config.axes.len()).iter().filter(with_a_method).collect::<AxisSet>();
    if axes.is_empty() { Err("no axis has a homing method".to_owned()) } else { Ok(axes) }
}

fn name(hub: &Hub, axis: u16) -> String {
    hub.host.config().axes.get(usize::from(axis)).map(|axis| axis.name.clone()).unwrap_or_default()
}

/// A refused axis does not prevent homing of the others, so the answer also names those that have started.
fn response(homing: &[String], failures: &[String]) -> AxesCommandResponse {
    let homing = match homing {
        [] => None,
        [axis] => Some(format!("{axis} has started homing")),
        several => Some(format!("{} have started homing", several.join(", "))),
    };
    let message: Vec<_> = failures.iter().cloned().chain(homing).collect();
    AxesCommandResponse { success: failures.is_empty(), message: message.join("; ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answer_names_who_homes_and_why_others_do_not() {
        let texts = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>();
        let said = |homing: &[&str], failures: &[&str]| {
            let AxesCommandResponse { success, message } = response(&texts(homing), &texts(failures));
            (success, message)
        };
        assert_eq!(said(&["x"], &[]), (true, "x has started homing".to_owned()));
        assert_eq!(said(&["x", "y"], &[]), (true, "x, y have started homing".to_owned()));
        assert_eq!(said(&["x"], &["y: it is off"]), (false, "y: it is off; x has started homing".to_owned()));
        assert_eq!(said(&[], &["x: no", "y: no"]), (false, "x: no; y: no".to_owned()));
    }
}
