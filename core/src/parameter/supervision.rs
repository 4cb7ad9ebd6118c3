//! Parameters of supervision: limit switches, target window, following error, aborts.

use serde::{Deserialize, Serialize};

/// Times at which the following error is checked.
pub const FOLLOWING_ERROR_CHECKS: &[&str] = &["every_cycle", "round_robin"];

/// Reaction to a stream of setpoints that reaches a software limit.
pub const JOG_AT_LIMIT: &[&str] = &["stop", "error"];

/// Supervision of an axis, in addition to its native limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Supervision {
    /// ENDSWMOD: reaction to a limit switch, 0 the error reaction, 1 a controlled stop.
    pub endswmod: i64,
    /// TESTVAL: maximum difference of two readings in the target window (inc); 0: not checked.
    pub testval: i64,
    /// ESCCOND: outputs after an abort.
    pub esccond: i64,
    /// Index in [`FOLLOWING_ERROR_CHECKS`].
    pub following_error_check: i64,
    /// 1: a following error of this axis stops the other axes, too.
    pub following_error_stops_all: i64,
    /// Maximum time to reach the target window (ns); 0: unlimited.
    pub in_position_timeout: i64,
    /// Index in [`JOG_AT_LIMIT`].
    pub jog_at_limit: i64,
}
