//! Between the cycle thread and everybody else: passes events and signals on, frees what the recorder has no room for, and watches the
//! system clock.

use super::clock::ClockWatch;
use super::frames::Spent;
use super::gate::Gate;
use super::keeper::Orders;
use super::lanes::{Commander, Numbers};
use super::objects::ObjectDesk;
use super::recorder::Asked;
use super::samples::SampleReceiver;
use super::services::HealthBoard;
use super::thread::{Statistics, Taken};
use super::trials::TrialDesk;
use super::tuning;
use super::wake::Wake;
use crate::parameters::{export_text, read_changes};
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Setpoints, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::{Event, Kind, Severity};
use lineshaft_core::object::{AxisSet, Object};
use lineshaft_core::parameter::ParameterImage;
use lineshaft_core::signal::Directory;
use lineshaft_core::text;
use lineshaft_msgs::srv::{
    RecordRequest, RecordResponse, SdoReadRequest, SdoReadResponse, SdoWriteRequest, SdoWriteResponse,
};
use lineshaft_ros::layer::TOLD;
use lineshaft_ros::line_limit::LineLimit;
use lineshaft_ros::surface::host::{
    BackendHealth, Busy, Coming, GateState, Host, Listing, Snapshot, StampedEvent, Statistics as HostStatistics,
    TuneOrder, Tuning,
};
use lineshaft_ros::surface::{JointNames, StateSender, TopicCommands, is_told};
use rtrb::Consumer;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError, RwLock};
use std::time::Duration;
use tokio::sync::mpsc::UnboundedSender;
use tokio::sync::oneshot;

/// Longest time between two checks: for work that does not wake the bridge.
const PERIOD: Duration = Duration::from_millis(20);

/// The running machine for everybody outside the cycle thread.
#[derive(Debug)]
pub struct Handle {
    config: MachineConfig,
    directory: Directory,
    pub(super) commander: Commander,
    recorder: Sender<Asked>,
    newest: Mutex<Newest>,
    parameters: RwLock<Arc<ParameterImage>>,
    keeper: Option<Orders>,
    joint_names: JointNames,
    robot_description: Option<String>,
    controller_manager: Option<String>,
    gate: Arc<Gate>,
    statistics: Arc<Statistics>,
    /// Counts at the last call of [`Host::statistics`].
    taken: Mutex<Taken>,
    /// What each axis' drive is called, in file order; none for a virtual axis.
    hardware: Vec<Option<String>>,
    health: HealthBoard,
    objects: ObjectDesk,
    pub(super) trials: TrialDesk,
    /// Which axes have a real drive, in file order.
    pub(super) real: Vec<bool>,
    begins_active: bool,
    /// Command of the newest [`Code::CLOCK_STEPPED`] whose event was published.
    clock_stepped: AtomicU64,
    topic_commands: TopicCommands,
}

/// The signals of the newest cycle, taken when they are asked for.
#[derive(Debug)]
struct Newest {
    signals: triple_buffer::Output<Snapshot>,
    /// As they were when they were asked for last.
    snapshot: Arc<Snapshot>,
}

impl Newest {
    fn read(&mut self) -> Arc<Snapshot> {
        if self.signals.update() {
            self.snapshot = Arc::new(self.signals.output_buffer().clone());
        }
        Arc::clone(&self.snapshot)
    }
}

impl Handle {
    /// A handle on a machine that is about to run.
    pub fn new(
        config: MachineConfig,
        directory: Directory,
        commander: Commander,
        trials: TrialDesk,
        recorder: Sender<Asked>,
        mut signals: triple_buffer::Output<Snapshot>,
        parameters: ParameterImage,
    ) -> Self {
        let snapshot = Arc::new(signals.read().clone());
        let newest = Mutex::new(Newest { signals, snapshot });
        let parameters = RwLock::new(Arc::new(parameters));
        let joint_names = JointNames::of_objects(&config);
        Self {
            config,
            directory,
            commander,
            recorder,
            newest,
            parameters,
            keeper: None,
            gate: Arc::new(Gate::opening()),
            statistics: Arc::default(),
            taken: Mutex::default(),
            hardware: Vec::new(),
            health: HealthBoard::default(),
            objects: ObjectDesk::default(),
            real: Vec::new(),
            trials,
            begins_active: true,
            clock_stepped: AtomicU64::new(0),
            topic_commands: TopicCommands::default(),
            robot_description: None,
            controller_manager: None,
            joint_names,
        }
    }

