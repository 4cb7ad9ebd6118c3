//! Connects the cycle thread with all other threads: passes on events and signals, frees commands for which the
//! recorder had no space, and watches the system clock.

use super::clock::ClockWatch;
use super::frames::Spent;
use super::gate::Gate;
use super::keeper::StoreRequests;
use super::lanes::{Commander, Numbers};
use super::objects::ObjectAccess;
use super::recorder::Asked;
use super::samples::SampleReceiver;
use super::services::HealthBoard;
use super::thread::{Statistics, Taken};
use super::trials::TrialSender;
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
use lineshaft_ros::layer::SENT_TO_ROSOUT;
use lineshaft_ros::line_limit::MessageRateLimit;
use lineshaft_ros::surface::host::{
    BackendHealth, GateState, Host, ParameterSelection, PendingAnswer, Snapshot, StampedEvent,
    Statistics as HostStatistics, SubmitError, TuneOrder, Tuning,
};
use lineshaft_ros::surface::{JointNames, StateSender, TopicCommands, is_logged_on_rosout};
use rtrb::Consumer;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError, RwLock};
use std::time::Duration;
use tokio::sync::mpsc::UnboundedSender;
use tokio::sync::oneshot;

/// Maximum time between two checks, for work that does not wake the bridge.
const PERIOD: Duration = Duration::from_millis(20);

/// Access to the running machine from outside the cycle thread.
#[derive(Debug)]
pub struct Handle {
    config: MachineConfig,
    directory: Directory,
    pub(super) commander: Commander,
    recorder: Sender<Asked>,
    newest: Mutex<Newest>,
    parameters: RwLock<Arc<ParameterImage>>,
    keeper: Option<StoreRequests>,
    joint_names: JointNames,
    robot_description: Option<String>,
    controller_manager: Option<String>,
    gate: Arc<Gate>,
    statistics: Arc<Statistics>,
    /// Counts at the last call of [`Host::statistics`].
    taken: Mutex<Taken>,
    /// Names of the drives of each axis, in the order of the file; `None` for a virtual axis.
    hardware: Vec<Option<String>>,
    health: HealthBoard,
    objects: ObjectAccess,
    pub(super) trials: TrialSender,
    /// Whether each axis has a real drive, in the order of the file.
    pub(super) real: Vec<bool>,
    begins_active: bool,
    /// Command number of the newest [`Code::CLOCK_STEPPED`] whose event was published.
    clock_stepped: AtomicU64,
    topic_commands: TopicCommands,
}

