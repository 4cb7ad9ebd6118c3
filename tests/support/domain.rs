//! ROS domains that no two tests share, in whichever process they run.

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

/// The domains that tests may take; whoever works by hand takes one below. The ports of those above 101 are ports that Linux also
/// gives to any socket that asks for none.
const DOMAINS: RangeInclusive<u32> = 10..=101;

/// A ROS domain that belongs to one test for as long as this value or a clone of it lives; each process in it holds one.
#[derive(Clone)]
pub(crate) struct Domain {
    id: u32,
    /// Its lock is the claim; the system frees it when the process ends, however it ends.
    _lock: Arc<File>,
    /// While a test has a domain, none that needs the whole machine runs.
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
        // Test processes start at different places, so that they seldom try what another has.
        let first = process::id().wrapping_mul(7).wrapping_add(NEXT.fetch_add(1, Ordering::Relaxed));
        (0..count)
            .map(|i| DOMAINS.start() + first.wrapping_add(i) % count)
            .find_map(|id| Some(Self { id, _lock: Arc::new(claim(id)?), _machine: machine.clone() }))
            .expect("a free ROS domain between 10 and 101: end the tests that hold them")
    }
}

/// The locked claim on a domain; `None` when somebody else has it. All checkouts on a machine share its ports.
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
