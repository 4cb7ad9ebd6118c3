//! Parameters of the reference selector (spec/amc.md), in the core's units.

use serde::{Deserialize, Serialize};

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
    /// 35.001: point of the table, from 0.
    pub cam_start_index: i64,
    /// 35.002 (inc of the master), behind that point.
    pub cam_start_position: i64,
    /// 41.007 (inc); left out: as `max_following_error`.
    pub following_error_window: Option<i64>,
    /// 41.024: as `stop_mode`.
    pub software_limit_stop_mode: i64,
}
