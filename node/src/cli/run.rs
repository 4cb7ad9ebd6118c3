//! `lineshaft run`.

mod drive_lines;
mod running;
mod watch;

use self::drive_lines::DriveLines;
use self::running::SurfaceInputs;
pub(super) use self::running::{Hardware, InitialData, Prepared, Recording, Running, stop_machine};
use self::watch::{Change, Timeouts, Watch};
use super::check::{summary, warnings};
use super::logging::Logging;
use super::record::RecordArgs;
use super::store::{self, StoreArgs};
use super::{Exit, complain, say};
use crate::cell::{Cell, OnLoss};
use crate::client::activate_command;
use crate::interrupt::{SAME_SIGNAL, Signals};
use crate::recording::Topic;
use crate::run::bridge::Handle;
use crate::run::realtime::Processor;
use crate::scenario::{Report, Scenario, other_cell};
use clap::{Args, value_parser};
use lineshaft_core::command::{Action, Command, Commands, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Kind;
use lineshaft_core::machine::{MAX_COMMANDS, Machine};
use lineshaft_core::object::AxisSet;
use lineshaft_core::text;
use lineshaft_ros::layer::{
    self, CreateError, Environment, Interface, Networks, Node, NodeOptions, RosArguments, Side, SideOptions, Tap,
    TappedMessage,
};
use lineshaft_ros::line_limit::MessageRateLimit;
use lineshaft_ros::surface::host::{GateState, Host};
use lineshaft_ros::surface::{Surface, check_names, start_commands};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

#[derive(Debug, Default, Args)]
pub(super) struct RunArgs {
    /// The cell; left out: the built-in demo
    cell: Option<PathBuf>,
    /// Put simulation in the place of every backend
    #[arg(long)]
    sim: bool,
    /// Play this scenario on the running machine; the node ends with it
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// Processor of the cycle thread: a number, or `any`; left out: the last one
    #[arg(long, value_name = "N|any", value_parser = processor)]
    cpu: Option<Processor>,
    #[command(flatten)]
    record: RecordArgs,
    /// Keep the frames of buses on CAN in recordings, as the flight recorder does in its bags
    #[arg(long)]
    record_frames: bool,
    #[command(flatten)]
    flight: FlightArgs,
    #[command(flatten)]
    store: StoreArgs,
}

/// The flight recorder.
#[derive(Clone, Debug, Args)]
struct FlightArgs {
    /// The last seconds that the flight recorder keeps and saves as a bag after a fault (s, 1 to 600; 0 off)
    #[arg(long, value_name = "SECONDS", default_value_t = 10, value_parser = value_parser!(u64).range(0..=600))]
    flight_recorder: u64,
    /// Where its bags go; left out: `~/.ros/lineshaft/<node>` (ROS_HOME counts)
    #[arg(long, value_name = "FOLDER")]
    flight_folder: Option<PathBuf>,
    /// How many of its bags are kept (1 to 1000); the oldest is removed for a new one
    #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = value_parser!(u64).range(1..=1000))]
    flight_keep: u64,
}

impl Default for FlightArgs {
    fn default() -> Self {
        Self { flight_recorder: 10, flight_folder: None, flight_keep: 10 }
    }
}

fn processor(text: &str) -> Result<Processor, String> {
    match text {
        "any" => Ok(Processor::Any),
        number => number
            .parse()
            .map(Processor::Number)
            .map_err(|_| "a number of a processor, or `any`, is allowed".to_owned()),
    }
}

pub(super) fn run(args: &RunArgs, ros: &RosArguments, logging: &Logging) -> Exit {
    let (cell, title) = match &args.cell {
        None => (Cell::demo(), "built-in demo".to_owned()),
        Some(path) => match Cell::load(path) {
            Ok(cell) => (cell, path.display().to_string()),
            Err(problems) => {
                eprint!("{problems}");
                return Exit::Usage;
            }
        },
    };
    let scenario = match args.scenario.as_deref().map(|path| Scenario::load(path, &cell)).transpose() {
        Ok(scenario) => scenario,
        Err(problems) => {
            eprint!("{problems}");
            return Exit::Usage;
        }
    };
    if let Some(note) = args.scenario.as_deref().and_then(|path| other_cell(path, args.cell.as_deref())) {
        tracing::warn!("{note}");
    }
    match start(args, cell, &title, scenario, ros, logging) {
        Ok(exit) => exit,
        Err(sentence) => {
            complain(&sentence);
            Exit::Usage
        }
    }
}

/// Prepares the machine; all errors that can be found before it starts are reported here, before anything has started.
fn start(
    args: &RunArgs,
    mut cell: Cell,
    title: &str,
    scenario: Option<Scenario>,
    ros: &RosArguments,
    logging: &Logging,
) -> Result<Exit, String> {
    let is_real = cell.backends.iter().any(|backend| !backend.is_simulated()) && !args.sim;
    if let Some(sentence) = scenario.as_ref().filter(|_| is_real).and_then(Scenario::needs_simulation) {
        return Err(sentence);
    }
    if scenario.as_ref().is_some_and(Scenario::switches_activity) {
        let why = "the lifecycle services of the node do that (~/change_state); `lineshaft sim` plays such a scenario";
        return Err(format!("--scenario: activate and deactivate are not for `run`: {why}"));
    }
    let mut options = options(ros, &cell, logging)?;
    let name = options.names.node().clone();
    let environment = environment(&cell)?;
    let Ok(store) = store::open_for_node(&args.store, &mut cell, &name, args.cell.as_deref()) else {
        return Ok(Exit::Usage);
    };
    let cell = &cell;
    let machine = Machine::new(cell.machine.clone()).map_err(|error| error.to_string())?;
    let are_kept = args.record_frames || args.flight.flight_recorder > 0;
    let hardware = Hardware::of(cell, args.cell.as_deref(), args.sim, are_kept)?;
    let first = start_commands(&cell.machine, &mut options.overrides)?;
    try_first(&cell.machine, &first)?;
    tracing::info!(
        "lineshaft {}: {title}: {}{}",
        env!("CARGO_PKG_VERSION"),
        summary(cell),
        if is_real { "" } else { ", simulated" }
    );
    let DriveLines { real, simulated } = DriveLines::of(cell, args.sim);
    real.iter().for_each(|line| tracing::warn!("{line}"));
    simulated.iter().for_each(|line| tracing::info!("{line}"));
    warnings(cell).iter().for_each(|warning| tracing::warn!("{warning}"));
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .thread_name(watch::SURFACE)
        // Requests and results come from the threads of the link and of the bridge. With the default interval of 61
        // tasks, some of them waited for seconds under heavy load of clients.
        .global_queue_interval(3)
        .enable_all()
        .build()
        .map_err(|error| format!("no threads for ROS: {error}"))?;
    let exit = runtime.block_on(async {
        // Before any thread runs, so that no signal ends the program without a stop of the axes.
        let signals = Signals::new().map_err(|error| format!("signals of the system cannot be received: {error}"))?;
        let given = InitialData { store, first, scenario, processor: args.cpu.unwrap_or_default() };
        let (prepared, heard) = Prepared::new(cell, machine, hardware, given);
        let tap = tap(cell);
        options.tap = Some(tap.0.clone());
        serve(Start { args, cell, options, environment: &environment, logging, tap }, prepared, heard, signals).await
    })?;
    runtime.shutdown_timeout(Duration::from_secs(1));
    Ok(exit)
}

/// Returns a copy of the topics that the node publishes and the cell selects, without those that bags record in each
/// cycle.
fn tap(cell: &Cell) -> (Tap, Receiver<TappedMessage>) {
    let topics = cell.ros.record_topics.clone();
    Tap::new(move |name| !Topic::is_of_cycles(name) && topics.holds(name))
}

/// Returns the node options of the ROS arguments.
fn options(ros: &RosArguments, cell: &Cell, logging: &Logging) -> Result<NodeOptions, String> {
    let name = ros.node_name(&cell.ros.name, &cell.ros.namespace).map_err(|error| error.to_string())?;
    let names = ros.names(&name).map_err(|error| error.to_string())?;
    check_names(&names)?;
    let loggers = logging.loggers(name.logger());
    for (logger, level) in &ros.levels {
        loggers.set(logger, Some(*level)).map_err(|reason| format!("--log-level {logger}: {reason}"))?;
    }
    if let Some(enclave) = &ros.enclave {
        tracing::debug!("enclave {enclave} is not used: DDS security does not exist here");
    }
    let side =
        SideOptions { side: Side::of_this_program(), participants: store::participants_folder(), ..Default::default() };
    Ok(NodeOptions {
        names,
        overrides: ros.overrides(&name),
        rosout: ros.rosout_logs,
        loggers,
        side,
        request_timeout: cell.ros.request_timeout,
        host_clock: None,
        tap: None,
    })
}

/// Returns the reaction of the machine to a loss of its ROS side; `is_final` is set if it is not started again.
fn on_loss(handle: Arc<Handle>, on_loss: OnLoss, is_final: Arc<AtomicBool>) -> layer::OnLoss {
    let lines = MessageRateLimit::default();
    Arc::new(move |loss| {
        let next = if loss.is_final { "it is not started again, the program ends" } else { "it is started again" };
        let reaction = reaction(on_loss);
        lines.log(loss.is_final, |more| tracing::error!("the ROS side {}: {reaction}; {next}{more}", loss.reason));
        if loss.is_final {
            is_final.store(true, Ordering::Release);
        }
        react(&handle, on_loss);
    })
}

/// Returns the reaction of the machine when it could not be halted by ROS, as text.
fn reaction(on_loss: OnLoss) -> &'static str {
    match on_loss {
        OnLoss::Halt => "all axes halt",
        OnLoss::None => "the axes go on (on_loss: none)",
    }
}

