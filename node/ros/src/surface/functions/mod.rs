//! Function slots and tables: `~/command_function`, `~/load_table`, `~/get_table`, `~/functions`.

mod command;
pub(super) mod fields;
mod states;
mod tables;

use super::hub::Hub;
use crate::layer::{CreateError, Node};
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    command::start(node, hub, tasks)?;
    tables::start(node, hub, tasks)?;
    states::start(node, hub, tasks)
}
