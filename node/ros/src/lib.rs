//! The ROS 2 layer of Lineshaft.
#![forbid(unsafe_code)]
