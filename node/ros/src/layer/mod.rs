//! ROS 2 client layer: the functions of rcl, with the message formats of ROS 2 Jazzy.
//!
//! The middleware runs at the other end of `link`. This module depends neither on it nor on axes.

mod action;
mod arguments;
mod client;
mod clock;
mod endpoint;
mod environment;
mod file;
mod log;
mod loggers;
mod name;
mod node;
mod publisher;
mod qos_overrides;
mod rosout;
mod service;
mod subscription;
mod tap;
mod time_source;

pub use self::action::{
    ActionEvent, ActionOptions, ActionServer, CancelPolicy, CancelRequest, GoalHandle, GoalId, GoalRequest, Status,
};
pub use self::arguments::{ArgumentError, Names, OverrideValue, Overrides, RosArguments};
pub use self::client::{ActionClient, ClientError, NodeNames, Progress, RequestNumber, ServiceClient};
pub use self::clock::{Clock, HostClock, now};
pub use self::endpoint::CreateError;
pub use self::environment::{Environment, EnvironmentError, Interface, Networks};
pub use self::file::open_file;
pub use self::log::Severity;
pub use self::loggers::{Level, Loggers};
pub use self::name::{FullName, NameError, NodeName};
pub use self::node::{Node, NodeHandle, NodeOptions, OnLoss, SideOptions};
pub use self::publisher::{PublishError, Publisher};
pub use self::rosout::{Rosout, SENT_TO_ROSOUT, Source};
pub use self::service::{Refusal, Reply, ReplyError, Request, RequestPolicy, ServiceServer};
pub use self::subscription::Subscription;
pub use self::tap::{Tap, TappedMessage, TappedTopic};
pub use self::time_source::TimeSource;
pub use crate::link::qos::Qos;
pub use crate::link::{LinkError, Loss, Side};
pub use crate::side::log_filter;

#[cfg(test)]
mod tests;
