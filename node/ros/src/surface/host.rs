//! What the surface needs of the program that runs the machine.

use super::joint_names::JointNames;
use super::topic_commands::TopicCommands;
use lineshaft_core::code::Code;
use lineshaft_core::command::{Action, Setpoints};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::drive::Health;
use lineshaft_core::event::Event;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_core::signal::{Board, Directory};
use lineshaft_msgs::srv::{
    RecordRequest, RecordResponse, SdoReadRequest, SdoReadResponse, SdoWriteRequest, SdoWriteResponse,
};
use std::pin::Pin;
use std::sync::Arc;
use tokio::sync::oneshot;

/// There is nobody who could have objects.
pub const NO_BUS: &str = "the cell has no backend on CAN";

/// An answer that comes within a bounded time.
pub type Coming<T> = Pin<Box<dyn Future<Output = T> + Send>>;

/// The signals of one cycle, and when it was.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// k
    pub cycle: u64,
    /// t_k: nanoseconds since the Unix epoch.
    pub stamp_ns: u64,
    /// The signals at the end of the cycle.
    pub board: Board,
}

/// An event, and when its cycle was.
#[derive(Clone, Copy, Debug)]
pub struct StampedEvent {
    /// The event.
    pub event: Event,
    /// t_k: nanoseconds since the Unix epoch.
    pub stamp_ns: u64,
}

/// Commands that may wait for a cycle in each of two lanes, that of the stops and that of all others: of ten clients each has one
/// for each of 64 axes under way, three times over. Of each lane a cycle takes 64, the stops first.
pub const MOST_COMMANDS: usize = 2048;

/// A command is not even taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Busy {
    /// The lanes are full: the machine does not keep up with what it is asked.
    #[error("{MOST_COMMANDS} commands wait for the machine already; try again")]
    Full,
    /// No cycle runs, so none would take it.
    #[error("the node is unconfigured and no cycle runs; configure and activate it first (~/change_state)")]
    Unconfigured,
}

impl Busy {
    /// The code for a result.
    pub fn code(self) -> Code {
        match self {
            Self::Full => Code::TOO_MANY_WAITING,
            Self::Unconfigured => Code::NOT_ACTIVE,
        }
    }
}

/// Whether cycles run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GateState {
    /// They run, and the backends exchange.
    Open,
    /// They do not.
    Closed,
    /// They do not, because a backend did not start: why.
    Failed(String),
}

/// Percentiles of a time (ns). Each is at most 1/32 (3.1 %) above the exact one, and never above the maximum; 0 without cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Percentiles {
    /// Median.
    pub p50: u64,
    /// 99 % of the cycles have at most this.
    pub p99: u64,
    /// 99.9 % of the cycles have at most this.
    pub p999: u64,
}

/// How well the cycle keeps its time, since the program began unless it says otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Cycles run.
    pub cycles: u64,
    /// Cycles missed.
    pub missed: u64,
    /// Sum of the wake-ups after their deadlines (ns); it may be a cycle ahead of `cycles`, or behind.
    pub lateness_ns: u64,
    /// Sum of the lengths of the cycles (ns), likewise.
    pub duration_ns: u64,
    /// Latest wake-up since the last time it was asked for (ns).
    pub newest_lateness_ns: u64,
    /// Longest cycle since the last time it was asked for (ns).
    pub newest_duration_ns: u64,
    /// Latest wake-up (ns).
    pub worst_lateness_ns: u64,
    /// Longest cycle (ns).
    pub worst_duration_ns: u64,
    /// Percentiles of the wake-ups since the last time they were asked for. A cycle at that moment may be counted here and its
    /// value in the maximum of the other period, or the other way round.
    pub newest_lateness: Percentiles,
    /// Percentiles of the lengths of the cycles since the last time they were asked for, likewise.
    pub newest_duration: Percentiles,
    /// Percentiles of the wake-ups.
    pub lateness: Percentiles,
    /// Percentiles of the lengths of the cycles.
    pub duration: Percentiles,
    /// Events that found no room.
    pub events_lost: u64,
}

/// How a backend does that has more to say than its drives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackendHealth {
    /// Its name in the cell.
    pub name: String,
    /// What it hangs on.
    pub hardware: String,
    /// How it does; none before it has started.
    pub health: Option<Health>,
}

/// Which parameters are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listing {
    /// All.
    All,
    /// Those that are not at the default of the catalogue.
    NotDefault,
    /// Those that the cell does not give so: what was set or saved.
    NotCell,
    /// Those that differ from what is saved.
    NotSaved,
}

/// How an axis is to be tuned; none: as the axis has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TuneOrder {
    /// Place of the axis.
    pub axis: u16,
    /// Largest way either side of where it stands (inc).
    pub travel: Option<f64>,
    /// Largest velocity (inc/s).
    pub velocity: Option<f64>,
    /// Largest effort in parts of the permitted one.
    pub effort: Option<f64>,
    /// Time of the motion to and fro (s).
    pub duration: Option<f64>,
    /// Inertia of the load in parts of the motor's, where there may be play between them.
    pub inertia_ratio: Option<f64>,
    /// A real drive may be moved.
    pub real: bool,
}

/// Tuning that is under way.
pub struct Tuning {
    /// How it does, and how it is stopped.
    pub watch: Arc<dyn TuningWatch>,
    /// What it has found, once the axis is off.
    pub found: Coming<Result<Tuned, Untuned>>,
}