/// Signals of the newest cycle, copied when they are requested.
#[derive(Debug)]
struct Newest {
    signals: triple_buffer::Output<Snapshot>,
    /// Signals at the last request.
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
    /// Creates a handle for a machine that is about to run.
    pub fn new(
        config: MachineConfig,
        directory: Directory,
        commander: Commander,
        trials: TrialSender,
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
            objects: ObjectAccess::default(),
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

    /// Sets the gate that controls the cycles, and their statistics.
    pub fn with_cycles(self, gate: Arc<Gate>, statistics: Arc<Statistics>) -> Self {
        Self { gate, statistics, ..self }
    }

    /// Sets the names of the drives of each axis, in the order of the file.
    pub fn with_hardware(self, hardware: Vec<Option<String>>) -> Self {
        Self { hardware, ..self }
    }

    /// Sets the health of the backends.
    pub fn with_health(self, health: HealthBoard) -> Self {
        Self { health, ..self }
    }

    /// Sets the access to objects of its devices.
    pub fn with_objects(self, objects: ObjectAccess) -> Self {
        Self { objects, ..self }
    }

    /// Sets which axes have a real drive, in the order of the file; by default all have.
    pub fn with_real(self, real: Vec<bool>) -> Self {
        Self { real, ..self }
    }

    /// Makes the machine wait for configuration; by default cycles run and axes may be switched on immediately.
    pub fn unconfigured(self) -> Self {
        self.commander.close();
        Self { begins_active: false, ..self }
    }

    /// Sets the store of saved parameters.
    pub fn with_keeper(self, keeper: StoreRequests) -> Self {
        Self { keeper: Some(keeper), ..self }
    }

    /// Sets the joint names of the axes; by default those of the objects.
    pub fn with_joint_names(self, joint_names: JointNames) -> Self {
        Self { joint_names, ..self }
    }

    /// Sets the URDF of the robot.
    pub fn with_robot_description(self, robot_description: Option<String>) -> Self {
        Self { robot_description, ..self }
    }

    /// Offers the services of a controller manager with that absolute name.
    pub fn with_controller_manager(self, controller_manager: Option<String>) -> Self {
        Self { controller_manager, ..self }
    }

    /// Ends the thread of the store after it has written its pending data.
    pub fn end_keeping(&self) {
        if let Some(keeper) = &self.keeper {
            keeper.end();
        }
    }

    /// Returns true if commands are accepted; not while the node is unconfigured.
    pub fn takes_commands(&self) -> bool {
        self.commander.is_open()
    }

    /// Returns the source of command numbers.
    pub fn numbers(&self) -> Numbers {
        self.commander.numbers()
    }

    /// Returns the configuration of the machine.
    pub(super) fn machine_config(&self) -> &MachineConfig {
        &self.config
    }

    /// Whether the event of this command, a note of [`Code::CLOCK_STEPPED`], was published.
    pub(super) fn has_published(&self, sequence: u64) -> bool {
        self.clock_stepped.load(Ordering::Acquire) == sequence
    }

    /// Submits a command of `source`.
    ///
    /// # Errors
    /// Returns an error if its queue is full, or if no cycle runs.
    pub fn submit_as(&self, source: Source, action: Action) -> Result<u64, SubmitError> {
        self.commander.submit(source, action)
    }
}

impl Handle {
    /// Returns an error unless the buses are open or the cell has none.
    fn has_buses(&self) -> Result<(), String> {
        match self.gate.state() {
            _ if self.objects.is_empty() => Ok(()),
            GateState::Open => Ok(()),
            GateState::Closed => Err(SubmitError::Unconfigured.to_string()),
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

    fn submit(&self, action: Action) -> Result<u64, SubmitError> {
        self.submit_as(Source::Ros, action)
    }

    fn topic_commands(&self) -> Option<&TopicCommands> {
        Some(&self.topic_commands)
    }

    fn stream(&self, setpoints: &Setpoints) -> Result<(), SubmitError> {
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

    fn write_parameters(&self, axes: AxisSet, what: ParameterSelection) -> String {
        export_text(&self.config, &self.parameters(), axes, what)
    }

    fn store_parameters(&self, answer: oneshot::Sender<Result<(), String>>) {
        match &self.keeper {
            // If the keeper has ended, it drops the answer, which the caller sees as an error.
            Some(keeper) => keeper.keep(self.parameters(), Some(answer)),
            None => {
                let sentence =
                    "the program keeps no parameters: `--store` names a file; what is saved holds until it ends";
                // The caller may have gone.
                let _ = answer.send(Err(sentence.to_owned()));
            }
        }
    }

    fn record(&self, request: RecordRequest, answer: oneshot::Sender<RecordResponse>) {
        // If the recorder has ended, it drops the answer, which the caller sees as an error.
        let _ = self.recorder.send((request, answer));
    }

    fn read_object(&self, request: &SdoReadRequest) -> Result<PendingAnswer<SdoReadResponse>, String> {
        self.has_buses()?;
        self.objects.read(request)
    }

    fn write_object(&self, request: &SdoWriteRequest) -> Result<PendingAnswer<SdoWriteResponse>, String> {
        self.has_buses()?;
        self.objects.write(request)
    }

    fn is_active_at_start(&self) -> bool {
        self.begins_active
    }

    fn open(&self) {
        if self.commander.deactivate_first() {
            self.gate.open();
        }
    }

    fn resume_commands(&self) {
        self.commander.open();
    }

    fn close(&self) {
        // In this order, so that commands accepted before are still executed.
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

/// Kinds of lines that are limited if they repeat.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Line {
    /// Source and code of an event.
    Event(Object, Code),
    /// End of the condition of an event.
    Over(Object, Code),
    SamplesLeftOut,
}

/// Parts of the bridge that receive data of the cycle thread.
pub struct Bridge {
    /// Events.
    events: Consumer<StampedEvent>,
    /// Signals of the cycles of the state topics, and their publisher.
    samples: (SampleReceiver, StateSender),
    /// Parameters.
    parameters: triple_buffer::Output<ParameterImage>,
    /// Commands to be freed.
    spent: Spent,
    /// Receivers of events; each gets all events in order.
    listeners: Vec<UnboundedSender<StampedEvent>>,
    /// Timing of the cycle thread.
    statistics: Arc<Statistics>,
    /// Woken by the cycle thread.
    wake: Wake,
    /// Events of one pass.
    taken: Vec<StampedEvent>,
    /// Number of lost events that were logged.
    told: u64,
    /// Number of lost samples that were logged.
    told_samples: u64,
    /// Makes stamps follow the system clock.
    clock: Option<ClockWatch>,
    lines: MessageRateLimit<Line>,
}

impl Bridge {
    /// Creates a bridge with one listener.
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
            lines: MessageRateLimit::default(),
        }
    }

    /// Makes stamps follow the system clock.
    pub fn with_clock(self, clock: ClockWatch) -> Self {
        Self { clock: Some(clock), ..self }
    }

    /// Runs until `stop` is set, and once more after it.
    pub fn run(mut self, handle: &Handle, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            self.pass_on(handle);
            self.wake.sleep(PERIOD);
        }
        self.pass_on(handle);
    }

    fn pass_on(&mut self, handle: &Handle) {
        self.spent.free();
        handle.commander.free_unshared();
        handle.trials.collect();
        // Events are taken before the parameters, and passed on after them. The cycle thread publishes its parameters
        // first, so that these are at least as new as the events.
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
            self.lines.log(Line::SamplesLeftOut, |more| {
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

/// Logs an event in one line.
fn log(event: &StampedEvent, handle: &Handle, lines: &MessageRateLimit<Line>) {
    let event = &event.event;
    let sentence = || handle.topic_commands.sentence(event, &handle.config);
    // An emergency message with code 0 means that the condition of the warning has ended.
    let is_over = event.severity == Severity::Info && matches!(event.code, Code::EMERGENCY | Code::FOREIGN_EMERGENCY);
    let kind = if is_over { Line::Over } else { Line::Event };
    let told = || match event.severity {
        Severity::Info => sentence(),
        Severity::Warn | Severity::Error => text::with_remedy(&sentence(), event.code),
    };
    let say = |line: fn(String)| lines.log(kind(event.source, event.code), |more| line(told() + more));
    match (event.severity, event.kind) {
        (Severity::Error, _) if is_logged_on_rosout(event) => {
            say(|line| tracing::error!(target: SENT_TO_ROSOUT, "{line}"))
        }
        (Severity::Error, _) => say(|line| tracing::error!("{line}")),
        // The surface has logged requests that never became a command.
        (_, Kind::Refused) if event.code == Code::BAD_REQUEST => {}
        // The client of a goal gets the reason of its end.
        (_, Kind::Done | Kind::Accepted | Kind::Overrun) => tracing::debug!("{}", sentence()),
        (Severity::Warn, _) if is_logged_on_rosout(event) => {
            say(|line| tracing::warn!(target: SENT_TO_ROSOUT, "{line}"))
        }
        (Severity::Warn, _) => say(|line| tracing::warn!("{line}")),
        (Severity::Info, Kind::Reset) => say(|line| tracing::info!("{line}")),
        (Severity::Info, _) if is_over => say(|line| tracing::info!("{line}")),
        (Severity::Info, _) => tracing::debug!("{}", sentence()),
    }
}
