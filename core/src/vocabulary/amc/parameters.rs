//! Parameters of the vocabulary, in the core's units.

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
}

/// Parameters of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// 34.001: 0 profile, 1 no profile, 2 and 3 the same and stop at a following error.
    pub stop_mode: i64,
    /// 34.003 (inc), signed.
    pub position_reference: i64,
    /// 34.005: 0 to 6.
    pub rotary_mode: i64,
    /// 34.006 (inc/s), signed.
    pub speed_reference: f64,
    /// 34.007: 0 to 7. The selector writes it back where it changes by itself.
    pub reference_select: i64,
    /// 34.008: 0 none, 1 cam, 2 gear.
    pub action_on_event: i64,
    /// 34.009: 0 to 7.
    pub reference_select_trigger: i64,
    /// 41.007 (inc); left out: as `max_following_error`.
    pub following_error_window: Option<i64>,
    /// 41.024: as `stop_mode`.
    pub software_limit_stop_mode: i64,
}
