use lineshaft_msgs::cdr::encode;
use lineshaft_msgs::foreign::controller_manager_msgs::srv::SwitchControllerRequest;
use lineshaft_msgs::foreign::rcl_interfaces::srv::{
    DescribeParametersRequest, GetLoggerLevelsRequest, GetParameterTypesRequest, GetParametersRequest,
    ListParametersRequest,
};
use lineshaft_msgs::foreign::std_srvs::srv::{TriggerRequest, TriggerResponse};
use lineshaft_msgs::srv::{
    AxesCommandRequest, ExportParametersRequest, ResetParametersRequest, SetMemoryRequest, SetOutputRequest,
    SetPositionRequest,
};
use lineshaft_msgs::{GetResultRequest, foreign::unique_identifier_msgs::msg::UUID};

use super::*;
use crate::link::guid::Guid;

const CYCLONE: [u8; 2] = [0x01, 0x10];
const FAST: [u8; 2] = [0x01, 0x0f];
const OTHER: [u8; 2] = [0x01, 0x12];

fn guid(vendor: [u8; 2], kind: u8) -> Guid {
    Guid([vendor[0], vendor[1], 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 1, kind])
}

fn sample(vendor: [u8; 2], bytes: Vec<u8>) -> Sample {
    let id = SampleId { writer: guid(vendor, 3), number: 42 };
    Sample { id, related: None, is_stale: false, written: None, came_ns: 0, is_big_endian: false, bytes: bytes.into() }
}

/// Returns a request as rmw_fastrtps sends it.
fn fast(bytes: Vec<u8>) -> Sample {
    Sample { related: Some(Related { guid: guid(FAST, 4), number: None }), ..sample(FAST, bytes) }
}

/// Returns a request as rmw_cyclonedds sends it.
fn cyclone(request: &impl Serialize) -> Sample {
    sample(CYCLONE, with_header(request))
}

fn with_header(request: &impl Serialize) -> Vec<u8> {
    let mut bytes = encode(&Header { client: 0x8877_6655_4433_2211, sequence: 9 });
    assert_eq!(bytes.len(), HEADER);
    bytes.extend(encode(request));
    bytes
}

fn axes(axes: &[&str]) -> AxesCommandRequest {
    AxesCommandRequest { axes: axes.iter().map(|axis| (*axis).to_owned()).collect() }
}

fn refusal<Q: DeserializeOwned + std::fmt::Debug>(sample: &Sample) -> Refusal {
    read::<Q>(sample).unwrap_err()
}

#[test]
fn rmw_fastrtps_is_answered_by_its_reader_and_the_number_of_the_sample() {
    let (caller, message) = read::<AxesCommandRequest>(&fast(encode(&axes(&["x"])))).unwrap();
    assert_eq!(message, axes(&["x"]));
    assert_eq!(caller.place, Place::Reader(guid(FAST, 4)));
    assert_eq!(caller.answers, SampleId { writer: guid(FAST, 4), number: 42 });
    let response = TriggerResponse { success: true, message: "done".to_owned() };
    assert_eq!(caller.reply(&response), encode(&response));
}

#[test]
fn an_identity_with_a_number_and_a_writer_is_kept() {
    let related = Some(Related { guid: guid(FAST, 3), number: Some(7) });
    let sample = Sample { related, ..sample(FAST, encode(&axes(&[]))) };
    let (caller, _) = read::<AxesCommandRequest>(&sample).unwrap();
    assert_eq!(caller.answers, SampleId { writer: guid(FAST, 3), number: 7 });
    assert_eq!(caller.place, Place::SameParticipant(sample.id.writer), "a writer reads no reply");
}

#[test]
fn rmw_cyclonedds_gets_its_header_back() {
    let (caller, message) = read::<AxesCommandRequest>(&cyclone(&axes(&["x", "turret"]))).unwrap();
    assert_eq!(message, axes(&["x", "turret"]));
    assert_eq!(caller.place, Place::SameParticipant(guid(CYCLONE, 3)));
    let reply = caller.reply(&TriggerResponse { success: true, message: String::new() });
    assert_eq!(reply[..HEADER], cyclone(&axes(&[])).bytes[..HEADER]);
    assert_eq!(reply[HEADER..], encode(&TriggerResponse { success: true, message: String::new() }));
}

