//! The ROS 2 interfaces of Lineshaft as Rust types.
//!
//! The files in `msg/`, `srv/`, `action/` and `foreign/` are the only source: the build makes the modules below from
//! them. A service or action `T` becomes a name `T` for the whole ([`Service`], [`Action`]) and one struct per part:
//! `TRequest`, `TResponse`, `TGoal`, `TResult`, `TFeedback`; a message is the struct `T` alone. [`cdr`] puts them on
//! the wire and into bags. Units and ranges stand at the fields.
//!
//! Nothing here knows DDS or opens a socket.
#![forbid(unsafe_code)]

pub mod about;
mod action_parts;
mod bounded;
pub mod cdr;
mod traits;

pub use action_parts::{FeedbackMessage, GetResult, GetResultRequest, GetResultResponse, SendGoal};
pub use action_parts::{SendGoalRequest, SendGoalResponse};
pub use bounded::{Bounded, Measured, TooLong};
pub use traits::{Action, Message, Service};

include!(concat!(env!("OUT_DIR"), "/interfaces.rs"));

// With these the build reads the interface files, and the tests hold the files against the contract.
#[cfg(test)]
#[path = "../build/files.rs"]
mod files;
#[cfg(test)]
#[allow(dead_code, reason = "the build uses more of it than the tests do")]
#[path = "../build/interface.rs"]
mod interface;
#[cfg(test)]
#[path = "../build/parse.rs"]
mod parse;

#[cfg(test)]
mod tests;
