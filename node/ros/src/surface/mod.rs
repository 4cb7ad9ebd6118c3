//! The surface: what Lineshaft shows of its machine in ROS 2 (contract section 7).
//!
//! It reads snapshots and events, and gives commands; it never touches the machine and nothing it does can make a cycle wait.

pub mod host;

mod axes;
mod goal;
mod hub;
pub mod lines;
pub mod messages;
mod move_axis;
mod parameters;
mod probe_axis;
mod record;
mod signals;
mod states;
mod synchronize;
mod vocabulary;

use crate::layer::{CreateError, Node};
use host::{Host, StampedEvent};
use hub::Hub;
use lineshaft_msgs::action::{MoveAxis, ProbeAxis, Synchronize};
use std::sync::Arc;
use tokio::sync::mpsc::UnboundedReceiver;
use tokio::task::JoinSet;

/// How often state is published (1/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// joint_states.
    pub joint_states: f64,
    /// ~/axis_states.
    pub axis_states: f64,
}

/// The surface of a running machine. Dropping it takes the node from the graph.
pub struct Surface {
    // Before the node: its tasks hold endpoints of it.
    _tasks: JoinSet<()>,
    _node: Node,
}

impl Surface {
    /// Opens all topics, services and actions on `node`. `events` are all events of the machine, in order.
    ///
    /// # Errors
    /// An endpoint that cannot be made.
    pub fn start(
        node: Node,
        host: Arc<dyn Host>,
        events: UnboundedReceiver<StampedEvent>,
        rates: Rates,
    ) -> Result<Self, CreateError> {
        let mut tasks = JoinSet::new();
        let hub = Hub::start(&node, Arc::clone(&host), events, &mut tasks)?;
        states::start(&node, &host, rates, &mut tasks)?;
        axes::start(&node, &hub, &mut tasks)?;
        goal::start::<MoveAxis>(&node, &hub, &mut tasks)?;
        goal::start::<ProbeAxis>(&node, &hub, &mut tasks)?;
        goal::start::<Synchronize>(&node, &hub, &mut tasks)?;
        parameters::start(&node, &hub, &mut tasks)?;
        record::start(&node, &hub, &mut tasks)?;
        vocabulary::start(&node, &hub, &mut tasks)?;
        Ok(Self { _tasks: tasks, _node: node })
    }
}
