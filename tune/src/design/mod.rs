//! Design of gains for given stability margins.
//!
//! Law      the proportional gain is as high as the margins of the rounded gains, the delays and a resonance allow; an
//!          optimum of the crossover alone would give a derivative term without a proportional one. The velocity loop
//!          is designed first, then the position loop around it. The integral term begins [`INTEGRAL`] (position) or
//!          [`INNER_INTEGRAL`] (velocity) below the crossover. Feed-forward is the inverse of the model at low
//!          frequencies
//! Reads    a model, the requirements
//! Writes   loops, their margins
//! Refuses  targets outside their range, structures that do not suit the drive, margins that no gains within their
//!          ranges reach
//! Source   MACS-REG-01, MACS-REG-05, MACS-REG-09, MACS-REG-10, MACS-AMP-01, MACS-AMP-04, WF-CLC-03
//!
//! An axis that may have backlash has more than one regime (`regimes.rs`), and the gains keep their margins in each.
//!
//! A coarse encoder limits the gain as well: one increment may change the output by [`Targets::ripple`].

mod position;
mod regimes;
mod search;
mod velocity;

pub use regimes::{COUPLING_DAMPING, MOST_INERTIA_RATIO, regimes};

use crate::loops::{LoopError, Loops};
use crate::model::{Model, ModelError, Takes, judge};
use crate::response::frequency::Margins;
use lineshaft_core::regulator::VelocityMethod;
use serde::{Deserialize, Serialize};

/// Requirements of the loops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Targets {
    /// Phase margin in degrees: 20 to 85.
    pub phase_margin: f64,
    /// Gain margin in dB, for increase and reduction: 3 to 40.
    pub gain_margin: f64,
    /// Maximum change of the output per increment, as a fraction of the full output: 0.0001 to 1.
    pub ripple: f64,
    /// Whether an integral term is wanted, if the law has one.
    pub integral: bool,
}

impl Default for Targets {
    /// Returns 60 degrees, 6 dB, a tenth of the output, with an integral term.
    fn default() -> Self {
        Self { phase_margin: 60.0, gain_margin: 6.0, ripple: 0.1, integral: true }
    }
}

/// Law of the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// Proportional, with kv.
    Proportional,
    /// PID of MACS.
    Pid {
        /// Sampling time TIMER (ms).
        timer: u32,
    },
}

/// Specification of a design.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DesignSpec {
    /// Law of the position loop.
    pub law: Law,
    /// Method of finding the velocity for a velocity loop (AMPMODE 0); `None`: AMPMODE 2, or a velocity drive.
    pub velocity: Option<VelocityMethod>,
    /// VELMAX (inc/s): the velocity for output 1 of the position loop. For a velocity drive it is the full reference.
    pub max_velocity: f64,
    /// Acceleration to which FFACC refers (inc/s^2).
    pub max_acceleration: f64,
    /// Inertia of the load relative to that of the motor, for an axis that may have backlash between them: 0 to 1000; 0
    /// if it is not given.
    pub inertia_ratio: f64,
    /// Requirements of the loops.
    pub targets: Targets,
}

/// Loops with their margins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Design {
    /// Loops with rounded gains.
    pub loops: Loops,
    /// Margins of the position loop with these gains, the worst of all regimes.
    pub position: Margins,
    /// Margins of the velocity loop with these gains, likewise; `None` without a velocity loop.
    pub velocity: Option<Margins>,
}

/// Error of a design.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// A structure that does not suit the drive.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// TIMER is no whole number of cycles.
    #[error("timer is {timer} ms; a whole number of cycles of {cycle} ms, up to 1000 ms, is permitted")]
    Timer {
        /// TIMER (ms).
        timer: u32,
        /// Cycle time (ms).
        cycle: f64,
    },
    /// No gains keep the margins.
    #[error(
        "no gains of the {which} loop within their ranges keep a phase margin of {phase} deg and a gain margin of {gain} dB{regimes}"
    )]
    Unreachable {
        /// Name of the loop.
        which: &'static str,
        /// Phase margin in degrees.
        phase: f64,
        /// Gain margin in dB.
        gain: f64,
        /// Text about the regimes; empty for a single one.
        regimes: &'static str,
    },
}

impl From<ModelError> for DesignError {
    fn from(error: ModelError) -> Self {
        Self::Loop(error.into())
    }
}

/// Ratio of the crossover of a position loop to the frequency at which its integral term begins.
pub const INTEGRAL: f64 = 12.0;

/// Ratio of the crossover of a velocity loop to the frequency at which its integral term begins.
pub const INNER_INTEGRAL: f64 = 6.0;

impl Targets {
    fn check(&self) -> Result<(), ModelError> {
        judge("phase_margin", self.phase_margin, "deg", 20.0, 85.0)?;
        judge("gain_margin", self.gain_margin, "dB", 3.0, 40.0)?;
        judge("ripple", self.ripple, "", 1e-4, 1.0)
    }

    fn are_kept(&self, margins: &Margins) -> bool {
        margins.crossover > 0.0
            && margins.phase >= self.phase_margin
            && margins.gain >= self.gain_margin
            && margins.reduction >= self.gain_margin
    }
}

impl DesignSpec {
    fn unreachable(&self, which: &'static str) -> DesignError {
        let Targets { phase_margin: phase, gain_margin: gain, .. } = self.targets;
        let both = ", with the whole inertia and with the motor alone";
        DesignError::Unreachable { which, phase, gain, regimes: if self.inertia_ratio > 0.0 { both } else { "" } }
    }
}

impl Law {
    /// Returns the cycles of the machine in its period.
    fn cycles(self, cycle: f64) -> Result<u32, DesignError> {
        let Self::Pid { timer } = self else { return Ok(1) };
        let count = (f64::from(timer) / (1000.0 * cycle)).round();
        let is_whole = (count * 1000.0 * cycle - f64::from(timer)).abs() < 1e-9 * f64::from(timer);
        if is_whole && count >= 1.0 && timer <= 1000 {
            return Ok(count as u32);
        }
        Err(DesignError::Timer { timer, cycle: 1000.0 * cycle })
    }
}

/// Designs the loops.
///
/// # Errors
/// The reason why there is no design.
pub fn design(model: &Model, wish: &DesignSpec) -> Result<Design, DesignError> {
    model.check()?;
    wish.targets.check()?;
    judge("max_velocity", wish.max_velocity, "inc/s", 1e-3, 1e12)?;
    judge("max_acceleration", wish.max_acceleration, "inc/s^2", 1e-3, 1e15)?;
    let cycles = wish.law.cycles(model.cycle)?;
    match (model.takes(), wish.velocity, wish.law) {
        (Takes::Velocity, Some(_), _) => return Err(LoopError::TwoVelocityLoops.into()),
        (Takes::Effort, None, Law::Proportional) => return Err(LoopError::NoDamping.into()),
        _ => {}
    }
    let regimes = regimes(model, wish.inertia_ratio)?;
    let inner = wish.velocity.map(|method| velocity::design(model, &regimes, wish, method)).transpose()?;
    let (loops, position) = position::design(model, &regimes, wish, cycles, inner.map(|(inner, _)| inner))?;
    Ok(Design { loops, position, velocity: inner.map(|(_, margins)| margins) })
}
