//! `lineshaft run`.

use super::check::{summary, warnings};
use super::logging::Logging;
use super::{Exit, FlightArgs, RunArgs, complain, say, store};
use crate::cell::Cell;
use crate::recording::bag::{Bag, Subject};
use crate::recording::encoder::Encoder;
use crate::run::bridge::{Bridge, Handle};
use crate::run::flight::Flight;
use crate::run::flight::folder::FlightFolder;
use crate::run::frames::frames;
use crate::run::gate::Gate;
use crate::run::keeper::Keeper;
use crate::run::lanes;
use crate::run::recorder::{FlightRecorder, Recorder};
use crate::run::thread::{CycleThread, Play, Statistics};
use crate::scenario::{Player, Report, Scenario};
use crate::store::Store;
use lineshaft_core::command::{Action, Command, Commands, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Kind;
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_core::signal::Signal;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_core::sim::Plant;
use lineshaft_core::text;
use lineshaft_ros::layer::{CreateError, Environment, Interface, Networks, Node, NodeName, NodeOptions, RosArguments};
use lineshaft_ros::surface::host::{Host, Snapshot, StampedEvent};
use lineshaft_ros::surface::{Rates, Surface, check_names, start_command};
use rtrb::RingBuffer;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::signal::unix::{Signal as UnixSignal, SignalKind, signal};
use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

/// Events between the cycle thread and the bridge: many cycles of the most that a machine can tell.
const EVENT_ROOM: usize = 1 << 16;
/// Within this time another signal is the first one, passed on twice.
const SAME_SIGNAL: Duration = Duration::from_millis(500);
/// How long axes may take to stop, and then to switch off, before the program ends all the same.
const PATIENCE: Duration = Duration::from_secs(10);

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
    match start(args, cell, &title, scenario, ros, logging) {
        Ok(exit) => exit,
        Err(sentence) => {
            complain(&sentence);
            Exit::Usage
        }
    }
}

/// Everything that can be wrong before the machine starts is said here; nothing has started then.
fn start(
    args: &RunArgs,
    mut cell: Cell,
    title: &str,
    scenario: Option<Scenario>,
    ros: &RosArguments,
    logging: &Logging,
) -> Result<Exit, String> {
    if let (Some(backend), false) = (cell.real_backends.first(), args.sim) {
        return Err(format!("backend {backend}: CAN does not exist yet; `lineshaft run --sim` simulates its drives"));
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
    let plant = cell.plant();
    cell.machine.check_backend(&plant).map_err(|error| error.to_string())?;
    let first = start_command(&cell.machine, &mut options.overrides)?;
    first.as_ref().map_or(Ok(()), |action| try_first(&cell.machine, action))?;
    let recording = Recording::open(args, cell, &name)?;
    tracing::info!("lineshaft {}: {title}: {}, simulated", env!("CARGO_PKG_VERSION"), summary(cell));
    warnings(cell).iter().for_each(|warning| tracing::warn!("{warning}"));
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(|error| format!("no threads for ROS: {error}"))?;
    let exit = runtime.block_on(async {
        // Before any thread runs: from here on no signal ends the program unheard.
        let signals = Signals::new().map_err(|error| format!("signals of the system cannot be received: {error}"))?;
        let (running, events) = Running::start(args, cell, machine, plant, scenario, recording, Given { store, first });
        Ok::<_, String>(serve(cell, options, &environment, running, events, signals, logging).await)
    })?;
    runtime.shutdown_timeout(Duration::from_secs(1));
    Ok(exit)
}

/// What the ROS arguments give to the node.
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
    Ok(NodeOptions { names, overrides: ros.overrides(&name), rosout: ros.rosout_logs, loggers })
}

/// Would the machine take this as its first command? A cycle of another one that is the same tells.
fn try_first(config: &MachineConfig, action: &Action) -> Result<(), String> {
    let mut machine = Machine::new(config.clone()).map_err(|error| error.to_string())?;
    let (inputs, mut outputs) = (machine.inputs(), machine.outputs());
    let command = Command { sequence: 1, source: Source::Cli, action: action.clone() };
    machine.cycle(&inputs, Commands::queue(&[command]), &mut outputs);
    match machine.events().iter().find(|event| event.kind == Kind::Refused) {
        Some(refused) => Err(format!("parameters that were given to the node: {}", text::sentence(refused, config))),
        None => Ok(()),
    }
}

fn environment(cell: &Cell) -> Result<Environment, String> {
    let environment = Environment::read().map_err(|error| error.to_string())?;
    if cell.ros.interfaces.is_empty() {
        return Ok(environment);
    }
    let existing = Interface::of_host().map_err(|error| error.to_string())?;
    environment.with_interfaces(&cell.ros.interfaces, &existing).map_err(|error| error.to_string())
}

