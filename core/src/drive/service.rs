//! The half of a backend that takes its time: starting, stopping, health. It runs on a thread of its own, never on that of the cycle.

/// What a backend has to say of itself outside the cycle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("backend {backend}: {problem}")]
pub struct ServiceError {
    /// Name.
    pub backend: String,
    /// What is wrong, and with what.
    pub problem: String,
}

/// The service half of a backend; the cyclic one is its [`Backend`](super::Backend). What the halves tell each other goes through rings
/// that were made before either ran: the cyclic half is with its thread already when this one starts, and starts again.
pub trait Service: Send {
    /// Makes it ready to exchange; may take its time.
    ///
    /// # Errors
    /// What is not there, or not as the cell says.
    fn start(&mut self) -> Result<(), ServiceError>;

    /// Does what is due beside the cycles. It has a thread of its own then, and may wait for whatever it hangs on.
    ///
    /// What it gives is what is wrong at present: one line of the log when it comes, and one when it is over; it stops nothing.
    fn look(&mut self) -> Vec<ServiceError>;

    /// Leaves its drives in a safe state.
    fn stop(&mut self);
}
