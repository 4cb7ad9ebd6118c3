//! The Lineshaft program: cells, scenarios, the cycle thread and the command line.
#![forbid(unsafe_code)]

pub mod cell;
pub mod cell_file;
pub mod cli;
pub mod document;
pub mod errors;
pub mod functions;
pub mod graph;
pub mod interfaces;
pub mod limits;
#[cfg(test)]
mod page;
pub mod parameters;
mod program;
mod progress;
pub mod recording;
pub mod run;
pub mod scenario;
pub mod store;
pub mod table;
pub mod tune;
mod whole_file;
