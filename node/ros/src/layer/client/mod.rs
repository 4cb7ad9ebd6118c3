//! Clients of services and actions, and the names of the nodes in the ROS graph.
//!
//! They are for commands of the program that talk to a node without ROS being installed. They talk to servers of this layer, which answer
//! clients of each kind.

mod action;
mod nodes;
mod service;

pub use self::action::{ActionClient, Progress};
pub use self::nodes::NodeNames;
pub use self::service::{ClientError, RequestNumber, ServiceClient};
