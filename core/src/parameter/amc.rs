//! Parameters of the reference selector (spec/amc.md), in units of the core.

use serde::{Deserialize, Serialize};

/// Parameters of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// 34.001: 0 profile, 1 no profile, 2 and 3 the same with a stop at a following error.
    pub stop_mode: i64,
    /// 34.003, position reference (inc), signed.
    pub position_reference: i64,
    /// 34.005, rotary mode: 0 to 6.
    pub rotary_mode: i64,
    /// 34.006, speed reference (inc/s), signed.
    pub speed_reference: f64,
    /// 34.007, reference select: 0 to 7. The selector writes its own changes back.
    pub reference_select: i64,
    /// 34.008, action on event: 0 none, 1 cam, 2 gear.
    pub action_on_event: i64,
    /// 34.009, reference select trigger: 0 to 7.
    pub reference_select_trigger: i64,
    /// 35.001, cam start: point of the table, from 0.
    pub cam_start_index: i64,
    /// 35.002, cam start: distance after that point (inc of the master).
    pub cam_start_position: i64,
    /// 41.007, following error window (inc); `None`: as `max_following_error`.
    pub following_error_window: Option<i64>,
    /// 41.024, stop mode at software limits: as `stop_mode`.
    pub software_limit_stop_mode: i64,
}
