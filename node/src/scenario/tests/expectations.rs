//! Tests expectations on signals, and the report of failed ones.

use super::*;

/// `feed` counts up from 0, one per cycle, in a scenario of 1000 cycles.
const RAMP: &str = "drive: [{signal: feed, ramp: {per_cycle: 1}}]\nexpect:\n- ";

fn holds(expectation: &str) {
    passes(&format!("scenario: s\ncycles: 1000\n{RAMP}{expectation}"));
}

fn fails(expectation: &str) -> String {
    failure(&format!("{RAMP}{expectation}"))
}

#[test]
fn values_stand_one_per_cycle() {
    holds("{signal: feed, from: 5, values: [5, 6, 7]}");
    holds("{signal: feed, from: 0.5 s, values: [500, 510, 520], every: 10 ms}");
    holds("{signal: feed, values: [0]}");
    holds("{signal: feed, from: end, values: [999]}");
    holds("{signal: feed, from: 998, values: [998, 999]}");
    assert_eq!(
        fails("{signal: feed, from: 5, values: [5, 6, 8, 8, 8], every: 1}"),
        "feed is 7 in cycle 7 (0.007 s); 8 was expected, value 3 of 5; 2 of 5 values differ: 7 instead of 8 in \
         cycle 7, 9 instead of 8 in cycle 9"
    );
    assert_eq!(
        bad("^{signal: feed, from: 98, values: [1, 2, 3]}"),
        "value 3 of 3 is at cycle 100 (0.1 s); the scenario ends with cycle 99 (0.099 s)"
    );
}

#[test]
fn values_are_exact_unless_within() {
    holds("{signal: feed, from: 5, values: [6, 6, 6], within: 1}");
    holds("{signal: feed, from: 5, values: [5, 6], within: 0}");
    holds("{signal: gain, values: [0.4, 0.6], within: 0.1}");
    holds("{signal: x.actual.position, values: [1 mm, -1000], within: 1 mm}");
    holds("{parameter: line.max_position, values: [null], within: 1 mm}");
    assert_eq!(
        fails("{signal: feed, from: 5, values: [6, 6, 4, 9], within: 1}"),
        "feed is 7 in cycle 7 (0.007 s); 4 within 1 was expected, value 3 of 4; 1 of 4 values differ"
    );
    assert_eq!(bad("{signal: feed, values: [1], within: ^-1}"), "within is -1; 0 and above is allowed");
    assert_eq!(
        bad("{signal: start, values: [1], within: ^1}"),
        "within has no meaning for a bit or an enum; is and not have"
    );
}

#[test]
fn a_list_of_values_that_fails_shows_its_first_five_differences() {
    // 0 to 6: only the second value is right.
    assert_eq!(
        fails("{signal: feed, values: [1, 1, 3, 4, 5, 6, 7]}"),
        "feed is 0 in cycle 0 (0 s); 1 was expected, value 1 of 7; 6 of 7 values differ: 0 instead of 1 in cycle 0, 2 \
         instead of 3 in cycle 2, 3 instead of 4 in cycle 3, 4 instead of 5 in cycle 4, 5 instead of 6 in cycle 5, .."
    );
}

#[test]
fn bits_of_a_word_are_compared_below_a_mask() {
    // 13 is 1101b.
    holds("{signal: feed, mask: 0x0C, at: 13, is: 0x0C}");
    holds("{signal: feed, mask: 4, from: 4, to: 7, is: 4}");
    holds("{signal: feed, mask: 4, from: 4, to: 7, not: 0}");
    holds("{signal: feed, mask: 3, from: 2, values: [2, 3, 0, 1]}");
    holds("{all: [{signal: feed, mask: 8, is: 8}, {signal: feed, mask: 1, is: 0}], mode: eventually}");
    // A negative number is in two's complement: -1 has all bits.
    passes(
        "scenario: s\ncycles: 9\ndrive: [{signal: feed, values: [-1]}]\nexpect: [{signal: feed, mask: 0xFFFF, is: 0xFFFF}]",
    );
    // Control word 0Fh is enable operation (CiA 402).
    passes(
        "scenario: s\ncycles: 99\nsteps: [{at: 0, do: {enable: {axes: [x]}}}]\n\
         expect: [{signal: x.output.control, mask: 0x0F, at: end, is: 0x0F}]",
    );
    assert_eq!(
        fails("{signal: feed, mask: 0x30, at: 16, is: 0x20}"),
        "feed & 0x30 is 0x10 in cycle 16 (0.016 s); 0x20 was expected"
    );
    assert_eq!(bad("{signal: feed, mask: 6, is: ^1}"), "feed & 0x6 is 0x1, which has bits outside of the mask 0x6");
    let words = "mask is for words and whole numbers without a unit";
    assert_eq!(bad("{signal: gain, mask: ^1, is: 1}"), format!("{words}; gain is none"));
    assert_eq!(bad("{signal: x.actual.position, mask: ^1, is: 1}"), format!("{words}; x.actual.position is none"));
    assert_eq!(bad("{signal: feed, mask: 1, min: ^1}"), "min has no meaning for bits of a mask; is and not have");
    assert_eq!(bad("{signal: feed, mask: ^0, is: 0}"), "mask is 0; 1..9223372036854775807 is allowed");
    assert_eq!(
        bad("{signal: feed, mask: ^1, minus: feed, is: 0}"),
        "mask stands together with plus or minus; one of them is expected"
    );
    assert_eq!(
        bad("{parameter: x.max_velocity, mask: ^1, is: 1}"),
        "parameter and mask stand side by side; one of them is expected"
    );
}

