//! Design of the velocity loop: VELKPROP, VELKINT, VELKILIM.

use super::search::Search;
use super::{DesignError, DesignSpec, INNER_INTEGRAL, regimes};
use crate::discrete::Discrete;
use crate::loops::{Inner, LoopError, pi};
use crate::model::Model;
use crate::response::frequency::{Margins, grid, velocity_radius};
use lineshaft_core::regulator::{VELOCITY_GAIN, VELOCITY_SUM, VelocityGains, VelocityMethod};

/// Maximum magnitude of each gain.
const MOST: f64 = 32_767.0;

/// Returns gains whose integral term can hold the whole output.
fn gains(proportional: f64, integral: f64, cycle: f64) -> Option<VelocityGains> {
    if !(1.0..=MOST).contains(&proportional) || !(0.0..=MOST).contains(&integral) {
        return None;
    }
    let limit = if integral > 0.0 { (1.0 / (integral * VELOCITY_GAIN * VELOCITY_SUM)).ceil().min(MOST) } else { 0.0 };
    Some(VelocityGains {
        proportional: proportional as i32,
        integral: integral as i32,
        limit: limit as i32,
        cycle: 1000.0 * cycle,
    })
}

/// Designs the loop for the regimes, the first of which is the model.
pub(super) fn design(
    model: &Model,
    models: &[Model],
    wish: &DesignSpec,
    method: VelocityMethod,
) -> Result<(Inner, Margins), DesignError> {
    let (targets, cycle) = (&wish.targets, model.cycle);
    let estimator = Discrete::estimator(method, cycle).map_err(LoopError::from)?;
    // Immediate effect of one increment.
    let per_increment = estimator.d.abs() * VELOCITY_GAIN / wish.max_velocity;
    let seen = |model| Discrete::of(model).connect(&estimator).scaled(1.0 / wish.max_velocity);
    let seen: Vec<Discrete> = models.iter().map(seen).collect();
    let grid = grid(model, cycle);
    let search = Search::new(&grid, cycle, &seen, &[pi(1.0, 0.0), pi(0.0, 1.0)], targets, regimes::max_imaginary(wish));
    let shape = |crossover: f64| {
        let integral = if targets.integral { crossover / INNER_INTEGRAL } else { 0.0 };
        vec![1.0, integral]
    };
    // Gains that the motor alone limits are small: without an integral term friction would stop the axis before its
    // target.
    let least = if targets.integral && models.len() > 1 { 1.0 } else { 0.0 };
    let rounded = |weights: &[f64]| {
        let [proportional, integral] = *weights else { return None };
        let gains = gains(
            (proportional / VELOCITY_GAIN).round(),
            (integral / (VELOCITY_GAIN * 1000.0 * cycle)).round().max(least),
            cycle,
        )?;
        let is_calm = f64::from(gains.proportional) * per_increment <= targets.ripple;
        let (proportional, integral) = Inner { gains, method }.weights();
        is_calm.then_some((gains, vec![proportional, integral]))
    };
    let radius = |gains: &VelocityGains| {
        let law = Inner { gains: *gains, method }.law();
        seen.iter().fold(0.0_f64, |most, seen| most.max(velocity_radius(&law.connect(seen).closed())))
    };
    let found = search.fastest(shape, rounded, radius, 0.0).ok_or_else(|| wish.unreachable("velocity"))?;
    Ok((Inner { gains: found.gains, method }, found.margins))
}
