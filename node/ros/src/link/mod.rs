//! Connection between the program and its ROS side, and supervision of the ROS side.
//!
//! The DDS library runs in a separate process (`side/`), so that a fault in it that the network causes does not affect the machine.
//! `protocol` defines the messages. `supervisor` starts a side, and another one when the first one fails or uses too much memory. `running`
//! is a running side. `registry` stores the state with which each new side is initialized.
//!
//! This module speaks of topics, services and callers as ROS does, and does not depend on the middleware or on the meaning of a topic.

pub(crate) mod frame;
mod participants;
pub(crate) mod protocol;
pub(crate) mod qos;
mod registry;
mod running;
mod start;
mod supervisor;

pub(crate) use self::registry::{Reader, WriteError, Writer};
pub use self::start::Side;
pub(crate) use self::supervisor::{Link, MemoryLimit, Opener, Settings};
pub use self::supervisor::{LinkError, Loss};