/// What is recorded, opened before the machine starts.
struct Recording {
    subject: Arc<Subject>,
    bag: Option<Bag>,
    flight: Option<FlightRecorder>,
}

impl Recording {
    fn open(args: &RunArgs, cell: &Cell, name: &NodeName) -> Result<Self, String> {
        let subject = Arc::new(Subject::new(cell, name));
        let bag = args.record.options().map(|options| Bag::create(&options, Subject::clone(&subject)));
        let bag = bag.transpose().map_err(|error| error.to_string())?;
        Ok(Self { subject, bag, flight: flight(&args.flight, name)? })
    }
}

/// The flight recorder, if it is on. A folder that was asked for must be there; without the usual one it is off, with a
/// warning.
fn flight(args: &FlightArgs, name: &NodeName) -> Result<Option<FlightRecorder>, String> {
    if args.flight_recorder == 0 {
        return Ok(None);
    }
    let keep = usize::try_from(args.flight_keep).unwrap_or(usize::MAX);
    let folder = match &args.flight_folder {
        Some(folder) => {
            let created = FlightFolder::create(folder.clone(), keep);
            created.map_err(|error| format!("--flight-folder: {error}"))?
        }
        None => match FlightFolder::create_beside(&flight_folder(name)?, keep) {
            Ok(folder) => folder,
            Err(error) => {
                tracing::warn!("the flight recorder is off: {error}; --flight-folder names another folder");
                return Ok(None);
            }
        },
    };
    Ok(Some((Flight::new(args.flight_recorder * 1_000_000_000), folder)))
}

fn flight_folder(name: &NodeName) -> Result<PathBuf, String> {
    let folder = store::node_folder(name);
    folder.ok_or_else(|| "no folder for the flight recorder: HOME is not set; give --flight-folder".to_owned())
}

/// What a machine begins with beside its cell.
struct Given {
    store: Option<Store>,
    /// Its first command.
    first: Option<Action>,
}

/// The threads of a running machine.
struct Running {
    handle: Arc<Handle>,
    statistics: Arc<Statistics>,
    stop_cycle: Arc<AtomicBool>,
    /// Ends bridge and recorder.
    stop_others: Arc<AtomicBool>,
    cycle: JoinHandle<()>,
    bridge: JoinHandle<()>,
    /// True where all bags have a good end.
    recorder: JoinHandle<bool>,
    /// Ends with [`Handle::end_keeping`].
    keeper: Option<JoinHandle<()>>,
    /// The report of the scenario, once it is over; nothing without one.
    report: Option<Receiver<Report>>,
}

impl Running {
    fn start(
        args: &RunArgs,
        cell: &Cell,
        machine: Machine,
        plant: Plant,
        scenario: Option<Scenario>,
        recording: Recording,
        given: Given,
    ) -> (Self, UnboundedReceiver<StampedEvent>) {
        let (commander, lanes) = lanes::lanes(machine.config().axes.len());
        let (frames, frames_out, spent) = frames(&machine);
        let (ask, asked) = channel();
        let (events, events_out) = RingBuffer::new(EVENT_ROOM);
        let first = Snapshot { cycle: 0, stamp_ns: 0, board: machine.board().clone() };
        let (snapshot, signals) = triple_buffer::triple_buffer(&first);
        let image = machine.parameter_image();
        let (parameters, parameters_out) = triple_buffer::triple_buffer(&image);
        let (config, directory) = (machine.config().clone(), machine.directory().clone());
        let statistics = Arc::new(Statistics::default());
        let gate = Arc::new(if cell.ros.autostart { Gate::opening() } else { Gate::default() });
        let handle = Handle::new(config.clone(), directory, commander, ask, first, image)
            .with_cycles(Arc::clone(&gate), Arc::clone(&statistics))
            .with_hardware(cell.hardware.clone())
            .with_robot_description(cell.robot.as_ref().map(|robot| robot.text.clone()));
        // Before the first cycle, and so before anything else that is asked.
        if let Some(Err(busy)) = given.first.map(|action| handle.submit_as(Source::Cli, action)) {
            tracing::error!("parameters that were given to the node are not set: {busy}");
        }
        let handle = if cell.ros.autostart { handle } else { handle.unconfigured() };
        let (handle, keeper) = match given.store {
            None => (handle, None),
            Some(store) => {
                let (orders, keeper) = Keeper::new(store, config);
                (handle.with_keeper(orders), Some(std::thread::spawn(move || keeper.run())))
            }
        };
        let handle = Arc::new(handle);
        let (stop_cycle, stop_others) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
        let encoder = Encoder::new(cell, machine.config(), machine.directory());
        let Recording { subject, bag, flight } = recording;
        let recorder = Recorder::new(Arc::clone(&handle), frames_out, encoder, subject, asked, bag, flight);
        let (listener, heard) = unbounded_channel();
        let (play, report) = match scenario {
            None => (None, None),
            Some(scenario) => {
                let (send, receive) = channel();
                let play = Play { player: Player::new(&scenario), numbers: handle.numbers(), report: send };
                (Some(play), Some(receive))
            }
        };
        let cycle = CycleThread {
            machine,
            plant,
            play,
            lanes,
            events,
            frames,
            snapshot,
            parameters,
            published: 0,
            gate,
            stop: Arc::clone(&stop_cycle),
            statistics: Arc::clone(&statistics),
            processor: args.cpu.unwrap_or_default(),
        };
        let (ready, granted) = channel();
        let cycle = std::thread::spawn(move || cycle.run(ready));
        if let Ok(refused) = granted.recv() {
            warn(&refused);
        }
        let bridge = Bridge::new(events_out, signals, parameters_out, spent, listener, Arc::clone(&statistics));
        let (for_bridge, end) = (Arc::clone(&handle), Arc::clone(&stop_others));
        let bridge = std::thread::spawn(move || bridge.run(&for_bridge, &end));
        let end = Arc::clone(&stop_others);
        let recorder = std::thread::spawn(move || recorder.run(&end));
        (Self { handle, statistics, stop_cycle, stop_others, cycle, bridge, recorder, keeper, report }, heard)
    }