fn react(handle: &Handle, on_loss: OnLoss) {
    if on_loss == OnLoss::Halt && handle.takes_commands() {
        let all = AxisSet::first(handle.config().axes.len());
        let asked = Instant::now();
        // The queue of stops is emptied within a cycle.
        while handle.submit_as(Source::Machine, Action::Halt(all)).is_err() && asked.elapsed() < SAME_SIGNAL {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Supervises the surface. If it is lost, the program ends, because it cannot be created again.
fn watch(surface: &Surface, handle: Arc<Handle>, on_loss: OnLoss, loss_timeout: Duration) -> std::io::Result<Watch> {
    let (runtime, patience) = (tokio::runtime::Handle::current(), Timeouts::until(loss_timeout));
    Watch::start(runtime, patience, surface.pulse(), move |change| match change {
        Change::Overdue(doing) => tracing::warn!("the ROS surface has not worked for {doing}"),
        Change::Silent(time) => {
            let (ms, reaction) = (time.as_millis(), reaction(on_loss));
            tracing::error!("the ROS surface has not worked for {ms} ms: {reaction}");
            react(&handle, on_loss);
        }
        Change::Back => tracing::warn!("the ROS surface works again"),
        Change::Lost => {
            let s = patience.lost.as_secs();
            tracing::error!("the ROS surface has not worked for {s} s: all axes halt; the program ends");
            if let Ok(runtime) = tokio::runtime::Builder::new_current_thread().enable_time().build() {
                runtime.block_on(stop_machine(&handle, || false));
            }
            std::process::exit(1);
        }
    })
}

/// Checks that the machine would accept these as its first commands, with a cycle of a copy of the machine.
fn try_first(config: &MachineConfig, actions: &[Action]) -> Result<(), String> {
    let mut machine = Machine::new(config.clone()).map_err(|error| error.to_string())?;
    let (mut inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let command =
        |(action, sequence): (&Action, u64)| Command { sequence, source: Source::Cli, action: action.clone() };
    let commands: Vec<_> = actions.iter().zip(1..).map(command).collect();
    // The maximum number of commands of a cycle.
    for commands in commands.chunks(MAX_COMMANDS) {
        inputs.begin(machine.next_cycle(), 0);
        machine.cycle(&inputs, Commands::queue(commands), &mut outputs);
        if let Some(refused) = machine.events().iter().find(|event| event.kind == Kind::Refused) {
            return Err(format!("parameters that were given to the node: {}", text::message(refused, config)));
        }
    }
    Ok(())
}

fn environment(cell: &Cell) -> Result<Environment, String> {
    let environment = Environment::read().map_err(|error| error.to_string())?;
    if cell.ros.interfaces.is_empty() {
        return Ok(environment);
    }
    let existing = Interface::of_host().map_err(|error| error.to_string())?;
    environment.with_interfaces(&cell.ros.interfaces, &existing).map_err(|error| error.to_string())
}

/// Objects to start, and their presentation.
struct Start<'a> {
    args: &'a RunArgs,
    cell: &'a Cell,
    options: NodeOptions,
    environment: &'a Environment,
    logging: &'a Logging,
    /// Copies of published messages for the recorder.
    tap: (Tap, Receiver<TappedMessage>),
}

/// Starts the machine after the node, and serves ROS until a signal is received or the machine fails.
///
/// # Errors
/// Returns an error if an argument is invalid; no cycle has run then.
async fn serve(start: Start<'_>, prepared: Prepared, heard: SurfaceInputs, signals: Signals) -> Result<Exit, String> {
    let Start { args, cell, mut options, environment, logging, tap } = start;
    let host: Arc<dyn Host> = prepared.handle.clone();
    let is_lost = Arc::<AtomicBool>::default();
    options.side.loss_timeout = cell.ros.loss_timeout;
    options.host_clock = Some(prepared.clock.clone());
    options.side.on_loss = on_loss(prepared.handle.clone(), cell.ros.on_loss, Arc::clone(&is_lost));
    let name = options.names.node().clone();
    let surface = Node::with(options, environment).map_err(CreateError::from).and_then(|node| {
        let rosout = node.rosout()?;
        let surface = Surface::start(node, host, heard.events, heard.states, &cell.groups)?;
        logging.show_on(Some(rosout));
        Ok(surface)
    });
    let mut surface = match surface {
        Ok(surface) => surface,
        Err(CreateError::Given(sentence)) => return Err(sentence),
        Err(error) => {
            tracing::error!("no ROS 2 node: {error}");
            return Ok(Exit::Failed);
        }
    };
    let recording = Recording::open(args, cell, &name, &prepared.buses, tap)?;
    let running = prepared.start(recording);
    let watch = watch(&surface, Arc::clone(&running.handle), cell.ros.on_loss, cell.ros.loss_timeout);
    let watch = watch.map_err(|error| format!("no thread that watches ROS: {error}"))?;
    let networks = match &environment.networks {
        Networks::Loopback => "this host only".to_owned(),
        Networks::All => "all interfaces".to_owned(),
        Networks::Only(addresses) => addresses.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
    };
    tracing::info!("ROS 2 node {name}, domain {}, {networks}; Ctrl-C ends it", environment.domain);
    if !cell.ros.autostart {
        let command = activate_command(&name.to_string());
        tracing::info!("autostart is false: the node waits, unconfigured; `{command}` starts it");
    }
    if let Some(why) = Interface::of_host().ok().and_then(|existing| environment.unreachable(&existing)) {
        tracing::warn!("{why}");
    }
    let why = wait_for_end(&running, &is_lost, &mut surface, signals).await;
    stop_machine(&running.handle, || running.cycle.is_finished()).await;
    logging.show_on(None);
    drop(watch);
    drop(surface);
    Ok(match (running.end(), why) {
        (exit, Ended::BySignal) => exit,
        (exit, Ended::ScenarioOver(report)) => {
            say(&report);
            if report.passed() { exit } else { Exit::Failed }
        }
        (_, Ended::NotStarted | Ended::ThreadFailed | Ended::WithoutRos) => Exit::Failed,
    })
}

/// Reason why the program ends.
enum Ended {
    BySignal,
    ScenarioOver(Box<Report>),
    /// The backends did not start, and a scenario waits for them.
    NotStarted,
    ThreadFailed,
    WithoutRos,
}

/// Waits for a signal, for the end of the scenario, or for the failure of a thread. After a first signal, a second one
/// ends the process.
async fn wait_for_end(running: &Running, is_lost: &AtomicBool, surface: &mut Surface, mut signals: Signals) -> Ended {
    let mut look = tokio::time::interval(Duration::from_millis(100));
    let mut records = true;
    loop {
        tokio::select! {
            _ = signals.recv() => break,
            _ = look.tick() => {
                if let Some(report) = running.report.as_ref().and_then(|report| report.try_recv().ok()) {
                    return Ended::ScenarioOver(Box::new(report));
                }
                // The scenario cannot be played any more. Without a scenario, a user may fix the error and configure
                // the node again.
                if let (Some(_), GateState::Failed(reason)) = (&running.report, running.handle.gate()) {
                    tracing::error!("the scenario is not played: {reason}");
                    return Ended::NotStarted;
                }
                if records && running.recorder.is_finished() {
                    records = false;
                    tracing::error!("the recorder has failed: nothing is recorded any more; the machine goes on");
                }
                if running.cycle.is_finished() || running.bridge.is_finished() {
                    return Ended::ThreadFailed;
                }
                if surface.has_failed() {
                    tracing::error!("a task of the ROS surface has failed: all axes halt; the program ends");
                    return Ended::WithoutRos;
                }
                if is_lost.load(Ordering::Acquire) {
                    return Ended::WithoutRos;
                }
            }
        }
    }
    tracing::info!("halting all axes; Ctrl-C again ends at once");
    tokio::spawn(async move {
        let first = Instant::now();
        // A terminal and a wrapper may both forward the same Ctrl-C.
        while first.elapsed() < SAME_SIGNAL {
            signals.recv().await;
        }
        std::process::exit(1);
    });
    Ended::BySignal
}
