//! Locks the whole machine: end-to-end tests share it, and a test that measures times takes it exclusively.
//!
//! Test processes of all checkouts on the machine use the same two files, as they do for the domains.

use std::{
    cell::RefCell,
    env,
    fs::{File, OpenOptions},
    sync::{Arc, Weak},
};

thread_local! {
    /// The lock that the test of this thread holds.
    static HELD: RefCell<Weak<MachineLock>> = const { RefCell::new(Weak::new()) };
}

/// A shared or exclusive lock of the machine, held until the last clone is dropped.
pub(crate) struct MachineLock {
    /// The system releases the lock when the process ends in any way.
    _file: File,
}

/// Runs the calling test alone: waits until no other end-to-end test runs on this machine, and lets none start before
/// the returned value is dropped. For tests whose result depends on the available processor time.
///
/// Panics if the test already has a domain: it would wait for itself.
#[track_caller]
pub(crate) fn alone() -> Arc<MachineLock> {
    assert!(held().is_none(), "alone() must be called before the test takes its first domain");
    take(File::lock)
}

/// Shares the machine with all tests except those that run alone. A test that already holds the lock gets the same one.
pub(crate) fn share() -> Arc<MachineLock> {
    held().unwrap_or_else(|| take(File::lock_shared))
}

fn held() -> Option<Arc<MachineLock>> {
    HELD.with_borrow(Weak::upgrade)
}

/// Takes the lock after a second lock, the turnstile, so that a test that waits for the whole machine prevents others
/// from starting.
fn take(lock: fn(&File) -> std::io::Result<()>) -> Arc<MachineLock> {
    let turnstile = open("turnstile");
    turnstile.lock().expect("the file system of the temporary folder has locks");
    let file = open("machine");
    lock(&file).expect("the file system of the temporary folder has locks");
    drop(turnstile);
    let taken = Arc::new(MachineLock { _file: file });
    HELD.set(Arc::downgrade(&taken));
    taken
}

fn open(name: &str) -> File {
    let path = env::temp_dir().join(format!("lineshaft-test-{name}.lock"));
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
    file.unwrap_or_else(|e| panic!("{} cannot be opened: {e}", path.display()))
}
