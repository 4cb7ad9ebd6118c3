//! Tests cycles and times.

use super::super::moment::{self, Moment};
use super::*;
use crate::document::Document;

fn cycles(text: &str, cycle_ns: u64) -> Option<u64> {
    let document = Document::parse("t.yaml", text);
    let cycles = moment::cycles(&document.root("t").unwrap(), cycle_ns);
    assert_eq!(cycles.is_none(), !document.problems().is_empty());
    cycles
}

#[test]
fn a_time_is_the_first_cycle_that_is_not_before_it() {
    for (text, cycle_ns, expected) in [
        ("0", 1_000_000, 0),
        ("17", 3_000_000, 17),
        ("1e3", 1_000_000, 1000),
        ("0 s", 1_000_000, 0),
        ("3 s", 1_000_000, 3000),
        ("9 ms", 3_000_000, 3),
        ("10 ms", 3_000_000, 4),
        ("1 ns", 20_000_000, 1),
        ("0.125 ms", 125_000, 1),
        ("0.1250001 ms", 125_000, 2),
        ("1 min", 1_000_000, 60_000),
    ] {
        let expected = if text == "0.1250001 ms" { None } else { Some(expected) };
        assert_eq!(cycles(text, cycle_ns), expected, "{text} in cycles of {cycle_ns} ns");
    }
}

#[test]
fn end_is_the_last_cycle_from_everywhere() {
    assert_eq!(Moment::End.after(40, 99), 99);
    assert_eq!(Moment::Cycle(40).after(40, 99), 80);
    assert_eq!(Moment::Cycle(i64::MAX).after(u64::MAX, 99), u64::MAX);
    assert_eq!((Moment::Cycle(-40).from(40, 99), Moment::Cycle(-41).from(40, 99)), (Some(0), None));
}

#[test]
fn times_of_cycles_are_exact_decimals() {
    for (cycle, cycle_ns, expected) in [
        (0, 1_000_000, "0"),
        (1, 1_000_000, "0.001"),
        (1000, 1_000_000, "1"),
        (1500, 1_000_000, "1.5"),
        (1, 125_000, "0.000125"),
        (1_000_000_000_000, 20_000_000, "20000000000"),
        (3, 333_333, "0.000999999"),
    ] {
        assert_eq!(moment::seconds(cycle, cycle_ns), expected);
    }
}

#[test]
fn a_length_is_a_time_or_a_number_of_cycles() {
    for (length, expected) in [("for: 3 s", 3000), ("for: 2.5 ms", 3), ("for: 20", 20), ("cycles: 20", 20)] {
        assert_eq!(scenario(&format!("scenario: s\n{length}")).cycles(), expected, "{length}");
    }
    for (length, expected) in [
        ("cycles: 0", "2:9: cycles is 0; 1..1000000000000 is allowed\n"),
        ("for: 0 s", "2:6: for is 0; at least one cycle is allowed\n"),
        ("for: 5 mm", "2:6: for: `5 mm` is a length; a time such as `5 s` is expected\n"),
        ("for: 1 s\ncycles: 7", "3:9: for and cycles stand side by side; one of them is expected\n"),
        ("every: 1", "1:1: a scenario has no length; `for: 3 s` or `cycles: 3000` is expected\n"),
        (
            "for: 1e12 s",
            "2:6: for: `1000000000000 s` is not a whole number of nanoseconds; times are whole nanoseconds up to 292 years\n",
        ),
    ] {
        assert_eq!(problems(&format!("scenario: s\n{length}")), expected);
    }
}

#[test]
fn what_is_no_moment_is_refused() {
    let at = |text: &str| problem("steps", &format!("{{at: ^{text}, do: {{halt: {{}}}}}}"));
    assert_eq!(at("0.5"), "at is 0.5; a whole number of cycles, or a time with its unit is allowed, write `0.5 s`");
    assert_eq!(at("-1"), "at is -1; 0..1000000000000 is allowed");
    assert_eq!(at("-1 ms"), "at is `-1 ms`; 0 and above is allowed");
    assert_eq!(at("100"), "at is cycle 100 (0.1 s); the scenario ends with cycle 99 (0.099 s)");
    assert_eq!(at("1 s"), "at is cycle 1000 (1 s); the scenario ends with cycle 99 (0.099 s)");
    assert_eq!(at("soon"), "at: `soon` is not a number, a time such as `1 s` is expected");
}
