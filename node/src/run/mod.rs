//! Running a machine in real time: the cycle thread, the ways into and out of it.
//!
//! The cycle thread owns the machine and its backends. Commands reach it through two bounded rings (a stop lane and a queue)
//! and a newest-wins mailbox; events leave it through a ring, signals through a newest-wins snapshot. Nothing that others
//! do can make it wait. It never writes files, sockets or logs: [`bridge`] does that for it.

pub mod backends;
pub mod bridge;
pub mod flight;
pub mod frames;
pub mod gate;
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
pub mod writer;
