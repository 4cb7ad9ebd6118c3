//! Limit and reference switches of an axis: those at its drive (60FDh) and those assigned to digital inputs by
//! parameters.
//!
//! Law      active = bit of the drive, or level of the assigned input: input n (the n-th digital input of the cell, in
//!          file order, from 1), inverted for -n
//! Source   MACS-IO-01, MACS-IO-02, MACS-LIM-07, CiA 402-2 object 60FDh

use crate::drive::{DriveInput, Inputs, inputs};
use crate::parameter::Assigned;
use serde::{Deserialize, Serialize};

/// The switches; true while active.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Switches {
    /// Reference switch.
    pub home: bool,
    /// Limit switch at the end of rising counts.
    pub positive: bool,
    /// Limit switch at the end of falling counts.
    pub negative: bool,
}

impl Switches {
    pub(in crate::axis) fn read(drive: Option<&DriveInput>, all: &Inputs, assigned: &Assigned) -> Self {
        let bits = drive.map_or(0, |drive| drive.inputs);
        let level = |place: usize| all.digital(place);
        let of = |bit: u32, number: i64| bits & bit != 0 || assigned_input(level, number);
        Self {
            home: of(inputs::HOME, assigned.refswitch),
            positive: of(inputs::POSITIVE_LIMIT, assigned.poslimitsw),
            negative: of(inputs::NEGATIVE_LIMIT, assigned.neglimitsw),
        }
    }
}

/// Returns the level of an assigned input: n, or -n for the inverse; false if none is assigned.
pub(crate) fn assigned_input(level: impl Fn(usize) -> bool, number: i64) -> bool {
    let Some(place) = number.unsigned_abs().checked_sub(1) else { return false };
    // An input number beyond the last input reads 0.
    let is_high = usize::try_from(place).is_ok_and(level);
    is_high != (number < 0)
}
