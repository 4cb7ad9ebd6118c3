//! Gate of the cycle thread: while it is closed, no cycle runs and no data is exchanged with any backend.
//!
//! Law      open: cycles run; closed: the thread sleeps, outside real time. It closes between two cycles, after every
//!          accepted command was executed
//! Refuses  to open if a backend does not start: it then stays closed, with the reason

use lineshaft_ros::surface::host::GateState;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::Thread;
use std::time::Duration;

/// Interval at which the sleeping thread checks whether the program ends.
const LOOK: Duration = Duration::from_millis(50);

/// Whether cycles run, and whether they should.
#[derive(Debug, Default)]
pub struct Gate {
    /// Whether cycles should run.
    wanted: AtomicBool,
    inner: Mutex<Inner>,
    /// Thread that sleeps while the gate is closed.
    sleeper: OnceLock<Thread>,
}

#[derive(Debug, Default)]
struct Inner {
    /// Whether cycles run.
    is_open: bool,
    /// Whether backends must be started first.
    is_unready: bool,
    /// Reason why a backend did not start.
    failure: Option<String>,
}

impl Gate {
    /// Creates a gate that opens when the thread waits for it.
    pub fn opening() -> Self {
        Self { wanted: AtomicBool::new(true), ..Self::default() }
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Requests cycles. They start later: [`Gate::state`] shows it.
    pub fn open(&self) {
        self.inner().failure = None;
        self.wanted.store(true, Ordering::Release);
        self.wake();
    }

    fn wake(&self) {
        if let Some(sleeper) = self.sleeper.get() {
            sleeper.unpark();
        }
    }

    /// Requests the end of cycles.
    pub fn close(&self) {
        self.wanted.store(false, Ordering::Release);
    }

    /// Returns the state.
    pub fn state(&self) -> GateState {
        let inner = self.inner();
        match &inner.failure {
            _ if inner.is_open => GateState::Open,
            Some(failure) => GateState::Failed(failure.clone()),
            None => GateState::Closed,
        }
    }

    /// Whether cycles should run. A single atomic load, for the cycle thread.
    pub fn is_wanted(&self) -> bool {
        self.wanted.load(Ordering::Acquire)
    }

    /// Sleeps until cycles run, which they do from then on; returns false when the program ends.
    pub fn wait(&self, stop: &AtomicBool) -> bool {
        let _ = self.sleeper.set(std::thread::current());
        loop {
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            let mut inner = self.inner();
            if self.is_wanted() && !inner.is_unready {
                inner.is_open = true;
                return true;
            }
            drop(inner);
            std::thread::park_timeout(LOOK);
        }
    }

    /// Records that no cycle runs any more; called by the cycle thread.
    pub fn set_closed(&self) {
        self.inner().is_open = false;
    }

    /// Makes cycles wait until backends are started.
    pub fn wait_for_services(&self) {
        self.inner().is_unready = true;
    }

    /// Records that all backends have started.
    pub fn set_ready(&self) {
        self.inner().is_unready = false;
        self.wake();
    }

    /// Returns true if the backends are not needed any more; cycles then wait for them again.
    pub fn end_of_cycles(&self) -> bool {
        let mut inner = self.inner();
        // Both under one lock, so that no cycle begins in between.
        let is_over = !inner.is_open && !self.is_wanted();
        inner.is_unready |= is_over;
        is_over
    }

    /// Records that a backend does not start.
    pub fn fail(&self, reason: String) {
        // First, because a client that sees the failure may try again immediately.
        self.wanted.store(false, Ordering::Release);
        self.inner().failure = Some(reason);
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
    fn failed_backend_start_keeps_the_gate_closed_until_the_next_request() {
        let gate = Gate::opening();
        gate.fail("no bus".to_owned());
        assert_eq!((gate.state(), gate.is_wanted()), (GateState::Failed("no bus".to_owned()), false));
        gate.open();
        assert_eq!((gate.state(), gate.is_wanted()), (GateState::Closed, true));
        assert!(gate.wait(&AtomicBool::new(false)));
        gate.close();
        assert_eq!((gate.state(), gate.is_wanted()), (GateState::Open, false), "until the last cycle has run");
        gate.set_closed();
        assert_eq!(gate.state(), GateState::Closed);
    }
}
