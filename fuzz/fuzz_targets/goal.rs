//! Goals from the wire to the machine: each is refused, or is a motion within the limits.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| lineshaft_ros::fuzz::any_goal(bytes));
