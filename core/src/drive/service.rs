//! Service half of a backend: start, stop, health. It runs on its own thread, never on that of the cycle.

use crate::code::Code;

/// Error of a backend outside the cycle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("backend {backend}: {problem}")]
pub struct ServiceError {
    /// Name of the backend.
    pub backend: String,
    /// Description of the problem and its object.
    pub problem: String,
}

/// Notice of a backend, which becomes an event of the machine (`Action::Note`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Note {
    /// One of [`Code::NOTES`].
    pub code: Code,
    /// Count or name, depending on the code.
    pub number: i64,
}

/// Health of a backend, for messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Present problems, one message each.
    pub problems: Vec<String>,
    /// Further values: a name, with its unit, and a value.
    pub values: Vec<(&'static str, String)>,
    /// Notices since the last call.
    pub notes: Vec<Note>,
}

/// The service half of a backend; the cyclic half is its [`Backend`](super::Backend). The halves communicate through
/// ring buffers that exist before both: the cyclic half is already on its thread when this one starts, and also when it
/// starts again.
pub trait Service: Send {
    /// Returns the name of the backend.
    fn name(&self) -> &str;

    /// Returns its hardware, such as the address of its bus.
    fn hardware(&self) -> String;

    /// Prepares the exchange; may block.
    ///
    /// # Errors
    /// A device that is missing or differs from the cell.
    fn start(&mut self) -> Result<(), ServiceError>;

    /// Does pending work for a moment between start and stop while no cycle runs, for example while other backends
    /// start or stop.
    fn poll_without_cycle(&mut self) {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }

    /// Does pending work during the cycles, on its own thread. It may wait for its hardware.
    ///
    /// Each problem is logged once when it occurs and once when it ends; it stops nothing.
    fn health_check(&mut self) -> Health;

    /// Puts its drives into a safe state.
    fn stop(&mut self);
}
