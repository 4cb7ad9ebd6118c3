//! Numbers of the parameters of the selector, and its connections.

use crate::object::{Leader, Object};
use serde::{Deserialize, Serialize};

// References of 34.007.
pub(super) const STOP: i64 = 0;
pub(super) const POSITION_ABSOLUTE: i64 = 1;
pub(super) const SPEED: i64 = 2;
pub(super) const CAM: i64 = 3;
pub(super) const GEAR: i64 = 4;
pub(super) const HOME: i64 = 5;
pub(super) const POSITION_RELATIVE: i64 = 6;
pub(super) const POSITION_PROFILE: i64 = 7;

// Actions of 34.008: start of the cam, start of the gear.
pub(super) const CAM_ON_FREEZE: i64 = 1;
pub(super) const GEAR_ON_FREEZE: i64 = 2;

/// Connections of the selector; fixed by the cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring {
    /// Leader of the gear and the cam (32.001).
    pub master: Option<Leader>,
    /// Object whose rising latch is the freeze event (32.007).
    pub freeze: Option<Object>,
    /// Index of the table of the cam.
    pub cam: Option<u16>,
}
