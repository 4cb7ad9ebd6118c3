//! Gains by stated margins.
//!
//! Law      as stiff, by its proportional gain, as the margins of the rounded gains, the delays and a resonance let: the crossover alone
//!          would end at a derivative part without a position. A velocity loop is designed first, the position loop around it. The integral part begins [`INTEGRAL`] (position) or [`INNER_INTEGRAL`] (velocity) below the
//!          crossover. Feed-forward is the inverse of the model at low frequencies
//! Reads    a model, what is wished
//! Writes   loops, their margins
//! Refuses  targets beyond their range, structures that do not suit the drive, margins that no gains within their ranges keep
//! Source   MACS-REG-01, MACS-REG-05, MACS-REG-09, MACS-REG-10, MACS-AMP-01, MACS-AMP-04, WF-CLC-03
//!
//! An axis that may have play has more regimes than one (`regimes.rs`), and the gains keep their margins in each.
//!
//! An encoder that is coarse limits the gain as well: one increment may move the output by [`Targets::ripple`].

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

/// What the loops have to keep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Targets {
    /// Degrees: 20 to 85.
    pub phase_margin: f64,
    /// dB, upwards and downwards: 3 to 40.
    pub gain_margin: f64,
    /// Largest part of the full output that one increment moves: 0.0001 to 1.
    pub ripple: f64,
    /// Is an integral part wished, where the law has one?
    pub integral: bool,
}

impl Default for Targets {
    /// 60 degrees, 6 dB, a tenth of the output, with an integral part.
    fn default() -> Self {
        Self { phase_margin: 60.0, gain_margin: 6.0, ripple: 0.1, integral: true }
    }
}

/// The law of the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// kv
    Proportional,
    /// The PID of MACS.
    Pid {
        /// TIMER (ms)
        timer: u32,
    },
}

/// What is to be designed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wish {
    /// Of the position loop.
    pub law: Law,
    /// A velocity loop below it (AMPMODE 0), and how it knows its velocity; none: AMPMODE 2, or a drive of velocities.
    pub velocity: Option<VelocityMethod>,
    /// VELMAX (inc/s): what the output 1 of the position loop asks a velocity for. Of a drive of velocities it is the full
    /// reference.
    pub max_velocity: f64,
    /// What FFACC refers to (inc/s^2).
    pub max_acceleration: f64,
    /// Inertia of the load in parts of the motor's, of an axis that may have play between them: 0 to 1000, 0 where none is told.
    pub inertia_ratio: f64,
    /// What the loops have to keep.
    pub targets: Targets,
}

/// Loops with their margins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Design {
    /// With gains as they can be set.
    pub loops: Loops,
    /// Of the position loop with these gains, the worse ones of all regimes.
    pub position: Margins,
    /// Of the velocity loop with these gains, likewise; none where there is none.
    pub velocity: Option<Margins>,
}

/// Why there are no gains.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// A structure that does not suit.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// TIMER is no whole number of cycles.
    #[error("timer is {timer} ms; a whole number of cycles of {cycle} ms, up to 1000 ms, is permitted")]
    Timer {
        /// ms
        timer: u32,
        /// ms
        cycle: f64,
    },
    /// None keeps them.
    #[error(
        "no gains of the {which} loop within their ranges keep a phase margin of {phase} deg and a gain margin of {gain} dB{regimes}"
    )]
    Unreachable {
        /// Which.
        which: &'static str,
        /// Degrees.
        phase: f64,
        /// dB
        gain: f64,
        /// Empty where there is one alone.
        regimes: &'static str,
    },
}

impl From<ModelError> for DesignError {
    fn from(error: ModelError) -> Self {
        Self::Loop(error.into())
    }
}

/// Crossover of a position loop in parts of the frequency where its integral part begins.
pub const INTEGRAL: f64 = 12.0;

/// Crossover of a velocity loop in parts of the frequency where its integral part begins.
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

impl Wish {
    fn unreachable(&self, which: &'static str) -> DesignError {
        let Targets { phase_margin: phase, gain_margin: gain, .. } = self.targets;
        let both = ", with the whole inertia and with the motor alone";
        DesignError::Unreachable { which, phase, gain, regimes: if self.inertia_ratio > 0.0 { both } else { "" } }
    }
}

impl Law {
    /// Cycles of the machine in its period.
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
/// Why there are none.
pub fn design(model: &Model, wish: &Wish) -> Result<Design, DesignError> {
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
