//! `use_sim_time`: whether stamps use the time of `/clock`.

use super::hub::Hub;
use super::table;
use crate::layer::{CreateError, NodeHandle};
use std::sync::Arc;
use tokio::task::JoinSet;

/// Parameter that every ROS 2 node has.
pub(super) const USE_SIM_TIME: &str = "use_sim_time";
const TEXT: &str = "Stamps and the starts of trajectories use the time that /clock says, 0 before it says any, and not that of \
                    the system. The cycle of the machine does not.";

pub(super) fn start(node: &NodeHandle, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    hub.own.declare_switch(USE_SIM_TIME, TEXT);
    let source = table::CLOCK.time_source(node)?;
    // Before the first stamp is used.
    source.switch(hub.own.switch(USE_SIM_TIME))?;
    let (hub, mut changes) = (Arc::clone(hub), hub.own.changes());
    tasks.spawn(async move {
        while changes.changed().await.is_ok() {
            let is_on = hub.own.switch(USE_SIM_TIME);
            if let Err(error) = source.switch(is_on) {
                tracing::error!("{USE_SIM_TIME} is {is_on}, but the clock stays as it is: {error}");
            }
        }
    });
    Ok(())
}
