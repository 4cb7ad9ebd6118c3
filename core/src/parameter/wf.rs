//! Machine data of the positioning modules (spec/wf725.md), in units of the core.

use super::AxisParameters;
use serde::{Deserialize, Serialize};

/// Parameters of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Acceleration (inc/s^2); `None`: `max_acceleration`.
    pub md1: Option<f64>,
    /// Deceleration (inc/s^2); `None`: `max_deceleration`.
    pub md2: Option<f64>,
    /// Distance from the zero mark to the reference point (inc).
    pub md17: i64,
    /// Speed value of reference travel towards the cam.
    pub reference_rapid: f64,
    /// Speed value of reference travel on the cam.
    pub reference_reduced: f64,
    /// Speed value of reference travel after the cam, to the zero mark.
    pub reference_creep: f64,
    /// PEH time (ns).
    pub md30: i64,
    /// Speed value of step 1.
    pub md42: i64,
    /// Speed value of step 2.
    pub md43: i64,
    /// Speed value of step 3.
    pub md44: i64,
    /// Distance of step 1 (inc).
    pub md45: i64,
    /// Distance of step 2 (inc).
    pub md46: i64,
    /// Distance of step 3 (inc).
    pub md47: i64,
    /// Distance of the switch-off (inc).
    pub md48: i64,
    /// PEH window (inc); `None`: `in_position_window`.
    pub peh_window: Option<i64>,
    /// 1: monitoring begins at START, 0: at the switch-off.
    pub peh_from_start: i64,
    /// Following error above which alarm 10 or 11 is raised (inc); `None`: not monitored.
    pub max_following_error: Option<i64>,
    /// Setup speed 1, a speed value.
    pub fixed_speed_1: f64,
    /// Setup speed 2, a speed value.
    pub fixed_speed_2: f64,
    /// Setup speed 3, a speed value.
    pub fixed_speed_3: f64,
    /// Zero offset NV (inc).
    pub zero_offset: i64,
    /// Tool length compensation WK (inc).
    pub tool_length: i64,
}

impl Parameters {
    /// Returns the pair of keys that contradict each other, if any: ramps must be within those of the axis, speeds and
    /// distances must decrease from step to step.
    ///
    /// # Errors
    /// The two keys: the value of the first exceeds that of the second.
    pub fn check(&self, axis: &AxisParameters) -> Result<(), (&'static str, &'static str)> {
        if self.md1.is_some_and(|rate| rate > axis.max_acceleration) {
            return Err(("wf.md1", "max_acceleration"));
        }
        if self.md2.is_some_and(|rate| rate > axis.deceleration_limit()) {
            let limit = if axis.max_deceleration.is_some() { "max_deceleration" } else { "max_acceleration" };
            return Err(("wf.md2", limit));
        }
        let pairs = [
            (self.md43, self.md42, ("wf.md43", "wf.md42")),
            (self.md44, self.md43, ("wf.md44", "wf.md43")),
            (self.md46, self.md45, ("wf.md46", "wf.md45")),
            (self.md47, self.md46, ("wf.md47", "wf.md46")),
            (self.md48, self.md47, ("wf.md48", "wf.md47")),
        ];
        pairs.into_iter().find(|(low, high, _)| low > high).map_or(Ok(()), |(_, _, keys)| Err(keys))
    }
}
