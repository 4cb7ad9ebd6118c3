//! Numbers of the selector's parameters, and what it is wired to.

use crate::object::{Leader, Object};
use serde::{Deserialize, Serialize};

// References that are selected: numbers of 34.007.
pub(super) const STOP: i64 = 0;
pub(super) const POSITION_ABSOLUTE: i64 = 1;
pub(super) const SPEED: i64 = 2;
pub(super) const CAM: i64 = 3;
pub(super) const GEAR: i64 = 4;
pub(super) const HOME: i64 = 5;
pub(super) const POSITION_RELATIVE: i64 = 6;
pub(super) const POSITION_PROFILE: i64 = 7;

// 34.008: the cam starts, the gear starts.
pub(super) const CAM_ON_FREEZE: i64 = 1;
pub(super) const GEAR_ON_FREEZE: i64 = 2;

/// What the selector is wired to; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring {
    /// What the gear and the cam follow (32.001).
    pub master: Option<Leader>,
    /// Whose rising latch is the freeze event (32.007).
    pub freeze: Option<Object>,
    /// Table of the cam, by its place.
    pub cam: Option<u16>,
}
