//! Services of controller_manager that ROS tools call: `ros2 control`, and the ros_control interface of MoveIt. They exist only if the cell
//! gives the name of a controller manager.
//!
//! Law      each group of the cell is a controller; without groups all axes with a drive are one controller. An inactive controller accepts
//!          no trajectory. Deactivation halts the axes of the controller; activation neither moves nor enables an axis
//! Reads    lifecycle state of the node
//! Refuses  see [`plan`]
//! Source   controller_manager of ros2_control (Jazzy, 4.31 and later); docs/interfaces.md lists the differences

mod lists;
mod plan;
mod switches;

use super::hub::Hub;
use super::lifecycle::NodeLifecycle;
use super::table;
use crate::layer::{CreateError, Node, Reply, Request, ServiceServer};
use lineshaft_core::command::Action;
use lineshaft_msgs::Service;
use lineshaft_msgs::foreign::controller_manager_msgs::srv::{
    ListControllerTypesResponse, ListControllersResponse, ListHardwareComponentsResponse,
    ListHardwareInterfacesResponse, SwitchController, SwitchControllerResponse,
};
use lists::Hardware;
use plan::Plan;
use std::sync::Arc;
pub(super) use switches::Controllers;
use tokio::task::JoinSet;

/// Creates the services under the name of the controller manager, if the cell gives one.
pub(super) fn start(
    node: &Node,
    hub: &Arc<Hub>,
    controllers: &Arc<Controllers>,
    life: &Arc<NodeLifecycle>,
    tasks: &mut JoinSet<()>,
) -> Result<(), CreateError> {
    let Some(manager) = controllers.manager() else { return Ok(()) };
    manager.log_names(&node.name().to_string(), controllers.all());
    let hardware = Hardware::of(hub.host.config(), hub.host.joint_names(), node.name().name());

    let server = table::LIST_CONTROLLERS.server_below(node, manager.name())?;
    let (all, rate) = (Arc::clone(controllers), hardware.rate());
    tasks.spawn(answer(server, move || ListControllersResponse { controller: lists::controllers(&all, rate) }));

    let server = table::LIST_CONTROLLER_TYPES.server_below(node, manager.name())?;
    let types = || ListControllerTypesResponse {
        types: vec![lists::TYPE.to_owned()],
        base_classes: vec![lists::BASE_CLASS.to_owned()],
    };
    tasks.spawn(answer(server, types));

    let server = table::LIST_HARDWARE_COMPONENTS.server_below(node, manager.name())?;
    let (all, life_of, joints) = (Arc::clone(controllers), Arc::clone(life), hardware.clone());
    let component =
        move || ListHardwareComponentsResponse { component: vec![joints.component(&all, life_of.message())] };
    tasks.spawn(answer(server, component));

    let server = table::LIST_HARDWARE_INTERFACES.server_below(node, manager.name())?;
    let (all, life_of) = (Arc::clone(controllers), Arc::clone(life));
    let interfaces = move || {
        let component = hardware.component(&all, life_of.message());
        ListHardwareInterfacesResponse {
            command_interfaces: component.command_interfaces,
            state_interfaces: component.state_interfaces,
        }
    };
    tasks.spawn(answer(server, interfaces));

    // rqt_joint_trajectory_controller recognizes a controller manager only if it has these services too.
    tasks.spawn(refuse(table::LOAD_CONTROLLER.server_below(node, manager.name())?, Arc::clone(hub)));
    tasks.spawn(refuse(table::UNLOAD_CONTROLLER.server_below(node, manager.name())?, Arc::clone(hub)));
    tasks.spawn(refuse(table::RELOAD_CONTROLLER_LIBRARIES.server_below(node, manager.name())?, Arc::clone(hub)));

    let server = table::SWITCH_CONTROLLER.server_below(node, manager.name())?;
    tasks.spawn(switch(server, Arc::clone(hub), Arc::clone(controllers)));
    Ok(())
}

/// Answers each request with the present state.
async fn answer<S: Service>(mut server: ServiceServer<S>, now: impl Fn() -> S::Response + Send) {
    while let Some(Request { reply, .. }) = server.next().await {
        reply.send_soon(now());
    }
}

/// Refuses each request: the controllers are the groups of the cell.
async fn refuse<S: Service>(mut server: ServiceServer<S>, hub: Arc<Hub>)
where
    S::Response: Default,
{
    let service = server.name().to_string();
    while let Some(Request { reply, .. }) = server.next().await {
        hub.refuse(format!(
            "{service}: groups of the cell are the controllers; none is loaded or unloaded in a node that runs"
        ));
        // `ok` is false.
        reply.send_soon(S::Response::default());
    }
}

/// Answers when the machine has accepted the halt of the deactivated controllers.
async fn switch(mut server: ServiceServer<SwitchController>, hub: Arc<Hub>, controllers: Arc<Controllers>) {
    let service = server.name().to_string();
    // Waiting answers end with the service.
    let mut open = JoinSet::new();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        let given = Plan::of(controllers.all(), &message).and_then(|plan| {
            // Submitted here in sequence, so that the later one of two requests takes effect.
            let cancel = |goal| hub.submit_without_answer(Action::Cancel { goal });
            let halt = |axes| hub.submit(Action::Halt(axes));
            let halt = controllers.switch(&plan, cancel, halt).map_err(|busy| busy.to_string())?;
            Ok((plan.summary(controllers.all()), halt))
        });
        match given {
            Err(sentence) => {
                hub.refuse(format!("{service}: {sentence}"));
                reply.send_soon(SwitchControllerResponse { ok: false, message: sentence });
            }
            Ok((summary, None)) => done(reply, summary),
            Ok((summary, Some(halt))) => {
                open.spawn(async move {
                    match halt.accepted().await {
                        Ok(()) => done(reply, summary),
                        Err(sentence) => {
                            let message = format!("{summary}, but its axes were not halted: {sentence}");
                            reply.send_soon(SwitchControllerResponse { ok: false, message });
                        }
                    }
                });
            }
        }
    }
}

fn done(reply: Reply<SwitchControllerResponse>, summary: String) {
    tracing::info!("{summary}");
    reply.send_soon(SwitchControllerResponse { ok: true, message: summary });
}

#[cfg(test)]
mod tests;
