//! Commands to a node over its own ROS 2 interfaces: `lineshaft state`, `enable`, `move` and so on. They need no ROS
//! installation.
//!
//! Each command is a separate node in the DDS domain while it runs. It sends nothing before exactly one node of the
//! given name is matched, and it reports the answer of that node. `session` finds the node and calls its services,
//! `goals` runs goals of its actions to their ends.

mod activate;
mod amount;
mod axes;
mod find;
mod goals;
mod home;
mod info;
mod jog;
mod motion;
mod node_log;
mod output;
mod session;
mod state;
mod stop;
#[cfg(test)]
mod test_node;

pub(crate) use self::activate::{activate, activate_command};
pub(crate) use self::amount::Given;
pub(crate) use self::axes::{AxesService, command_axes};
pub(crate) use self::home::home;
pub(crate) use self::jog::{Jog, jog};
pub(crate) use self::motion::{Motion, move_axis};
pub(crate) use self::session::Options;
pub(crate) use self::state::{StateForm, state};

/// Reason why a command failed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Failure {
    /// The command line is wrong; nothing was sent.
    #[error("{0}")]
    Usage(String),
    /// The node refused or aborted the request, or did not answer.
    #[error("{0}")]
    Failed(String),
}

impl Failure {
    fn usage(error: impl std::fmt::Display) -> Self {
        Self::Usage(error.to_string())
    }

    fn failed(error: impl std::fmt::Display) -> Self {
        Self::Failed(error.to_string())
    }
}
