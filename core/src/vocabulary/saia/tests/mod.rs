//! The module as its program sees it.

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
