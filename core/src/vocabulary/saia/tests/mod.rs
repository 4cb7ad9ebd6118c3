//! Tests of the module through its interface.

mod anything;
mod contacts;
mod coordinate;
mod errors;
mod flags;
mod judged;
mod loads;
mod regulator;
mod rig;
mod scaling;
mod states;
mod takeover;
