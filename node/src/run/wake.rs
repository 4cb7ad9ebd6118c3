//! Wakes a thread from another one that must not wait.

use std::sync::{Arc, OnceLock};
use std::thread::{Thread, current, park_timeout};
use std::time::Duration;

/// Both ends: one thread sleeps, another one wakes it.
#[derive(Clone, Debug, Default)]
pub struct Wake(Arc<OnceLock<Thread>>);

impl Wake {
    /// Sleeps until woken, at most `longest`. Does not sleep if it was woken since the last call. Only one thread may
    /// call it.
    pub fn sleep(&self, longest: Duration) {
        self.0.get_or_init(current);
        park_timeout(longest);
    }

    /// Wakes the sleeping thread. Never waits; makes a system call only if that thread sleeps.
    pub fn wake(&self) {
        if let Some(sleeper) = self.0.get() {
            sleeper.unpark();
        }
    }
}
