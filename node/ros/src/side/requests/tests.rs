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
use serde::de::DeserializeOwned;

use super::laws::received;
use super::*;

const CYCLONE: [u8; 2] = [0x01, 0x10];
const FAST: [u8; 2] = [0x01, 0x0f];
const OTHER: [u8; 2] = [0x01, 0x12];

fn guid(vendor: [u8; 2], kind: u8) -> Guid {
    Guid([vendor[0], vendor[1], 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 1, kind])
}

fn request(vendor: [u8; 2], bytes: Vec<u8>) -> Taken {
    let id = SampleId { writer: guid(vendor, 3), number: 42 };
    Taken { id, related: None, written: None, is_big_endian: false, bytes: bytes.into() }
}

/// Returns a request as rmw_fastrtps sends it.
fn fast(bytes: Vec<u8>) -> Taken {
    Taken { related: Some(Related { guid: guid(FAST, 4), number: None }), ..request(FAST, bytes) }
}

/// Returns a request as rmw_cyclonedds sends it.
fn cyclone(message: &impl Serialize) -> Taken {
    request(CYCLONE, with_header(message))
}

fn with_header(message: &impl Serialize) -> Vec<u8> {
    let mut bytes = encode(&CycloneHeader { client: 0x8877_6655_4433_2211, sequence: 9 });
    assert_eq!(bytes.len(), HEADER);
    bytes.extend(encode(message));
    bytes
}

fn axes(axes: &[&str]) -> AxesCommandRequest {
    AxesCommandRequest { axes: axes.iter().map(|axis| (*axis).to_owned()).collect() }
}

/// Returns the client of a request, if it is known.
fn client_of(request: &Taken) -> Option<DdsClient> {
    DdsClient::read(&client(request).0)
}

fn read<Q: DeserializeOwned>(request: &Taken) -> Result<(DdsClient, Q), String> {
    let message = received(request).decode()?;
    Ok((client_of(request).expect("a known client"), message))
}

fn reply(client: &DdsClient, response: &impl Serialize) -> Vec<u8> {
    client.reply(encode(response).into()).into()
}

fn refusal<Q: DeserializeOwned + std::fmt::Debug>(request: &Taken) -> String {
    read::<Q>(request).unwrap_err()
}

fn may_be_plain(request: &Taken) -> bool {
    received(request).may_be_plain::<AxesCommandRequest>()
}

/// Whether the decoder has refused the message.
fn is_undecodable<Q: DeserializeOwned + std::fmt::Debug>(request: &Taken) -> bool {
    !refusal::<Q>(request).contains("rmw_cyclonedds")
}

#[test]
fn rmw_fastrtps_is_answered_by_its_reader_and_the_number_of_the_sample() {
    let (client, message) = read::<AxesCommandRequest>(&fast(encode(&axes(&["x"])))).unwrap();
    assert_eq!(message, axes(&["x"]));
    assert_eq!(client.place, Place::Reader(guid(FAST, 4)));
    assert_eq!(client.answers, Some(SampleId { writer: guid(FAST, 4), number: 42 }));
    let response = TriggerResponse { success: true, message: "done".to_owned() };
    assert_eq!(reply(&client, &response), encode(&response));
}

#[test]
fn an_identity_with_a_number_and_a_writer_is_kept() {
    let related = Some(Related { guid: guid(FAST, 3), number: Some(7) });
    let request = Taken { related, ..request(FAST, encode(&axes(&[]))) };
    let (client, _) = read::<AxesCommandRequest>(&request).unwrap();
    assert_eq!(client.answers, Some(SampleId { writer: guid(FAST, 3), number: 7 }));
    assert_eq!(client.place, Place::SameParticipant(request.id.writer), "a writer reads no reply");
}

#[test]
fn rmw_cyclonedds_gets_its_header_back() {
    let (client, message) = read::<AxesCommandRequest>(&cyclone(&axes(&["x", "turret"]))).unwrap();
    assert_eq!(message, axes(&["x", "turret"]));
    assert_eq!((client.place, client.answers), (Place::SameParticipant(guid(CYCLONE, 3)), None));
    let reply = reply(&client, &TriggerResponse { success: true, message: String::new() });
    assert_eq!(reply[..HEADER], cyclone(&axes(&[])).bytes[..HEADER]);
    assert_eq!(reply[HEADER..], encode(&TriggerResponse { success: true, message: String::new() }));
}

#[test]
fn a_big_endian_caller_gets_its_header_back_in_little_endian() {
    let mut bytes = 5u64.to_be_bytes().to_vec();
    bytes.extend(6i64.to_be_bytes());
    bytes.extend([0, 0, 0, 1, 0, 0, 0, 2, b'x', 0]);
    let request = Taken { is_big_endian: true, ..request(CYCLONE, bytes) };
    let (client, message) = read::<AxesCommandRequest>(&request).unwrap();
    assert_eq!(message, axes(&["x"]));
    assert_eq!(reply(&client, &0u8), encode(&(5u64, 6i64, 0u8)));
}

#[test]
fn clients_that_follow_dds_rpc_are_answered_by_their_sample() {
    let request = request(OTHER, encode(&axes(&["x"])));
    let (client, message) = read::<AxesCommandRequest>(&request).unwrap();
    assert_eq!((message, client.answers), (axes(&["x"]), Some(request.id)));
    assert_eq!(reply(&client, &7u8), [7]);
}

