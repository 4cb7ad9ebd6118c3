//! Tests verb `probe_axis`.

use super::*;

/// x searches up to 100 mm from cycle 100 on: at 50 mm/s from cycle 200 on, where it is at 2.5 mm.
const SEARCH: &str = "scenario: s\n\
    cycles: 1200\n\
    steps:\n\
    - {at: 0, do: {enable: {axes: [x]}}}\n\
    - {name: go, at: 100, do: {probe_axis: {id: p, axis: x, position: 100 mm, event: mark, distance: 10 mm}}}\n";

/// In cycle 301 the actual position is 5000 + 100 * 50 - 2500 inc, and it was 17.5 inc less at the latch.
#[test]
fn a_mark_between_two_cycles_moves_the_end() {
    passes(&format!(
        "{SEARCH}\
         - {{at: 301, do: {{inject: {{latch: {{input: mark, age: 350 us}}}}}}}}\n\
         - {{at: 310, do: {{inject: {{latch: {{input: mark, age: 0 us}}}}}}}}\n\
         expect:\n\
         - {{signal: x.target.position, since: go, at: 200, is: 100 mm}}\n\
         - {{event: {{kind: mark, source: x, age_ns: 350000, increments: 7482}}, at: 301, count: 1}}\n\
         - {{event: {{kind: mark}}, count: 1}}\n\
         - {{signal: x.target.position, at: 301, is: 17483 inc}}\n\
         - {{signal: x.command.position, at: end, is: 17483 inc}}\n\
         - {{event: {{kind: done, source: x, code: 0, increments: 17483}}, count: 1}}\n"
    ));
}

#[test]
fn without_a_mark_it_fails_and_by_id_it_can_be_cancelled() {
    passes(
        "scenario: s\ncycles: 1200\nsteps:\n\
         - {at: 0, do: {enable: {axes: [x, turret]}}}\n\
         - {at: 100, do: [{probe_axis: {axis: x, mode: relative, position: -5 mm, event: belt, edge: both}},\
           {probe_axis: {id: t, axis: turret, units: increments, position: 9000, event: turret, edge: falling}}]}\n\
         - {at: 300, do: {inject: {latch: {input: turret, edge: rising}}}}\n\
         - {at: 350, do: {cancel: {id: t}}}\n\
         expect:\n\
         - {event: {kind: done, source: x, code: PROBE_MISSED, increments: -5 mm, severity: warn}, count: 1}\n\
         - {event: {kind: done, source: turret, code: CANCELLED}, count: 1}\n\
         - {event: {kind: mark}, count: 0}\n\
         - {signal: x.state, at: end, is: STANDSTILL}\n",
    );
}

/// A mark is under the sensor already: the axis does not continue to 100 mm. With the parameter it searches for the
/// next mark.
#[test]
fn an_active_input_refuses_the_probe_before_motion_unless_that_is_allowed() {
    let sentence = "x: probe input is already active: mark is 1, allowed 0 before a rising edge";
    passes(&format!(
        "scenario: s\ncycles: 2000\n\
         drive: [{{signal: mark, at: 0, values: [1], then: {{hold: 399}}}}]\n\
         steps:\n\
         - {{at: 0, do: {{enable: {{axes: [x]}}}}}}\n\
         - {{name: go, at: 100, do: {{probe_axis: {{axis: x, position: 100 mm, event: mark}}}}, refused: {{code: PROBE_INPUT_ACTIVE, text: \"{sentence}\"}}}}\n\
         - {{at: 200, do: {{set_parameters: {{x.probe_active_input: allow}}}}}}\n\
         - {{at: 300, do: {{probe_axis: {{axis: x, position: 100 mm, event: mark}}}}}}\n\
         - {{at: 500, do: {{inject: {{latch: {{input: mark}}}}}}}}\n\
         expect:\n\
         - {{signal: x.command.position, from: 0, to: 300, is: 0}}\n\
         - {{signal: x.state, from: 50, to: 299, is: STANDSTILL}}\n\
         - {{parameter: x.probe_active_input, at: 199, is: refuse}}\n\
         - {{event: {{kind: mark, source: x}}, at: 500, count: 1}}\n\
         - {{event: {{kind: done, source: x, code: 0}}, from: 500, to: end, count: 1}}\n"
    ));
}

#[test]
fn what_is_wrong_with_it_is_told_at_its_place() {
    let wrong = |arguments: &str| problem("steps", &format!("{{at: 1, do: {arguments}}}"));
    assert_eq!(wrong("{probe_axis: ^{axis: x, position: 1 mm}}"), "missing key `event` in probe_axis");
    assert_eq!(wrong("{probe_axis: ^{axis: x, event: mark}}"), "missing key `position` in probe_axis");
    assert_eq!(
        wrong("{probe_axis: ^{axis: x, position: 1 mm, event: start}}"),
        "`start` does not latch; mark, belt, x, turret can"
    );
    assert_eq!(
        wrong("{probe_axis: {axis: x, event: mark, mode: ^velocity}}"),
        "mode is `velocity`; one of absolute, relative is allowed"
    );
    assert_eq!(
        wrong("{probe_axis: {axis: x, position: 1 mm, event: mark, ^buffer_mode: 1}}"),
        "unknown key `buffer_mode` in probe_axis"
    );
}
