//! Simulated CiA 402 drive, independent of the bus: its objects and modes of operation. The mechanics are those of the core.
//!
//! Law      the bus reads and writes the [`ObjectTable`] by process data and SDO; the drive passes on between objects and mechanics
//! Source   CiA 402-2

mod drive;
mod interpolation;
mod modes;
pub mod objects;
mod profile;
mod table;
mod touch_probe;

pub use drive::SimulatedDrive;
pub use table::{BusRules, ObjectTable, TableAccess};
