//! Between the cycle thread and everybody else: passes events and signals on, frees what came back.

use super::lanes::{Commander, Numbers, Spent};
use lineshaft_core::command::{Action, Source};
use lineshaft_core::config::MachineConfig;
use lineshaft_core::event::{Kind, Severity};
use lineshaft_core::signal::Directory;
use lineshaft_core::text;
use lineshaft_ros::surface::host::{Busy, Host, Snapshot, StampedEvent};
use rtrb::Consumer;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;
use tokio::sync::mpsc::UnboundedSender;

/// How often the rings are looked at: well above any rate that ROS is given.
const PERIOD: Duration = Duration::from_millis(1);

/// The running machine for everybody outside the cycle thread.
#[derive(Debug)]
pub struct Handle {
    config: MachineConfig,
    directory: Directory,
    commander: Commander,
    newest: RwLock<Arc<Snapshot>>,
}

impl Handle {
    /// A handle on a machine that is about to run.
    pub fn new(config: MachineConfig, directory: Directory, commander: Commander, first: Snapshot) -> Self {
        Self { config, directory, commander, newest: RwLock::new(Arc::new(first)) }
    }

    /// Where the numbers of commands come from.
    pub fn numbers(&self) -> Numbers {
        self.commander.numbers()
    }

    /// Hands a command over, in the name of `source`.
    ///
    /// # Errors
    /// Its lane is full.
    pub fn submit_as(&self, source: Source, action: Action) -> Result<u64, Busy> {
        self.commander.submit(source, action)
    }
}

impl Host for Handle {
    fn config(&self) -> &MachineConfig {
        &self.config
    }

    fn directory(&self) -> &Directory {
        &self.directory
    }

    fn submit(&self, action: Action) -> Result<u64, Busy> {
        self.submit_as(Source::Ros, action)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Arc::clone(&self.newest.read().unwrap_or_else(PoisonError::into_inner))
    }
}

/// What the bridge takes from the cycle thread.
pub struct Bridge {
    /// Events.
    pub events: Consumer<StampedEvent>,
    /// Signals.
    pub signals: triple_buffer::Output<Snapshot>,
    /// Commands that have applied.
    pub spent: Spent,
    /// Who gets the events, each all of them in order.
    pub listeners: Vec<UnboundedSender<StampedEvent>>,
}

impl Bridge {
    /// Works until `stop` is set, and once more after it.
    pub fn run(mut self, handle: &Handle, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            self.pass_on(handle);
            std::thread::sleep(PERIOD);
        }
        self.pass_on(handle);
    }

    fn pass_on(&mut self, handle: &Handle) {
        self.spent.free();
        // Signals first: who reacts to an event finds signals that are at least as new.
        if self.signals.update() {
            let newest = Arc::new(self.signals.output_buffer().clone());
            *handle.newest.write().unwrap_or_else(PoisonError::into_inner) = newest;
        }
        while let Ok(event) = self.events.pop() {
            log(&event, handle);
            self.listeners.retain(|listener| listener.send(event).is_ok());
        }
    }
}

/// One line for what a person would want to know.
fn log(event: &StampedEvent, handle: &Handle) {
    let event = &event.event;
    let sentence = || text::sentence(event, &handle.config);
    match (event.severity, event.kind) {
        (Severity::Error, _) => tracing::error!("{}", sentence()),
        // What ends a goal is told to the one who gave it.
        (_, Kind::Done | Kind::Accepted | Kind::Overrun) => tracing::debug!("{}", sentence()),
        (Severity::Warn, _) => tracing::warn!("{}", sentence()),
        (Severity::Info, Kind::Reset) => tracing::info!("{}", sentence()),
        (Severity::Info, _) => tracing::debug!("{}", sentence()),
    }
}
