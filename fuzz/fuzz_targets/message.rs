//! Messages from topics and bags: each is rejected, or written again as it was read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lineshaft_msgs::cdr::{Endian, MAX_PADDING, decode, decode_with_header, encode};
use lineshaft_msgs::foreign::{rcl_interfaces, sensor_msgs, trajectory_msgs};
use lineshaft_msgs::{Message, msg};

fn law<M: Message>(bytes: &[u8]) {
    for endian in [Endian::Little, Endian::Big] {
        match decode::<M>(bytes, endian) {
            Ok(message) => {
                let length = encode(&message).len();
                assert!(length <= bytes.len() && bytes.len() <= length + MAX_PADDING);
            }
            Err(error) => assert!(error.to_string().len() < 600),
        }
    }
    let _ = decode_with_header::<M>(bytes);
}

fuzz_target!(|bytes: &[u8]| {
    let [kind, bytes @ ..] = bytes else { return };
    match kind % 8 {
        0 => law::<msg::AxisStates>(bytes),
        1 => law::<msg::Event>(bytes),
        2 => law::<msg::AppliedCommand>(bytes),
        3 => law::<msg::CycleInputs>(bytes),
        4 => law::<sensor_msgs::msg::JointState>(bytes),
        5 => law::<trajectory_msgs::msg::JointTrajectory>(bytes),
        6 => law::<rcl_interfaces::msg::ParameterEvent>(bytes),
        _ => law::<rcl_interfaces::msg::ParameterDescriptor>(bytes),
    }
});