#[test]
fn signals_are_added_and_subtracted() {
    holds("{signal: feed, plus: feed, at: 7, is: 14}");
    holds("{signal: feed, plus: gain, at: 7, is: 7.5}");
    holds("{signal: feed, plus: gain, minus: feed, is: 0.5}");
    assert_eq!(
        fails("{signal: feed, plus: feed, minus: gain, at: 7, is: 14}"),
        "feed plus feed minus gain is 13.5 in cycle 7 (0.007 s); 14 was expected"
    );
    assert_eq!(
        bad("{signal: x.command.position, plus: ^x.command.velocity, is: 0}"),
        "x.command.position has inc and x.command.velocity has inc/s; a sum needs the same unit"
    );
}

#[test]
fn memory_cell_has_the_unit_of_the_compared_position() {
    holds("{signal: feed, minus: x.actual.position, at: 7, is: 7}");
    // 1000 inc are 1 mm.
    holds("{signal: x.actual.position, minus: feed, at: 7, is: -7 um}");
    holds("{signal: feed, plus: feed, minus: x.actual.position, at: 7, is: 14 um}");
    assert_eq!(
        fails("{signal: x.actual.position, minus: feed, at: 7, is: 0}"),
        "x.actual.position minus feed is -7 inc (-0.007 mm) in cycle 7 (0.007 s); 0 inc (0 mm) was expected"
    );
    assert_eq!(
        bad("{signal: feed, plus: x.command.position, minus: ^x.command.velocity, is: 0}"),
        "feed plus x.command.position has inc and x.command.velocity has inc/s; a difference needs the same unit"
    );
    // Only a number in memory takes the unit of the other signal.
    assert_eq!(
        bad("{signal: flag, minus: ^x.command.position, is: 0}"),
        "flag has no unit and x.command.position has inc; a difference needs the same unit"
    );
    assert_eq!(
        bad("{signal: x.index.count, minus: ^x.command.position, is: 0}"),
        "x.index.count has no unit and x.command.position has inc; a difference needs the same unit"
    );
}

#[test]
fn a_value_at_one_cycle_is_exact_unless_within() {
    holds("{signal: feed, at: 17, is: 17}");
    holds("{signal: feed, at: 17 ms, is: 20, within: 3}");
    holds("{signal: feed, at: end, is: 999}");
    assert_eq!(fails("{signal: feed, at: 17, is: 18}"), "feed is 17 in cycle 17 (0.017 s); 18 was expected");
    assert_eq!(
        fails("{signal: feed, at: end, is: 1002, within: 2}"),
        "feed is 999 in cycle 999 (0.999 s); 1002 within 2 was expected"
    );
}

