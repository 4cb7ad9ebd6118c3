//! An observer of place and velocity, critically damped.
//!
//! Law      both poles at p = e^(-w T): the place takes 1 - p^2 of a residual, the velocity (1 - p)^2
//! Reads    the change of the cycle (inc)
//! Writes   the velocity (inc/cycle); of a ramp it is T (1 + p) / (1 - p) - T/2 late, nearly 2/w
//! Refuses  nothing: the settings are judged before

use super::track::Gains;

/// Gains for a bandwidth in rad per cycle.
pub(super) fn gains(bandwidth: f64) -> Gains {
    let rest = -libm::expm1(-bandwidth);
    Gains { place: rest * (2.0 - rest), velocity: rest * rest, acceleration: 0.0 }
}
