//! Drives of CiA 402: their objects, their PDOs, and what a cycle of the machine makes of them.

mod counter;
pub mod homing;
pub mod image;
pub mod layout;
pub mod objects;
pub mod probe;

pub use counter::Counter;
pub use homing::HomingSetup;
pub use layout::{Layout, LayoutError};
