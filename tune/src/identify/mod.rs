//! The model of an axis from a record of its excitation.
//!
//! Law      positions are explained by what integrals of the command, of the friction's sign and of the position itself add to them:
//!          no measured value is differentiated, so that a coarse encoder adds no more than its rounding. What enters
//!          linearly (gain, frictions, load, share of the resonance) comes from least squares, the rest (delay, time constant,
//!          frequency, damping) from a search around it
//! Reads    a [`Record`]
//! Writes   a [`Model`], the standard deviation of each figure, how much is explained
//! Refuses  [`Refusal`]: an axis that is stuck, does not react, moves against the command, moves too little, or otherwise
//!
//! Friction needs a sense that is known: stretches count in which the axis moves one way. A resonance counts where it
//! leaves less than [`WORTH`] of what is left without it.

mod effort;
mod fit;
mod refusal;
mod velocity;

pub use refusal::Refusal;

use crate::model::{Model, Takes};
use crate::record::Record;
use serde::{Deserialize, Serialize};

/// A model and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identified {
    /// What was found.
    pub model: Model,
    /// Standard deviations of its figures, each in the unit of the figure; 0 for a figure that it does not have.
    pub deviation: Deviation,
    /// Of the motion that is not explained by where each stretch begins, what the model explains (%).
    pub explained: f64,
    /// Root of the mean square that is left, in parts of that of the motion.
    pub nrmse: f64,
}

/// Standard deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// s
    pub delay: f64,
    /// Velocity at the command 1 (inc/s), acceleration at the command 1 (inc/s^2).
    pub gain: f64,
    /// s
    pub time_constant: f64,
    /// inc/s
    pub offset: f64,
    /// 1/s
    pub viscous: f64,
    /// inc/s^2
    pub coulomb: f64,
    /// inc/s^2
    pub load: f64,
    /// Hz
    pub frequency: f64,
    /// Of the critical damping.
    pub damping: f64,
    /// Of the ratio of inertias.
    pub inertia_ratio: f64,
}

/// Standard deviations of a delay that count where play may hide some of it.
const HIDDEN: f64 = 3.0;

impl Identified {
    /// The model for gains of an axis whose ratio of inertias is told (above 0): a motor that is alone within its play answers sooner than with
    /// its load, which hides a part of the delay, and the delay becomes three of its deviations longer. Without a ratio the model as it is.
    pub fn for_design(&self, inertia_ratio: f64) -> Model {
        let hidden = if inertia_ratio > 0.0 { HIDDEN * self.deviation.delay } else { 0.0 };
        Model { delay: self.model.delay + hidden, ..self.model }
    }
}

/// Below this way (inc) an axis is stuck.
pub const LEAST_MOTION: i64 = 3;

/// Below this way (inc) an encoder tells too little.
pub const LEAST_WAY: i64 = 100;

/// The least that a model explains (%).
pub const LEAST_EXPLAINED: f64 = 80.0;

/// The least that the command explains of what is left without it (%).
pub const LEAST_REACTION: f64 = 25.0;

/// What a resonance leaves at most of the squares that are left without it.
pub const WORTH: f64 = 0.7;

/// Finds the model.
///
/// # Errors
/// Why there is none.
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
    /// Of the motion.
    whole: f64,
    /// Left without the command.
    without: f64,
    /// Left with it.
    left: f64,
}

impl Squares {
    /// Refuses what does not react, reacts the other way round, or is not explained; else how much is (%), and the NRMSE.
    fn judge(&self, figure: f64, unit: &'static str) -> Result<(f64, f64), Refusal> {
        let part = |left: f64, of: f64| if of > 0.0 { (100.0 * (1.0 - left / of)).clamp(0.0, 100.0) } else { 0.0 };
        let reaction = part(self.left, self.without);
        let explained = part(self.left, self.whole);
        // What is left of an encoder's rounding alone reacts to nothing any more, and is explained.
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
