//! Signals that end a command in an orderly way; they are those of the whole program.

use super::Failure;
use crate::interrupt::{SAME_SIGNAL, Signals};
use std::time::Instant;

/// Receiver of the signals; without it they end the process immediately.
pub(super) struct Stop {
    signals: Source,
    first: Option<Instant>,
}

/// Source of signals.
enum Source {
    System(Signals),
    /// Signals of a test.
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
    /// Returns an error if the operating system does not deliver signals.
    pub(super) fn listen() -> Result<Self, Failure> {
        let signals =
            Signals::new().map_err(|error| Failure::Failed(format!("signals cannot be received: {error}")))?;
        Ok(Self { signals: Source::System(signals), first: None })
    }

    /// Creates a receiver of the signals that are sent to the channel.
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
