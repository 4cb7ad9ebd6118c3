//! Runs kept as bags: read by tools that this project did not write, replayed, compared, and what is left of them when the
//! program is killed or the disk is full.
//!
//! `LINESHAFT_LONG=1` makes the tests long that are better the longer they are.

mod support;

#[path = "recording/bench.rs"]
mod bench;
#[path = "recording/flight.rs"]
mod flight;
#[path = "recording/killed.rs"]
mod killed;
#[path = "recording/layouts.rs"]
mod layouts;
#[path = "recording/node.rs"]
mod node;
#[path = "recording/replayed.rs"]
mod replayed;
#[path = "recording/simulated.rs"]
mod simulated;
