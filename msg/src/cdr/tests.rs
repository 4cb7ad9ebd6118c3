use std::fmt;

use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::*;
use crate::foreign::rcl_interfaces::msg::{FloatingPointRange, ParameterDescriptor};
use crate::foreign::rmw_dds_common::msg::NodeEntitiesInfo;
use crate::foreign::sensor_msgs::msg::JointState;
use crate::foreign::std_msgs::msg::{Header, String as Text};
use crate::foreign::std_srvs::srv::TriggerResponse;
use crate::msg::{AxisState, AxisStates, CycleInputs};
use crate::{Bounded, Message};

fn refusal<T: DeserializeOwned + fmt::Debug>(bytes: &[u8]) -> DecodeError {
    decode::<T>(bytes, Endian::Little).unwrap_err()
}

#[test]
fn a_bool_is_zero_or_one() {
    let error = refusal::<TriggerResponse>(&[2, 0, 0, 0, 1, 0, 0, 0, 0]);
    assert_eq!(error.problem, Problem::Bool { value: 2 });
    assert_eq!(
        error.to_string(),
        "std_srvs/srv/Trigger_Response, success, byte 1: a bool is 2, only 0 and 1 are allowed"
    );
}

#[test]
fn a_string_ends_in_its_zero_and_is_utf8() {
    let cases: [(&[u8], Problem, &str); 5] = [
        (&[0, 0, 0, 0], Problem::NoRoomForZero, "a string has length 0, at least 1 is needed for the zero at its end"),
        (&[2, 0, 0, 0, 104, 105], Problem::NoZero { last: 105 }, "a string ends in byte 0x69, only 0x00 is allowed"),
        (&[3, 0, 0, 0, 104, 0xff, 0], Problem::Utf8 { valid: 1 }, "a string is no UTF-8 from its byte 1 on"),
        (&[9, 0, 0, 0, 104, 0], Problem::TooShort { needed: 9, left: 2 }, "9 bytes are needed, 2 are left"),
        (&[3, 0], Problem::TooShort { needed: 4, left: 2 }, "4 bytes are needed, 2 are left"),
    ];
    for (bytes, problem, sentence) in cases {
        let error = refusal::<Text>(bytes);
        assert_eq!(error.problem, problem);
        let expected = format!("std_msgs/msg/String, data, byte {}: {sentence}", error.at);
        assert_eq!(error.to_string(), expected);
    }
}

#[test]
fn padding_that_is_missing_is_counted_among_the_bytes_needed() {
    // A string of 6 bytes, then an f64 at byte 16.
    let error = refusal::<crate::srv::SetPositionRequest>(&[2, 0, 0, 0, 120, 0, 0]);
    assert_eq!(
        (error.field.as_str(), error.at, error.problem),
        ("position", 6, Problem::TooShort { needed: 10, left: 1 })
    );
}

#[test]
fn four_bytes_behind_the_last_field_are_refused() {
    let mut bytes = encode(&Text { data: "hi".to_owned() });
    bytes.extend([0; 4]);
    let error = refusal::<Text>(&bytes);
    assert_eq!(error.to_string(), "std_msgs/msg/String, byte 7: 4 bytes are left over, at most 3 are allowed");
}

#[test]
fn the_field_is_named_through_arrays_and_structs() {
    let axis = AxisState { name: "y".to_owned(), ..AxisState::default() };
    let message = AxisStates { axes: vec![AxisState::default(), axis], ..AxisStates::default() };
    let mut bytes = encode(&message);
    let zero = 1 + bytes.iter().position(|byte| *byte == b'y').unwrap();
    bytes[zero] = b'!';
    let error = refusal::<AxisStates>(&bytes);
    assert_eq!((error.type_name, error.field.as_str()), (AxisStates::NAME, "axes[1].name"));
    assert_eq!(error.problem, Problem::NoZero { last: b'!' });
}

#[test]
fn a_sequence_is_not_longer_than_the_bytes_that_are_left() {
    let mut bytes = encode(&Header::default());
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes.extend(u32::MAX.to_le_bytes());
    bytes.extend([0; 10]);
    let error = refusal::<JointState>(&bytes);
    assert_eq!(error.problem, Problem::SequenceLength { length: u32::MAX, left: 10 });
    let sentence =
        "sensor_msgs/msg/JointState, name, byte 20: a sequence announces 4294967295 elements, 10 bytes are left";
    assert_eq!(error.to_string(), sentence);
}

/// Stores the number of elements for which it should allocate memory.
#[derive(Debug)]
struct Room(usize);

