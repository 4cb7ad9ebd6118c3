//! Properties that must hold for every request of any client.

use std::fmt::Debug;

use bytes::Bytes;
use lineshaft_msgs::action::{HomeAxisGoal, MoveAxisGoal, PhaseGoal, ProbeAxisGoal, RunFunctionGoal, SynchronizeGoal};
use lineshaft_msgs::cdr;
use lineshaft_msgs::foreign::action_msgs::srv::CancelGoalRequest;
use lineshaft_msgs::foreign::rcl_interfaces::srv::{
    DescribeParametersRequest, ListParametersRequest, SetParametersRequest,
};
use lineshaft_msgs::foreign::std_srvs::srv::TriggerRequest;
use lineshaft_msgs::srv::{
    AxesCommandRequest, ImportParametersRequest, RecordRequest, ResetParametersRequest, SdoReadRequest,
    SdoWriteRequest, SetPositionRequest, VocabularyRequest,
};
use lineshaft_msgs::{GetResultRequest, SendGoalRequest};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{DdsClient, HEADER, Related, client};
use crate::fuzz::LONGEST_SENTENCE;
use crate::link::protocol::{Sample, SampleId};
use crate::side::dds::Taken;
use crate::side::guid::Guid;

/// Checks the properties. The first two bytes select client and service; the others are the sample.
///
/// # Panics
/// A property does not hold.
pub fn any_request(bytes: &[u8]) {
    let [form, kind, bytes @ ..] = bytes else { return };
    let request = request(*form, bytes);
    match kind % 19 {
        0 => law::<AxesCommandRequest>(&request),
        1 => law::<SetPositionRequest>(&request),
        2 => law::<VocabularyRequest>(&request),
        3 => law::<RecordRequest>(&request),
        4 => law::<ImportParametersRequest>(&request),
        5 => law::<ResetParametersRequest>(&request),
        6 => law::<SetParametersRequest>(&request),
        7 => law::<DescribeParametersRequest>(&request),
        8 => law::<ListParametersRequest>(&request),
        9 => law::<CancelGoalRequest>(&request),
        10 => law::<GetResultRequest>(&request),
        11 => law::<SendGoalRequest<MoveAxisGoal>>(&request),
        12 => law::<SendGoalRequest<ProbeAxisGoal>>(&request),
        13 => law::<SendGoalRequest<SynchronizeGoal>>(&request),
        14 => law::<SdoReadRequest>(&request),
        15 => law::<SdoWriteRequest>(&request),
        16 => law::<SendGoalRequest<PhaseGoal>>(&request),
        18 => law::<SendGoalRequest<RunFunctionGoal>>(&request),
        _ => {
            law::<SendGoalRequest<HomeAxisGoal>>(&request);
            law::<TriggerRequest>(&request);
        }
    }
}

fn request(form: u8, bytes: &[u8]) -> Taken {
    let vendor = [[0x01, 0x10], [0x01, 0x0f], [0x01, 0x12]][usize::from(form % 3)];
    let guid = |kind| Guid([vendor[0], vendor[1], 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 1, kind]);
    let related = match form >> 2 & 3 {
        0 => Some(Related { guid: guid(4), number: None }),
        1 => Some(Related { guid: guid(3), number: Some(i64::from(form)) }),
        _ => None,
    };
    Taken {
        id: SampleId { writer: guid(3), number: 42 },
        related,
        written: None,
        is_big_endian: form & 0x80 != 0,
        bytes: bytes.to_vec().into(),
    }
}

/// Returns the request as the program receives it.
pub(super) fn received(request: &Taken) -> Sample {
    let (caller, header) = client(request);
    Sample { caller, header, is_big_endian: request.is_big_endian, bytes: request.bytes.clone(), ..Sample::default() }
}