    /// Ends the threads; an error when one of them has panicked.
    fn end(self) -> Exit {
        self.stop_cycle.store(true, Ordering::Relaxed);
        let cycle = self.cycle.join();
        self.stop_others.store(true, Ordering::Relaxed);
        let (bridge, recorder) = (self.bridge.join(), self.recorder.join());
        // After the bridge: it has passed on what was saved last.
        self.handle.end_keeping();
        let keeper = self.keeper.map_or(Ok(()), JoinHandle::join);
        let of = |counter: &std::sync::atomic::AtomicU64| counter.load(Ordering::Relaxed);
        let statistics = &self.statistics;
        tracing::info!(
            "{} cycles, {} missed; latest start {} us after its time, longest cycle {} us",
            of(&statistics.cycles),
            of(&statistics.missed),
            of(&statistics.worst_lateness_ns) / 1000,
            of(&statistics.worst_duration_ns) / 1000,
        );
        if cycle.is_err() || bridge.is_err() || recorder.is_err() || keeper.is_err() {
            tracing::error!("a thread of the machine has failed; drives are left to their own supervision");
            return Exit::Failed;
        }
        // A bag without a good end was told of; what was asked for is not there.
        if recorder.is_ok_and(|is_good| is_good) { Exit::Good } else { Exit::Failed }
    }
}

fn warn(refused: &[String]) {
    if !refused.is_empty() {
        tracing::warn!("cycles may come late: {}; see docs/realtime.md", refused.join(", "));
    }
}

/// Serves ROS until a signal comes or the machine fails.
async fn serve(
    cell: &Cell,
    options: NodeOptions,
    environment: &Environment,
    running: Running,
    events: UnboundedReceiver<StampedEvent>,
    signals: Signals,
    logging: &Logging,
) -> Exit {
    let host: Arc<dyn Host> = running.handle.clone();
    let rates = Rates { joint_states: cell.ros.joint_states_rate, axis_states: cell.ros.axis_states_rate };
    let name = options.names.node().clone();
    let surface = Node::with(options, environment).map_err(CreateError::from).and_then(|node| {
        let rosout = node.rosout()?;
        let surface = Surface::start(node, host, events, rates, &cell.groups)?;
        logging.show_on(Some(rosout));
        Ok(surface)
    });
    let surface = match surface {
        Ok(surface) => surface,
        Err(CreateError::Given(sentence)) => {
            complain(&sentence);
            // It was there for a moment: a client may have been quick.
            stop_machine(&running).await;
            running.end();
            return Exit::Usage;
        }
        Err(error) => {
            tracing::error!("no ROS 2 node: {error}");
            // A scenario may move axes already.
            stop_machine(&running).await;
            running.end();
            return Exit::Failed;
        }
    };
    let networks = match &environment.networks {
        Networks::Loopback => "this host only".to_owned(),
        Networks::All => "all interfaces".to_owned(),
        Networks::Only(addresses) => addresses.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
    };
    tracing::info!("ROS 2 node {name}, domain {}, {networks}; Ctrl-C ends it", environment.domain);
    let why = wait_for_end(&running, signals).await;
    stop_machine(&running).await;
    logging.show_on(None);
    drop(surface);
    match (running.end(), why) {
        (exit, Ended::BySignal) => exit,
        (exit, Ended::ScenarioOver(report)) => {
            say(&report);
            if report.passed() { exit } else { Exit::Failed }
        }
        (_, Ended::ThreadFailed) => Exit::Failed,
    }
}