impl<'de> Deserialize<'de> for Room {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Look;
        impl<'de> Visitor<'de> for Look {
            type Value = Room;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a sequence")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Room, A::Error> {
                let room = elements.size_hint().unwrap_or(usize::MAX);
                while elements.next_element::<u8>()?.is_some() {}
                Ok(Room(room))
            }
        }
        deserializer.deserialize_seq(Look)
    }
}

#[test]
fn allocation_is_limited_to_available_bytes() {
    let mut bytes = vec![5, 0, 0, 0];
    bytes.extend([0; 5]);
    assert_eq!(decode::<Room>(&bytes, Endian::Little).unwrap().0, 5);
    bytes[0] = 6;
    assert_eq!(refusal::<Room>(&bytes).problem, Problem::SequenceLength { length: 6, left: 5 });
}

#[test]
fn a_long_sequence_that_fails_early_has_taken_little() {
    // A megabyte that announces a million strings of 24 bytes each in memory; the first one is rejected.
    let mut bytes = encode(&CycleInputs::default());
    let place = bytes.len() - 11 * 4;
    bytes[place..place + 4].copy_from_slice(&1_000_000_u32.to_le_bytes());
    bytes.resize(place + 4 + 1_000_000, 0);
    let error = refusal::<CycleInputs>(&bytes);
    assert_eq!((error.field.as_str(), error.problem), ("latch_object[0]", Problem::NoRoomForZero));
}

#[test]
fn bounds_hold_for_arrays_and_strings() {
    let range = FloatingPointRange { from_value: 0.0, to_value: 1.0, step: 0.0 };
    // The unbounded equivalent of the end of ParameterDescriptor, as a faulty sender would write it.
    let mut bytes = encode(&ParameterDescriptor::default());
    bytes.truncate(bytes.len() - 8);
    bytes.extend(2_u32.to_le_bytes());
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes.extend(encode(&[range.clone(), range]));
    bytes.extend(0_u32.to_le_bytes());
    let error = refusal::<ParameterDescriptor>(&bytes);
    assert_eq!((error.type_name, error.field.as_str()), (ParameterDescriptor::NAME, "floating_point_range"));
    assert_eq!(error.problem, Problem::Refused("2 elements, at most 1 are allowed".to_owned()));

    let long = encode(&("n".repeat(257), "n", Vec::<[u8; 16]>::new(), Vec::<[u8; 16]>::new()));
    let error = refusal::<NodeEntitiesInfo>(&long);
    assert_eq!(error.problem, Problem::Refused("257 bytes, at most 256 are allowed".to_owned()));
    let fits = encode(&("n".repeat(256), "n", Vec::<[u8; 16]>::new(), Vec::<[u8; 16]>::new()));
    let info = decode::<NodeEntitiesInfo>(&fits, Endian::Little).unwrap();
    assert_eq!(info.node_namespace, Bounded::new("n".repeat(256)).unwrap());
}

#[test]
fn nan_is_for_the_caller_to_refuse() {
    let bits = 0x7ff8_0000_0000_0001_u64;
    let request = crate::srv::SetPositionRequest { position: f64::from_bits(bits), ..Default::default() };
    let back: crate::srv::SetPositionRequest = decode(&encode(&request), Endian::Little).unwrap();
    assert_eq!(back.position.to_bits(), bits);
}

#[test]
fn a_header_says_the_order_of_the_bytes() {
    let text = Text { data: "hi".to_owned() };
    assert_eq!(decode_with_header::<Text>(&[0, 0, 0, 0, 0, 0, 0, 3, 104, 105, 0]).as_ref(), Ok(&text));
    // Some senders put the number of padding bytes into the last header byte.
    assert_eq!(decode_with_header::<Text>(&[0, 1, 0, 1, 3, 0, 0, 0, 104, 105, 0, 0]), Ok(text));
    let error = decode_with_header::<Text>(&[0, 7, 0, 0, 3, 0, 0, 0, 104, 105, 0]).unwrap_err();
    let sentence = "the header is [00, 07, 00, 00], only [00, 00, ..] and [00, 01, ..] of four bytes are allowed";
    assert_eq!(error.to_string(), sentence);
    assert_eq!(decode_with_header::<Text>(&[0, 1]).unwrap_err().problem, Problem::Header { start: vec![0, 1] });
}

#[test]
fn type_that_no_message_contains_is_refused() {
    let error = refusal::<Option<u8>>(&[0, 0, 0, 0]);
    assert_eq!(error.to_string(), "an option cannot stand in a message");
}

#[test]
fn a_value_behind_others_is_aligned_from_its_own_first_byte() {
    let joints = JointState { name: vec!["x".to_owned()], position: vec![0.5], ..JointState::default() };
    for before in 0..9 {
        let mut bytes = vec![7; before];
        append_with_header(&mut bytes, &joints);
        assert_eq!(bytes[before..], encode_with_header(&joints));
    }
}
