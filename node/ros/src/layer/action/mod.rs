//! Actions, as rcl_action serves them: goals, results for every client that requests them, cancel, feedback, status.

mod goals;
mod requests;
mod server;

pub use self::goals::{GoalId, Status};
pub use self::requests::{CancelRequest, GoalHandle, GoalRequest};
pub use self::server::{ActionEvent, ActionOptions, ActionServer, CancelPolicy};
