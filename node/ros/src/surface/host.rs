//! Interface of the surface to the program that runs the machine.

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

/// Error if no backend can have objects.
pub const NO_BUS: &str = "the cell has no backend on CAN";

/// Answer that arrives within a bounded time.
pub type PendingAnswer<T> = Pin<Box<dyn Future<Output = T> + Send>>;

/// Signals of one cycle, with its time.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Cycle number k.
    pub cycle: u64,
    /// Cycle time stamp t_k, in nanoseconds since the Unix epoch.
    pub stamp_ns: u64,
    /// Signals at the end of the cycle.
    pub board: Board,
}

/// Event with the time of its cycle.
#[derive(Clone, Copy, Debug)]
pub struct StampedEvent {
    /// The event.
    pub event: Event,
    /// Cycle time stamp t_k, in nanoseconds since the Unix epoch.
    pub stamp_ns: u64,
}

/// Maximum number of commands that wait for a cycle in each of two queues, one for stops and one for all other commands: ten clients with
/// one command in progress for each of 64 axes, times three. A cycle reads 64 commands of each queue, stops first.
pub const MOST_COMMANDS: usize = 2048;

/// Reason why a command is not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SubmitError {
    /// The queues are full: the machine does not keep up with the commands.
    #[error("{MOST_COMMANDS} commands wait for the machine already; try again")]
    Full,
    /// No cycles run, so that no command would be read.
    #[error(
        "the node is unconfigured and no cycle runs; configure and activate it first (`lineshaft activate` with the name of \
         the node, or ~/change_state)"
    )]
    Unconfigured,
}

impl SubmitError {
    /// Returns the code for a result.
    pub fn code(self) -> Code {
        match self {
            Self::Full => Code::TOO_MANY_WAITING,
            Self::Unconfigured => Code::NOT_ACTIVE,
        }
    }
}

/// State of the cycles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GateState {
    /// Cycles run, and the backends exchange data.
    Open,
    /// No cycles run.
    Closed,
    /// No cycles run, because a backend did not start, with the reason.
    Failed(String),
}

/// Percentiles of a time, in ns. Each is at most 1/32 (3.1 %) above the exact value, and never above the maximum; 0 without cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Percentiles {
    /// Median.
    pub p50: u64,
    /// Maximum of 99 % of the cycles.
    pub p99: u64,
    /// Maximum of 99.9 % of the cycles.
    pub p999: u64,
}

/// Timing of the cycle, since the program start unless noted otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Number of cycles.
    pub cycles: u64,
    /// Number of missed cycles.
    pub missed: u64,
    /// Sum of the wake-up latencies, in ns; it may differ from `cycles` by one cycle.
    pub lateness_ns: u64,
    /// Sum of the cycle durations, in ns; it may differ from `cycles` by one cycle.
    pub duration_ns: u64,
    /// Maximum wake-up latency since the last request of the statistics, in ns.
    pub newest_lateness_ns: u64,
    /// Maximum cycle duration since the last request of the statistics, in ns.
    pub newest_duration_ns: u64,
    /// Maximum wake-up latency, in ns.
    pub worst_lateness_ns: u64,
    /// Maximum cycle duration, in ns.
    pub worst_duration_ns: u64,
    /// Percentiles of the wake-up latencies since the last request. A cycle at that moment may be counted in one period and have its value
    /// in the maximum of the other one.
    pub newest_lateness: Percentiles,
    /// Percentiles of the cycle durations since the last request, with the same restriction.
    pub newest_duration: Percentiles,
    /// Percentiles of the wake-up latencies.
    pub lateness: Percentiles,
    /// Percentiles of the cycle durations.
    pub duration: Percentiles,
    /// Number of events that had no room.
    pub events_lost: u64,
}

/// Health of a backend that reports more than its drives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackendHealth {
    /// Name in the cell.
    pub name: String,
    /// Hardware to which it is connected.
    pub hardware: String,
    /// Health; `None` before its start.
    pub health: Option<Health>,
}

/// Selection of parameters to list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterSelection {
    /// All parameters.
    All,
    /// Parameters that differ from the default of the catalogue.
    NotDefault,
    /// Parameters that differ from the cell, because they were set or saved.
    NotCell,
    /// Parameters that differ from the saved ones.
    NotSaved,
}

/// Settings of a tuning run; `None`: value of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TuneOrder {
    /// Index of the axis.
    pub axis: u16,
    /// Maximum travel in each direction from the present position, in increments.
    pub travel: Option<f64>,
    /// Maximum velocity, in inc/s.
    pub velocity: Option<f64>,
    /// Maximum effort, as a fraction of the permitted one.
    pub effort: Option<f64>,
    /// Duration of the excitation, in s.
    pub duration: Option<f64>,
    /// Load inertia as a multiple of the motor inertia, if there may be backlash between them.
    pub inertia_ratio: Option<f64>,
    /// Whether a real drive may be moved.
    pub real: bool,
}

/// Tuning run in progress.
pub struct Tuning {
    /// Progress, and the means to cancel the run.
    pub watch: Arc<dyn TuningWatch>,
    /// Result, once the axis is off.
    pub found: PendingAnswer<Result<TuningResult, TuningFailure>>,
}

/// Progress of a tuning run.
pub trait TuningWatch: Send + Sync {
    /// Returns the phase, and the finished part of the excitation, 0 to 1.
    fn progress(&self) -> (TuningPhase, f64);

    /// Stops and disables the axis; there is no result then.
    fn cancel(&self);
}