    /// The same, whose cycles run as `gate` lets them and are counted in `statistics`.
    pub fn with_cycles(self, gate: Arc<Gate>, statistics: Arc<Statistics>) -> Self {
        Self { gate, statistics, ..self }
    }

    /// The same with what each axis' drive is called, in file order.
    pub fn with_hardware(self, hardware: Vec<Option<String>>) -> Self {
        Self { hardware, ..self }
    }

    /// The same with how its backends do.
    pub fn with_health(self, health: HealthBoard) -> Self {
        Self { health, ..self }
    }

    /// The same with where objects of its devices are asked for.
    pub fn with_objects(self, objects: ObjectDesk) -> Self {
        Self { objects, ..self }
    }

    /// The same, of which these axes have a real drive, in file order; without it all count as such.
    pub fn with_real(self, real: Vec<bool>) -> Self {
        Self { real, ..self }
    }

    /// The same on a machine that waits to be configured; without it cycles run and axes may be switched on at once.
    pub fn unconfigured(self) -> Self {
        self.commander.close();
        Self { begins_active: false, ..self }
    }

    /// The same, whose saved parameters are kept in a store.
    pub fn with_keeper(self, keeper: Orders) -> Self {
        Self { keeper: Some(keeper), ..self }
    }

    /// The same, whose axes have these joint names; without it those of the objects.
    pub fn with_joint_names(self, joint_names: JointNames) -> Self {
        Self { joint_names, ..self }
    }

    /// The same, whose robot is described by this URDF.
    pub fn with_robot_description(self, robot_description: Option<String>) -> Self {
        Self { robot_description, ..self }
    }

    /// The same, which offers the services of a controller manager of that absolute name.
    pub fn with_controller_manager(self, controller_manager: Option<String>) -> Self {
        Self { controller_manager, ..self }
    }

    /// Ends the thread of the store, once it has written what it has.
    pub fn end_keeping(&self) {
        if let Some(keeper) = &self.keeper {
            keeper.end();
        }
    }

    /// Are commands taken? Not while the node is unconfigured.
    pub fn takes_commands(&self) -> bool {
        self.commander.is_open()
    }

    /// Where the numbers of commands come from.
    pub fn numbers(&self) -> Numbers {
        self.commander.numbers()
    }

    /// What the machine is made of.
    pub(super) fn machine_config(&self) -> &MachineConfig {
        &self.config
    }

    /// Whether the event of this command, a note of [`Code::CLOCK_STEPPED`], was published.
    pub(super) fn has_published(&self, sequence: u64) -> bool {
        self.clock_stepped.load(Ordering::Acquire) == sequence
    }

    /// Hands a command over, in the name of `source`.
    ///
    /// # Errors
    /// Its lane is full, or no cycle runs.
    pub fn submit_as(&self, source: Source, action: Action) -> Result<u64, Busy> {
        self.commander.submit(source, action)
    }
}

impl Handle {
    /// Are the buses open, or is there none that could be?
    fn has_buses(&self) -> Result<(), String> {
        match self.gate.state() {
            _ if self.objects.is_empty() => Ok(()),
            GateState::Open => Ok(()),
            GateState::Closed => Err(Busy::Unconfigured.to_string()),
            GateState::Failed(why) => Err(why),
        }
    }
}

impl Host for Handle {
    fn published(&self, event: &Event) {
        if event.code == Code::CLOCK_STEPPED {
            self.clock_stepped.store(event.command, Ordering::Release);
        }
    }

    fn robot_description(&self) -> Option<&str> {
        self.robot_description.as_deref()
    }

    fn controller_manager(&self) -> Option<&str> {
        self.controller_manager.as_deref()
    }

    fn config(&self) -> &MachineConfig {
        &self.config
    }

    fn joint_names(&self) -> &JointNames {
        &self.joint_names
    }

    fn directory(&self) -> &Directory {
        &self.directory
    }

    fn submit(&self, action: Action) -> Result<u64, Busy> {
        self.submit_as(Source::Ros, action)
    }

    fn topic_commands(&self) -> Option<&TopicCommands> {
        Some(&self.topic_commands)
    }

