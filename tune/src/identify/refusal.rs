//! Why nothing is known of an axis.

use crate::model::ModelError;

/// Why a record says nothing of its axis.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// A value that is none.
    #[error(transparent)]
    Value(#[from] ModelError),
    /// The lists do not belong together.
    #[error(
        "the record has {commands} commands, {positions} positions and {efforts} efforts; as many of each are expected, or no effort"
    )]
    Uneven {
        /// How many.
        commands: usize,
        /// How many.
        positions: usize,
        /// How many.
        efforts: usize,
    },
    /// Too little time.
    #[error("the record has {cycles} cycles; at least {least} are expected")]
    Short {
        /// How many.
        cycles: usize,
        /// How many there should be.
        least: usize,
    },
    /// Nothing was asked.
    #[error("the largest command is {command}; above 0 is expected")]
    NoCommand {
        /// Largest magnitude.
        command: f64,
    },
    /// It stands.
    #[error(
        "the axis is stuck: it moved {increments} inc at a command of up to {command:.3}; at least {least} inc are expected"
    )]
    Stuck {
        /// From the lowest to the highest position.
        increments: i64,
        /// Largest magnitude.
        command: f64,
        /// How many there should be.
        least: i64,
    },
    /// Too coarse.
    #[error("the axis moved {increments} inc; for this encoder at least {least} inc are expected")]
    Little {
        /// From the lowest to the highest position.
        increments: i64,
        /// How many there should be.
        least: i64,
    },
    /// What moves it is not the command: a phase is open, or another axis is wired.
    #[error(
        "the axis moves, but not with the command, which explains {percent:.0} % of its motion; at least {least:.0} % are expected"
    )]
    NoReaction {
        /// Of what else is not explained.
        percent: f64,
        /// How much there should be.
        least: f64,
    },
    /// The other way round.
    #[error("the axis moves against the command: {figure:.3} {unit} at the command 1; above 0 is expected")]
    Reversed {
        /// Velocity or acceleration at the command 1.
        figure: f64,
        /// Of it.
        unit: &'static str,
    },
    /// The model is not that of this axis.
    #[error("the model explains {percent:.0} % of the motion; at least {least:.0} % are expected")]
    PoorFit {
        /// Of the variance.
        percent: f64,
        /// How much there should be.
        least: f64,
    },
    /// It is explained as a whole, and not where it matters to a loop.
    #[error(
        "half of the positions deviate by more than {left:.1} inc from those of the model, {most:.1} inc are permitted: there is play before the load, or something else that the model does not know"
    )]
    Misfit {
        /// The median (inc).
        left: f64,
        /// Largest one (inc).
        most: f64,
    },
}