#[test]
fn default_mode_of_a_window_is_always() {
    holds("{signal: feed, min: 0, max: 999}");
    holds("{signal: feed, from: 10, to: 20, min: 10, max: 20}");
    holds("{signal: feed, from: 10, to: 20, is: 20, mode: eventually}");
    holds("{signal: feed, from: 10, to: 20, is: 21, mode: never}");
    assert_eq!(
        fails("{signal: feed, from: 10, to: 20, max: 18, mode: always}"),
        "feed is 19 in cycle 19 (0.019 s); at most 18 was expected from cycle 10 (0.01 s) to cycle 20 (0.02 s); 2 of 11 \
         cycles fail"
    );
    assert_eq!(
        fails("{signal: feed, from: 0.01 s, to: 20, not: 20}"),
        "feed is 20 in cycle 20 (0.02 s); anything but 20 was expected from cycle 10 (0.01 s) to cycle 20 (0.02 s); 1 of \
         11 cycles fail"
    );
    assert_eq!(
        fails("{signal: feed, from: 10, to: 20, is: 25, mode: eventually}"),
        "feed 25 was expected once from cycle 10 (0.01 s) to cycle 20 (0.02 s), and never came; closest was 20 in cycle \
         20 (0.02 s)"
    );
    assert_eq!(
        fails("{signal: feed, from: 10, to: 20, max: 4, mode: eventually}"),
        "feed at most 4 was expected once from cycle 10 (0.01 s) to cycle 20 (0.02 s), and never came; closest was 10 in \
         cycle 10 (0.01 s)"
    );
    assert_eq!(
        fails("{signal: feed, from: 10, to: 20, min: 18, max: 30, mode: never}"),
        "feed is 18 in cycle 18 (0.018 s); 18 to 30 was never to be from cycle 10 (0.01 s) to cycle 20 (0.02 s); 3 of 11 \
         cycles fail"
    );
    assert_eq!(
        fails("{signal: line.state, from: 10, is: HOMING, mode: eventually}"),
        "line.state HOMING was expected once from cycle 10 (0.01 s) to cycle 999 (0.999 s), and never came; line.state is \
         STANDSTILL in cycle 999 (0.999 s)"
    );
}

#[test]
fn several_conditions_go_together() {
    holds("{all: [{signal: feed, min: 0}, {signal: line.state, is: STANDSTILL}]}");
    holds("{any: [{signal: feed, max: 499}, {signal: feed, min: 500}]}");
    assert_eq!(
        fails(
            "{all: [{signal: feed, max: 7}, {any: [{signal: line.enabled, is: 1}, {signal: start, is: true}]}], to: 9}"
        ),
        "feed is 8, line.enabled is 1, start is 0 in cycle 8 (0.008 s); all of (feed at most 7; any of (line.enabled 1; \
         start 1)) was expected from cycle 0 (0 s) to cycle 9 (0.009 s); 2 of 10 cycles fail"
    );
    assert_eq!(
        fails("{all: [{signal: feed, is: 3}, {signal: start, is: 1}], mode: eventually, to: 9}"),
        "all of (feed 3; start 1) was expected once from cycle 0 (0 s) to cycle 9 (0.009 s), and never came; feed is 9, \
         start is 0 in cycle 9 (0.009 s)"
    );
}

#[test]
fn since_counts_from_the_cycle_in_which_a_step_fired() {
    let steps = "steps: [{name: go, when: {signal: feed, is: 100}, do: {halt: {}}}]\n";
    let text = |expectation: &str| format!("{steps}{RAMP}{expectation}");
    let good = |expectation: &str| passes(&format!("scenario: s\ncycles: 1000\n{}", text(expectation)));
    good("{signal: feed, since: go, at: 0, is: 101}");
    good("{signal: feed, since: go, at: 10 ms, is: 111}");
    good("{signal: feed, since: go, at: end, is: 999}");
    good("{signal: feed, since: go, from: 5, to: 6, min: 106, max: 107}");
    good("{signal: feed, since: go, from: 5, values: [106, 107]}");
    good("{signal: feed, since: go, from: 0.5 s, to: 2 s, is: 700, mode: eventually}");
    assert_eq!(
        failure(&text("{signal: feed, since: go, at: 7, is: 1}")),
        "feed is 108 in cycle 108 (0.108 s); 1 was expected"
    );
    assert_eq!(
        failure(&text("{signal: feed, since: go, from: 800, to: 899, min: 0}")),
        "it reaches up to cycle 1000 (1 s); the scenario ends with cycle 999 (0.999 s)"
    );
    assert_eq!(
        failure(&text("{signal: feed, since: go, from: 898, values: [999, 1000]}")),
        "it reaches up to cycle 1000 (1 s); the scenario ends with cycle 999 (0.999 s)"
    );
    assert!(failure(&text("{signal: feed, since: go, at: 5 s, is: 0, mode: eventually}")).contains("never came"));
}

