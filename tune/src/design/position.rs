//! Design of the position loop: kv, or KPROP, KDER, KINT, KILIM, FFVEL, FFACC.

use super::search::{FoundGains, Search};
use super::{DesignError, DesignSpec, INTEGRAL, Law, Targets, regimes};
use crate::discrete::{Discrete, radius, unit_circle};
use crate::loops::{Inner, Loops, PositionLaw, gain, pid};
use crate::model::{Dynamics, Model};
use crate::response::frequency::{Margins, grid};
use core::f64::consts::TAU;
use lineshaft_core::regulator::{K_OUT, PidGains, Window};

/// Maximum KPROP, KDER, KINT and KILIM.
const MOST: f64 = 65_000.0;

/// Maximum FFVEL and FFACC.
const MOST_FORWARD: f64 = 100_000.0;

/// Derivative times that are tried for a drive with effort interface (samples): number per octave, and number of
/// octaves.
const TIMES: (u32, u32) = (3, 12);

/// Fraction of the proportional gain that an integral term may cost if its gain would be less than 1.
const INTEGRAL_WORTH: f64 = 0.5;

/// Output of the integral term in addition to friction and load, and the factor on these.
const RESERVE: (f64, f64) = (0.05, 1.5);

/// Designs the loop for the regimes, the first of which is the model.
pub(super) fn design(
    model: &Model,
    models: &[Model],
    wish: &DesignSpec,
    cycles: u32,
    velocity: Option<Inner>,
) -> Result<(Loops, Margins), DesignError> {
    let position = match wish.law {
        Law::Proportional => PositionLaw::Proportional { kv: 1.0 },
        Law::Pid { .. } => PositionLaw::Pid { gains: PidGains::default(), cycles },
    };
    let loops = Loops { position, velocity, max_velocity: wish.max_velocity, max_acceleration: wish.max_acceleration };
    let axes = models.iter().map(|regime| loops.axis(regime)).collect::<Result<Vec<_>, _>>()?;
    let period = model.cycle * f64::from(cycles);
    let grid = grid(model, period);
    let found = match wish.law {
        Law::Proportional => proportional(&axes, &grid, period, wish),
        Law::Pid { timer } => with_pid(model, &loops, &axes, &grid, period, wish, timer),
    };
    let found = found.ok_or_else(|| wish.unreachable("position"))?;
    Ok((Loops { position: found.gains, ..loops }, found.margins))
}

fn proportional(axes: &[Discrete], grid: &[f64], period: f64, wish: &DesignSpec) -> Option<FoundGains<PositionLaw>> {
    let targets = &wish.targets;
    let search = Search::new(grid, period, axes, &[gain(1.0)], targets, None);
    let rounded = |weights: &[f64]| {
        let weight = *weights.first()?;
        let law = PositionLaw::Proportional { kv: weight * wish.max_velocity };
        (weight <= targets.ripple).then(|| (law, vec![weight]))
    };
    let poles = |law: &PositionLaw| poles(law, axes, wish);
    search.fastest(|_| vec![1.0], rounded, poles, 0.0)
}

fn with_pid(
    model: &Model,
    loops: &Loops,
    axes: &[Discrete],
    grid: &[f64],
    period: f64,
    wish: &DesignSpec,
    timer: u32,
) -> Option<FoundGains<PositionLaw>> {
    let targets = &wish.targets;
    // With a velocity loop, oscillations of the coupling are handled by that loop.
    let swing = if loops.velocity.is_some() { None } else { regimes::max_imaginary(wish) };
    let laws = [pid(1.0, 0.0, 0.0), pid(0.0, 1.0, 0.0), pid(0.0, 0.0, 1.0)];
    let search = Search::new(grid, period, axes, &laws, targets, swing);
    let base = PidGains {
        bandwidth: 1000,
        window: Window::default(),
        period_ms: i64::from(timer),
        ..forward(model, loops, axes, period)
    };
    let need = need(model, loops);
    let cycles = loops.cycles();
    let poles = |law: &PositionLaw| poles(law, axes, wish);
    let times = times(model, loops, period);
    let best = |least: f64| {
        let rounded = |weights: &[f64]| rounded(weights, least, &base, need, cycles, targets);
        let mut best: Option<FoundGains<PositionLaw>> = None;
        for &time in &times {
            let shape = |crossover: f64| {
                let integral = if targets.integral { crossover / INTEGRAL } else { 0.0 };
                vec![1.0, time, integral]
            };
            let softer = best.as_ref().map_or(0.0, |best| best.weight);
            best = search.fastest(shape, rounded, poles, softer).or(best);
        }
        best
    };
    let free = best(0.0);
    if !targets.integral {
        return free;
    }
    // The smallest integral term may be too large, or cost too much.
    let price = INTEGRAL_WORTH * free.as_ref().map_or(0.0, |free| free.weight);
    best(1.0).filter(|whole| whole.weight >= price).or(free)
}

