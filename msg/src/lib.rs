//! The ROS 2 interfaces of Lineshaft as Rust types.
//!
//! The files in `msg/`, `srv/`, `action/` and `foreign/` are the only source: the build generates the modules below
//! from them. A service or action `T` becomes a type `T` for the whole ([`Service`], [`Action`]) and one struct per
//! part: `TRequest`, `TResponse`, `TGoal`, `TResult`, `TFeedback`; a message is only the struct `T`. [`cdr`] encodes
//! them for the wire and for bags. Units and ranges are documented at the fields.
//!
//! This crate does not use DDS and opens no socket.
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

// The build uses these modules to read the interface files, and the tests compare the files with the contract.
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
