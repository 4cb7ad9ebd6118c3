//! Handling of trajectories that exceed the velocities and accelerations of their axes.

use serde::{Deserialize, Serialize};

/// Action if a trajectory exceeds a limit by more than the margin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum OnExcess {
    /// The time of the trajectory is stretched until it is within the limits. Its path does not change.
    #[default]
    Scale,
    /// The trajectory is refused.
    Refuse,
}

impl OnExcess {
    /// All actions with their names in files and parameters.
    pub const ALL: [(Self, &'static str); 2] = [(Self::Scale, "scale"), (Self::Refuse, "refuse")];

    /// Returns the name in files and parameters.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(known, _)| *known == self).map_or("", |(_, name)| name)
    }
}

/// Settings for comparing the rates of a trajectory with `max_velocity`, `max_acceleration` and `max_deceleration` of
/// its axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryLimits {
    /// Share by which a rate may exceed its limit.
    pub margin: f64,
    /// Action beyond the margin.
    pub on_excess: OnExcess,
    /// Largest factor by which the time may be stretched; beyond it the trajectory is refused.
    pub max_stretch: f64,
}

impl TrajectoryLimits {
    /// Allowed margins.
    pub const MARGINS: (f64, f64) = (0.0, 0.1);
    /// Allowed values of `max_stretch`.
    pub const STRETCHES: (f64, f64) = (1.0, 10.0);

    /// Whether all values are within their ranges.
    pub fn is_sound(&self) -> bool {
        let is_within = |value: f64, (low, high): (f64, f64)| value >= low && value <= high;
        is_within(self.margin, Self::MARGINS) && is_within(self.max_stretch, Self::STRETCHES)
    }

    /// Returns the largest allowed stretch.
    pub fn most(&self) -> f64 {
        match self.on_excess {
            OnExcess::Scale => self.max_stretch,
            OnExcess::Refuse => 1.0,
        }
    }
}

impl Default for TrajectoryLimits {
    /// A plan within the limits of its axes needs a stretch of at most sqrt(5/3) = 1.291 if its samples have
    /// velocities, and of at most 1.4387 if they have accelerations as well: the largest acceleration of the cubic, or
    /// quintic, between two samples of a motion whose acceleration is within +-1.
    fn default() -> Self {
        Self { margin: 1e-3, on_excess: OnExcess::Scale, max_stretch: 1.44 }
    }
}