#[test]
fn what_came_before_a_step_counts_from_it() {
    // It fires in cycle 101.
    let steps = "steps: [{name: go, when: {signal: feed, is: 100}, do: {halt: {}}}]\n";
    let text = |expectation: &str| format!("{steps}{RAMP}{expectation}");
    let good = |expectation: &str| passes(&format!("scenario: s\ncycles: 1000\n{}", text(expectation)));
    good("{signal: feed, since: go, at: -1, is: 100}");
    good("{signal: feed, since: go, at: -1 ms, is: 100}");
    // The first cycle not earlier than 1.5 ms before the step.
    good("{signal: feed, since: go, at: -1.5 ms, is: 100}");
    good("{signal: feed, since: go, at: -0, is: 101}");
    good("{signal: feed, since: go, at: -101, is: 0}");
    good("{signal: feed, since: go, from: -3, to: 2, min: 98, max: 103}");
    good("{signal: feed, since: go, from: -3, to: -2, is: 99, mode: eventually}");
    good("{signal: feed, since: go, from: -2, values: [99, 100, 101, 102]}");
    good("{signal: feed, since: go, from: -4, values: [97, 99, 101], every: 2}");
    good("{all: [{signal: feed, is: 100}, {any: [{signal: feed, is: 1}, {signal: start, is: 0}]}], since: go, at: -1}");
    assert_eq!(
        failure(&text("{signal: feed, since: go, from: -2, to: 1, is: 99}")),
        "feed is 100 in cycle 100 (0.1 s); 99 was expected from cycle 99 (0.099 s) to cycle 102 (0.102 s); 3 of 4 cycles \
         fail"
    );
    assert_eq!(
        failure(&text("{signal: feed, since: go, from: -3, values: [98, 100, 101, 101]}")),
        "feed is 99 in cycle 99 (0.099 s); 100 was expected, value 2 of 4; 2 of 4 values differ: 99 instead of \
         100 in cycle 99, 100 instead of 101 in cycle 100"
    );
    assert_eq!(
        failure(&text("{signal: feed, since: go, at: -102, is: 0}")),
        "it reaches 102 cycles back, before cycle 0; the step fired in cycle 101 (0.101 s)"
    );
    // If the cycle of the step is known, the problem is reported when the scenario is read.
    let at = "{scenario: s, cycles: 99, steps: [{name: go, at: 7, do: {halt: {}}}], expect: [\n";
    let known = |expectation: &str| problems(&format!("{at}{expectation}]}}"));
    assert_eq!(
        known("{signal: feed, since: go, from: -8, to: 3, is: 1}"),
        "2:1: 8 cycles before step `go` is before cycle 0; it fires in cycle 7 (0.007 s)\n"
    );
    assert_eq!(
        known("{signal: feed, since: go, at: -100001, is: 1}"),
        "2:31: at is 100001 cycles before the step; up to 100000 are allowed\n"
    );
    assert_eq!(
        known("{signal: feed, since: go, from: -2, to: -3, is: 1}"),
        "2:41: to is -3 cycles from the step, before from -2\n"
    );
    assert_eq!(
        known("{signal: feed, since: go, at: -0.5, is: 1}"),
        "2:31: at is -0.5; a whole number of cycles, or a time with its unit is allowed, write `-0.5 s`\n"
    );
    assert_eq!(bad("{signal: feed, at: ^-1, is: 1}"), "at is -1; 0..1000000000000 is allowed");
}

