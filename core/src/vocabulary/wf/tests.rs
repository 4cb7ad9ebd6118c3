//! The vocabulary against an axis that is given to it, and on a whole machine.

mod anything;
mod bench;
mod blocks;
mod closed;
mod open;
mod refusals;
mod rig;
