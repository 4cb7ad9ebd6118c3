//! Tests recordings of runs as bags: reading with independent tools, replay, comparison, and the rest of a bag after
//! the program was killed or while the disk is full.
//!
//! `LINESHAFT_LONG=1` extends the tests that find more in a longer time.

mod bench;
mod flight;
mod killed;
mod layouts;
mod node;
mod replayed;
mod simulated;
