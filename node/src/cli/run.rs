//! `lineshaft run`.

use super::check::summary;
use super::{Exit, FlightArgs, RunArgs, say, store};
use crate::cell::Cell;
use crate::recording::bag::{Bag, Subject};
use crate::recording::encoder::Encoder;
use crate::run::bridge::{Bridge, Handle};
use crate::run::flight::Flight;
use crate::run::flight::folder::FlightFolder;
use crate::run::frames::frames;
use crate::run::keeper::Keeper;
use crate::run::lanes;
use crate::run::recorder::{FlightRecorder, Recorder};
use crate::run::thread::{CycleThread, Play, Statistics};
use crate::scenario::{Player, Report, Scenario};
use crate::store::Store;
use lineshaft_core::command::{Action, Source};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_core::signal::Signal;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_core::sim::Plant;
use lineshaft_ros::layer::{Environment, Interface, Networks, Node, NodeName, RosArguments};
use lineshaft_ros::surface::host::{Host, Snapshot, StampedEvent};
use lineshaft_ros::surface::{Rates, Surface};
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
/// How long axes may take to stop, and then to switch off, before the program ends all the same.
const PATIENCE: Duration = Duration::from_secs(10);

pub(super) fn run(args: &RunArgs, ros: RosArguments) -> Exit {
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
    match start(args, cell, &title, scenario, ros) {
        Ok(exit) => exit,
        Err(sentence) => {
            eprintln!("error: {sentence}");
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
    ros: RosArguments,
) -> Result<Exit, String> {
    if let (Some(backend), false) = (cell.real_backends.first(), args.sim) {
        return Err(format!("backend {backend}: CAN does not exist yet; `lineshaft run --sim` simulates its drives"));
    }
    if !cell.ros.autostart {
        return Err("ros: autostart: false needs the lifecycle services, which do not exist yet".to_owned());
    }
    let name = ros.name.as_deref().unwrap_or(&cell.ros.name);
    let namespace = ros.namespace.as_deref().unwrap_or(&cell.ros.namespace);
    let name = NodeName::new(namespace, name).map_err(|error| error.to_string())?;
    let environment = environment(&cell)?;
    let Ok(store) = store::open_for_node(&args.store, &mut cell, &name, args.cell.as_deref()) else {
        return Ok(Exit::Usage);
    };
    let cell = &cell;
    let machine = Machine::new(cell.machine.clone()).map_err(|error| error.to_string())?;
    let plant = Plant::new(&cell.machine, &cell.models.iter().copied().map(Some).collect::<Vec<_>>());
    cell.machine.check_backend(&plant).map_err(|error| error.to_string())?;
    let recording = Recording::open(args, cell, &name)?;
    tracing::info!("lineshaft {}: {title}: {}, simulated", env!("CARGO_PKG_VERSION"), summary(cell));
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(|error| format!("no threads for ROS: {error}"))?;
    let exit = runtime.block_on(async {
        // Before any thread runs: from here on no signal ends the program unheard.
        let signals = Signals::new().map_err(|error| format!("signals of the system cannot be received: {error}"))?;
        let (running, events) = Running::start(args, cell, machine, plant, scenario, recording, store);
        Ok::<_, String>(serve(cell, name, &environment, running, events, signals).await)
    })?;
    runtime.shutdown_timeout(Duration::from_secs(1));
    Ok(exit)
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
        store: Option<Store>,
    ) -> (Self, UnboundedReceiver<StampedEvent>) {
        let (commander, lanes) = lanes::lanes();
        let (frames, frames_out, spent) = frames(&machine);
        let (ask, asked) = channel();
        let (events, events_out) = RingBuffer::new(EVENT_ROOM);
        let first = Snapshot { cycle: 0, stamp_ns: 0, board: machine.board().clone() };
        let (snapshot, signals) = triple_buffer::triple_buffer(&first);
        let image = machine.parameter_image();
        let (parameters, parameters_out) = triple_buffer::triple_buffer(&image);
        let (config, directory) = (machine.config().clone(), machine.directory().clone());
        let handle = Handle::new(config.clone(), directory, commander, ask, first, image);
        let (handle, keeper) = match store {
            None => (handle, None),
            Some(store) => {
                let (orders, keeper) = Keeper::new(store, config);
                (handle.with_keeper(orders), Some(std::thread::spawn(move || keeper.run())))
            }
        };
        let handle = Arc::new(handle);
        let statistics = Arc::new(Statistics::default());
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
    name: NodeName,
    environment: &Environment,
    running: Running,
    events: UnboundedReceiver<StampedEvent>,
    signals: Signals,
) -> Exit {
    let host: Arc<dyn Host> = running.handle.clone();
    let rates = Rates { joint_states: cell.ros.joint_states_rate, axis_states: cell.ros.axis_states_rate };
    let surface = Node::new(name.clone(), environment)
        .map_err(|error| error.to_string())
        .and_then(|node| Surface::start(node, host, events, rates).map_err(|error| error.to_string()));
    let surface = match surface {
        Ok(surface) => surface,
        Err(error) => {
            tracing::error!("no ROS 2 node: {error}");
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
        signals.recv().await;
        std::process::exit(1);
    });
    Ended::BySignal
}

/// Halts all axes, then switches them off.
async fn stop_machine(running: &Running) {
    let all = AxisSet::first(running.handle.config().axes.len());
    let handle = &running.handle;
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
