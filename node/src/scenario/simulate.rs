//! Runs a scenario on a simulated machine as fast as possible, without ROS and without a clock.

use super::{Player, Report, Scenario, Trace, moment};
use crate::cell::Cell;
use crate::interrupt::{EndSignal, Interrupt};
use crate::output::StandardOutput;
use crate::progress::{MOMENT, Progress};
use crate::recording::bag::{BagError, BagOptions};
use crate::recording::encoder::sentence;
use crate::recording::simulation::SimulationRecorder;
use crate::store::{Store, StoreError};
use lineshaft_core::command::{Action, Commands};
use lineshaft_core::config::{ConfigError, MachineConfig};
use lineshaft_core::drive::Backend;
use lineshaft_core::event::{Event, Severity};
use lineshaft_core::machine::{MAX_COMMANDS, Machine};
use lineshaft_core::parameter::{AxisParameters, MachineParameters, ParameterImage};
use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::io::Errno;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Number of cycles between two updates of the progress bar.
const PROGRESS_CYCLES: u64 = 1024;

/// Options of a simulation.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// File for the traced signals.
    pub csv: Option<PathBuf>,
    /// Options of the recording.
    pub record: Option<BagOptions>,
    /// Whether every event is printed on standard output when it occurs.
    pub events: bool,
    /// Whether a progress bar is shown, if standard error is a terminal.
    pub progress: bool,
    /// Ends the simulation before its next cycle.
    pub interrupt: Interrupt,
}

/// Reason why a simulation was not run to its end. Failures of the scenario are in its [`Report`].
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// The trace could not be written: no such folder, no permission, no space.
    #[error("cannot write the trace {}: {error}", .path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The recording could not be created: its path is in use or invalid.
    #[error(transparent)]
    Place(BagError),
    /// The recording could not be completed.
    #[error(transparent)]
    Record(#[from] BagError),
    /// The stored values could not be written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// No machine can be made from the cell.
    #[error("the cell makes no machine: {0}")]
    Machine(#[from] ConfigError),
    /// The simulation was interrupted. Its output files are complete up to that cycle.
    #[error("interrupted by {signal} after {} of {}; no expectation was judged", span(.ran, .cycle_ns), span(.cycles, .cycle_ns))]
    Interrupted {
        /// Signal that interrupted it.
        signal: EndSignal,
        /// Number of cycles that have run.
        ran: u64,
        /// Number of cycles of the scenario.
        cycles: u64,
        /// Cycle time, in ns.
        cycle_ns: u64,
    },
}

/// Formats a number of cycles, and their time.
fn span(cycles: &u64, cycle_ns: &u64) -> String {
    format!("{cycles} cycles ({} s)", moment::seconds(*cycles, *cycle_ns))
}

/// Runs a scenario on the cell that it was read for, with a simulation in place of every backend.
///
/// # Errors
/// Returns an error if the trace or the recording cannot be written, if no machine can be made from the cell, or if it
/// was interrupted.
pub fn simulate(cell: &Cell, scenario: &Scenario, options: &Options) -> Result<Report, SimulateError> {
    simulate_with(cell, scenario, options, None)
}

/// Does the same with a store, from which the cell was loaded: values that the scenario stores are written at the end
/// of the cycle.
///
/// # Errors
/// Returns the same errors, or an error if the store cannot be written.
pub fn simulate_with(
    cell: &Cell,
    scenario: &Scenario,
    options: &Options,
    store: Option<Store>,
) -> Result<Report, SimulateError> {
    let started = Instant::now();
    let mut machine = Machine::new(cell.machine.clone())?;
    let mut plant = cell.plant();
    let mut trace = match &options.csv {
        Some(path) => Some(TraceFile::create(path, scenario, &machine)?),
        None => None,
    };
    let mut recorder = match &options.record {
        Some(options) => {
            let recorder = SimulationRecorder::new(cell, &machine, options, Some(scenario.name()));
            Some(recorder.map_err(SimulateError::Place)?)
        }
        None => None,
    };
    let mut keeper = store.map(|store| StoreWriter::new(store, &machine));
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let mut player = Player::new(scenario);
    let mut sequence = 0;
    // A progress bar would be mixed with the lines of events.
    let mut bar = Progress::wanted("cycles", MOMENT, options.progress && !options.events);
    let mut lines = options.events.then(|| BufWriter::new(StandardOutput));
    let mut ended_by = None;
    for cycle in 0..scenario.cycles() {
        ended_by = options.interrupt.requested().map(|signal| (signal, cycle));
        if ended_by.is_some() {
            break;
        }
        player.before(cycle, &mut sequence, Some(&mut plant), MAX_COMMANDS);
        inputs.begin(cycle, 0);
        plant.read(&mut inputs);
        player.override_inputs(&mut inputs);
        if let Some(recorder) = &mut recorder {
            recorder.before(&machine);
        }
        machine.cycle(&inputs, player.commands(), &mut outputs);
        plant.write(&outputs);
        if let Some(recorder) = &mut recorder {
            recorder.after(&inputs, player.commands(), &machine)?;
        }
        if let Some(keeper) = &mut keeper {
            keeper.after(&machine, player.commands())?;
        }
        if let Some(lines) = &mut lines {
            for event in machine.events() {
                // The reader may have closed the pipe; the simulation continues. Another error is reported at the end
                // of the program.
                let _ = writeln!(lines, "{}", line(cycle, event, player.commands(), machine.config()));
            }
        }
        player.after(&machine);
        if let Some(trace) = &mut trace {
            trace.write(cycle, &machine)?;
        }
        if cycle % PROGRESS_CYCLES == 0 {
            bar.set_with(cycle, Some(scenario.cycles()), || doing(&player, cycle, cell.machine.cycle_ns));
        }
    }
    drop(bar);
    drop(lines);
    if let Some(trace) = trace {
        trace.finish()?;
    }
    if let Some(recorder) = recorder {
        recorder.finish()?;
    }
    if let Some((signal, ran)) = ended_by {
        let (cycles, cycle_ns) = (scenario.cycles(), machine.config().cycle_ns);
        return Err(SimulateError::Interrupted { signal, ran, cycles, cycle_ns });
    }
    Ok(Report { wall: Some(started.elapsed()), ..player.finish() })
}

/// Returns the progress of a simulation, and the step that fired last.
fn doing(player: &Player, cycle: u64, cycle_ns: u64) -> String {
    let seconds = cycle as f64 * cycle_ns as f64 / 1e9;
    let step = player.last_step().map_or_else(String::new, |step| format!(", {step}"));
    format!("{seconds:.1} s simulated{step}")
}

/// Formats an event: time, severity, kind, message and code.
fn line(cycle: u64, event: &Event, commands: Commands<'_>, config: &MachineConfig) -> String {
    let severity = match event.severity {
        Severity::Info => "info",
        Severity::Warn => "warn",
        Severity::Error => "error",
    };
    let (when, kind) = (moment::text(cycle, config.cycle_ns), event.kind.name());
    let said = sentence(event, commands.iter(), config);
    let code = if event.code.0 == 0 { String::new() } else { format!(" (code {})", event.code.0) };
    format!("{when} {severity} {kind}: {said}{code}")
}

/// Writes the stored parameter values (layer User) to the disk after each cycle.
struct StoreWriter {
    store: Store,
    image: ParameterImage,
    /// Last state of layer User.
    seen: (Vec<AxisParameters>, MachineParameters),
}

impl StoreWriter {
    fn new(store: Store, machine: &Machine) -> Self {
        let image = machine.parameter_image();
        Self { store, seen: (image.user.clone(), image.machine[1]), image }
    }

    fn after(&mut self, machine: &Machine, commands: Commands<'_>) -> Result<(), StoreError> {
        if machine.parameter_version() == self.image.version {
            return Ok(());
        }
        machine.copy_parameters(&mut self.image);
        let (user, own) = (&self.image.user, self.image.machine[1]);
        // Saving values that are stored already must write them again, because another program may have changed the
        // file.
        let saves = commands.iter().any(|command| matches!(command.action, Action::SaveParameters(_)));
        if saves || (user, &own) != (&self.seen.0, &self.seen.1) {
            self.store.keep_all(machine.config(), user, &own)?;
            self.seen.0.clone_from(user);
            self.seen.1 = own;
        }
        Ok(())
    }
}

struct TraceFile<'a> {
    path: &'a Path,
    trace: Trace<BufWriter<File>>,
}

