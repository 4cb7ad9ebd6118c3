//! How much of a cycle an axis executes, and the summary of its last cycles.

use crate::drive::DriveInput;

/// How much of the present cycle is executed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// The whole cycle.
    #[default]
    Full,
    /// Only the motion.
    Reduced,
    /// No part of it.
    Skipped,
}

/// Summary of the last cycles. It is not part of the state: a restored machine executes its first cycles in full.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::axis) struct CyclePace {
    /// Pace of the present cycle.
    pub(in crate::axis) pace: Pace,
    /// Pace of the next cycle without disturbance.
    pub(in crate::axis) next: Pace,
    /// Pace that the end of the last full cycle allows.
    pub(in crate::axis) found: Pace,
    /// Whether the present cycle continues from the last one without disturbance.
    pub(in crate::axis) goes_on: bool,
    /// Whether it may switch outputs of the machine in a reduced cycle.
    pub(in crate::axis) switches: bool,
    /// Whether the loops that are closed here have their outputs of this cycle.
    pub(in crate::axis) has_stepped: bool,
    /// Whether the compensation of this cycle has been calculated.
    pub(in crate::axis) has_compensated: bool,
    /// Inputs of its drive at that time; unused for a virtual axis.
    pub(in crate::axis) told: DriveInput,
}
