//! What the surface needs of the program that runs the machine.

use lineshaft_core::command::Action;
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::Event;
use lineshaft_core::object::AxisSet;
use lineshaft_core::parameter::ParameterImage;
use lineshaft_core::signal::{Board, Directory};
use lineshaft_msgs::srv::{RecordRequest, RecordResponse};
use std::sync::Arc;
use tokio::sync::oneshot;

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

/// The lanes are full: the machine does not keep up with what it is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("too many commands wait for the machine; try again")]
pub struct Busy;

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

/// The running machine, as the surface sees it.
pub trait Host: Send + Sync + 'static {
    /// What the machine is made of.
    fn config(&self) -> &MachineConfig;

    /// Names of its signals.
    fn directory(&self) -> &Directory;

    /// Hands a command over and returns its sequence number; the answer comes as an event.
    ///
    /// # Errors
    /// The lane is full; nothing was handed over.
    fn submit(&self, action: Action) -> Result<u64, Busy>;

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

    /// Writes layer User of the newest parameters down, if it has changed; the answer comes when it is on the disk, or says
    /// why it is not. An answer that is dropped means that the machine has stopped.
    fn store_parameters(&self, answer: oneshot::Sender<Result<(), String>>);

    /// Asks the recorder, which answers when it is done or has failed. An answer that is dropped means that the machine has
    /// stopped.
    fn record(&self, request: RecordRequest, answer: oneshot::Sender<RecordResponse>);

    /// The newest signals.
    fn snapshot(&self) -> Arc<Snapshot>;

    /// The newest parameters: at least as new as every event that was passed on.
    fn parameters(&self) -> Arc<ParameterImage>;
}