/// A request is refused with a short message, or decoded completely, in the form of its client. One from Cyclone DDS fits no other form.
fn law<Q: DeserializeOwned + Serialize + Debug>(request: &Taken) {
    let sample = received(request);
    let message = match sample.decode::<Q>() {
        Ok(message) => message,
        Err(refusal) => return assert!(refusal.len() < LONGEST_SENTENCE, "{refusal}"),
    };
    let client = DdsClient::read(&sample.caller).expect("a request that can be read identifies its client");
    let header = client.reply(Bytes::from_static(&[0])).len() - 1;
    assert!(header == 0 || header == HEADER);
    let (used, given) = (header + cdr::encode(&message).len(), request.bytes.len());
    assert!(used <= given && given <= used + cdr::MAX_PADDING, "{used} of {given} bytes are {message:?}");
    if request.related.is_none() {
        let fits = |bytes: &[u8]| cdr::decode::<Q>(bytes, request.endian()).is_ok();
        let (plain, headed) = (fits(&request.bytes), request.bytes.get(HEADER..).is_some_and(fits));
        if request.id.writer.is_cyclone() {
            assert!(headed && !plain, "{message:?} can be read in both forms");
        } else {
            assert!(plain, "{message:?} has no plain form");
        }
        assert_eq!(request.id.writer.is_cyclone(), header == HEADER);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lineshaft_msgs::foreign::unique_identifier_msgs::msg::UUID;
    use proptest::prelude::*;

    /// Generates typical bytes of messages: small numbers, letters, zeros.
    fn bytes(most: usize) -> impl Strategy<Value = Vec<u8>> {
        prop::collection::vec(prop_oneof![4 => Just(0), 2 => 0..4_u8, 1 => Just(b'x'), 1 => any::<u8>()], 0..most)
    }

    fn good() -> impl Strategy<Value = (u8, Vec<u8>)> {
        let axes = prop::collection::vec("[a-z]{0,5}", 0..4);
        let axes = axes.prop_map(|axes| (0, cdr::encode(&AxesCommandRequest { axes })));
        let position = ("[a-z]{0,9}", any::<f64>(), any::<u8>());
        let position = position
            .prop_map(|(axis, position, units)| (1, cdr::encode(&SetPositionRequest { axis, position, units })));
        let goal = (any::<[u8; 16]>(), "[a-z]{0,9}", any::<f64>());
        let goal = goal.prop_map(|(uuid, axis, position)| {
            let goal = MoveAxisGoal { axis, position, ..MoveAxisGoal::default() };
            (11, cdr::encode(&SendGoalRequest { goal_id: UUID { uuid }, goal }))
        });
        let result = any::<[u8; 16]>().prop_map(|uuid| (10, cdr::encode(&GetResultRequest { goal_id: UUID { uuid } })));
        prop_oneof![axes, position, goal, result]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn any_bytes_are_refused_or_understood_in_one_way(form: u8, kind: u8, bytes in bytes(200)) {
            any_request(&[&[form, kind], bytes.as_slice()].concat());
        }

        /// Valid requests with or without the header of the other RMW, longer, shorter, and with a wrong length.
        #[test]
        fn good_requests_are_so_when_they_are_damaged(
            form: u8, (kind, good) in good(), headed: bool, longer in 0..20_usize, shorter in 0..20_usize,
            lie in prop::option::of((any::<prop::sample::Index>(), any::<u32>())),
        ) {
            let mut bytes = if headed { vec![7; HEADER] } else { Vec::new() };
            bytes.extend(good);
            bytes.resize(bytes.len() + longer, 0);
            bytes.truncate(bytes.len().saturating_sub(shorter));
            if let Some((place, length)) = lie
                && bytes.len() >= 4
            {
                let place = place.index(bytes.len() / 4) * 4;
                bytes[place..place + 4].copy_from_slice(&length.to_le_bytes());
            }
            any_request(&[&[form, kind], bytes.as_slice()].concat());
        }

        /// Valid requests are decoded in the form of each client, so that the property above is not trivial.
        #[test]
        fn good_requests_are_understood((_, good) in good()) {
            let fast = request(1, &good);
            prop_assert!(fast.related.is_some());
            let sample = received(&fast);
            let known = sample.decode::<AxesCommandRequest>().is_ok() || sample.decode::<SetPositionRequest>().is_ok()
                || sample.decode::<SendGoalRequest<MoveAxisGoal>>().is_ok() || sample.decode::<GetResultRequest>().is_ok();
            prop_assert!(known);
        }
    }

    /// A goal with a name of 10 MB, in each form, needs only memory of its own length, and its message is not longer than others.
    #[test]
    fn ten_megabytes_are_refused_shortly() {
        let goal = MoveAxisGoal { axis: "x".repeat(10_000_000), ..MoveAxisGoal::default() };
        let mut bytes = cdr::encode(&SendGoalRequest { goal_id: UUID::default(), goal });
        bytes.resize(bytes.len() + 4, 0);
        for form in [0, 1, 8, 9, 10, 0x80] {
            any_request(&[&[form, 11], bytes.as_slice()].concat());
            any_request(&[&[form, 0], bytes.as_slice()].concat());
        }
    }
}
