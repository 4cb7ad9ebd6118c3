//! Parameters of what watches over an axis: limit switches, the target window, the following error, aborts.

use serde::{Deserialize, Serialize};

/// When the following error is looked at.
pub const FOLLOWING_ERROR_CHECKS: &[&str] = &["every_cycle", "round_robin"];

/// What ends a stream of setpoints that leads into a software limit.
pub const JOG_AT_LIMIT: &[&str] = &["stop", "error"];

/// How an axis is watched, beside its native limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Supervision {
    /// ENDSWMOD: 0 a limit switch is answered by the error reaction, 1 by a controlled stop.
    pub endswmod: i64,
    /// TESTVAL: two readings in the target window differ by less than this (inc); 0: not asked.
    pub testval: i64,
    /// ESCCOND: what an abort does to the outputs.
    pub esccond: i64,
    /// Place in [`FOLLOWING_ERROR_CHECKS`].
    pub following_error_check: i64,
    /// 1: a following error of this axis stops the others, too.
    pub following_error_stops_all: i64,
    /// How long the target window may take (ns); 0: for ever.
    pub in_position_timeout: i64,
    /// Place in [`JOG_AT_LIMIT`].
    pub jog_at_limit: i64,
}