#[test]
fn expected_parameters_have_the_names_and_units_of_set_parameters() {
    let set = "steps: [{at: 10, do: {set_parameters: {x.max_velocity: 80 mm/s, x.profile: s_ramp}}}]\nexpect:\n- ";
    let holds = |expectation: &str| passes(&format!("scenario: s\ncycles: 1000\n{set}{expectation}"));
    let fails = |expectation: &str| failure(&format!("{set}{expectation}"));
    holds("{parameter: x.max_velocity, at: 9, is: 100 mm/s}");
    holds("{parameter: x.max_velocity, at: 10, is: 80 mm/s}");
    // A number without unit is in SI, as in set_parameters.
    holds("{parameter: x.max_velocity, from: 10, is: 0.08}");
    holds("{parameter: x.max_velocity, max: 0.1 m/s, min: 79 mm/s}");
    holds("{parameter: x.max_velocity, at: end, is: 81 mm/s, within: 1 mm/s}");
    holds("{parameter: x.max_velocity, from: 9, values: [100 mm/s, 80 mm/s]}");
    holds("{parameter: x.profile, from: 10, is: s_ramp}");
    holds("{parameter: x.profile, is: s_ramp, mode: eventually}");
    holds("{parameter: x.error_reaction, is: 2}");
    holds("{parameter: x.max_position, is: 850 mm}");
    holds("{parameter: line.max_position, is: null}");
    holds("{all: [{parameter: line.max_position, is: null}, {parameter: x.max_position, not: null}]}");
    assert_eq!(
        fails("{parameter: x.max_velocity, at: 9, is: 80 mm/s}"),
        "x.max_velocity is 100 mm/s in cycle 9 (0.009 s); 80 mm/s was expected"
    );
    assert_eq!(
        fails("{parameter: line.max_position, at: 9, is: 1 m}"),
        "line.max_position is not set in cycle 9 (0.009 s); 1 m was expected"
    );
    assert_eq!(
        fails("{parameter: x.profile, at: 9, is: s_ramp}"),
        "x.profile is trapezoid in cycle 9 (0.009 s); s_ramp was expected"
    );
    // With nine digits, a smaller difference would be reported as two equal numbers.
    assert_eq!(
        fails("{parameter: x.max_velocity, at: 10, is: 80.0000000001 mm/s}"),
        "x.max_velocity is 80 mm/s in cycle 10 (0.01 s); 80.0000000001 mm/s was expected"
    );
    assert_eq!(
        bad("{parameter: x.profile, is: ^TRAPEZOID}"),
        "x.profile is TRAPEZOID; one of trapezoid, s_ramp, jerk is allowed, did you mean `trapezoid`?"
    );
    assert_eq!(
        bad("{parameter: ^x.max_velosity, is: 1}"),
        "no parameter is called `x.max_velosity`, did you mean `x.max_velocity`?"
    );
    assert_eq!(bad("{parameter: ^z.max_velocity, is: 1}"), "no axis is called `z`; there are line, x, turret");
    assert_eq!(
        bad("{parameter: x.max_velocity, is: ^80 mm}"),
        "x.max_velocity: `80 mm` is a length; a velocity such as `80 mm/s` is expected"
    );
    assert_eq!(
        bad("{parameter: x.profile, is: ^s_rmp}"),
        "x.profile is s_rmp; one of trapezoid, s_ramp, jerk is allowed, did you mean `s_ramp`?"
    );
    assert_eq!(
        bad("{parameter: x.max_velocity, signal: ^feed, is: 1}"),
        "parameter and signal stand side by side; one of them is expected"
    );
    // A step may wait for a parameter.
    passes(
        "scenario: s\ncycles: 99\nsteps:\n- {at: 10, do: {set_parameters: {x.max_velocity: 80 mm/s}}}\n\
         - {name: go, when: {parameter: x.max_velocity, max: 90 mm/s}, do: {halt: {}}}\n\
         expect: [{parameter: x.max_velocity, since: go, at: -2, is: 100 mm/s}]",
    );
}

#[test]
fn what_counts_from_an_optional_step_that_never_fired_is_not_judged() {
    let report = run(
        "scenario: s\ncycles: 9\nsteps: [{name: go, optional: true, when: {signal: feed, is: 1}, do: {halt: {}}}]\n\
         expect: [{signal: feed, since: go, at: 0, is: 1}, {signal: feed, is: 7}]",
    );
    assert_eq!(
        report.to_string(),
        "scenario `s`: PASSED\n  9 cycles, 0.009 s\n  2 expectations (1 not judged), 0 of 1 step fired\n  optional and never \
         fired:\n    s.yaml:3:9: step `go` never fired: feed 1 never came\n"
    );
}

