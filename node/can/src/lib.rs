//! CAN for Lineshaft: transports, CANopen master, EDS and DCF files. This is the only crate with CAN, and it does not depend on ROS. The
//! crate `lineshaft-cia402` has the profile of drives.
#![forbid(unsafe_code)]

pub mod acts;
pub mod can_objects;
pub mod commission;
pub mod config;
pub mod eds;
mod frame;
pub mod layout;
pub mod load;
pub mod lss;
pub mod master;
mod nmt;
mod node_id;
pub mod pdo_image;
pub mod sdo;
pub mod sheet;
pub mod simulate;
pub mod transport;
mod watch;

pub use frame::{CAPTURE, Frame, FrameError, Id};
pub use nmt::{NmtCommand, NmtState, SignOfLife};
pub use node_id::NodeId;
pub use watch::{DeviceEvent, Monitor, Monitoring};

/// Tests of the master check that cycles allocate no memory.
#[cfg(test)]
#[global_allocator]
static ALLOCATOR: assert_no_alloc::AllocDisabler = assert_no_alloc::AllocDisabler;
