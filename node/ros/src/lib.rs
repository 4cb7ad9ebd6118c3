//! ROS 2 for Lineshaft.
//!
//! [`layer`] is a small ROS 2 client library: node, publishers, services, actions, logs. It answers clients of rmw_fastrtps
//! and of rmw_cyclonedds, and knows nothing of axes. The DDS library is in [`side`], which is a process of its own.
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
