//! CAN for Lineshaft: transports, the CANopen master, CiA 402 drives. So far its first types; the crate alone knows CAN,
//! and it knows no ROS.
#![forbid(unsafe_code)]

mod frame;

pub use frame::{Frame, FrameError, Id};
