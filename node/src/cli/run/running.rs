//! A running machine: its interfaces, its threads, and how it is stopped.

use super::super::{Exit, store};
use super::{FlightArgs, RunArgs};
use crate::cell::Cell;
use crate::recording::bag::{Bag, BagOptions, Subject};
use crate::recording::cadence::Cadence;
use crate::recording::encoder::Encoder;
use crate::run::backends::{Backends, NewBackend};
use crate::run::bridge::{Bridge, Handle};
use crate::run::can;
use crate::run::clock::{ClockWatch, CycleClock};
use crate::run::flight::Flight;
use crate::run::flight::folder::FlightFolder;
use crate::run::frames::{FrameReceiver, frames};
use crate::run::gate::Gate;
use crate::run::keeper::StoreWriter;
use crate::run::lanes;
use crate::run::objects::ObjectAccess;
use crate::run::realtime::Processor;
use crate::run::recorder::{Asked, FlightRecorder, NamedFrames, Published, Recorder};
use crate::run::samples::{Cadences, samples};
use crate::run::services::Services;
use crate::run::spawn;
use crate::run::thread::{CycleThread, Play, Statistics};
use crate::run::trials::trials;
use crate::run::wake::Wake;
use crate::scenario::{Player, Report, Scenario};
use crate::store::Store;
use lineshaft_core::command::{Action, Source};
use lineshaft_core::drive::{Note, Service};
use lineshaft_core::machine::Machine;
use lineshaft_core::object::AxisSet;
use lineshaft_core::signal::Signal;
use lineshaft_core::signal::axis::AxisSignal;
use lineshaft_ros::layer::{HostClock, NodeName, Tap, TappedMessage};
use lineshaft_ros::surface::host::{Host, Snapshot, StampedEvent};
use lineshaft_ros::surface::{StateReceiver, states};
use rtrb::RingBuffer;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

/// Capacity of the event queue from the cycle thread to the bridge: many cycles of the maximum number of events.
const EVENT_ROOM: usize = 1 << 16;
/// Maximum time for axes to stop, and then to switch off, before the program ends anyway.
const PATIENCE: Duration = Duration::from_secs(10);

/// Recordings, opened before the machine starts.
pub(in crate::cli) struct Recording {
    subject: Arc<Subject>,
    bag: Option<Bag>,
    flight: Option<FlightRecorder>,
    published: Option<Published>,
}

impl Recording {
    /// Opens a bag, if there are options for one.
    ///
    /// # Errors
    /// Returns an error if the path is in use or cannot be created.
    pub(in crate::cli) fn of_cycles(cell: &Cell, name: &NodeName, bag: Option<&BagOptions>) -> Result<Self, String> {
        let subject = Arc::new(Subject::new(cell, name));
        let bag = bag.map(|options| Bag::create(options, Subject::clone(&subject))).transpose();
        Ok(Self { subject, bag: bag.map_err(|error| error.to_string())?, flight: None, published: None })
    }

    /// Opens the recordings of a run; `tap` copies the messages that the node publishes.
    pub(super) fn open(
        args: &RunArgs,
        cell: &Cell,
        name: &NodeName,
        buses: &[NamedFrames],
        tap: (Tap, Receiver<TappedMessage>),
    ) -> Result<Self, String> {
        let kept = buses.iter().filter(|_| args.record_frames).map(|(name, _)| name.clone());
        let (tap, copies) = tap;
        let (buses, published) = (kept.collect(), tap.topics());
        let subject = Arc::new(Subject { buses, published, ..Subject::new(cell, name) });
        let bag = args.record.options().map(|options| Bag::create(&options, Subject::clone(&subject)));
        let bag = bag.transpose().map_err(|error| error.to_string())?;
        let published = Some(Published::new(tap, copies));
        Ok(Self { subject, bag, flight: flight(&args.flight, name)?, published })
    }
}

