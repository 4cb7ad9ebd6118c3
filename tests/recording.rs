//! Runs kept as bags: read by tools that this project did not write, replayed, compared, and what is left of them when the
//! program is killed or the disk is full.
//!
//! `LINESHAFT_LONG=1` makes the tests long that are better the longer they are.

mod bench;
mod flight;
mod killed;
mod layouts;
mod node;
mod replayed;
mod simulated;
