//! Tests latches that a scenario injects, and latches passed by a driven count.

use super::*;

/// 40 inc in each cycle: from 360 to 400 in cycle 10.
const BELT: &str = "scenario: s\ncycles: 20\ndrive: [{signal: belt.count, ramp: {per_cycle: 40}}]\n";

fn latches(arguments: &str, expected: &str) {
    passes(&format!(
        "{BELT}steps: [{{at: 10, do: {{inject: {{latch: {{input: belt, {arguments}}}}}}}}}]\n\
         expect: [{{event: {{kind: latch, source: belt, {expected}}}, at: 10, count: 1}}]"
    ));
}

/// The machine interpolates the age of a position, and the position of an age, linearly within the cycle.
#[test]
fn an_encoder_latches_by_position_by_age_or_by_both() {
    // 30 of 40 inc before the end of the cycle.
    latches("position: 370", "increments: 370, age_ns: 750000");
    // 40 inc are 1 mm.
    latches("position: 9.25 mm", "increments: 370, age_ns: 750000");
    latches("age: 750 us", "increments: 370, age_ns: 750000");
    latches("position: 370, age: 100 us", "increments: 370, age_ns: 100000");
    latches("edge: falling", "increments: 400, age_ns: 0");
}

#[test]
fn an_axis_latches_by_position() {
    passes(
        "scenario: s\ncycles: 20\ndrive: [{signal: x.actual.count, ramp: {per_cycle: 40}}]\n\
         steps: [{at: 10, do: {inject: {latch: {input: x, position: 370}}}}]\n\
         expect:\n\
         - {event: {kind: latch, source: x, increments: 370, age_ns: 750000}, at: 10, count: 1}\n\
         - {signal: x.latch.position, at: 10, is: 370}",
    );
}

#[test]
fn an_input_has_no_position_to_latch() {
    let bad = |arguments: &str| problem("steps", &format!("{{at: 1, do: {{inject: {{latch: {{{arguments}}}}}}}}}"));
    assert_eq!(
        bad("input: mark, position: ^5 mm"),
        "position is 5 mm; an input catches no position, give `age`, or name the encoder or axis"
    );
    assert_eq!(
        bad("input: belt, position: ^0.5"),
        "position is 0.5; whole increments, or a position with its unit is allowed, write `0.5 m`"
    );
}

/// Returns the report in a cell with printed marks on the belt at 20, 60, 100 inc and an index of x every 100 inc.
fn failures_with_marks(text: &str) -> String {
    let text_of_cell = CELL
        .replace(
            "address: 1, latch: true}",
            "address: 1, latch: true, sim: {marks: {of: belt, every: 1 mm, first: 0.5 mm}}}",
        )
        .replace("max_following_error: 10 mm, sim: {model: ideal}", "sim: {model: ideal, index: {every: 100 inc}}");
    let cell = Cell::parse("cell.yaml", &text_of_cell).unwrap_or_else(|problems| panic!("{problems}"));
    let scenario = Scenario::parse("s.yaml", text, &cell).unwrap_or_else(|problems| panic!("{problems}"));
    simulate(&cell, &scenario, &Options::default()).unwrap().to_string()
}

/// 8 inc in each cycle: 20 is half-way between 16 (cycle 2) and 24 (cycle 3), and every fifth cycle has another mark.
#[test]
fn printed_marks_follow_an_encoder_that_is_driven() {
    let report = failures_with_marks(
        "scenario: s\ncycles: 20\ndrive: [{signal: belt.count, ramp: {per_cycle: 8}}]\nexpect:\n\
         - {event: {kind: latch, source: mark, age_ns: 500000}, at: 3, count: 1}\n\
         - {event: {kind: latch, source: mark, age_ns: 500000}, at: 8, count: 1}\n\
         - {event: {kind: latch, source: mark}, count: 4}",
    );
    assert!(report.starts_with("scenario `s`: PASSED"), "{report}");
}

/// 30 inc in each cycle: the index at 100 is between 90 and 120, the one at 200 between 180 and 210.
#[test]
fn index_pulses_follow_an_axis_whose_count_is_driven() {
    let report = failures_with_marks(
        "scenario: s\ncycles: 9\ndrive: [{signal: x.actual.count, ramp: {per_cycle: 30}}]\nexpect:\n\
         - {signal: x.index.count, values: [0, 0, 0, 0, 1, 1, 1, 2, 2]}\n\
         - {signal: x.index.position, at: 4, is: 100}\n\
         - {signal: x.index.position, at: end, is: 200}",
    );
    assert!(report.starts_with("scenario `s`: PASSED"), "{report}");
}