#[test]
fn a_big_endian_caller_gets_its_header_back_in_little_endian() {
    let mut bytes = 5u64.to_be_bytes().to_vec();
    bytes.extend(6i64.to_be_bytes());
    bytes.extend([0, 0, 0, 1, 0, 0, 0, 2, b'x', 0]);
    let sample = Sample { is_big_endian: true, ..sample(CYCLONE, bytes) };
    let (caller, message) = read::<AxesCommandRequest>(&sample).unwrap();
    assert_eq!(message, axes(&["x"]));
    assert_eq!(caller.reply(&0u8), encode(&(5u64, 6i64, 0u8)));
}

#[test]
fn clients_that_follow_dds_rpc_are_answered_by_their_sample() {
    let sample = sample(OTHER, encode(&axes(&["x"])));
    let (caller, message) = read::<AxesCommandRequest>(&sample).unwrap();
    assert_eq!((message, caller.answers), (axes(&["x"]), sample.id));
    assert_eq!(caller.reply(&7u8), [7]);
}

#[test]
fn three_bytes_of_padding_are_allowed() {
    for form in [fast(encode(&axes(&["x"]))), cyclone(&axes(&["x"])), sample(OTHER, encode(&axes(&["x"])))] {
        let longer = |by: usize| {
            let mut bytes = form.bytes.to_vec();
            bytes.extend(vec![0; by]);
            Sample { bytes: bytes.into(), ..form.clone() }
        };
        assert!(read::<AxesCommandRequest>(&longer(3)).is_ok());
        assert!(matches!(refusal::<AxesCommandRequest>(&longer(4)), Refusal::Decode(_)));
    }
}

#[test]
fn a_request_in_the_form_of_the_other_rmw_is_refused() {
    // The header of 16 bytes has the length of a goal ID and of two f64, so these requests could be confused.
    let id = GetResultRequest { goal_id: UUID { uuid: [7; 16] } };
    let position = SetPositionRequest { axis: "x".to_owned(), position: 1.5, units: 0 };
    assert!(read::<GetResultRequest>(&cyclone(&id)).is_ok() && read::<GetResultRequest>(&fast(encode(&id))).is_ok());

    assert!(matches!(refusal::<GetResultRequest>(&fast(with_header(&id))), Refusal::Decode(_)));
    assert!(matches!(refusal::<GetResultRequest>(&sample(OTHER, with_header(&id))), Refusal::Decode(_)));
    assert!(matches!(refusal::<GetResultRequest>(&sample(CYCLONE, encode(&id))), Refusal::Decode(_)));
    assert!(matches!(refusal::<(f64, f64)>(&fast(with_header(&(1.5, -2.5)))), Refusal::Decode(_)));
    assert!(matches!(refusal::<(f64, f64)>(&sample(CYCLONE, encode(&(1.5, -2.5)))), Refusal::Decode(_)));
    assert!(matches!(refusal::<SetPositionRequest>(&fast(with_header(&position))), Refusal::Decode(_)));
    assert!(matches!(refusal::<SetPositionRequest>(&sample(CYCLONE, encode(&position))), Refusal::Decode(_)));
    assert!(matches!(refusal::<TriggerRequest>(&fast(with_header(&0u8))), Refusal::Decode(_)));
    assert_eq!(refusal::<TriggerRequest>(&sample(CYCLONE, vec![0])), Refusal::NoHeader { length: 1 });
}