/// Phases of a tuning run, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum TuningPhase {
    /// The axis is being enabled.
    Enabling = 1,
    /// The axis is being excited.
    Exciting = 2,
    /// The axis is being stopped and disabled.
    Disabling = 3,
    /// The axis is off; its model and its gains are being calculated.
    Designing = 4,
}

/// Result of a tuning run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TuningResult {
    /// Report for the user.
    pub report: String,
    /// Gains by parameter key; empty if there are none.
    pub gains: Vec<(&'static str, f64)>,
}

/// Reason why tuning has no result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TuningFailure {
    /// Code.
    pub code: Code,
    /// Message.
    pub message: String,
}

/// Running machine, as the surface sees it.
pub trait Host: Send + Sync + 'static {
    /// Returns the configuration of the machine.
    fn config(&self) -> &MachineConfig;

    /// Returns the joint names of the axes.
    fn joint_names(&self) -> &JointNames;

    /// Returns the names of the signals.
    fn directory(&self) -> &Directory;

    /// Submits a command and returns its sequence number; the answer is an event.
    ///
    /// # Errors
    /// The queue is full, or no cycles run; nothing was submitted.
    fn submit(&self, action: Action) -> Result<u64, SubmitError>;

    /// Returns the store of commands from messages of topics, if events name these topics.
    fn topic_commands(&self) -> Option<&TopicCommands> {
        None
    }

    /// Submits streamed setpoints: each replaces the last one of its axis, and all take effect in the same cycle. There is no answer; an
    /// axis that does not follow a setpoint reports a warning.
    ///
    /// # Errors
    /// No cycles run; nothing was submitted.
    fn stream(&self, setpoints: &Setpoints) -> Result<(), SubmitError>;

    /// Returns the command for a verb of an earlier controller; `arguments` are YAML. May block.
    ///
    /// # Errors
    /// The request is invalid, as a message.
    fn read_vocabulary(&self, axis: &str, verb: &str, arguments: &str) -> Result<Action, String>;

    /// Returns the command that sets parameters from a text with lines such as `x.max_velocity: 0.8 m/s`. May block.
    ///
    /// # Errors
    /// The text is invalid, as a message.
    fn read_parameters(&self, text: &str) -> Result<Action, String>;

    /// Returns the active parameters as a text for [`Host::read_parameters`]. May block.
    fn write_parameters(&self, axes: AxisSet, what: ParameterSelection) -> String;

    /// Starts to tune an axis.
    ///
    /// # Errors
    /// The request is invalid, as a message; nothing has moved.
    fn tune(&self, _order: &TuneOrder) -> Result<Tuning, String> {
        Err("this machine tunes no axis".to_owned())
    }

    /// Stores layer User of the newest parameters if it has changed. The answer is sent when it is on the disk, or with the reason of the
    /// failure. A dropped answer means that the machine has stopped.
    fn store_parameters(&self, answer: oneshot::Sender<Result<(), String>>);

    /// Sends a request to the recorder, which answers when it is finished or has failed. A dropped answer means that the machine has
    /// stopped.
    fn record(&self, request: RecordRequest, answer: oneshot::Sender<RecordResponse>);

    /// Starts to read an object of a device on a bus. Requests are executed in the order of these calls.
    ///
    /// # Errors
    /// The request is invalid, as a message; no device was accessed.
    fn read_object(&self, _request: &SdoReadRequest) -> Result<PendingAnswer<SdoReadResponse>, String> {
        Err(NO_BUS.to_owned())
    }

    /// Starts to write an object of a device on a bus. Requests are executed in the order of these calls.
    ///
    /// # Errors
    /// The request is invalid, as a message; no device was accessed.
    fn write_object(&self, _request: &SdoWriteRequest) -> Result<PendingAnswer<SdoWriteResponse>, String> {
        Err(NO_BUS.to_owned())
    }

    /// Returns the robot description (URDF) to be published; `None`: it is not published.
    fn robot_description(&self) -> Option<&str> {
        None
    }

    /// Returns the absolute name of the controller manager; `None`: its services do not exist.
    fn controller_manager(&self) -> Option<&str> {
        None
    }

    /// Returns true if cycles run from the start, and axes may be enabled; otherwise cycles start with [`Host::open`].
    fn is_active_at_start(&self) -> bool;

    /// Starts the backends and the cycles, with a deactivated machine in the first cycle. [`Host::gate`] reports when they run. The machine
    /// continues from its previous state.
    fn open(&self);

    /// Accepts commands again, once cycles run.
    fn resume_commands(&self);

    /// Stops accepting commands, executes those that wait, then ends the cycles and stops the backends.
    fn close(&self);

    /// Returns the state of the cycles.
    fn gate(&self) -> GateState;

    /// Returns the timing of the cycle. The newest values start again with each call, so there must be only one caller.
    fn statistics(&self) -> Statistics;

    /// Returns the name of the drive of an axis, `backend:address`; `None` for a virtual axis.
    fn hardware(&self, axis: u16) -> Option<&str>;

    /// Returns the backends that report more than their drives: those that had to be started.
    fn backends(&self) -> Vec<BackendHealth> {
        Vec::new()
    }

    /// Called when an event was published on ~/events.
    fn published(&self, _event: &Event) {}

    /// Returns the newest signals.
    fn snapshot(&self) -> Arc<Snapshot>;

    /// Returns the newest parameters: at least as new as every event that was delivered.
    fn parameters(&self) -> Arc<ParameterImage>;
}
