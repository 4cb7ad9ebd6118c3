//! `lineshaft explain`.

use super::params::width;
use super::{Exit, complain, say_all};
use clap::Args;

pub(super) const HELP: &str = "\
A name of several things prints all of them. An object before a dot does not count: `x.max_velocity` is `max_velocity`.

Examples:
  lineshaft explain 10205
  lineshaft explain E10205
  lineshaft explain max_velocity
  lineshaft explain x.actual.position
  lineshaft explain varsync.m1
  lineshaft explain move_axis
  lineshaft explain lineshaft_msgs/AxisStates
  lineshaft explain MoveAxis.buffer_mode
  lineshaft explain MC_GearIn
  lineshaft explain 8611h
  lineshaft explain 60FDh

Exit codes: 0 good, 2 bad usage, or nothing of that name.";

/// A name.
#[derive(Debug, Args)]
pub(super) struct ExplainArgs {
    /// A code, an object of CANopen, a parameter, a key, a signal, a value, a function type or its field, a verb of scenarios, a command, a
    /// ROS topic, service, action or type or its field, or a function block or a term of PLCopen
    what: String,
}

pub(super) fn explain(args: &ExplainArgs) -> Exit {
    match crate::explain::explain(&args.what, width()) {
        Ok(text) => {
            say_all(&text);
            Exit::Good
        }
        Err(sentence) => {
            complain(&sentence);
            Exit::Usage
        }
    }
}
