//! Assigns ROS domains so that no two tests share one, in any process.

use std::{
    env, fmt,
    fs::{File, OpenOptions},
    ops::RangeInclusive,
    process,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
};

use super::machine::{self, MachineLock};

/// The domains that tests may take; lower ones are for manual work. The ports of those above 101 are ports that Linux
/// also assigns to sockets that request none.
const DOMAINS: RangeInclusive<u32> = 10..=101;

/// A ROS domain that belongs to one test as long as this value or a clone of it exists; each process in it holds one.
#[derive(Clone)]
pub(crate) struct Domain {
    id: u32,
    /// File whose lock reserves the domain; the system releases the lock when the process ends in any way.
    _lock: Arc<File>,
    /// While a test has a domain, no test that needs the whole machine runs.
    _machine: Arc<MachineLock>,
}

impl Domain {
    /// Takes a free domain.
    ///
    /// Panics when all are taken.
    pub(crate) fn take() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let machine = machine::share();
        let count = DOMAINS.end() - DOMAINS.start() + 1;
        // Test processes start at different numbers, so that they rarely try a domain of another one.
        let first = process::id().wrapping_mul(7).wrapping_add(NEXT.fetch_add(1, Ordering::Relaxed));
        (0..count)
            .map(|i| DOMAINS.start() + first.wrapping_add(i) % count)
            .find_map(|id| Some(Self { id, _lock: Arc::new(claim(id)?), _machine: machine.clone() }))
            .expect("a free ROS domain between 10 and 101: end the tests that hold them")
    }
}

/// Returns the locked file of a domain; `None` when another process has it. All checkouts on a machine share its ports.
fn claim(id: u32) -> Option<File> {
    let path = env::temp_dir().join(format!("lineshaft-test-domain-{id}.lock"));
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(path).ok()?;
    file.try_lock().ok().map(|()| file)
}

impl fmt::Display for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.id.fmt(f)
    }
}
