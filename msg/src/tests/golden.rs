//! Bytes written by hand from the rules of CDR: a number of n bytes starts at a multiple of n; the length of a string
//! includes its zero; an empty sequence has no padding after its length; an empty struct is one byte.

use std::fmt::Debug;

use crate::action::MoveAxisGoal;
use crate::cdr::{Endian, decode, encode};
use crate::foreign::action_msgs::msg::{GoalInfo, GoalStatus, GoalStatusArray};
use crate::foreign::builtin_interfaces::msg::Time;
use crate::foreign::rcl_interfaces::msg::ParameterValue;
use crate::foreign::rcl_interfaces::msg::{FloatingPointRange, Parameter, ParameterDescriptor, ParameterType};
use crate::foreign::rmw_dds_common::msg::{Gid, NodeEntitiesInfo, ParticipantEntitiesInfo};
use crate::foreign::sensor_msgs::msg::JointState;
use crate::foreign::std_msgs::msg::{Header, String as Text};
use crate::foreign::std_srvs::srv::TriggerRequest;
use crate::foreign::unique_identifier_msgs::msg::UUID;
use crate::msg::{AxisState, AxisStates, CycleInputs, Event};
use crate::srv::{SetOutputRequest, SetPositionRequest};
use crate::{Bounded, SendGoalRequest};

/// Parses pairs of hexadecimal digits; all other characters only show the positions.
fn bytes(text: &str) -> Vec<u8> {
    let digits: Vec<u8> = text.chars().filter_map(|c| c.to_digit(16)).map(|digit| digit as u8).collect();
    digits.chunks(2).map(|pair| pair[0] << 4 | pair[1]).collect()
}

#[track_caller]
fn is_on_the_wire<T>(value: T, expected: &str)
where
    T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + Debug,
{
    let expected = bytes(expected);
    assert_eq!(encode(&value), expected);
    assert_eq!(decode::<T>(&expected, Endian::Little), Ok(value));
}

fn header(sec: i32, nanosec: u32, frame_id: &str) -> Header {
    Header { stamp: Time { sec, nanosec }, frame_id: frame_id.to_owned() }
}

#[test]
fn a_string_has_its_length_and_its_zero() {
    is_on_the_wire(Text { data: "hi".to_owned() }, "03000000 68 69 00");
    is_on_the_wire(Text::default(), "01000000 00");
}

#[test]
fn an_empty_struct_is_one_byte() {
    is_on_the_wire(TriggerRequest::default(), "00");
}

#[test]
fn structs_nest_without_a_mark() {
    is_on_the_wire(header(-1, 2, "b"), "ffffffff 02000000 02000000 62 00");
}

#[test]
fn a_number_is_aligned_behind_a_string() {
    let request = SetPositionRequest { axis: "x".to_owned(), position: -1.5, units: 2 };
    is_on_the_wire(request, "02000000 78 00 | 0000 | 000000000000f8bf | 02");
}

#[test]
fn numbers_are_aligned_behind_a_sequence_of_strings() {
    let request = SetOutputRequest { outputs: vec!["a".to_owned(), "b".to_owned()], values: vec![1.0, -1.5] };
    is_on_the_wire(
        request,
        "02000000 02000000 61 00 | 0000 | 02000000 62 00 | 0000 | 02000000 | 000000000000f03f 000000000000f8bf",
    );
}

#[test]
fn strings_in_a_sequence_are_aligned_and_empty_sequences_have_no_padding() {
    let message = JointState {
        header: header(1, 0, ""),
        name: vec!["ab".to_owned(), "c".to_owned()],
        position: vec![1.0],
        velocity: vec![],
        effort: vec![],
    };
    let expected = "01000000 00000000 01000000 00 | 000000
        02000000 03000000 61 62 00 | 00 | 02000000 63 00 | 0000
        01000000 000000000000f03f 00000000 00000000";
    is_on_the_wire(message, expected);
}