/// The signals that end the program.
struct Signals([UnixSignal; 3]);

impl Signals {
    /// # Errors
    /// The system does not give them.
    fn new() -> std::io::Result<Self> {
        Ok(Self([
            signal(SignalKind::interrupt())?,
            signal(SignalKind::terminate())?,
            // A terminal that is closed.
            signal(SignalKind::hangup())?,
        ]))
    }

    async fn recv(&mut self) {
        let [interrupt, terminate, hangup] = &mut self.0;
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
            _ = hangup.recv() => {}
        }
    }
}

/// Why the program ends.
enum Ended {
    BySignal,
    ScenarioOver(Box<Report>),
    ThreadFailed,
}

/// Waits for a signal, for the end of the scenario, or for a thread to fail. From a first signal on a second one ends the
/// process.
async fn wait_for_end(running: &Running, mut signals: Signals) -> Ended {
    let mut look = tokio::time::interval(Duration::from_millis(100));
    let mut records = true;
    loop {
        tokio::select! {
            () = signals.recv() => break,
            _ = look.tick() => {
                if let Some(report) = running.report.as_ref().and_then(|report| report.try_recv().ok()) {
                    return Ended::ScenarioOver(Box::new(report));
                }
                if records && running.recorder.is_finished() {
                    records = false;
                    tracing::error!("the recorder has failed: nothing is recorded any more; the machine goes on");
                }
                if running.cycle.is_finished() || running.bridge.is_finished() {
                    return Ended::ThreadFailed;
                }
            }
        }
    }
    tracing::info!("halting all axes; Ctrl-C again ends at once");
    tokio::spawn(async move {
        let first = Instant::now();
        // A terminal and a wrapper may both pass the same Ctrl-C on.
        while first.elapsed() < SAME_SIGNAL {
            signals.recv().await;
        }
        std::process::exit(1);
    });
    Ended::BySignal
}

/// Halts all axes, then switches them off.
async fn stop_machine(running: &Running) {
    let all = AxisSet::first(running.handle.config().axes.len());
    let handle = &running.handle;
    if !handle.takes_commands() {
        // Unconfigured: every drive is off and no cycle runs.
        return;
    }
    let asked = Instant::now();
    // A full lane empties within a few cycles.
    while handle.submit_as(Source::Cli, Action::Halt(all)).is_err() && asked.elapsed() < PATIENCE {
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    let stands = |snapshot: &Snapshot, first| snapshot.board.real(AxisSignal::CommandVelocity.of(first)) == 0.0;
    if !until(running, &axes(handle, true), stands).await {
        tracing::warn!("not all axes stand after {} s", PATIENCE.as_secs());
    }
    let _ = handle.submit_as(Source::Cli, Action::Disable(all));
    let is_off = |snapshot: &Snapshot, first| !snapshot.board.bit(AxisSignal::Enabled.of(first));
    if !until(running, &axes(handle, false), is_off).await {
        tracing::warn!("not all axes are off after {} s", PATIENCE.as_secs());
    }
}

/// First signals of the axes; virtual ones, which are always on, only when they are asked for.
fn axes(handle: &Handle, with_virtual: bool) -> Vec<Signal> {
    let axes = handle.config().axes.iter().filter(|axis| with_virtual || axis.drive.is_some());
    axes.filter_map(|axis| handle.directory().find(&format!("{}.state", axis.name))).collect()
}

/// Waits until something holds for axes in a snapshot that is newer than now; false when it takes too long.
async fn until(running: &Running, axes: &[Signal], holds: impl Fn(&Snapshot, Signal) -> bool) -> bool {
    let handle = &running.handle;
    let (begin, start) = (handle.snapshot().cycle, Instant::now());
    while start.elapsed() < PATIENCE && !running.cycle.is_finished() {
        tokio::time::sleep(Duration::from_millis(2)).await;
        let snapshot = handle.snapshot();
        // Two cycles further the command has applied.
        if snapshot.cycle > begin + 2 && axes.iter().all(|&first| holds(&snapshot, first)) {
            return true;
        }
    }
    false
}
