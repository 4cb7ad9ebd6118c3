//! Wakes one thread from another one that must not wait.

use std::sync::{Arc, OnceLock};
use std::thread::{Thread, current, park_timeout};
use std::time::Duration;

/// Both ends: one thread sleeps, another one wakes it.
#[derive(Clone, Debug, Default)]
pub struct Wake(Arc<OnceLock<Thread>>);

impl Wake {
    /// Sleeps until it is woken, at most so long. If it was woken since the last call, it does not sleep. For one thread alone.
    pub fn sleep(&self, longest: Duration) {
        self.0.get_or_init(current);
        park_timeout(longest);
    }

    /// Wakes the thread that sleeps. Never waits; a system call only where that thread sleeps.
    pub fn wake(&self) {
        if let Some(sleeper) = self.0.get() {
            sleeper.unpark();
        }
    }
}
