//! Wrong lengths in every message, request, response, goal, result and feedback.

use std::fs;

use super::any_value::any_value;
use crate::Message;
use crate::cdr::{Endian, decode, encode};

/// Maximum length of the message about invalid bytes (bytes).
const LONGEST_SENTENCE: usize = 600;

/// Replaces each word of a valid value in turn by a length of 4 GiB, of 2 GiB, and of the number of bytes.
fn replace_lengths<T: Message>() {
    let good = encode(&any_value::<T>(&[161; 300]));
    for place in (0..good.len().saturating_sub(3)).step_by(4) {
        for length in [u32::MAX, i32::MAX as u32, good.len() as u32] {
            let mut bytes = good.clone();
            bytes[place..place + 4].copy_from_slice(&length.to_le_bytes());
            for endian in [Endian::Little, Endian::Big] {
                if let Err(error) = decode::<T>(&bytes, endian) {
                    let sentence = error.to_string();
                    assert!(sentence.len() < LONGEST_SENTENCE, "{sentence}");
                }
            }
        }
    }
}

/// Returns the peak of memory that this process has requested (kB), including memory that it did not access.
fn requested_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:")).expect("a line of every process");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}

#[test]
fn wrong_length_causes_no_large_allocation() {
    let before = requested_memory();
    macro_rules! call {
        ($type:ty) => {
            replace_lengths::<$type>()
        };
    }
    for_every_struct!(call);
    let after = requested_memory();
    // The other tests of this process request some MB; a single wrong length that is used would be at least 2 GiB.
    assert!(after - before < 1_000_000, "{before} kB before, {after} kB after");
}

#[test]
fn error_message_of_ten_megabyte_text_is_short() {
    use crate::srv::AxesCommandRequest;
    let mut bytes = encode(&AxesCommandRequest { axes: vec!["x".to_owned(), "y".repeat(10_000_000)] });
    let last = bytes.len() - 1;
    bytes[last] = b'y';
    let error = decode::<AxesCommandRequest>(&bytes, Endian::Little).unwrap_err();
    assert_eq!((error.field.as_str(), error.to_string().len() < 150), ("axes[1]", true), "{error}");
}