/// Returns the flight recorder, if it is on. A given folder must exist; without the default folder it is off, with a
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
        None => match FlightFolder::create_unique(&flight_folder(name)?, keep) {
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

/// Devices with which a machine exchanges data.
pub(in crate::cli) struct Hardware {
    backends: Backends,
    services: Vec<Box<dyn Service>>,
    /// Access to objects of its devices.
    objects: ObjectAccess,
    /// Recorded frames of its buses.
    buses: Vec<NamedFrames>,
    /// Whether each axis has a real drive, in the order of the file.
    real: Vec<bool>,
}

impl Hardware {
    /// Creates the hardware of a cell; if `is_sim`, all of it is simulated. `are_kept`: frames of its buses are
    /// recorded.
    ///
    /// # Errors
    /// Returns an error if its files, or its buses and drives according to them, are wrong.
    pub(in crate::cli) fn of(cell: &Cell, file: Option<&Path>, is_sim: bool, are_kept: bool) -> Result<Self, String> {
        let real = if is_sim { Vec::new() } else { can::backends(cell, file, are_kept)? };
        let simulated = cell.backends.iter().filter(|backend| is_sim && backend.has_objects());
        let mut found = Self {
            backends: Backends::simulated(cell.plant_of(|backend| is_sim || backend.is_simulated())),
            services: Vec::new(),
            objects: ObjectAccess::new(simulated.map(|backend| backend.name.clone()).collect()),
            buses: Vec::new(),
            real: if is_sim { vec![false; cell.machine.axes.len()] } else { cell.real_axes() },
        };
        for NewBackend { name, cyclic, service, objects, frames } in real {
            if let Some(objects) = objects {
                found.objects = found.objects.with_bus(objects);
            }
            found.buses.extend(frames.map(|frames| (name.clone(), frames)));
            found.backends = found.backends.with(name, cyclic);
            found.services.push(service);
        }
        cell.machine.check_backends(&found.backends.all()).map_err(|error| error.to_string())?;
        found.backends.check_clock().map_err(|error| error.to_string())?;
        Ok(found)
    }
}

/// Initial data of a machine, in addition to its cell.
#[derive(Default)]
pub(in crate::cli) struct InitialData {
    pub store: Option<Store>,
    /// First commands.
    pub first: Vec<Action>,
    pub scenario: Option<Scenario>,
    pub processor: Processor,
}

/// Threads of a running machine.
pub(in crate::cli) struct Running {
    pub handle: Arc<Handle>,
    statistics: Arc<Statistics>,
    stop_cycle: Arc<AtomicBool>,
    /// Ends the bridge and the recorder.
    stop_others: Arc<AtomicBool>,
    pub cycle: JoinHandle<()>,
    /// Thread of backends that must be started.
    services: Option<JoinHandle<()>>,
    pub bridge: JoinHandle<()>,
    /// Returns true if all bags were finished without error.
    pub recorder: JoinHandle<bool>,
    /// Ends with [`Handle::end_keeping`].
    keeper: Option<JoinHandle<()>>,
    /// Receiver of the report of the scenario; `None` without a scenario.
    pub report: Option<Receiver<Report>>,
}

/// A machine with all its interfaces, before its first cycle: no thread runs, and no device was accessed.
pub(in crate::cli) struct Prepared {
    pub handle: Arc<Handle>,
    cycle: CycleThread,
    services: Option<Services>,
    bridge: Bridge,
    keeper: Option<StoreWriter>,
    encoder: Encoder,
    frames: FrameReceiver,
    asked: Receiver<Asked>,
    pub buses: Vec<NamedFrames>,
    report: Option<Receiver<Report>>,
    /// Clock of the stamps.
    pub clock: HostClock,
}

/// Data that the bridge will pass on to the surface.
pub(in crate::cli) struct SurfaceInputs {
    pub events: UnboundedReceiver<StampedEvent>,
    pub states: StateReceiver,
}

impl Prepared {
    /// Prepares a machine; also returns the data for the surface.
    pub(in crate::cli) fn new(
        cell: &Cell,
        machine: Machine,
        hardware: Hardware,
        given: InitialData,
    ) -> (Self, SurfaceInputs) {
        let Hardware { backends, services, objects, buses, real } = hardware;
        let (commander, lanes) = lanes::lanes(machine.config().axes.len());
        let (frames, frames_out, spent) = frames(&machine);
        let (ask, asked) = channel();
        let (desk, slot) = trials();
        let (events, events_out) = RingBuffer::new(EVENT_ROOM);
        let first = Snapshot { cycle: 0, stamp_ns: 0, board: machine.board().clone() };
        let (snapshot, signals) = triple_buffer::triple_buffer(&first);
        let wake = Wake::default();
        let cycle_ns = machine.config().cycle_ns;
        let cadences = Cadences {
            joint_states: Cadence::new(cell.ros.joint_states_rate, cycle_ns),
            axis_states: Cadence::new(cell.ros.axis_states_rate, cycle_ns),
            shaft: cell.ros.shaft_rate.map(|rate| Cadence::new(rate, cycle_ns)),
        };
        let (samples, samples_out) = samples(cadences, cycle_ns, machine.board());
        let image = machine.parameter_image();
        let (parameters, parameters_out) = triple_buffer::triple_buffer(&image);
        let (config, directory) = (machine.config().clone(), machine.directory().clone());
        let statistics = Arc::new(Statistics::default());
        let gate = Arc::new(if cell.ros.autostart { Gate::opening() } else { Gate::default() });
        // Without services, cycles do not wait for them.
        let services = (!services.is_empty()).then(|| Services::new(services, Arc::clone(&gate)));
        let handle = Handle::new(config.clone(), directory, commander, desk, ask, signals, image)
            .with_cycles(Arc::clone(&gate), Arc::clone(&statistics))
            .with_hardware(cell.hardware_names())
            .with_health(services.as_ref().map(Services::board).unwrap_or_default())
            .with_objects(objects)
            .with_real(real)
            .with_joint_names(cell.joint_names.clone())
            .with_robot_description(cell.robot.as_ref().map(|robot| robot.text.clone()))
            .with_controller_manager(cell.ros.controller_manager.clone());
        // Queued before the first cycle, and so before any other request.
        let mut first = given.first.into_iter().map(|action| handle.submit_as(Source::Cli, action));
        if let Some(busy) = first.find_map(Result::err) {
            tracing::error!("parameters that were given to the node are not set: {busy}");
        }
        drop(first);
        let handle = if cell.ros.autostart { handle } else { handle.unconfigured() };
        let (handle, keeper) = match given.store {
            None => (handle, None),
            Some(store) => {
                let (orders, keeper) = StoreWriter::new(store, config);
                (handle.with_keeper(orders), Some(keeper))
            }
        };
        let handle = Arc::new(handle);
        let encoder = Encoder::new(cell, machine.config(), machine.directory());
        let (listener, events_heard) = unbounded_channel();
        let (states, states_heard) = states(cell.ros.shaft_rate.is_some());
        let (play, report) = match given.scenario {
            None => (None, None),
            Some(scenario) => {
                let (send, receive) = channel();
                let play = Play { player: Player::new(&scenario), numbers: handle.numbers(), report: send };
                (Some(play), Some(receive))
            }
        };
        let bridge = Bridge::new(
            events_out,
            (samples_out, states),
            parameters_out,
            spent,
            listener,
            Arc::clone(&statistics),
            wake.clone(),
        );
        let clock = HostClock::default();
        let bridge = bridge.with_clock(ClockWatch::new(clock.clone()));
        let cycle = CycleThread {
            machine,
            backends,
            play,
            trials: (slot, handle.numbers()),
            lanes,
            events,
            frames,
            snapshot,
            samples,
            parameters,
            published: 0,
            wake,
            gate,
            stop: Arc::default(),
            statistics,
            clock: CycleClock::new(clock.clone()),
            processor: given.processor,
        };
        let heard = SurfaceInputs { events: events_heard, states: states_heard };
        let frames = frames_out;
        (Self { handle, cycle, services, bridge, keeper, encoder, frames, asked, buses, report, clock }, heard)
    }

    /// Starts the threads.
    pub(in crate::cli) fn start(self, recording: Recording) -> Running {
        let Self { handle, cycle, services, bridge, keeper, encoder, frames, asked, buses, report, clock: _ } = self;
        let Recording { subject, bag, flight, published } = recording;
        let (stop_cycle, stop_others) = (Arc::clone(&cycle.stop), Arc::<AtomicBool>::default());
        let statistics = Arc::clone(&cycle.statistics);
        let keeper = keeper.map(|keeper| spawn("store", move || keeper.run()));
        let recorder =
            Recorder::new(Arc::clone(&handle), frames, encoder, subject, asked, bag, flight).with_buses(buses);
        let recorder = recorder.with_published(published);
        let (ready, granted) = channel();
        let end = Arc::clone(&stop_others);
        let by_services = Arc::clone(&handle);
        let tell = move |Note { code, number }| {
            // If the queue is full, the log contains the important part.
            let _ = by_services.submit_as(Source::Machine, Action::Note { code, number });
        };
        let services = services.map(|services| spawn("backends", move || services.run(&end, &tell)));
        let cycle = spawn("cycle", move || cycle.run(ready));
        if let Ok(refused) = granted.recv() {
            warn(&refused);
        }
        let (for_bridge, end) = (Arc::clone(&handle), Arc::clone(&stop_others));
        let bridge = spawn("bridge", move || bridge.run(&for_bridge, &end));
        let end = Arc::clone(&stop_others);
        let recorder = spawn("recorder", move || recorder.run(&end));
        Running { handle, services, statistics, stop_cycle, stop_others, cycle, bridge, recorder, keeper, report }
    }
}

impl Running {
    /// Ends the threads; fails if one of them has panicked.
    pub(in crate::cli) fn end(self) -> Exit {
        self.stop_cycle.store(true, Ordering::Relaxed);
        let cycle = self.cycle.join();
        self.stop_others.store(true, Ordering::Relaxed);
        let services = self.services.map_or(Ok(()), JoinHandle::join);
        let (bridge, recorder) = (self.bridge.join(), self.recorder.join());
        // After the bridge, which has passed on the last stored values.
        self.handle.end_keeping();
        let keeper = self.keeper.map_or(Ok(()), JoinHandle::join);
        tracing::info!("{}", self.statistics.summary());
        if cycle.is_err() || bridge.is_err() || recorder.is_err() || keeper.is_err() || services.is_err() {
            tracing::error!("a thread of the machine has failed; drives are left to their own supervision");
            return Exit::Failed;
        }
        // The end of an incomplete bag was reported; the requested recording is missing.
        if recorder.is_ok_and(|is_good| is_good) { Exit::Good } else { Exit::Failed }
    }
}

fn warn(refused: &[String]) {
    if !refused.is_empty() {
        tracing::warn!("cycles may come late: {}; see docs/realtime.md", refused.join(", "));
    }
}

/// Halts all axes, then switches them off; does not wait if the cycle thread has ended.
pub(in crate::cli) async fn stop_machine(handle: &Handle, is_over: impl Fn() -> bool) {
    let all = AxisSet::first(handle.config().axes.len());
    if !handle.takes_commands() {
        // Unconfigured: every drive is off and no cycle runs.
        return;
    }
    let asked = Instant::now();
    // A full queue is emptied within a few cycles.
    while handle.submit_as(Source::Cli, Action::Halt(all)).is_err() && asked.elapsed() < PATIENCE {
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    let stands = |snapshot: &Snapshot, first| snapshot.board.real(AxisSignal::CommandVelocity.of(first)) == 0.0;
    if !until(handle, &axes(handle, true), &is_over, stands).await {
        tracing::warn!("not all axes stand after {} s", PATIENCE.as_secs());
    }
    let _ = handle.submit_as(Source::Cli, Action::Disable(all));
    let is_off = |snapshot: &Snapshot, first| !snapshot.board.bit(AxisSignal::Enabled.of(first));
    if !until(handle, &axes(handle, false), &is_over, is_off).await {
        tracing::warn!("not all axes are off after {} s", PATIENCE.as_secs());
    }
}

/// Returns the first signal of each axis; virtual axes, which are always on, only if `with_virtual`.
fn axes(handle: &Handle, with_virtual: bool) -> Vec<Signal> {
    let axes = handle.config().axes.iter().filter(|axis| with_virtual || axis.drive.is_some());
    axes.filter_map(|axis| handle.directory().find(&format!("{}.state", axis.name))).collect()
}

/// Waits until a condition is true for axes in a snapshot newer than now; returns false after a timeout.
async fn until(
    handle: &Handle,
    axes: &[Signal],
    is_over: &impl Fn() -> bool,
    holds: impl Fn(&Snapshot, Signal) -> bool,
) -> bool {
    let (begin, start) = (handle.snapshot().cycle, Instant::now());
    while start.elapsed() < PATIENCE && !is_over() {
        tokio::time::sleep(Duration::from_millis(2)).await;
        let snapshot = handle.snapshot();
        // Two cycles later the command has been applied.
        if snapshot.cycle > begin + 2 && axes.iter().all(|&first| holds(&snapshot, first)) {
            return true;
        }
    }
    false
}
