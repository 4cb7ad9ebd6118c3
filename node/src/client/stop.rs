//! Signals that end a command in order: those of the whole program.

use super::Failure;
use crate::interrupt::{SAME_SIGNAL, Signals};
use std::time::Instant;

/// Listens to the signals; without it they end the process at once.
pub(super) struct Stop {
    signals: Signals,
    first: Option<Instant>,
}

impl Stop {
    /// # Errors
    /// The system does not deliver them.
    pub(super) fn listen() -> Result<Self, Failure> {
        let signals =
            Signals::new().map_err(|error| Failure::Failed(format!("signals cannot be received: {error}")))?;
        Ok(Self { signals, first: None })
    }

    /// Waits for a signal. The second call waits for another one.
    pub(super) async fn requested(&mut self) {
        loop {
            self.signals.recv().await;
            match self.first {
                Some(first) if first.elapsed() < SAME_SIGNAL => {}
                Some(_) => return,
                None => {
                    self.first = Some(Instant::now());
                    return;
                }
            }
        }
    }
}