#[test]
fn three_bytes_of_padding_are_allowed() {
    for form in [fast(encode(&axes(&["x"]))), cyclone(&axes(&["x"])), request(OTHER, encode(&axes(&["x"])))] {
        let longer = |by: usize| {
            let mut bytes = form.bytes.to_vec();
            bytes.extend(vec![0; by]);
            Taken { bytes: bytes.into(), ..form.clone() }
        };
        assert!(read::<AxesCommandRequest>(&longer(3)).is_ok());
        assert!(is_undecodable::<AxesCommandRequest>(&longer(4)));
    }
}

#[test]
fn a_request_in_the_form_of_the_other_rmw_is_refused() {
    // The header of 16 bytes has the length of a goal ID and of two f64, so these requests could be confused.
    let id = GetResultRequest { goal_id: UUID { uuid: [7; 16] } };
    let position = SetPositionRequest { axis: "x".to_owned(), position: 1.5, units: 0 };
    assert!(read::<GetResultRequest>(&cyclone(&id)).is_ok() && read::<GetResultRequest>(&fast(encode(&id))).is_ok());

    assert!(is_undecodable::<GetResultRequest>(&fast(with_header(&id))));
    assert!(is_undecodable::<GetResultRequest>(&request(OTHER, with_header(&id))));
    assert!(is_undecodable::<GetResultRequest>(&request(CYCLONE, encode(&id))));
    assert!(is_undecodable::<(f64, f64)>(&fast(with_header(&(1.5, -2.5)))));
    assert!(is_undecodable::<(f64, f64)>(&request(CYCLONE, encode(&(1.5, -2.5)))));
    assert!(is_undecodable::<SetPositionRequest>(&fast(with_header(&position))));
    assert!(is_undecodable::<SetPositionRequest>(&request(CYCLONE, encode(&position))));
    assert!(is_undecodable::<TriggerRequest>(&fast(with_header(&0u8))));
    let sentence = "1 bytes are too short for rmw_cyclonedds, whose header alone has 16";
    assert_eq!(refusal::<TriggerRequest>(&request(CYCLONE, vec![0])), sentence);
}

#[test]
fn request_from_cyclone_dds_that_fits_both_forms_is_refused_unless_it_is_marked() {
    // Without header: two empty names. With header: the rest is an empty list, which would mean all axes.
    let mut both = encode(&axes(&["", ""]));
    both.extend([0; 3]);
    assert_eq!(both.len(), 20);
    let cyclone = request(CYCLONE, both.clone());
    let sentence =
        "20 bytes can be read with and without rmw_cyclonedds' header of 16 bytes, and nothing shows which is right";
    assert_eq!(refusal::<AxesCommandRequest>(&cyclone), sentence);
    // Its client may be plain: the 16 bytes before a refusal would read as `success: true`, because the first one is not 0.
    assert!(may_be_plain(&cyclone) && both[0] != 0);
    for other in [request(OTHER, both.clone()), fast(both)] {
        assert_eq!(read::<AxesCommandRequest>(&other).unwrap().1, axes(&["", ""]));
    }
}

#[test]
fn refused_request_of_a_plain_client_on_cyclone_dds_is_told_from_one_of_rmw_cyclonedds() {
    let plain = request(CYCLONE, encode(&axes(&["x", "turret"])));
    assert!(client_of(&plain).is_some(), "its first 16 bytes look like a header");
    assert!(read::<AxesCommandRequest>(&plain).is_err() && may_be_plain(&plain));
    let damaged = request(CYCLONE, [with_header(&axes(&["x"])), vec![0; 8]].concat());
    assert!(read::<AxesCommandRequest>(&damaged).is_err() && !may_be_plain(&damaged));
    // The client of a marked request, and of a request from another DDS library, is known.
    let bytes = || encode(&axes(&["x"]));
    assert!(!may_be_plain(&fast(bytes())) && !may_be_plain(&request(OTHER, bytes())));
}

#[test]
fn client_of_a_request_that_cannot_be_read_is_known() {
    let bad = [encode(&axes(&["x"])), vec![0; 8]].concat();
    let (fast, other) = (fast(bad.clone()), request(OTHER, bad));
    assert!(is_undecodable::<AxesCommandRequest>(&fast) && is_undecodable::<AxesCommandRequest>(&other));
    assert_eq!(client_of(&fast).unwrap().place, Place::Reader(guid(FAST, 4)));
    assert_eq!(client_of(&other).unwrap().answers, Some(other.id));
    let short = received(&request(CYCLONE, vec![0; HEADER - 1]));
    assert_eq!(short.caller, Caller::default());
}

/// Checks that a request is read from each kind of client, which pads it to a multiple of 4 bytes.
fn each_client_is_understood<Q: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(message: &Q) {
    let padded = |mut bytes: Vec<u8>| {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    };
    let plain = padded(encode(message));
    for request in [request(OTHER, plain.clone()), fast(plain), request(CYCLONE, padded(with_header(message)))] {
        assert_eq!(received(&request).decode::<Q>().as_ref(), Ok(message), "{:?}", request.id);
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
