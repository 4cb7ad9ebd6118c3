//! Frequency response of a loop, and its margins.
//!
//! Law      phase margin: the smallest angle between the open loop and -1 where its magnitude is 1; gain margin: the
//!          smallest factor above 1 that brings it to -1, gain reduction: the largest one below 1; sensitivity: the
//!          largest |1 / (1 + L)|. Stable: all poles of the closed loop are inside the unit circle
//! Reads    loops, a model
//! Writes   points on a grid up to half the sampling frequency, margins
//! Refuses  loops that do not suit the model
//!
//! Between two points logarithm and angle are interpolated linearly.

use crate::discrete::{C64, Discrete, magnitude, poles, radius, unit_circle};
use crate::loops::{LoopError, Loops};
use crate::model::{Dynamics, Model};
use core::f64::consts::PI;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Margins of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Margins {
    /// Highest frequency at which the magnitude of the open loop is 1 (Hz); 0 without a crossover.
    pub crossover: f64,
    /// Phase margin in degrees, 0 to 180.
    pub phase: f64,
    /// Gain margin in dB; infinite if no gain is too high.
    pub gain: f64,
    /// Permitted reduction of the gain in dB; infinite if no gain is too low.
    pub reduction: f64,
    /// Largest sensitivity, 1 or more.
    pub sensitivity: f64,
    /// Largest magnitude of a pole of the closed loop.
    pub radius: f64,
}

impl Margins {
    /// Returns true if all poles are inside the unit circle.
    pub fn is_stable(&self) -> bool {
        self.radius < 1.0
    }

    /// Returns the worse of both values for each margin, with the crossover of the first.
    #[must_use]
    pub fn worse(&self, other: &Self) -> Self {
        Self {
            crossover: self.crossover,
            phase: self.phase.min(other.phase),
            gain: self.gain.min(other.gain),
            reduction: self.reduction.min(other.reduction),
            sensitivity: self.sensitivity.max(other.sensitivity),
            radius: self.radius.max(other.radius),
        }
    }
}

/// A frequency of the response.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Frequency (Hz).
    pub frequency: f64,
    /// Gain of the open loop (dB).
    pub open_gain: f64,
    /// Phase of the open loop (degrees), continuous from the previous point.
    pub open_phase: f64,
    /// Gain of the closed loop (dB).
    pub closed_gain: f64,
    /// Phase of the closed loop (degrees), continuous from the previous point.
    pub closed_phase: f64,
}

/// The response of a loop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bode {
    /// Points, from low to high frequency.
    pub points: Vec<Point>,
    /// Margins of the loop.
    pub margins: Margins,
}

impl Bode {
    /// Returns the point of the phase margin: magnitude 1 with the smallest angle to -1.
    pub fn at_phase_margin(&self) -> Option<Point> {
        let found = self.pairs().filter(|(a, b)| (a.open_gain > 0.0) != (b.open_gain > 0.0));
        let found = found.map(|(a, b)| a.towards(b, a.open_gain / (a.open_gain - b.open_gain)));
        found.min_by(|a, b| a.margin().abs().total_cmp(&b.margin().abs()))
    }

    /// Returns the point of the gain margin: the direction of -1 with the largest magnitude below 1.
    pub fn at_gain_margin(&self) -> Option<Point> {
        let crossed = self.pairs().filter_map(|(a, b)| {
            let (from, to) = (a.margin(), a.margin() + b.open_phase - a.open_phase);
            let crosses = from.abs() < 90.0 && (from > 0.0) != (to > 0.0);
            crosses.then(|| a.towards(b, from / (from - to)))
        });
        // At half the sampling frequency all values are real.
        let last = self.points.last().filter(|last| last.margin().abs() < 90.0).copied();
        crossed.chain(last).filter(|at| at.open_gain < 0.0).max_by(|a, b| a.open_gain.total_cmp(&b.open_gain))
    }

    fn pairs(&self) -> impl Iterator<Item = (&Point, &Point)> {
        self.points.iter().zip(self.points.iter().skip(1))
    }
}

impl Point {
    /// Returns the angle from -1 (degrees, -180 to 180).
    fn margin(&self) -> f64 {
        to_180((self.open_phase + 180.0) * PI / 180.0)
    }

