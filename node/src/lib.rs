//! The Lineshaft program: cells, scenarios, the cycle thread and the command line.
#![forbid(unsafe_code)]
// Output goes through `output`, which checks every write.
#![cfg_attr(not(test), deny(clippy::print_stdout))]

// First, because the other modules use its macros.
#[macro_use]
mod output;

pub mod cell;
pub mod cell_file;
pub mod cli;
mod client;
pub mod document;
pub mod errors;
mod explain;
pub mod functions;
pub mod graph;
pub mod interfaces;
pub mod interrupt;
pub mod limits;
#[cfg(test)]
mod page;
pub mod parameters;
mod program;
mod progress;
pub mod recording;
pub mod reference;
pub mod run;
pub mod scenario;
mod starter;
pub mod store;
pub mod table;
mod terminal;
pub mod tune;
mod whole_file;
