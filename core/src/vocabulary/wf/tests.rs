//! Tests of the vocabulary on a test axis, and on a whole machine.

mod anything;
mod bench;
mod blocks;
mod closed;
mod open;
mod refusals;
mod rig;
