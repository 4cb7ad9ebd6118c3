//! Tests of the interfaces as a whole.

mod any_value;
mod contract;
mod golden;
mod hashes;
mod hostile;
mod names;
mod package;
mod wire;
