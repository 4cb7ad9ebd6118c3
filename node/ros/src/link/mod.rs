//! What the program and its ROS side say to each other, and how the program keeps a ROS side.
//!
//! The DDS library lives in a process of its own (`side/`): what the network does to it, it does not do to the machine.
//! `protocol` is the language of the two, `supervisor` starts a side, and another one when it fails or has grown; `running` is a side
//! that runs; `registry` knows all that a new side has to be told.
//!
//! Never imports the DDS library, `side/dds`, or what a topic means.

pub(crate) mod frame;
pub(crate) mod guid;
mod participants;
pub(crate) mod protocol;
pub(crate) mod qos;
mod registry;
mod running;
mod start;
mod supervisor;

pub(crate) use self::registry::{Reader, Unwritten, Writer};
pub use self::start::Side;
pub(crate) use self::supervisor::{Growth, Link, Opener, Settings};
pub use self::supervisor::{LinkError, Loss};
