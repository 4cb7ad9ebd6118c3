//! Laws of the encoding, for every message, request, response, goal, result and feedback.

use std::fmt::Debug;

use byteorder::BigEndian;
use proptest::prelude::*;

use super::any_value::any_value;
use crate::cdr::{Endian, MAX_PADDING, Problem, decode, decode_with_header, encode, encode_with_header};
use crate::{Action, FeedbackMessage, GetResultResponse, Message, SendGoalRequest};

/// An encoded value decodes to the same value, in both byte orders, with and without header.
fn comes_back<T: Message>(bytes: &[u8]) {
    let value = any_value::<T>(bytes);
    let little = encode(&value);
    assert_eq!(decode::<T>(&little, Endian::Little).as_ref(), Ok(&value));
    let big = cdr_encoding::to_vec::<T, BigEndian>(&value).unwrap();
    assert_eq!(decode::<T>(&big, Endian::Big).as_ref(), Ok(&value));
    let with_header = encode_with_header(&value);
    assert_eq!(with_header, [&[0, 1, 0, 0], little.as_slice()].concat());
    assert_eq!(decode_with_header::<T>(&with_header), Ok(value));
}

/// No byte may be missing; up to three may follow.
fn checks_length<T: Message>(bytes: &[u8]) {
    let value = any_value::<T>(bytes);
    let mut good = encode(&value);
    for length in 0..good.len() {
        let error = decode::<T>(&good[..length], Endian::Little).unwrap_err();
        assert_eq!(error.type_name, T::NAME);
        assert!(matches!(error.problem, Problem::TooShort { .. } | Problem::SequenceLength { .. }), "{error}");
    }
    for extra in 1..=MAX_PADDING + 2 {
        good.push(0xa5);
        let decoded = decode::<T>(&good, Endian::Little);
        match extra {
            0..=MAX_PADDING => assert_eq!(decoded.as_ref(), Ok(&value)),
            left => assert_eq!(decoded.unwrap_err().problem, Problem::LeftOver { left }),
        }
    }
}

/// Any bytes are either rejected or are a value that is encoded as it was read.
fn decodes_or_rejects<T: Message>(bytes: &[u8]) {
    for endian in [Endian::Little, Endian::Big] {
        if let Ok(value) = decode::<T>(bytes, endian) {
            let again = encode(&value);
            // Compared as bytes, because NaN may be in it.
            assert_eq!(encode(&decode::<T>(&again, Endian::Little).unwrap()), again);
            assert!(again.len() <= bytes.len() && again.len() + MAX_PADDING >= bytes.len());
        }
    }
}

/// A valid value with one byte changed.
fn survives_a_changed_byte<T: Message>(bytes: &[u8], place: usize, change: u8) {
    let mut changed = encode(&any_value::<T>(bytes));
    let place = place % changed.len();
    changed[place] ^= change;
    decodes_or_rejects::<T>(&changed);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_value_round_trips(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        macro_rules! call { ($type:ty) => { comes_back::<$type>(&bytes) } }
        for_every_struct!(call);
    }

    #[test]
    fn every_struct_checks_its_length(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        macro_rules! call { ($type:ty) => { checks_length::<$type>(&bytes) } }
        for_every_struct!(call);
    }

    #[test]
    fn no_bytes_make_it_panic(
        bytes in prop::collection::vec(prop_oneof![Just(0), Just(1), Just(2), any::<u8>()], 0..300),
    ) {
        macro_rules! call { ($type:ty) => { decodes_or_rejects::<$type>(&bytes) } }
        for_every_struct!(call);
    }

    #[test]
    fn no_changed_byte_makes_it_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..200), place in any::<usize>(), change in 1..=u8::MAX,
    ) {
        macro_rules! call { ($type:ty) => { survives_a_changed_byte::<$type>(&bytes, place, change) } }
        for_every_struct!(call);
    }
}

fn parts_come_back<A: Action>() {
    fn comes_back<T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + Debug>(value: T) {
        assert_eq!(decode::<T>(&encode(&value), Endian::Little), Ok(value));
    }
    let bytes: Vec<u8> = (1..200).collect();
    let goal_id = any_value(&bytes);
    comes_back(SendGoalRequest { goal_id, goal: any_value::<A::Goal>(&bytes) });
    comes_back(GetResultResponse { status: 4, result: any_value::<A::Result>(&bytes) });
    let goal_id = any_value(&bytes);
    comes_back(FeedbackMessage { goal_id, feedback: any_value::<A::Feedback>(&bytes) });
}

#[test]
fn the_parts_of_every_action_come_back() {
    parts_come_back::<crate::action::MoveAxis>();
    parts_come_back::<crate::action::HomeAxis>();
    parts_come_back::<crate::action::Synchronize>();
}
