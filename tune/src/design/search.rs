//! Search for the fastest gains of a law that keep their margins.
//!
//! Law      for each shape of a law its gain is set for one crossover after the other, from high to low, and rounded
//!          for its parameters; the first one whose rounded gains are stable and keep all margins in each regime of the
//!          axis is the best of the shape. The crossover is that of the first regime
//! Reads    the frequency response of each term of the law with each regime
//! Writes   gains
//! Refuses  nothing: returns `None` if no gains keep the margins

use super::Targets;
use crate::discrete::{C64, Discrete, magnitude};
use crate::response::frequency::{Margins, margins, sampled};

/// Maximum crossover relative to the sampling frequency.
const HIGHEST: f64 = 0.25;

/// Grid points between two crossovers that are tried first.
const STRIDE: usize = 4;

/// Data of a search.
pub(super) struct Search<'a> {
    pub(super) grid: &'a [f64],
    pub(super) period: f64,
    /// Frequency responses of the axis with each term of the law at gain 1: for each regime, for each term, at each
    /// frequency.
    pub(super) regimes: Vec<Vec<Vec<C64>>>,
    pub(super) targets: &'a Targets,
    /// Maximum imaginary part of the open loop of a motor alone beyond its crossover; `None` without such a regime.
    pub(super) most: Option<f64>,
}

/// Gains with their margins.
pub(super) struct FoundGains<G> {
    pub(super) gains: G,
    /// Weight of the first term.
    pub(super) weight: f64,
    /// Worst margins of all regimes, with the crossover of the first.
    pub(super) margins: Margins,
}

impl<'a> Search<'a> {
    /// Creates a search; `axes` are the regimes.
    pub(super) fn new(
        grid: &'a [f64],
        period: f64,
        axes: &[Discrete],
        laws: &[Discrete],
        targets: &'a Targets,
        most: Option<f64>,
    ) -> Self {
        let laws: Vec<Vec<C64>> = laws.iter().map(|law| sampled(law, grid, period)).collect();
        let of = |axis: &Discrete| {
            let axis = sampled(axis, grid, period);
            laws.iter().map(|law| law.iter().zip(&axis).map(|(l, g)| l * g).collect()).collect()
        };
        Self { grid, period, regimes: axes.iter().map(of).collect(), targets, most }
    }

    fn open(parts: &[Vec<C64>], weights: &[f64], at: usize) -> C64 {
        parts.iter().zip(weights).fold(C64::new(0.0, 0.0), |sum, (part, weight)| sum + part[at] * *weight)
    }

    /// Returns the open loop of the first regime.
    fn first(&self, weights: &[f64], at: usize) -> C64 {
        self.regimes.first().map_or(C64::new(0.0, 0.0), |parts| Self::open(parts, weights, at))
    }

    /// Returns the fastest gains. `shape` returns the weights of the terms for a crossover (rad per sample); `rounded`
    /// the gains that can be set, with their weights; `poles` the largest magnitude of a pole of the closed loops. The
    /// search ends at a first weight of `softer` or less.
    pub(super) fn fastest<G: Copy>(
        &self,
        shape: impl Fn(f64) -> Vec<f64>,
        rounded: impl Fn(&[f64]) -> Option<(G, Vec<f64>)>,
        poles: impl Fn(&G) -> f64,
        softer: f64,
    ) -> Option<FoundGains<G>> {
        let highest = self.grid.iter().rposition(|f| f * self.period <= HIGHEST)?;
        let attempt = |at: usize| self.attempt(at, &shape, &rounded, &poles);
        let mut at = highest;
        loop {
            if self.weights(at, &shape).first().is_none_or(|weight| *weight <= softer) {
                return None;
            }
            if let Some(found) = attempt(at) {
                // There may be a faster one between this one and the previous one.
                return (at + 1..(at + STRIDE).min(highest + 1)).rev().find_map(attempt).or(Some(found));
            }
            at = at.checked_sub(STRIDE)?;
        }
    }

    /// Returns the weights for a crossover at that grid point.
    fn weights(&self, at: usize, shape: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
        let mut weights = shape(core::f64::consts::TAU * self.grid[at] * self.period);
        let size = magnitude(self.first(&weights, at));
        weights.iter_mut().for_each(|weight| *weight /= size);
        weights
    }

    fn attempt<G>(
        &self,
        at: usize,
        shape: impl Fn(f64) -> Vec<f64>,
        rounded: impl Fn(&[f64]) -> Option<(G, Vec<f64>)>,
        poles: impl Fn(&G) -> f64,
    ) -> Option<FoundGains<G>> {
        let weights = self.weights(at, shape);
        // Far from the margin even before rounding: not worth the further checks.
        if self.angle(self.first(&weights, at)) < self.targets.phase_margin - 5.0 {
            return None;
        }
        let (gains, weights) = rounded(&weights)?;
        let mut found: Option<Margins> = None;
        for (regime, parts) in self.regimes.iter().enumerate() {
            let open: Vec<C64> = (0..self.grid.len()).map(|at| Self::open(parts, &weights, at)).collect();
            let margins = margins(self.grid, &open);
            if !self.targets.are_kept(&margins) || regime > 0 && self.coupling_may_oscillate(&open, margins.crossover) {
                return None;
            }
            found = Some(found.map_or(margins, |found| found.worse(&margins)));
        }
        let margins = Margins { radius: poles(&gains), ..found? };
        let weight = weights.first().copied().unwrap_or(0.0);
        margins.is_stable().then_some(FoundGains { gains, weight, margins })
    }

    /// Returns true if a coupling of some stiffness may oscillate.
    fn coupling_may_oscillate(&self, open: &[C64], crossover: f64) -> bool {
        let beyond = self.grid.iter().zip(open).filter(|(f, _)| **f > crossover);
        self.most.is_some_and(|most| beyond.into_iter().any(|(_, open)| open.im > most))
    }

    /// Returns the angle to -1 (degrees, 0 to 180).
    fn angle(&self, open: C64) -> f64 {
        libm::atan2(-open.im, -open.re).abs() * 180.0 / core::f64::consts::PI
    }
}
