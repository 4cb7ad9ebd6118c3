//! ROS 2 for Lineshaft.
//!
//! [`layer`] is a small ROS 2 client library: node, publishers, services, actions, logs. It is independent of axes. The DDS library is in
//! [`side`], which runs as a separate process, and serves clients with rmw_fastrtps and rmw_cyclonedds.
#![forbid(unsafe_code)]

#[cfg(any(test, feature = "fuzz"))]
pub mod fuzz;
pub mod layer;
pub mod line_limit;
mod link;
pub mod offset;
pub mod side;
pub mod silence;
pub mod surface;
