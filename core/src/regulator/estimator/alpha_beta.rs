//! An observer of position and velocity, critically damped.
//!
//! Law      both poles at p = e^(-w T): the position gain is 1 - p^2, the velocity gain (1 - p)^2
//! Reads    the change of the cycle (inc)
//! Writes   the velocity (inc/cycle); its delay for a ramp is T (1 + p) / (1 - p) - T/2, nearly 2/w
//! Refuses  nothing: the settings are checked before

use super::track::Gains;

/// Returns the gains for a bandwidth in rad per cycle.
pub(super) fn gains(bandwidth: f64) -> Gains {
    let rest = -libm::expm1(-bandwidth);
    Gains { place: rest * (2.0 - rest), velocity: rest * rest, acceleration: 0.0 }
}
