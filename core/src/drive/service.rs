//! The half of a backend that takes its time: starting, stopping, health. It runs on a thread of its own, never on that of the cycle.

use crate::code::Code;

/// What a backend has to say of itself outside the cycle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("backend {backend}: {problem}")]
pub struct ServiceError {
    /// Name.
    pub backend: String,
    /// What is wrong, and with what.
    pub problem: String,
}

/// Something that has happened to a backend, which becomes an event of the machine (`Action::Note`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Note {
    /// One of [`Code::NOTES`].
    pub code: Code,
    /// What the code counts or names.
    pub number: i64,
}

/// How a backend does, for people.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// What is wrong at present, a sentence each.
    pub problems: Vec<String>,
    /// What else is worth knowing: a name, with its unit, and a value.
    pub values: Vec<(&'static str, String)>,
    /// What has happened since it was asked last.
    pub notes: Vec<Note>,
}

/// The service half of a backend; the cyclic one is its [`Backend`](super::Backend). What the halves tell each other goes through rings
/// that were made before either ran: the cyclic half is with its thread already when this one starts, and starts again.
pub trait Service: Send {
    /// Name of the backend.
    fn name(&self) -> &str;

    /// What it hangs on, such as the address of its bus.
    fn hardware(&self) -> String;

    /// Makes it ready to exchange; may take its time.
    ///
    /// # Errors
    /// What is not there, or not as the cell says.
    fn start(&mut self) -> Result<(), ServiceError>;

    /// Does what is due for a moment while no cycle runs, between the start of this one and the stop of this one: others start or stop
    /// meanwhile.
    fn idle(&mut self) {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }

    /// Does what is due beside the cycles. It has a thread of its own then, and may wait for whatever it hangs on.
    ///
    /// Each problem is one line of the log when it comes, and one when it is over; it stops nothing.
    fn look(&mut self) -> Health;

    /// Leaves its drives in a safe state.
    fn stop(&mut self);
}
