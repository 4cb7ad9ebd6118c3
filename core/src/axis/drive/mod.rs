//! The drive of an axis: power, brake, two drives, drives with analog command.

pub(super) mod analog;
mod brake;
pub(super) mod power;
mod skew;