    fn stream(&self, setpoints: &Setpoints) -> Result<(), Busy> {
        self.commander.stream(setpoints)
    }

    fn read_vocabulary(&self, axis: &str, verb: &str, arguments: &str) -> Result<Action, String> {
        crate::scenario::vocabulary_command(axis, verb, arguments, &self.config, &self.directory)
    }

    fn read_parameters(&self, text: &str) -> Result<Action, String> {
        let changes = read_changes("parameters", text, &self.config, &self.directory);
        changes.map(Action::SetParameters).map_err(|problems| problems.to_string())
    }

    fn tune(&self, order: &TuneOrder) -> Result<Tuning, String> {
        tuning::begin(self, &self.real, order)
    }

    fn write_parameters(&self, axes: AxisSet, what: Listing) -> String {
        export_text(&self.config, &self.parameters(), axes, what)
    }

    fn store_parameters(&self, answer: oneshot::Sender<Result<(), String>>) {
        match &self.keeper {
            // A keeper that has ended drops the answer, which tells the asker.
            Some(keeper) => keeper.keep(self.parameters(), Some(answer)),
            None => {
                let sentence =
                    "the program keeps no parameters: `--store` names a file; what is saved holds until it ends";
                // Who asked may have gone.
                let _ = answer.send(Err(sentence.to_owned()));
            }
        }
    }

    fn record(&self, request: RecordRequest, answer: oneshot::Sender<RecordResponse>) {
        // A recorder that has ended drops the answer, which tells the asker.
        let _ = self.recorder.send((request, answer));
    }

    fn read_object(&self, request: &SdoReadRequest) -> Result<Coming<SdoReadResponse>, String> {
        self.has_buses()?;
        self.objects.read(request)
    }

    fn write_object(&self, request: &SdoWriteRequest) -> Result<Coming<SdoWriteResponse>, String> {
        self.has_buses()?;
        self.objects.write(request)
    }

    fn begins_active(&self) -> bool {
        self.begins_active
    }

    fn open(&self) {
        if self.commander.deactivate_first() {
            self.gate.open();
        }
    }

    fn take_commands(&self) {
        self.commander.open();
    }

    fn close(&self) {
        // In this order: what was taken until then has its cycle.
        self.commander.close();
        self.gate.close();
    }

    fn gate(&self) -> GateState {
        self.gate.state()
    }