    /// Interpolates to another point, with the frequency by its logarithm.
    fn towards(&self, to: &Self, part: f64) -> Self {
        let between = |from: f64, to: f64| from + part * (to - from);
        Self {
            frequency: self.frequency * libm::pow(to.frequency / self.frequency, part),
            open_gain: between(self.open_gain, to.open_gain),
            open_phase: between(self.open_phase, to.open_phase),
            closed_gain: between(self.closed_gain, to.closed_gain),
            closed_phase: between(self.closed_phase, to.closed_phase),
        }
    }
}

/// Grid points without a resonance.
const POINTS: u32 = 500;

/// Grid points around a resonance, and their range relative to its frequency.
const NEAR: (u32, f64) = (200, 0.3);

/// Decades of a grid.
const DECADES: f64 = 5.0;

/// Returns the frequencies (Hz) up to half the sampling frequency.
pub(crate) fn grid(model: &Model, period: f64) -> Vec<f64> {
    let highest = 0.5 / period;
    let spread = |k: u32| highest * libm::exp10(DECADES * (f64::from(k) / f64::from(POINTS) - 1.0));
    let mut grid: Vec<f64> = (0..POINTS).map(spread).collect();
    if let Dynamics::Effort { resonance: Some(r), .. } = model.dynamics {
        for centre in [r.frequency, r.frequency / (1.0 + r.inertia_ratio).sqrt()] {
            let near = |k: u32| centre * (1.0 + NEAR.1 * (2.0 * f64::from(k) / f64::from(NEAR.0) - 1.0));
            grid.extend((0..=NEAR.0).map(near).filter(|f| *f < highest));
        }
    }
    grid.push(highest);
    grid.sort_by(f64::total_cmp);
    grid.dedup();
    grid
}

/// Returns the response of a system at each frequency.
pub(crate) fn sampled(system: &Discrete, grid: &[f64], period: f64) -> Vec<C64> {
    grid.iter().map(|frequency| system.at(unit_circle(2.0 * PI * frequency * period))).collect()
}

/// Returns all margins except the poles.
pub(crate) fn margins(grid: &[f64], open: &[C64]) -> Margins {
    let mut margins = Margins {
        crossover: 0.0,
        phase: 180.0,
        gain: f64::INFINITY,
        reduction: f64::INFINITY,
        sensitivity: 1.0,
        radius: f64::INFINITY,
    };
    for value in open {
        margins.sensitivity = margins.sensitivity.max(1.0 / magnitude(value + 1.0));
    }
    for (f, l) in grid.windows(2).zip(open.windows(2)) {
        let (&[f0, f1], &[l0, l1]) = (f, l) else { continue };
        let (high, low) = (libm::log(magnitude(l0)), libm::log(magnitude(l1)));
        let (from, to) = angles(l0, l1);
        if (high > 0.0) != (low > 0.0) {
            let part = high / (high - low);
            margins.crossover = f0 * libm::pow(f1 / f0, part);
            let angle = from + part * (to - from);
            margins.phase = margins.phase.min(to_180(angle).abs());
        }
        // Angle 0 is the direction of -1 itself.
        if from.abs() < PI / 2.0 && (from > 0.0) != (to > 0.0) {
            let part = from / (from - to);
            margins.cross(high + part * (low - high));
        }
    }
    // At half the sampling frequency all values are real.
    if let Some(last) = open.last().filter(|last| last.re < 0.0) {
        margins.cross(libm::log(magnitude(*last)));
    }
    margins
}

impl Margins {
    fn cross(&mut self, logarithm: f64) {
        let db = logarithm * 20.0 / core::f64::consts::LN_10;
        if db < 0.0 {
            self.gain = self.gain.min(-db);
        } else {
            self.reduction = self.reduction.min(db);
        }
    }
}

/// Returns the angles of two neighbours from -1, the second one by the shorter path from the first (rad).
fn angles(l0: C64, l1: C64) -> (f64, f64) {
    let from = libm::atan2(-l0.im, -l0.re);
    let way = l1 * l0.conj();
    (from, from + libm::atan2(way.im, way.re))
}

/// Returns an angle in degrees, -180 to 180.
fn to_180(angle: f64) -> f64 {
    libm::atan2(libm::sin(angle), libm::cos(angle)) * 180.0 / PI
}

