//! Signals that end a command in order: those of the whole program.

use super::Failure;
use crate::interrupt::{SAME_SIGNAL, Signals};
use std::time::Instant;

/// Listens to the signals; without it they end the process at once.
pub(super) struct Stop {
    signals: Source,
    first: Option<Instant>,
}

/// Where signals come from.
enum Source {
    System(Signals),
    /// Signals that a test makes.
    #[cfg(test)]
    Made(tokio::sync::mpsc::UnboundedReceiver<()>),
}

impl Source {
    async fn next(&mut self) {
        match self {
            Self::System(signals) => {
                signals.recv().await;
            }
            #[cfg(test)]
            Self::Made(signals) => {
                if signals.recv().await.is_none() {
                    std::future::pending::<()>().await;
                }
            }
        }
    }
}

impl Stop {
    /// # Errors
    /// The system does not deliver them.
    pub(super) fn listen() -> Result<Self, Failure> {
        let signals =
            Signals::new().map_err(|error| Failure::Failed(format!("signals cannot be received: {error}")))?;
        Ok(Self { signals: Source::System(signals), first: None })
    }

    /// Listens to the signals that are sent to the channel.
    #[cfg(test)]
    pub(super) fn made() -> (tokio::sync::mpsc::UnboundedSender<()>, Self) {
        let (sender, signals) = tokio::sync::mpsc::unbounded_channel();
        (sender, Self { signals: Source::Made(signals), first: None })
    }

    /// Waits for a signal. The second call waits for another one.
    pub(super) async fn requested(&mut self) {
        loop {
            self.signals.next().await;
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
