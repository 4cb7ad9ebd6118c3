//! The trial of an axis with a real drive.
//!
//! Law      the machine runs as `lineshaft run` has it, without ROS: backends start, the drive speaks, the trial runs, all axes stop and go off. A signal
//!          cancels the trial; a second one ends the process, and the drive by its own supervision
//! Reads    the cell, signals of the system
//! Writes   what the drives are asked for
//! Refuses  backends that do not start

use crate::cell::Cell;
use crate::cli::run::{Given, Hardware, Prepared, Recording, Running, Signals, stop_machine};
use crate::cli::{Exit, TuneArgs};
use crate::run::bridge::Handle;
use crate::tune::{Ended, Setting, Trial};
use lineshaft_core::command::Source;
use lineshaft_core::drive::DriveState;
use lineshaft_core::machine::Machine;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_ros::layer::NodeName;
use lineshaft_ros::surface::host::{GateState, Host, TuningWatch};
use lineshaft_tune::Record;
use std::time::{Duration, Instant};

/// How long a drive may take to speak, once its backend has started.
const PATIENCE: Duration = Duration::from_secs(5);
/// Between two looks.
const LOOK: Duration = Duration::from_millis(20);

/// Tries the axis. How one ended that was run is no error.
///
/// # Errors
/// Why none was run, or why what it did is not known.
pub(super) fn try_real(args: &TuneArgs, cell: &Cell, setting: Setting) -> Result<(Ended, Record), String> {
    let mut cell = cell.clone();
    // Nobody else could configure and activate it.
    cell.ros.autostart = true;
    let hardware = Hardware::of(&cell, Some(&args.cell), false, false)?;
    let machine = Machine::new(cell.machine.clone()).map_err(|error| error.to_string())?;
    let name = NodeName::new(&cell.ros.namespace, &cell.ros.name).map_err(|error| error.to_string())?;
    let recording = Recording::of_cycles(&cell, &name, args.record.options().as_ref())?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
    let runtime = runtime.map_err(|error| format!("no threads: {error}"))?;
    runtime.block_on(async {
        // Before any thread runs: from here on no signal ends the program unheard.
        let signals = Signals::new().map_err(|error| format!("signals of the system cannot be received: {error}"))?;
        // What the surface would hear nobody does.
        let (prepared, _) = Prepared::new(&cell, machine, hardware, Given::default());
        let running = prepared.start(recording);
        let tried = attend(&running, signals, setting).await;
        stop_machine(&running.handle, || running.cycle.is_finished()).await;
        let exit = running.end();
        let trial = tried?;
        if exit != Exit::Good {
            return Err("the machine or its recorder has failed; the log says more".to_owned());
        }
        Ok((trial.ended().unwrap_or(Ended::Late), trial.record().clone()))
    })
}

/// From the start of the backends to the end of the trial.
async fn attend(running: &Running, mut signals: Signals, setting: Setting) -> Result<Trial, String> {
    tokio::select! {
        ready = until_ready(&running.handle, setting.axis) => ready?,
        () = signals.recv() => return Err("stopped before anything moved".to_owned()),
    }
    let (watch, mut back) = running.handle.begin_trial(setting, Source::Cli)?;
    tracing::info!("the axis moves now; Ctrl-C stops it");
    let mut is_cancelled = false;
    loop {
        tokio::select! {
            trial = &mut back => return trial.map_err(|_| "the machine has stopped".to_owned()),
            () = signals.recv() => {
                if is_cancelled {
                    tracing::error!("a second signal: drives are left to their own supervision");
                    std::process::exit(1);
                }
                is_cancelled = true;
                watch.cancel();
            }
            () = tokio::time::sleep(LOOK), if running.cycle.is_finished() => {
                return Err("the cycle thread has failed; drives are left to their own supervision".to_owned());
            }
        }
    }
}

/// The backends have started, and the drive of the axis speaks. One that does not says why when it is to be switched on.
async fn until_ready(handle: &Handle, axis: u16) -> Result<(), String> {
    loop {
        match handle.gate() {
            GateState::Open => break,
            GateState::Failed(why) => return Err(why),
            GateState::Closed => tokio::time::sleep(LOOK).await,
        }
    }
    let name = handle.config().axes.get(usize::from(axis)).map_or("", |axis| axis.name.as_str());
    let first = handle.directory().find(&format!("{name}.state"));
    let speaks = || {
        let board = &handle.snapshot().board;
        first.is_some_and(|first| board.int(AxisSignal::DriveState.of(first)) != DriveState::NotReady as i64)
    };
    let begin = Instant::now();
    while !speaks() && begin.elapsed() < PATIENCE {
        tokio::time::sleep(LOOK).await;
    }
    Ok(())
}
