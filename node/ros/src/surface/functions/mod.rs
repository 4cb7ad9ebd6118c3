//! Function slots and tables: `~/command_function`, `~/run_function`, `~/load_program`, `~/load_table`, `~/get_table`, `~/functions`.

mod command;
pub(super) mod fields;
mod programs;
pub(super) mod run;
mod states;
mod tables;

use super::goal;
use super::hub::Hub;
use crate::layer::{CreateError, Node};
use lineshaft_msgs::action::RunFunction;
use std::sync::Arc;
use tokio::task::JoinSet;

pub(super) fn start(node: &Node, hub: &Arc<Hub>, tasks: &mut JoinSet<()>) -> Result<(), CreateError> {
    command::start(node, hub, tasks)?;
    goal::start::<RunFunction>(node, hub, tasks)?;
    programs::start(node, hub, tasks)?;
    tables::start(node, hub, tasks)?;
    states::start(node, hub, tasks)
}
