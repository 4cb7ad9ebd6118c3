//! Identification of the model of an axis from a record of its excitation.
//!
//! Law      positions are explained by integrals of the command, of the sign of friction and of the position itself: no
//!          measured value is differentiated, so that a coarse encoder adds only its rounding. Linear figures (gain,
//!          frictions, load, weight of the resonance) are found by least squares, the others (delay, time constant,
//!          frequency, damping) by a search around it
//! Reads    a [`Record`]
//! Writes   a [`Model`], the standard deviation of each figure, the explained fraction
//! Refuses  [`Refusal`]: an axis that is stuck, does not react, moves against the command, moves too little, or differs
//!          from the model
//!
//! Friction needs a known direction: only stretches in which the axis moves in one direction are used. A resonance is
//! accepted if its residual is less than [`MAX_RESONANCE_RATIO`] of the residual without it.

mod effort;
mod fit;
mod refusal;
mod velocity;

pub use refusal::Refusal;

use crate::model::{Model, Takes};
use crate::record::Record;
use serde::{Deserialize, Serialize};

/// A model and its accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identified {
    /// The identified model.
    pub model: Model,
    /// Standard deviations of its figures, each in the unit of the figure; 0 for a figure that the model does not have.
    pub deviation: Deviation,
    /// Explained part (%) of the motion, apart from the initial states of the stretches.
    pub explained: f64,
    /// Root mean square of the residual, relative to that of the motion.
    pub nrmse: f64,
}

/// Standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Delay (s).
    pub delay: f64,
    /// Velocity at command 1 (inc/s), or acceleration at command 1 (inc/s^2).
    pub gain: f64,
    /// Time constant (s).
    pub time_constant: f64,
    /// Offset of the velocity (inc/s).
    pub offset: f64,
    /// Viscous friction (1/s).
    pub viscous: f64,
    /// Coulomb friction (inc/s^2).
    pub coulomb: f64,
    /// Load (inc/s^2).
    pub load: f64,
    /// Frequency of the resonance (Hz).
    pub frequency: f64,
    /// Damping, relative to the critical one.
    pub damping: f64,
    /// Ratio of inertias.
    pub inertia_ratio: f64,
}

/// Standard deviations of the delay to add if backlash may hide a part of it.
const HIDDEN_DELAY_DEVIATIONS: f64 = 3.0;

impl Identified {
    /// Returns the model for the design of gains of an axis with a given ratio of inertias (above 0): a motor that
    /// turns alone within the backlash responds sooner than with its load, which hides a part of the delay. The delay
    /// is therefore increased by three of its standard deviations. Without a ratio the model is returned unchanged.
    pub fn for_design(&self, inertia_ratio: f64) -> Model {
        let hidden = if inertia_ratio > 0.0 { HIDDEN_DELAY_DEVIATIONS * self.deviation.delay } else { 0.0 };
        Model { delay: self.model.delay + hidden, ..self.model }
    }
}

/// Distance (inc) below which an axis is stuck.
pub const LEAST_MOTION: i64 = 3;

/// Distance (inc) below which an encoder gives too little information.
pub const LEAST_WAY: i64 = 100;

/// Minimum explained part of a model (%).
pub const LEAST_EXPLAINED: f64 = 80.0;

/// Minimum part of the remaining motion that the command explains (%).
pub const LEAST_REACTION: f64 = 25.0;

/// Maximum ratio of the residual squares with a resonance to those without it.
pub const MAX_RESONANCE_RATIO: f64 = 0.7;

/// Identifies the model.
///
/// # Errors
/// The reason why there is no model.
pub fn identify(record: &Record) -> Result<Identified, Refusal> {
    record.check()?;
    let command = record.commands.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if command <= 0.0 {
        return Err(Refusal::NoCommand { command });
    }
    let least = record.positions.iter().copied().min().unwrap_or(0);
    let increments = record.positions.iter().copied().max().unwrap_or(0).saturating_sub(least);
    if increments < LEAST_MOTION {
        return Err(Refusal::Stuck { increments, command, least: LEAST_MOTION });
    }
    if increments < LEAST_WAY {
        return Err(Refusal::Little { increments, least: LEAST_WAY });
    }
    match record.takes {
        Takes::Velocity => velocity::identify(record),
        Takes::Effort => effort::identify(record),
    }
}

/// Sums of squares of a fit.
struct Squares {
    /// Sum of the motion.
    whole: f64,
    /// Residual without the command.
    without: f64,
    /// Residual with the command.
    left: f64,
}

impl Squares {
    /// Returns an error for an axis that does not react, reacts in the wrong direction, or is not explained; otherwise
    /// the explained part (%), and the NRMSE.
    fn judge(&self, figure: f64, unit: &'static str) -> Result<(f64, f64), Refusal> {
        let part = |left: f64, of: f64| if of > 0.0 { (100.0 * (1.0 - left / of)).clamp(0.0, 100.0) } else { 0.0 };
        let reaction = part(self.left, self.without);
        let explained = part(self.left, self.whole);
        // A residual that is only the rounding of the encoder would not depend on the command, but then the motion is
        // explained.
        if reaction < LEAST_REACTION {
            return Err(Refusal::NoReaction { percent: reaction, least: LEAST_REACTION });
        }
        if figure <= 0.0 {
            return Err(Refusal::Reversed { figure, unit });
        }
        if explained < LEAST_EXPLAINED {
            return Err(Refusal::PoorFit { percent: explained, least: LEAST_EXPLAINED });
        }
        Ok((explained, (self.left / self.whole).sqrt()))
    }
}