#[test]
fn request_from_cyclone_dds_that_fits_both_forms_is_refused_unless_it_is_marked() {
    // Without header: two empty names. With header: the rest is an empty list, which would mean all axes.
    let mut both = encode(&axes(&["", ""]));
    both.extend([0; 3]);
    assert_eq!(both.len(), 20);
    let cyclone = sample(CYCLONE, both.clone());
    assert_eq!(refusal::<AxesCommandRequest>(&cyclone), Refusal::Ambiguous { length: 20 });
    // Its client may be plain: the 16 bytes before a refusal would read as `success: true`, because the first one is not 0.
    assert!(is_plain::<AxesCommandRequest>(&cyclone) && both[0] != 0);
    for other in [sample(OTHER, both.clone()), fast(both)] {
        assert_eq!(read::<AxesCommandRequest>(&other).unwrap().1, axes(&["", ""]));
    }
}

#[test]
fn refused_request_of_a_plain_client_on_cyclone_dds_is_told_from_one_of_rmw_cyclonedds() {
    let plain = sample(CYCLONE, encode(&axes(&["x", "turret"])));
    assert!(client(&plain).is_some(), "its first 16 bytes look like a header");
    assert!(read::<AxesCommandRequest>(&plain).is_err() && is_plain::<AxesCommandRequest>(&plain));
    let damaged = sample(CYCLONE, [with_header(&axes(&["x"])), vec![0; 8]].concat());
    assert!(read::<AxesCommandRequest>(&damaged).is_err() && !is_plain::<AxesCommandRequest>(&damaged));
    // The client of a marked request, and of a request from another DDS library, is known.
    let bytes = || encode(&axes(&["x"]));
    assert!(
        !is_plain::<AxesCommandRequest>(&fast(bytes())) && !is_plain::<AxesCommandRequest>(&sample(OTHER, bytes()))
    );
}

#[test]
fn client_of_a_request_that_cannot_be_read_is_known() {
    let bad = [encode(&axes(&["x"])), vec![0; 8]].concat();
    let (fast, other) = (fast(bad.clone()), sample(OTHER, bad));
    assert!(read::<AxesCommandRequest>(&fast).is_err() && read::<AxesCommandRequest>(&other).is_err());
    assert_eq!(client(&fast).unwrap().place, Place::Reader(guid(FAST, 4)));
    assert_eq!(client(&other).unwrap().answers, other.id);
    assert_eq!(client(&sample(CYCLONE, vec![0; HEADER - 1])), None);
}

/// Checks that a request is read from each kind of client, which pads it to a multiple of 4 bytes.
fn each_client_is_understood<Q: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(request: &Q) {
    let padded = |mut bytes: Vec<u8>| {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    };
    let plain = padded(encode(request));
    for sample in [sample(OTHER, plain.clone()), fast(plain), sample(CYCLONE, padded(with_header(request)))] {
        assert_eq!(read::<Q>(&sample).as_ref().map(|(_, message)| message), Ok(request), "{:?}", sample.id);
    }
}

/// All services with a list of names. A single name of 8 characters ends in zeros, which are an empty list after the header of
/// rmw_cyclonedds.
#[test]
fn lists_of_names_of_any_length_are_read_from_each_client() {
    for (length, count) in (1..=32).flat_map(|length| [(length, 1), (length, 2), (length, 3)]) {
        let names = || vec!["x".repeat(length); count];
        each_client_is_understood(&AxesCommandRequest { axes: names() });
        each_client_is_understood(&ResetParametersRequest { axes: names(), layer: 0 });
        each_client_is_understood(&ExportParametersRequest { axes: names(), which: 0 });
        each_client_is_understood(&SetOutputRequest { outputs: names(), values: vec![1.0; count] });
        each_client_is_understood(&SetMemoryRequest { cells: names(), values: vec![0.0; count] });
        each_client_is_understood(&GetParametersRequest { names: names() });
        each_client_is_understood(&GetParameterTypesRequest { names: names() });
        each_client_is_understood(&DescribeParametersRequest { names: names() });
        each_client_is_understood(&ListParametersRequest { prefixes: names(), depth: 0 });
        each_client_is_understood(&GetLoggerLevelsRequest { names: names() });
        let (activate_controllers, deactivate_controllers) = (names(), Vec::new());
        let both = SwitchControllerRequest { activate_controllers, deactivate_controllers, ..Default::default() };
        each_client_is_understood(&both);
    }
}