impl<'a> TraceFile<'a> {
    fn create(path: &'a Path, scenario: &Scenario, machine: &Machine) -> Result<Self, SimulateError> {
        let file = create(path).map_err(|error| failed(path, error))?;
        let trace = Trace::new(BufWriter::new(file), scenario, machine.directory());
        Ok(Self { path, trace: trace.map_err(|error| failed(path, error))? })
    }

    fn write(&mut self, cycle: u64, machine: &Machine) -> Result<(), SimulateError> {
        self.trace.write(cycle, machine.board()).map_err(|error| failed(self.path, error))
    }

    fn finish(self) -> Result<(), SimulateError> {
        self.trace.finish().map(drop).map_err(|error| failed(self.path, error))
    }
}

/// Creates a file. Opening a named pipe for writing would wait for its reader, so a pipe without a reader is refused.
fn create(path: &Path) -> io::Result<File> {
    if !fs::metadata(path).is_ok_and(|about| about.file_type().is_fifo()) {
        return File::create(path);
    }
    let nobody = |error: Errno| match error {
        Errno::NXIO => io::Error::other("it is a named pipe that nobody reads"),
        error => error.into(),
    };
    let pipe = open(path, OFlags::WRONLY | OFlags::NONBLOCK, Mode::empty()).map_err(nobody)?;
    fcntl_setfl(&pipe, OFlags::WRONLY)?;
    Ok(pipe.into())
}

fn failed(path: &Path, error: io::Error) -> SimulateError {
    SimulateError::Csv { path: path.to_owned(), error }
}
