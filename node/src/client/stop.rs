//! Signals that end a command: Ctrl-C, SIGTERM, and SIGHUP of a terminal that is closed.

use super::Failure;
use std::time::{Duration, Instant};
use tokio::signal::unix::{Signal, SignalKind, signal};

/// Within this time another signal is the first one, passed on twice by a terminal and a wrapper.
const SAME_SIGNAL: Duration = Duration::from_millis(500);

/// Listens to the signals; without it they end the process at once.
pub(super) struct Stop {
    signals: [Signal; 3],
    first: Option<Instant>,
}

impl Stop {
    /// # Errors
    /// The system does not deliver them.
    pub(super) fn listen() -> Result<Self, Failure> {
        let listen =
            |kind| signal(kind).map_err(|error| Failure::Failed(format!("signals cannot be received: {error}")));
        let signals =
            [listen(SignalKind::interrupt())?, listen(SignalKind::terminate())?, listen(SignalKind::hangup())?];
        Ok(Self { signals, first: None })
    }

    /// Waits for a signal. The second call waits for another one.
    pub(super) async fn requested(&mut self) {
        loop {
            let [interrupt, terminate, hangup] = &mut self.signals;
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
                _ = hangup.recv() => {}
            }
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
