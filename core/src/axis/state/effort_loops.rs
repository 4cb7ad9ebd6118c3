//! State of the loops inside the position loop.

use super::current_stage::CurrentStage;
use crate::parameter::Amplifier;
use crate::regulator::{HeatFilter, I2t, VelocityEstimator, VelocityLoop};
use serde::{Deserialize, Serialize};

/// State of these loops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::axis) struct EffortLoops {
    pub(in crate::axis) velocity: VelocityLoop,
    /// None while the axis is off.
    pub(in crate::axis) estimator: Option<VelocityEstimator>,
    /// Travel of the encoder of the velocity loop since the axis was switched on (inc of that encoder), independent of
    /// new coordinates.
    pub(in crate::axis) way: i64,
    pub(in crate::axis) current: CurrentStage,
    /// Effort as a fraction of max_effort, -1 to 1.
    pub(in crate::axis) output: f64,
    /// I2t supervision with the parameters from which it was made.
    pub(in crate::axis) watch: Option<I2t>,
    pub(in crate::axis) heat: HeatFilter,
    pub(in crate::axis) is_told: bool,
}

impl EffortLoops {
    /// Whether the state is valid for these parameters. `cycle_ns`: cycle time with which the axis runs.
    pub(in crate::axis) fn is_sound(&self, p: &Amplifier, cycle_ns: u64) -> bool {
        let is_made_so = |mut estimator: VelocityEstimator| {
            estimator.restart();
            p.estimator(cycle_ns) == Ok(estimator)
        };
        self.velocity.is_sound()
            && self.estimator.is_none_or(|estimator| estimator.is_sound() && is_made_so(estimator))
            && self.current.is_sound()
            && self.output.abs() <= 1.0
            && self.watch.is_none_or(|watch| watch.is_sound())
            && self.heat.is_sound()
    }

    /// Resets the loops: no output, no history. The thermal model continues.
    pub(in crate::axis) fn clear(&mut self) {
        *self = Self { watch: self.watch, heat: self.heat, is_told: self.is_told, ..Self::default() };
    }
}
