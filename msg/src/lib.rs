//! The ROS 2 interfaces of Lineshaft.
#![forbid(unsafe_code)]
