//! Lifecycle of the node: `~/change_state`, the four services that report states and transitions, and `~/transition_event`.
//!
//! configure opens the gate of the cycle, activate and deactivate are commands of the machine, cleanup closes the gate. Only one transition
//! is executed at a time.

mod life;
mod states;

use super::hub::Hub;
use super::table;
use crate::layer::{CreateError, Node, Request, ServiceServer};
pub(super) use life::NodeLifecycle;
use lineshaft_msgs::foreign::lifecycle_msgs::srv::{
    ChangeState, ChangeStateResponse, GetAvailableStates, GetAvailableStatesResponse, GetAvailableTransitions,
    GetAvailableTransitionsResponse, GetState, GetStateResponse,
};
use states::{STATES, TRANSITIONS, Transition};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<Arc<NodeLifecycle>, CreateError> {
    let life = Arc::new(NodeLifecycle::new(
        Arc::clone(hub),
        node.name().to_string(),
        table::TRANSITION_EVENT.publisher(node)?,
    ));
    tasks.spawn(change(table::CHANGE_STATE.server(node)?, Arc::clone(&life)));
    tasks.spawn(serve_state(table::GET_STATE.server(node)?, Arc::clone(&life)));
    tasks.spawn(serve_states(table::GET_AVAILABLE_STATES.server(node)?));
    let here = Arc::clone(&life);
    let from_here = move || here.state().transitions().map(Transition::description).collect();
    tasks.spawn(serve_transitions(table::GET_AVAILABLE_TRANSITIONS.server(node)?, from_here));
    let all = || TRANSITIONS.map(Transition::description).into();
    tasks.spawn(serve_transitions(table::GET_TRANSITION_GRAPH.server(node)?, all));
    if hub.host.is_active_at_start() {
        tasks.spawn(Arc::clone(&life).begin());
    }
    Ok(life)
}

async fn change(mut server: ServiceServer<ChangeState>, life: Arc<NodeLifecycle>) {
    // A transition continues if its client leaves; it ends with the node.
    let mut open = JoinSet::new();
    while let Some(Request { message, reply }) = server.next().await {
        while open.try_join_next().is_some() {}
        // Started in sequence, in the order of the requests.
        let Some(begun) = life.begin_change(&message.transition) else {
            reply.send_soon(ChangeStateResponse { success: false });
            continue;
        };
        let life = Arc::clone(&life);
        open.spawn(async move {
            let success = life.end_change(begun).await;
            // A client that has left is not an error of the machine; the layer logs it.
            let _ = reply.send(ChangeStateResponse { success }).await;
        });
    }
}

async fn serve_state(mut server: ServiceServer<GetState>, life: Arc<NodeLifecycle>) {
    while let Some(Request { reply, .. }) = server.next().await {
        reply.send_soon(GetStateResponse { current_state: life.state().message() });
    }
}

async fn serve_states(mut server: ServiceServer<GetAvailableStates>) {
    while let Some(Request { reply, .. }) = server.next().await {
        reply.send_soon(GetAvailableStatesResponse { available_states: STATES.map(states::State::message).into() });
    }
}

async fn serve_transitions(
    mut server: ServiceServer<GetAvailableTransitions>,
    which: impl Fn() -> Vec<lineshaft_msgs::foreign::lifecycle_msgs::msg::TransitionDescription>,
) {
    while let Some(Request { reply, .. }) = server.next().await {
        reply.send_soon(GetAvailableTransitionsResponse { available_transitions: which() });
    }
}