#[test]
fn a_parameter_value_has_all_its_fields() {
    let value =
        ParameterValue { r#type: ParameterType::PARAMETER_INTEGER, integer_value: 5, ..ParameterValue::default() };
    let parameter = Parameter { name: "abc".to_owned(), value };
    // The bytes of the value shift with the name before them: its type is at 8, its integer at 16.
    let expected = "04000000 61 62 63 00 | 02 00 | 000000000000 | 0500000000000000 0000000000000000
        01000000 00 | 000000 | 00000000 00000000 00000000 00000000 00000000";
    is_on_the_wire(parameter, expected);
}

#[test]
fn a_bounded_array_is_a_sequence() {
    let range = FloatingPointRange { from_value: 0.0, to_value: 1.0, step: 0.5 };
    let descriptor = ParameterDescriptor {
        name: "a".to_owned(),
        r#type: ParameterType::PARAMETER_DOUBLE,
        read_only: true,
        floating_point_range: Some(range).into(),
        ..ParameterDescriptor::default()
    };
    let expected = "02000000 61 00 | 03 | 00 | 01000000 00 | 000000 | 01000000 00 | 01 00 | 00
        01000000 | 00000000 | 0000000000000000 000000000000f03f 000000000000e03f
        00000000";
    is_on_the_wire(descriptor, expected);
}

#[test]
fn a_fixed_array_has_no_length() {
    let gid = |first: u8| Gid { data: std::array::from_fn(|i| first + i as u8) };
    let node = NodeEntitiesInfo {
        node_namespace: Bounded::new("/".to_owned()).unwrap(),
        node_name: Bounded::new("n".to_owned()).unwrap(),
        reader_gid_seq: vec![],
        writer_gid_seq: vec![gid(0x20)],
    };
    let message = ParticipantEntitiesInfo { gid: gid(0x10), node_entities_info_seq: vec![node] };
    let expected = "10 11 12 13 14 15 16 17 18 19 1a 1b 1c 1d 1e 1f
        01000000 02000000 2f 00 | 0000 | 02000000 6e 00 | 0000
        00000000 01000000 20 21 22 23 24 25 26 27 28 29 2a 2b 2c 2d 2e 2f";
    is_on_the_wire(message, expected);
}

#[test]
fn a_goal_follows_its_identifier() {
    let goal = MoveAxisGoal {
        axis: "x".to_owned(),
        mode: MoveAxisGoal::RELATIVE,
        units: MoveAxisGoal::INCREMENTS,
        position: 1.0,
        velocity: 2.0,
        acceleration: 0.5,
        deceleration: 0.0,
        jerk: -1.0,
        buffer_mode: MoveAxisGoal::BUFFERED,
        direction: MoveAxisGoal::CURRENT,
    };
    let request = SendGoalRequest { goal_id: UUID { uuid: [0xaa; 16] }, goal };
    let expected = "aaaaaaaaaaaaaaaa aaaaaaaaaaaaaaaa 02000000 78 00 01 02
        000000000000f03f 0000000000000040 000000000000e03f 0000000000000000 000000000000f0bf 01 03";
    is_on_the_wire(request, expected);
}

#[test]
fn a_status_array_aligns_each_element() {
    let status = |status| GoalStatus {
        goal_info: GoalInfo { goal_id: UUID { uuid: [1; 16] }, stamp: Time { sec: 3, nanosec: 4 } },
        status,
    };
    let message = GoalStatusArray { status_list: vec![status(2), status(GoalStatus::STATUS_ABORTED)] };
    // The identifier of the second goal follows directly (bytes), its stamp is at 48 (numbers of four bytes).
    let expected = "02000000 0101010101010101 0101010101010101 03000000 04000000 02
        0101010101010101 0101010101010101 | 000000 | 03000000 04000000 06";
    is_on_the_wire(message, expected);
}

#[test]
fn axis_states_have_every_field_in_its_place() {
    let axis = AxisState {
        name: "x".to_owned(),
        state: AxisState::STANDSTILL,
        drive_state: 4,
        reference: 8,
        mode_of_operation: -1,
        enabled: true,
        homed: true,
        in_position: false,
        in_velocity: true,
        in_sync: false,
        warning: false,
        positive_limit: false,
        negative_limit: true,
        error_code: 10_001,
        command_position: 1.0,
        command_velocity: 2.0,
        command_acceleration: -1.0,
        position: 0.5,
        velocity: 4.0,
        effort: -0.5,
        following_error: 8.0,
        sync_error: -2.0,
        command_increments: 1,
        position_increments: -2,
        following_error_increments: 3,
        sync_error_increments: i64::MIN,
    };
    let message = AxisStates { header: header(1, 500, ""), cycle: 7, axes: vec![axis] };
    let expected = "01000000 f4010000 01000000 00 | 000000 | 0700000000000000 01000000
        02000000 78 00 | 01 04 08 ff | 01 01 00 01 00 00 00 01 | 0000 | 11270000 | 00000000
        000000000000f03f 0000000000000040 000000000000f0bf 000000000000e03f
        0000000000001040 000000000000e0bf 0000000000002040 00000000000000c0
        0100000000000000 feffffffffffffff 0300000000000000 0000000000000080";
    is_on_the_wire(message, expected);
}

#[test]
fn an_event_has_every_field_in_its_place() {
    let message = Event {
        header: header(0, 9, "f"),
        sequence: 1,
        cycle: 2,
        age_ns: 350_000,
        severity: Event::WARN,
        kind: "latch".to_owned(),
        source: "x".to_owned(),
        code: 0x10000,
        increments: -1,
        fraction: 0.5,
        value: 1.0,
        text: "ok".to_owned(),
    };
    let expected = "00000000 09000000 02000000 66 00 | 0000 | 0100000000000000 0200000000000000
        30570500 01 | 000000 | 06000000 6c 61 74 63 68 00 | 0000 | 02000000 78 00 | 0000 | 00000100
        ffffffffffffffff 000000000000e03f 000000000000f03f 03000000 6f 6b 00";
    is_on_the_wire(message, expected);
}

#[test]
fn inputs_have_every_array_in_its_place() {
    let message = CycleInputs {
        cycle: 5,
        missed: 1,
        digital: vec![3],
        analog: vec![],
        encoder_count: vec![-1],
        encoder_epoch: vec![2],
        encoder_valid: vec![true],
        encoder_has_index: vec![true],
        encoder_index: vec![-2],
        drive_count: vec![7],
        drive_epoch: vec![0],
        drive_velocity: vec![1.0],
        drive_effort: vec![0.5],
        drive_status: vec![0x0627],
        drive_mode: vec![8],
        drive_fault: vec![0],
        drive_online: vec![true],
        drive_fresh: vec![false],
        drive_inputs: vec![5],
        drive_has_index: vec![false],
        drive_index: vec![0],
        latch_object: vec!["m".to_owned()],
        latch_edge: vec![CycleInputs::RISING],
        latch_has_age: vec![true],
        latch_age_ns: vec![350_000],
        latch_has_position: vec![false],
        latch_position: vec![0],
        latches_lost: 4,
        drive_bus: vec![CycleInputs::OFF],
        drive_has_emergency: vec![true],
        drive_emergency: vec![0x0504_0302_0111_8130],
        drive_unacknowledged: vec![true],
    };
    let expected = "0500000000000000 01000000 01000000 0300000000000000 00000000
        01000000 ffffffffffffffff 01000000 02000000 01000000 01 | 000000
        01000000 01 | 000000 | 01000000 | 00000000 | feffffffffffffff
        01000000 | 00000000 | 0700000000000000 01000000 00000000 01000000 | 00000000 | 000000000000f03f
        01000000 | 00000000 | 000000000000e03f 01000000 2706 | 0000 | 01000000 08 | 000000 | 01000000 0000 | 0000
        01000000 01 | 000000 | 01000000 00 | 000000 | 01000000 05000000
        01000000 00 | 000000 | 01000000 | 00000000 | 0000000000000000 | 01000000 02000000 6d 00 | 0000
        01000000 01 | 000000 | 01000000 01 | 000000 | 01000000 30570500 01000000 00 | 000000
        01000000 | 0000000000000000 04000000
        01000000 02 | 000000 | 01000000 01 | 000000 | 01000000 3081110102030405 01000000 01";
    is_on_the_wire(message, expected);
}
