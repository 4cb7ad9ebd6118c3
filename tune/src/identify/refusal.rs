//! Errors of an identification.

use crate::model::ModelError;

/// Error of a record from which its axis cannot be identified.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// A value outside its range.
    #[error(transparent)]
    Value(#[from] ModelError),
    /// Lists of different lengths.
    #[error(
        "the record has {commands} commands, {positions} positions and {efforts} efforts; as many of each are expected, or no effort"
    )]
    Uneven {
        /// Number of commands.
        commands: usize,
        /// Number of positions.
        positions: usize,
        /// Number of efforts.
        efforts: usize,
    },
    /// A record that is too short.
    #[error("the record has {cycles} cycles; at least {least} are expected")]
    Short {
        /// Number of cycles.
        cycles: usize,
        /// Required number.
        least: usize,
    },
    /// All commands are 0.
    #[error("the largest command is {command}; above 0 is expected")]
    NoCommand {
        /// Largest magnitude.
        command: f64,
    },
    /// The axis does not move.
    #[error(
        "the axis is stuck: it moved {increments} inc at a command of up to {command:.3}; at least {least} inc are expected"
    )]
    Stuck {
        /// Distance from the lowest to the highest position.
        increments: i64,
        /// Largest magnitude.
        command: f64,
        /// Required distance.
        least: i64,
    },
    /// The motion is too small for the encoder.
    #[error("the axis moved {increments} inc; for this encoder at least {least} inc are expected")]
    Little {
        /// Distance from the lowest to the highest position.
        increments: i64,
        /// Required distance.
        least: i64,
    },
    /// The command does not move the axis: a phase is open, or another axis is wired.
    #[error(
        "the axis moves, but not with the command, which explains {percent:.0} % of its motion; at least {least:.0} % are expected"
    )]
    NoReaction {
        /// Explained part of the remaining motion.
        percent: f64,
        /// Required part.
        least: f64,
    },
    /// The axis moves in the opposite direction.
    #[error("the axis moves against the command: {figure:.3} {unit} at the command 1; above 0 is expected")]
    Reversed {
        /// Velocity or acceleration at command 1.
        figure: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// The model does not fit this axis.
    #[error("the model explains {percent:.0} % of the motion; at least {least:.0} % are expected")]
    PoorFit {
        /// Explained part of the variance.
        percent: f64,
        /// Required part.
        least: f64,
    },
    /// The motion as a whole is explained, but not as accurately as a loop needs.
    #[error(
        "half of the positions deviate by more than {left:.1} inc from those of the model, {most:.1} inc are permitted: there is play before the load, or something else that the model does not know"
    )]
    Misfit {
        /// Median of the deviation (inc).
        left: f64,
        /// Maximum deviation (inc).
        most: f64,
    },
}
