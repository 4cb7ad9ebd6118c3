//! Requests of both RMWs, and of neither: each is rejected, or decoded to the last byte and in one way only.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| lineshaft_ros::fuzz::any_request(bytes));
