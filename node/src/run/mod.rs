//! Running a machine in real time: the cycle thread, the ways into and out of it.
//!
//! The cycle thread owns the machine and its backends. Commands reach it through two bounded rings (a stop lane and a queue)
//! and a newest-wins mailbox; events leave it through a ring, signals through a newest-wins snapshot. Nothing that others
//! do can make it wait. It never writes files, sockets or logs: [`bridge`] does that for it.

pub mod backends;
pub mod bridge;
pub mod clock;
pub mod decoder;
pub mod flight;
pub mod frames;
pub mod gate;
pub mod histogram;
pub mod keeper;
pub mod lanes;
pub mod objects;
mod pool;
pub mod realtime;
pub mod recorder;
pub mod samples;
pub mod services;
pub mod thread;
pub mod trials;
mod tuning;
pub mod wake;
pub mod writer;

use std::thread::{Builder, JoinHandle};

/// Starts a thread. Tools such as `top -H` and `perf` show the first 15 bytes of its name.
///
/// # Panics
/// The system has no thread left, as [`std::thread::spawn`].
pub fn spawn<T: Send + 'static>(name: &str, work: impl FnOnce() -> T + Send + 'static) -> JoinHandle<T> {
    Builder::new().name(name.to_owned()).spawn(work).unwrap_or_else(|error| panic!("thread {name}: {error}"))
}
