//! Runs a machine in real time: the cycle thread, and its inputs and outputs.
//!
//! The cycle thread owns the machine and its backends. It receives commands through two bounded ring buffers (a stop
//! queue and a normal queue) and a mailbox with the newest setpoints; it sends events through a ring buffer and signals
//! through a snapshot of the newest ones. No other thread can make it wait. It never writes files, sockets or logs;
//! [`bridge`] does that.

pub mod backends;
pub mod bridge;
pub mod can;
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
pub mod schedule;
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
/// If the operating system cannot create a thread, like [`std::thread::spawn`].
pub fn spawn<T: Send + 'static>(name: &str, work: impl FnOnce() -> T + Send + 'static) -> JoinHandle<T> {
    Builder::new().name(name.to_owned()).spawn(work).unwrap_or_else(|error| panic!("thread {name}: {error}"))
}
