//! Runs the trial of an axis with a real drive.
//!
//! Law      the machine runs as with `lineshaft run`, without ROS: backends start, the drive is online, the trial runs,
//!          all axes stop and are switched off. A signal cancels the trial; another one, at least half a second later,
//!          ends the process, and the drive stops by its own supervision
//! Reads    the cell, signals of the operating system
//! Writes   setpoints of the drives
//! Refuses  backends that do not start

use super::TuneArgs;
use crate::cell::Cell;
use crate::cli::Exit;
use crate::cli::run::{Hardware, InitialData, Prepared, Recording, Running, stop_machine};
use crate::interrupt::{SAME_SIGNAL, Signals};
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

/// Reason why there is no record.
#[derive(Debug, thiserror::Error)]
pub(super) enum RealError {
    /// The arguments or files are wrong.
    #[error("{0}")]
    Given(String),
    /// The run failed.
    #[error("{0}")]
    Run(String),
}

/// Maximum time until a drive is online, after its backend has started.
const PATIENCE: Duration = Duration::from_secs(5);
/// Polling interval.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Runs the trial of the axis. A trial that was ended early is no error.
///
/// # Errors
/// Returns an error if no trial was run, or if its result is unknown.
pub(super) fn try_real(args: &TuneArgs, cell: &Cell, setting: Setting) -> Result<(Ended, Record), RealError> {
    let mut cell = cell.clone();
    // There is no other client to configure and activate it.
    cell.ros.autostart = true;
    let hardware = Hardware::of(&cell, Some(&args.cell), false, false).map_err(RealError::Given)?;
    let given = |error: &dyn std::fmt::Display| RealError::Given(error.to_string());
    let machine = Machine::new(cell.machine.clone()).map_err(|error| given(&error))?;
    let name = NodeName::new(&cell.ros.namespace, &cell.ros.name).map_err(|error| given(&error))?;
    let recording = Recording::of_cycles(&cell, &name, args.record.options().as_ref()).map_err(RealError::Given)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
    let runtime = runtime.map_err(|error| RealError::Run(format!("no threads: {error}")))?;
    let tried = runtime.block_on(async {
        // Before any thread runs, so that no signal ends the program without a stop of the axes.
        let mut signals =
            Signals::new().map_err(|error| format!("signals of the system cannot be received: {error}"))?;
        // There is no surface that would receive these data.
        let (prepared, _) = Prepared::new(&cell, machine, hardware, InitialData::default());
        let running = prepared.start(recording);
        let (tried, first) = run_trial(&running, &mut signals, setting).await;
        end_by_next(signals, first);
        if running.handle.gate() != GateState::Open {
            // No cycle accepts a command, so nothing was switched on.
            running.handle.close();
        }
        stop_machine(&running.handle, || running.cycle.is_finished()).await;
        let exit = running.end();
        let trial = tried?;
        if exit != Exit::Good {
            return Err("the machine or its recorder has failed; the log says more".to_owned());
        }
        Ok((trial.ended().unwrap_or(Ended::Late), trial.record().clone()))
    });
    // The task that waits for signals never ends.
    runtime.shutdown_background();
    tried.map_err(RealError::Run)
}

/// Runs from the start of the backends to the end of the trial.
///
/// Returns the trial, and the time of the first signal, if there was one.
async fn run_trial(
    running: &Running,
    signals: &mut Signals,
    setting: Setting,
) -> (Result<Trial, String>, Option<Instant>) {
    tokio::select! {
        ready = until_ready(&running.handle, setting.axis) => if let Err(why) = ready {
            return (Err(why), None);
        },
        _ = signals.recv() => return (Err("stopped before anything moved".to_owned()), Some(Instant::now())),
    }
    let (watch, mut back) = match running.handle.begin_trial(setting, Source::Cli) {
        Ok(begun) => begun,
        Err(why) => return (Err(why), None),
    };
    tracing::info!("the axis moves now; Ctrl-C stops it");
    let mut first = None;
    loop {
        tokio::select! {
            trial = &mut back => return (trial.map_err(|_| "the machine has stopped".to_owned()), first),
            _ = signals.recv() => {
                let begun = *first.get_or_insert_with(Instant::now);
                // A terminal and a wrapper may both forward the same Ctrl-C.
                if begun.elapsed() >= SAME_SIGNAL {
                    tracing::error!("another signal: drives are left to their own supervision");
                    std::process::exit(1);
                }
                watch.cancel();
            }
            () = tokio::time::sleep(POLL_INTERVAL) => if running.cycle.is_finished() || running.bridge.is_finished() {
                let why = "a thread of the machine has failed; drives are left to their own supervision";
                return (Err(why.to_owned()), first);
            }
        }
    }
}

/// Ends the process on the next signal that is no repetition of the first one.
fn end_by_next(mut signals: Signals, first: Option<Instant>) {
    tokio::spawn(async move {
        loop {
            signals.recv().await;
            if first.is_none_or(|first| first.elapsed() >= SAME_SIGNAL) {
                std::process::exit(1);
            }
        }
    });
}

/// Waits until the backends have started and the drive of the axis is online. A drive that is offline reports the
/// reason when it is switched on.
async fn until_ready(handle: &Handle, axis: u16) -> Result<(), String> {
    loop {
        match handle.gate() {
            GateState::Open => break,
            GateState::Failed(why) => return Err(why),
            GateState::Closed => tokio::time::sleep(POLL_INTERVAL).await,
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
        tokio::time::sleep(POLL_INTERVAL).await;
    }
    Ok(())
}
