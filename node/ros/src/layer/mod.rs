//! The ROS 2 layer: what rcl is to other nodes, made of a DDS library and of the wire formats of ROS 2 Jazzy.
//!
//! Only `dds` knows the DDS library. Nothing here knows axes.

mod action;
mod arguments;
mod clock;
mod dds;
mod endpoint;
mod environment;
mod graph;
mod guid;
mod latched;
mod log;
mod matches;
mod name;
mod node;
mod publisher;
mod qos;
mod rosout;
mod service;

pub use self::action::{
    ActionEvent, ActionOptions, ActionServer, CancelRequest, Cancels, GoalHandle, GoalId, GoalRequest, Status,
};
pub use self::arguments::{ArgumentError, RosArguments};
pub use self::clock::now;
pub use self::dds::DdsError;
pub use self::endpoint::CreateError;
pub use self::environment::{Environment, EnvironmentError, Interface, Networks};
pub use self::log::log_filter;
pub use self::name::{FullName, NameError, NodeName};
pub use self::node::Node;
pub use self::publisher::{PublishError, Publisher};
pub use self::qos::Qos;
pub use self::rosout::{Rosout, Severity, Source};
pub use self::service::{Reply, ReplyError, Request, ServiceServer};

#[cfg(test)]
mod tests;
