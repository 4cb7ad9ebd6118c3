//! Runs the trial of an axis of a simulated cell as fast as possible.

use super::setting::{Setting, Unfit};
use super::trial::{Ended, Trial};
use crate::cell::Cell;
use crate::interrupt::{EndSignal, Interrupt};
use crate::recording::bag::{BagError, BagOptions};
use crate::recording::simulation::SimulationRecorder;
use lineshaft_core::command::{Command, Commands, Source};
use lineshaft_core::config::ConfigError;
use lineshaft_core::drive::Backend;
use lineshaft_core::machine::Machine;
use lineshaft_core::sim::Plant;
use lineshaft_tune::Record;

/// Reason why no trial was run.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The axis or a bound is not suitable.
    #[error(transparent)]
    Unfit(#[from] Unfit),
    /// No machine can be made from the cell.
    #[error("the cell makes no machine: {0}")]
    Machine(#[from] ConfigError),
    /// The run could not be recorded.
    #[error(transparent)]
    Record(#[from] BagError),
    /// The trial was interrupted; the recording is complete up to that cycle.
    #[error("interrupted by {0}")]
    Interrupted(EndSignal),
}

/// Runs a trial of the axis with a simulation of all backends, and records it if requested. `prepare` may change the
/// plant.
///
/// # Errors
/// Returns the reason why no trial was run; an early end of a trial is no error.
pub fn try_simulated(
    cell: &Cell,
    setting: Setting,
    record: Option<&BagOptions>,
    prepare: impl FnOnce(&mut Plant),
) -> Result<(Ended, Record), TrialError> {
    try_until(cell, setting, record, prepare, &Interrupt::default())
}

/// Does the same, until it is interrupted.
///
/// # Errors
/// Returns the same errors, or that it was interrupted.
pub(crate) fn try_until(
    cell: &Cell,
    setting: Setting,
    record: Option<&BagOptions>,
    prepare: impl FnOnce(&mut Plant),
    interrupt: &Interrupt,
) -> Result<(Ended, Record), TrialError> {
    let mut machine = Machine::new(cell.machine.clone())?;
    let mut plant = cell.plant();
    prepare(&mut plant);
    let mut trial = Trial::new(setting, Source::Cli, machine.config(), machine.directory())?;
    let mut recorder = record.map(|options| SimulationRecorder::new(cell, &machine, options, None)).transpose()?;
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut commands: Vec<Command> = Vec::new();
    let mut number = 0;
    while trial.ended().is_none() && interrupt.requested().is_none() {
        commands.clear();
        // Drives are online after the first cycle.
        if machine.next_cycle() > 1 {
            commands.extend(trial.before(&machine, || number + 1));
        }
        number += commands.len() as u64;
        inputs.begin(machine.next_cycle(), 0);
        plant.read(&mut inputs);
        if let Some(recorder) = &mut recorder {
            recorder.before(&machine);
        }
        machine.cycle(&inputs, Commands::queue(&commands), &mut outputs);
        plant.write(&outputs);
        if let Some(recorder) = &mut recorder {
            recorder.after(&inputs, Commands::queue(&commands), &machine)?;
        }
    }
    if let Some(recorder) = recorder {
        recorder.finish()?;
    }
    if trial.ended().is_none()
        && let Some(signal) = interrupt.requested()
    {
        return Err(TrialError::Interrupted(signal));
    }
    Ok((trial.ended().unwrap_or(Ended::Late), trial.record().clone()))
}