/// How tuning does.
pub trait TuningWatch: Send + Sync {
    /// Its phase, and the part of the excitation that is over, 0 to 1.
    fn progress(&self) -> (TuningPhase, f64);

    /// Stops the axis and switches it off; nothing is found then.
    fn cancel(&self);
}

/// What tuning does, in the order of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum TuningPhase {
    /// The axis is switched on.
    Enabling = 1,
    /// It is shaken.
    Exciting = 2,
    /// It stops and is switched off.
    Disabling = 3,
    /// It is off; its model and its gains are computed.
    Designing = 4,
}

/// What tuning has found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tuned {
    /// For people.
    pub report: String,
    /// Gains by the keys of their parameters; empty where there are none.
    pub gains: Vec<(&'static str, f64)>,
}

/// Why tuning has found nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Untuned {
    /// Code.
    pub code: Code,
    /// Sentence.
    pub message: String,
}

/// The running machine, as the surface sees it.
pub trait Host: Send + Sync + 'static {
    /// What the machine is made of.
    fn config(&self) -> &MachineConfig;

    /// Joint names of its axes.
    fn joint_names(&self) -> &JointNames;

    /// Names of its signals.
    fn directory(&self) -> &Directory;

    /// Hands a command over and returns its sequence number; the answer comes as an event.
    ///
    /// # Errors
    /// The lane is full, or no cycle runs; nothing was handed over.
    fn submit(&self, action: Action) -> Result<u64, Busy>;

    /// Commands that came as messages of topics, if events are to name these topics.
    fn topic_commands(&self) -> Option<&TopicCommands> {
        None
    }

    /// Hands streamed setpoints over: each takes the place of the last one of its axis, and all of them enter the same cycle. None
    /// is answered; what an axis does not follow it tells by a warning.
    ///
    /// # Errors
    /// No cycle runs; nothing was handed over.
    fn stream(&self, setpoints: &Setpoints) -> Result<(), Busy>;

    /// The command that a verb of an old controller asks for; `arguments` are YAML. It may take its time.
    ///
    /// # Errors
    /// What is wrong with it, in one sentence.
    fn read_vocabulary(&self, axis: &str, verb: &str, arguments: &str) -> Result<Action, String>;

    /// The command that sets parameters as a text of lines `x.max_velocity: 0.8 m/s` says. It may take its time.
    ///
    /// # Errors
    /// What is wrong with it, in one sentence.
    fn read_parameters(&self, text: &str) -> Result<Action, String>;

    /// Parameters in force as a text that [`Host::read_parameters`] takes. It may take its time.
    fn write_parameters(&self, axes: AxisSet, what: Listing) -> String;

    /// Begins to tune an axis.
    ///
    /// # Errors
    /// What is wrong with it, in one sentence; nothing has moved.
    fn tune(&self, _order: &TuneOrder) -> Result<Tuning, String> {
        Err("this machine tunes no axis".to_owned())
    }

    /// Writes layer User of the newest parameters down, if it has changed; the answer comes when it is on the disk, or says
    /// why it is not. An answer that is dropped means that the machine has stopped.
    fn store_parameters(&self, answer: oneshot::Sender<Result<(), String>>);

    /// Asks the recorder, which answers when it is done or has failed. An answer that is dropped means that the machine has
    /// stopped.
    fn record(&self, request: RecordRequest, answer: oneshot::Sender<RecordResponse>);

    /// Has an object of a device on a bus read. Requests are begun in the order of these calls.
    ///
    /// # Errors
    /// What is wrong with it, in one sentence; no device was asked.
    fn read_object(&self, _request: &SdoReadRequest) -> Result<Coming<SdoReadResponse>, String> {
        Err(NO_BUS.to_owned())
    }

    /// Has one written, likewise.
    ///
    /// # Errors
    /// What is wrong with it, in one sentence; no device was asked.
    fn write_object(&self, _request: &SdoWriteRequest) -> Result<Coming<SdoWriteResponse>, String> {
        Err(NO_BUS.to_owned())
    }

    /// The description of the robot (URDF) that is published; none: nothing is.
    fn robot_description(&self) -> Option<&str> {
        None
    }

    /// Absolute name of the controller manager whose services are offered; none: they do not exist.
    fn controller_manager(&self) -> Option<&str> {
        None
    }

    /// Do cycles run from the start, with axes that may be switched on? Else they wait for [`Host::open`].
    fn begins_active(&self) -> bool;

    /// Has the backends start and cycles run, the first one with a deactivated machine. [`Host::gate`] tells when they do. The
    /// machine goes on from the state that it had.
    fn open(&self);

    /// Takes commands again, once cycles run.
    fn take_commands(&self);

    /// Takes no more commands, gives those that wait their cycle, then ends the cycles and stops the backends.
    fn close(&self);

    /// Whether cycles run.
    fn gate(&self) -> GateState;

    /// How well the cycle keeps its time. What is newest begins anew with each call: one asker may call it.
    fn statistics(&self) -> Statistics;

    /// What the drive of an axis is called, `backend:address`; none for a virtual axis.
    fn hardware(&self, axis: u16) -> Option<&str>;

    /// Backends that have more to say than their drives: those that had to be started.
    fn backends(&self) -> Vec<BackendHealth> {
        Vec::new()
    }

    /// Learns that an event was published on ~/events.
    fn published(&self, _event: &Event) {}

    /// The newest signals.
    fn snapshot(&self) -> Arc<Snapshot>;

    /// The newest parameters: at least as new as every event that was passed on.
    fn parameters(&self) -> Arc<ParameterImage>;
}