    fn statistics(&self) -> HostStatistics {
        self.statistics.take(&mut self.taken.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn backends(&self) -> Vec<BackendHealth> {
        self.health.read()
    }

    fn hardware(&self, axis: u16) -> Option<&str> {
        self.hardware.get(usize::from(axis))?.as_deref()
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner).read()
    }

    fn parameters(&self) -> Arc<ParameterImage> {
        Arc::clone(&self.parameters.read().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Kinds of lines that may repeat.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Line {
    /// Who has what to tell.
    Event(Object, Code),
    /// That it is over.
    Over(Object, Code),
    SamplesLeftOut,
}

/// What the bridge takes from the cycle thread.
pub struct Bridge {
    /// Events.
    events: Consumer<StampedEvent>,
    /// Signals of the cycles of the state topics, and who publishes them.
    samples: (SampleReceiver, StateSender),
    /// Parameters.
    parameters: triple_buffer::Output<ParameterImage>,
    /// Commands that nobody wants any more.
    spent: Spent,
    /// Who gets the events, each all of them in order.
    listeners: Vec<UnboundedSender<StampedEvent>>,
    /// How the cycle thread does.
    statistics: Arc<Statistics>,
    /// Woken by the cycle thread.
    wake: Wake,
    /// Events of one look.
    taken: Vec<StampedEvent>,
    /// Lost events that were told.
    told: u64,
    /// Samples that were left out, likewise.
    told_samples: u64,
    /// Makes stamps follow the system clock.
    clock: Option<ClockWatch>,
    lines: LineLimit<Line>,
}

impl Bridge {
    /// A bridge with one listener.
    pub fn new(
        events: Consumer<StampedEvent>,
        samples: (SampleReceiver, StateSender),
        parameters: triple_buffer::Output<ParameterImage>,
        spent: Spent,
        listener: UnboundedSender<StampedEvent>,
        statistics: Arc<Statistics>,
        wake: Wake,
    ) -> Self {
        Self {
            events,
            samples,
            parameters,
            spent,
            listeners: vec![listener],
            statistics,
            wake,
            taken: Vec::new(),
            told: 0,
            told_samples: 0,
            clock: None,
            lines: LineLimit::default(),
        }
    }

    /// The same, which makes stamps follow the system clock.
    pub fn with_clock(self, clock: ClockWatch) -> Self {
        Self { clock: Some(clock), ..self }
    }

    /// Works until `stop` is set, and once more after it.
    pub fn run(mut self, handle: &Handle, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            self.pass_on(handle);
            self.wake.sleep(PERIOD);
        }
        self.pass_on(handle);
    }

    fn pass_on(&mut self, handle: &Handle) {
        self.spent.free();
        handle.commander.free_kept();
        handle.trials.collect();
        // Events are taken before the parameters, and passed on after them: the cycle thread publishes its parameters first, so
        // these are at least as new as the events.
        self.taken.extend(std::iter::from_fn(|| self.events.pop().ok()));
        let (samples, states) = &mut self.samples;
        samples.take(|sample| {
            let snapshot = Arc::new(sample.snapshot.clone());
            if sample.joint_states {
                states.joint_states(&snapshot);
            }
            if sample.axis_states {
                states.axis_states(&snapshot);
            }
            if sample.shaft {
                states.shaft(&snapshot);
            }
        });
        let left_out = samples.lost() + states.left_out();
        if left_out > self.told_samples {
            self.lines.say(Line::SamplesLeftOut, |more| {
                tracing::warn!("{left_out} samples of joint_states, axis_states and shaft were left out so far: ROS had no time for them{more}");
            });
            self.told_samples = left_out;
        }
        if self.parameters.update() {
            let newest = Arc::new(self.parameters.output_buffer().clone());
            if let Some(keeper) = handle.keeper.as_ref().filter(|_| {
                let before = handle.parameters();
                newest.user != before.user || newest.machine[1] != before.machine[1]
            }) {
                keeper.keep(Arc::clone(&newest), None);
            }
            *handle.parameters.write().unwrap_or_else(PoisonError::into_inner) = newest;
        }
        for event in self.taken.drain(..) {
            log(&event, handle, &self.lines);
            self.listeners.retain(|listener| listener.send(event).is_ok());
        }
        if let Some(clock) = &mut self.clock {
            clock.look(handle);
        }
        let lost = self.statistics.events_lost.load(Ordering::Relaxed);
        if lost > self.told {
            tracing::error!("{} events were lost on their way: more came than can be passed on", lost - self.told);
            self.told = lost;
        }
    }
}

/// One line for what a person would want to know.
fn log(event: &StampedEvent, handle: &Handle, lines: &LineLimit<Line>) {
    let event = &event.event;
    let sentence = || handle.topic_commands.sentence(event, &handle.config);
    // An emergency message with code 0: what was told as a warning is over.
    let is_over = event.severity == Severity::Info && matches!(event.code, Code::EMERGENCY | Code::FOREIGN_EMERGENCY);
    let kind = if is_over { Line::Over } else { Line::Event };
    let told = || match event.severity {
        Severity::Info => sentence(),
        Severity::Warn | Severity::Error => text::with_remedy(&sentence(), event.code),
    };
    let say = |line: fn(String)| lines.say(kind(event.source, event.code), |more| line(told() + more));
    match (event.severity, event.kind) {
        (Severity::Error, _) if is_told(event) => say(|line| tracing::error!(target: TOLD, "{line}")),
        (Severity::Error, _) => say(|line| tracing::error!("{line}")),
        // The surface has told what never became a command.
        (_, Kind::Refused) if event.code == Code::BAD_REQUEST => {}
        // What ends a goal is told to the one who gave it.
        (_, Kind::Done | Kind::Accepted | Kind::Overrun) => tracing::debug!("{}", sentence()),
        (Severity::Warn, _) if is_told(event) => say(|line| tracing::warn!(target: TOLD, "{line}")),
        (Severity::Warn, _) => say(|line| tracing::warn!("{line}")),
        (Severity::Info, Kind::Reset) => say(|line| tracing::info!("{line}")),
        (Severity::Info, _) if is_over => say(|line| tracing::info!("{line}")),
        (Severity::Info, _) => tracing::debug!("{}", sentence()),
    }
}