fn response(grid: &[f64], open: &[C64], radius: f64) -> Bode {
    let db = |value: C64| 20.0 * libm::log10(magnitude(value));
    let mut points: Vec<Point> = Vec::with_capacity(grid.len());
    for (&frequency, &l) in grid.iter().zip(open) {
        let closed = l / (l + 1.0);
        let before = points.last().copied();
        let goes_on = |value: C64, before: Option<f64>| {
            let phase = libm::atan2(value.im, value.re) * 180.0 / PI;
            before.map_or(phase, |before| phase - 360.0 * ((phase - before) / 360.0).round())
        };
        points.push(Point {
            frequency,
            open_gain: db(l),
            open_phase: goes_on(l, before.map(|p| p.open_phase)),
            closed_gain: db(closed),
            closed_phase: goes_on(closed, before.map(|p| p.closed_phase)),
        });
    }
    Bode { points, margins: Margins { radius, ..margins(grid, open) } }
}

/// Returns the response of the position loop.
///
/// # Errors
/// Loops that do not suit the model.
pub fn bode(model: &Model, loops: &Loops) -> Result<Bode, LoopError> {
    loops.check(model)?;
    let period = model.cycle * f64::from(loops.cycles());
    let chain = loops.position_chain(&loops.axis(model)?);
    let grid = grid(model, period);
    Ok(response(&grid, &sampled(&chain, &grid, period), radius(&chain.closed())))
}

/// Returns the response of the velocity loop; `None` without a velocity loop.
///
/// # Errors
/// Loops that do not suit the model.
pub fn velocity_bode(model: &Model, loops: &Loops) -> Result<Option<Bode>, LoopError> {
    loops.check(model)?;
    let Some(inner) = &loops.velocity else { return Ok(None) };
    let chain = inner.chain(&Discrete::of(model), model.cycle, loops.max_velocity)?;
    let grid = grid(model, model.cycle);
    Ok(Some(response(&grid, &sampled(&chain, &grid, model.cycle), velocity_radius(&chain.closed()))))
}

/// A velocity loop does not depend on the position of its axis: one pole at 1 is that of the position, not of the loop.
pub(crate) fn velocity_radius(closed: &DMatrix<f64>) -> f64 {
    let mut all = poles(closed);
    let far = |z: &C64| magnitude(z - 1.0);
    all.sort_by(|a, b| far(a).total_cmp(&far(b)));
    if all.is_empty() { f64::INFINITY } else { all.iter().skip(1).fold(0.0_f64, |most, &z| most.max(magnitude(z))) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loops::PositionLaw;

    /// kv 100 1/s around an integrator at 1 ms: L = 0.1 z^-n / (z - 1), of the magnitude 0.1 / (2 sin(a/2)) and the phase
    /// -(90 deg + a/2 + n a) at the angle a of a sample.
    fn integrator(delay: f64) -> Bode {
        let dynamics = Dynamics::Velocity { gain: 1e5, time_constant: 0.0, offset: 0.0 };
        let model = Model { cycle: 1e-3, delay, dynamics };
        let position = PositionLaw::Proportional { kv: 100.0 };
        bode(&model, &Loops { position, velocity: None, max_velocity: 1e5, max_acceleration: 1e6 }).unwrap()
    }

    #[track_caller]
    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 2e-3 * expected.abs(), "{value} {expected}");
    }

    #[test]
    fn margins_have_their_places() {
        let bode = integrator(1e-3);
        let angle = 2.0 * libm::asin(0.05);
        let at = bode.at_phase_margin().unwrap();
        near(at.frequency, angle / (2.0 * PI * 1e-3));
        near(at.open_phase, -90.0 - 1.5 * angle * 180.0 / PI);
        near(bode.margins.phase, 90.0 - 1.5 * angle * 180.0 / PI);
        // At a + a/2 = 90 deg the magnitude is 0.1.
        let at = bode.at_gain_margin().unwrap();
        near(at.frequency, 1000.0 / 6.0);
        near(at.open_gain, -20.0);
        near(bode.margins.gain, 20.0);
    }

    /// Without a delay the direction of -1 is first reached at half the sampling frequency.
    #[test]
    fn the_last_frequency_may_be_that_of_the_gain_margin() {
        let at = integrator(0.0).at_gain_margin().unwrap();
        near(at.frequency, 500.0);
        near(at.open_gain, 20.0 * libm::log10(0.05));
    }

    #[test]
    fn a_loop_without_points_has_no_margins() {
        let bode = Bode { points: Vec::new(), ..integrator(0.0) };
        assert_eq!((bode.at_phase_margin(), bode.at_gain_margin()), (None, None));
    }
}
