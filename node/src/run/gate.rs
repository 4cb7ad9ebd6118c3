//! The gate of the cycle thread: while it is closed no cycle runs and nothing is exchanged with any backend.
//!
//! Law      open: cycles run; closed: the thread sleeps, outside real time. It closes between two cycles, once every command that
//!          was taken has had its cycle
//! Refuses  to open where a backend does not start: it stays closed then, and says why

use lineshaft_ros::surface::host::GateState;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::Thread;
use std::time::Duration;

/// How often the sleeping thread looks whether the program ends.
const LOOK: Duration = Duration::from_millis(50);

/// Whether cycles run, and whether they should.
#[derive(Debug, Default)]
pub struct Gate {
    /// Cycles should run.
    wanted: AtomicBool,
    /// Cycles run.
    is_open: AtomicBool,
    /// Why a backend did not start.
    failure: Mutex<Option<String>>,
    /// Who sleeps before it.
    sleeper: OnceLock<Thread>,
}

impl Gate {
    /// A gate that opens when the thread comes to it.
    pub fn opening() -> Self {
        Self { wanted: AtomicBool::new(true), ..Self::default() }
    }

    /// Has the cycles run. It takes its time: [`Gate::state`] tells when they do.
    pub fn open(&self) {
        *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = None;
        self.wanted.store(true, Ordering::Release);
        if let Some(sleeper) = self.sleeper.get() {
            sleeper.unpark();
        }
    }

    /// Has the cycles end.
    pub fn close(&self) {
        self.wanted.store(false, Ordering::Release);
    }

    /// How it stands.
    pub fn state(&self) -> GateState {
        if self.is_open.load(Ordering::Acquire) {
            return GateState::Open;
        }
        let failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone();
        failure.map_or(GateState::Closed, GateState::Failed)
    }

    /// Should cycles run? One load, for the cycle thread.
    pub fn is_wanted(&self) -> bool {
        self.wanted.load(Ordering::Acquire)
    }

    /// Sleeps until cycles should run; false when the program ends.
    pub fn wait(&self, stop: &AtomicBool) -> bool {
        let _ = self.sleeper.set(std::thread::current());
        loop {
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            if self.is_wanted() {
                return true;
            }
            std::thread::park_timeout(LOOK);
        }
    }

    /// The cycle thread tells that the backends exchange, or no longer do.
    pub fn set_open(&self, is_open: bool) {
        self.is_open.store(is_open, Ordering::Release);
    }

    /// The cycle thread tells why a backend does not start.
    pub fn fail(&self, reason: String) {
        // First: who sees the failure may try again at once.
        self.wanted.store(false, Ordering::Release);
        *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(reason);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn a_thread_sleeps_until_it_opens_or_the_program_ends() {
        for ends in [false, true] {
            let (gate, stop) = (Arc::new(Gate::default()), Arc::new(AtomicBool::new(false)));
            let (of_thread, end) = (Arc::clone(&gate), Arc::clone(&stop));
            let thread = std::thread::spawn(move || of_thread.wait(&end));
            std::thread::sleep(Duration::from_millis(20));
            assert!(!thread.is_finished());
            if ends {
                stop.store(true, Ordering::Relaxed)
            } else {
                gate.open()
            }
            assert_eq!(thread.join().unwrap(), !ends);
        }
    }

    #[test]
    fn a_backend_that_does_not_start_leaves_it_closed_until_it_is_asked_again() {
        let gate = Gate::opening();
        gate.fail("no bus".to_owned());
        assert_eq!((gate.state(), gate.is_wanted()), (GateState::Failed("no bus".to_owned()), false));
        gate.open();
        assert_eq!((gate.state(), gate.is_wanted()), (GateState::Closed, true));
        gate.set_open(true);
        gate.close();
        assert_eq!((gate.state(), gate.is_wanted()), (GateState::Open, false), "until the last cycle has run");
    }
}