/// Returns the largest magnitude of a pole of the closed loops.
fn poles(law: &PositionLaw, axes: &[Discrete], wish: &DesignSpec) -> f64 {
    let law = law.law(wish.max_velocity);
    axes.iter().fold(0.0_f64, |most, axis| most.max(radius(&law.connect(axis).closed())))
}

/// Returns the derivative times (samples).
fn times(model: &Model, loops: &Loops, period: f64) -> Vec<f64> {
    match (model.dynamics, loops.velocity) {
        (Dynamics::Effort { .. }, None) => {
            let (per, octaves) = TIMES;
            (0..=per * octaves).map(|k| libm::exp2(f64::from(k) / f64::from(per))).collect()
        }
        (Dynamics::Effort { .. }, Some(_)) => vec![0.0, 0.5, 1.0, 2.0, 4.0],
        (Dynamics::Velocity { time_constant, .. }, _) => {
            let lag = time_constant / period;
            vec![0.0, 0.5, 1.0, 2.0, 4.0, 0.5 * lag, lag]
        }
    }
}

/// Returns the gains of these weights, with KINT not below `least`.
fn rounded(
    weights: &[f64],
    least: f64,
    base: &PidGains,
    need: f64,
    cycles: u32,
    targets: &Targets,
) -> Option<(PositionLaw, Vec<f64>)> {
    let [proportional, derivative, integral] = *weights else { return None };
    let [proportional, derivative, integral] = [proportional, derivative, integral].map(|part| (part * K_OUT).round());
    let integral = integral.max(least);
    let fits = proportional >= 1.0 && [proportional, derivative, integral].iter().all(|gain| *gain <= MOST);
    let is_calm = (proportional + derivative + integral) / K_OUT <= targets.ripple;
    let limit = if integral > 0.0 { (need * K_OUT / integral).ceil().min(MOST) } else { 0.0 };
    let gains = PidGains {
        proportional: proportional as i64,
        derivative: derivative as i64,
        integral: integral as i64,
        limit: limit as i64,
        ..*base
    };
    let weights = vec![proportional / K_OUT, derivative / K_OUT, integral / K_OUT];
    (fits && is_calm).then_some((PositionLaw::Pid { gains, cycles }, weights))
}

/// Returns the output that the integral term must be able to hold (fraction of the full output).
fn need(model: &Model, loops: &Loops) -> f64 {
    let part = match (model.dynamics, loops.velocity) {
        // The velocity loop itself compensates friction and load.
        (Dynamics::Effort { .. }, Some(_)) => 0.0,
        (Dynamics::Effort { acceleration, coulomb, load, .. }, None) => (coulomb + load.abs()) / acceleration,
        (Dynamics::Velocity { gain, offset, .. }, _) => offset.abs() / gain,
    };
    (RESERVE.0 + RESERVE.1 * part).min(1.0)
}

/// Returns FFVEL and FFACC.
fn forward(model: &Model, loops: &Loops, axes: &[Discrete], period: f64) -> PidGains {
    let per = |value: f64| (1000.0 * value).round().clamp(0.0, MOST_FORWARD) as i64;
    let (velocity, acceleration) = match (model.dynamics, loops.velocity) {
        (Dynamics::Effort { acceleration, viscous, .. }, None) => {
            (viscous * loops.max_velocity / acceleration, loops.max_acceleration / acceleration)
        }
        _ => {
            let Some(axis) = axes.first() else { return PidGains::default() };
            // At a low frequency a velocity drive is a gain and a delay.
            let omega = TAU * 1e-3 * 0.5 / period;
            let seen = axis.at(unit_circle(omega * period)) * crate::discrete::C64::new(0.0, omega);
            let (gain, delay) = (crate::discrete::magnitude(seen), -libm::atan2(seen.im, seen.re) / omega);
            (loops.max_velocity / gain, delay * loops.max_acceleration / gain)
        }
    };
    PidGains { velocity: per(velocity), acceleration: per(acceleration), ..PidGains::default() }
}