#[test]
fn values_may_have_units_and_reports_show_both() {
    let bad = |expectation: &str| failure(&format!("expect:\n- {expectation}"));
    assert_eq!(
        bad("{signal: x.actual.position, at: end, is: 120 mm, within: 2 um}"),
        "x.actual.position is 0 inc (0 mm) in cycle 999 (0.999 s); 120000 inc (120 mm) within 2 inc (0.002 mm) was expected"
    );
    assert_eq!(
        bad("{signal: turret.command.velocity, at: 3, min: 15 rpm}"),
        "turret.command.velocity is 0 inc/s (0 deg/s) in cycle 3 (0.003 s); at least 9000 inc/s (90 deg/s) was expected"
    );
    assert_eq!(
        bad("{signal: x.command.acceleration, at: 3, min: 0.5 m/s^2, max: 1e6}"),
        "x.command.acceleration is 0 inc/s^2 (0 mm/s^2) in cycle 3 (0.003 s); 500000 inc/s^2 (500 mm/s^2) to 1000000 \
         inc/s^2 (1000 mm/s^2) was expected"
    );
    assert_eq!(bad("{signal: level, at: 3, is: 250 mV}"), "level is 0 V in cycle 3 (0.003 s); 0.25 V was expected");
    assert_eq!(
        bad("{signal: belt.position, at: 3, is: 1 cm}"),
        "belt.position is 0 inc (0 m) in cycle 3 (0.003 s); 400 inc (0.01 m) was expected"
    );
    assert_eq!(
        bad("{signal: x.error, at: 3, is: FOLLOWING_ERROR}"),
        "x.error is 0 in cycle 3 (0.003 s); 10201 (FOLLOWING_ERROR) was expected"
    );
    assert_eq!(
        bad("{signal: x.command.position, minus: line.command.position, at: 3, is: 7}"),
        "x.command.position minus line.command.position is 0 inc in cycle 3 (0.003 s); 7 inc was expected"
    );
    assert_eq!(
        bad("{signal: x.command.position, minus: x.actual.position, at: 3, is: -7 um}"),
        "x.command.position minus x.actual.position is 0 inc (0 mm) in cycle 3 (0.003 s); -7 inc (-0.007 mm) was expected"
    );
}

/// Returns the problem of an expectation.
fn bad(expectation: &str) -> String {
    problem("expect", expectation)
}

#[test]
fn errors_of_an_expectation_are_reported() {
    let steps = "{scenario: s, cycles: 9, steps: [{name: running, at: 1, do: {halt: {}}}], expect: [\n";
    assert_eq!(
        problems(&format!("{steps}{{signal: feed, since: runing, is: 1}}]}}")),
        "2:23: no step is called `runing`, did you mean `running`?\n"
    );
    assert_eq!(
        bad("{signal: feed, is: 1, at: 3, from: ^4}"),
        "at and from stand side by side; one of them is expected"
    );
    assert_eq!(bad("{signal: feed, is: 1, at: 3, to: ^4}"), "at and to stand side by side; one of them is expected");
    assert_eq!(
        bad("{signal: feed, is: 1, from: 30, to: ^20}"),
        "to is cycle 20 (0.02 s), before from cycle 30 (0.03 s)"
    );
    assert_eq!(
        bad("{signal: feed, is: 1, to: ^100}"),
        "to is cycle 100 (0.1 s); the scenario ends with cycle 99 (0.099 s)"
    );
    assert_eq!(
        bad("{signal: feed, is: 1, mode: ^often}"),
        "mode is `often`; one of always, eventually, never is allowed"
    );
    assert_eq!(
        bad("{signal: feed, ^at: 3, values: [1]}"),
        "unknown key `at` in an expectation, known are since, parameter, signal, plus, minus, mask, every, values, within, \
         from"
    );
    assert_eq!(bad("{signal: ^fed, is: 1}"), "no signal is called `fed`, did you mean `feed`?");
    assert_eq!(
        bad("{signal: x.command.position, is: ^120 deg}"),
        "x.command.position: `120 deg` is an angle; a length such as `120 mm` is expected"
    );
    assert_eq!(
        bad("{signal: x.command.position, is: ^0.5}"),
        "x.command.position is 0.5; whole increments, or a position with its unit is allowed, a number without a unit is in increments; \
         `0.5 m` is `500 mm`"
    );
    assert_eq!(
        bad("{signal: x.command.position, is: ^1.5}"),
        "x.command.position is 1.5; whole increments, or a position with its unit is allowed, write `1.5 mm`"
    );
    assert_eq!(
        bad("{signal: x.command.velocity, is: ^1 mm}"),
        "x.command.velocity: `1 mm` is a length; a velocity such as `1 mm/s` is expected"
    );
    assert_eq!(bad("{signal: x.state, is: ^8}"), "x.state is 8; 0..7 is allowed");
    assert_eq!(
        bad("{signal: x.command.position, minus: ^x.command.velocity, is: 0}"),
        "x.command.position has inc and x.command.velocity has inc/s; a difference needs the same unit"
    );
    assert_eq!(
        bad("{signal: x.command.position, minus: turret.command.position, is: ^1 mm}"),
        "x.command.position minus turret.command.position is `1 mm`; a whole number -9223372036854775808..9223372036854775807 is allowed, a unit is not allowed here"
    );
    assert_eq!(
        bad("{signal: x.error, is: ^FOLOWING_ERROR}"),
        "no code is called `FOLOWING_ERROR`; a number or a name is expected, did you mean `FOLLOWING_ERROR`?"
    );
}
