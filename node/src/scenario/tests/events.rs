//! Tests expectations on events.

use super::*;

/// x is enabled, then commanded beyond its limits and to 10 mm; marks occur in cycles 500, 510 and 520.
const STEPS: &str = "steps:\n\
    - {at: 0, do: {enable: {axes: [x]}}}\n\
    - {name: go, at: 100, do: {move_axis: {axis: x, position: 10 mm}}}\n\
    - {at: 200, do: {move_axis: {axis: x, position: 900 mm}}, refused: max_position}\n\
    - {at: 500, every: 10, count: 3, do: {inject: {latch: {input: mark, age: 350 us}}}}\n\
    expect:\n- ";

fn holds(expectation: &str) {
    passes(&format!("scenario: s\ncycles: 1000\n{STEPS}{expectation}"));
}

fn fails(expectation: &str) -> String {
    failure(&format!("{STEPS}{expectation}"))
}

#[test]
fn events_are_chosen_by_their_fields() {
    holds("{event: {kind: latch, source: mark}, count: 3}");
    holds("{event: {kind: latch, source: mark}, from: 0.505 s, to: end, count: 2}");
    holds("{event: {kind: latch}, at: 510, count: 1}");
    holds("{event: {kind: latch}, since: go, at: 410, count: 1}");
    holds("{event: {kind: latch, age_ns: 350000}, min: 3}");
    holds("{event: {kind: latch, age_ns: 350001}, count: 0}");
    holds("{event: {kind: done, source: x, code: 0, increments: 10 mm}, at: 400, count: 1}");
    holds("{event: {kind: done, source: x, code: NONE, increments: 10000}}");
    holds("{event: {kind: refused, severity: warn, code: ABOVE_MAX_POSITION}, count: 1}");
    holds("{event: {kind: refused, text: 'target 900 mm exceeds max_position 850 mm'}, at: 200, count: 1}");
    holds("{event: {severity: error}, max: 0}");
    holds("{event: {kind: state, source: x, text: now STANDSTILL}, min: 2, max: 2}");
    holds("{event: {kind: accepted, source: machine}, at: 0}");
    // Text is compared ignoring case.
    holds("{event: {kind: state, source: x, text: now standstill}, min: 2, max: 2}");
    holds("{event: {kind: refused, text: 'TARGET 900 MM EXCEEDS'}, count: 1}");
}

#[test]
fn mode_has_the_same_meaning_for_events_and_signals() {
    holds("{event: {kind: latch, source: mark}, mode: eventually}");
    holds("{event: {kind: latch, source: mark}, to: 499, mode: never}");
    assert_eq!(
        fails("{event: {kind: latch}, to: 499, mode: eventually}"),
        "event kind latch came 0 times from cycle 0 (0 s) to cycle 499 (0.499 s); at least 1 was expected"
    );
    assert_eq!(
        fails("{event: {kind: latch}, to: 510, mode: never}"),
        "event kind latch came 2 times from cycle 0 (0 s) to cycle 510 (0.51 s); 0 was expected; it came in cycle 500, 510"
    );
    let bad = |expectation: &str| problem("expect", expectation);
    assert_eq!(
        bad("{event: {kind: latch}, mode: ^always}"),
        "mode is always, but an event stands in one cycle; eventually or never is allowed, count, min and max say how often it comes"
    );
    assert_eq!(
        bad("{event: {kind: latch}, count: 1, mode: ^never}"),
        "mode and count stand side by side; one of them is expected"
    );
    assert_eq!(
        bad("{event: {kind: latch}, mode: ^nevr}"),
        "mode is `nevr`; one of always, eventually, never is allowed, did you mean `never`?"
    );
}

#[test]
fn events_before_a_step_count_from_it() {
    let since = |name: &str, when: &str, expectation: &str| {
        format!(
            "scenario: s\ncycles: 1000\nsteps:\n- {{at: 500, every: 10, count: 3, do: {{inject: {{latch: {{input: mark, \
             age: 350 us}}}}}}}}\n- {{name: {name}, {when}, do: {{halt: {{}}}}}}\nexpect: [{expectation}]"
        )
    };
    // It fires in cycle 521, after the last mark in 520.
    let when = "when: {signal: line.state, is: STANDSTILL}, after: 20";
    passes(&since("go", when, "{event: {kind: latch}, since: go, at: -1, count: 1}"));
    passes(&since("go", when, "{event: {kind: latch}, since: go, from: -11, to: 5, count: 2}"));
    passes(&since("go", when, "{event: {kind: latch}, since: go, from: -21, to: -1, count: 3}"));
    passes(&since("go", when, "{event: {kind: latch}, since: go, from: -10, to: -2, mode: never}"));
}

#[test]
fn wrong_number_of_events_is_reported_with_their_cycles() {
    assert_eq!(
        fails("{event: {kind: latch, source: mark}, from: 0, to: 0.6 s, count: 5}"),
        "event kind latch, source mark came 3 times from cycle 0 (0 s) to cycle 600 (0.6 s); 5 was expected; it came in \
         cycle 500, 510, 520"
    );
    assert_eq!(
        fails("{event: {kind: limit}, from: 900}"),
        "event kind limit came 0 times from cycle 900 (0.9 s) to cycle 999 (0.999 s); at least 1 was expected"
    );
    assert_eq!(
        fails("{event: {kind: refused}, at: 200, min: 2, max: 4}"),
        "event kind refused came once in cycle 200 (0.2 s); 2 to 4 was expected; it came in cycle 200"
    );
    assert_eq!(
        fails("{event: {kind: latch}, max: 2}"),
        "event kind latch came 3 times from cycle 0 (0 s) to cycle 999 (0.999 s); 0 to 2 was expected; it came in cycle \
         500, 510, 520"
    );
    assert_eq!(
        fails("{event: {kind: latch}, since: go, from: 0, to: 1 s, count: 3}"),
        "it reaches up to cycle 1100 (1.1 s); the scenario ends with cycle 999 (0.999 s)"
    );
}

#[test]
fn errors_of_an_event_are_reported() {
    let bad = |expectation: &str| problem("expect", expectation);
    assert_eq!(bad("{event: {kind: ^latches}}").split(", did").nth(1), Some(" you mean `latch`?"));
    assert_eq!(bad("{event: {source: ^marc}}"), "nothing is called `marc` in the cell, did you mean `mark`?");
    assert_eq!(bad("{event: {severity: ^bad}}"), "severity is `bad`; one of info, warn, error is allowed");
    assert_eq!(
        bad("{event: {code: ^ABOVE_MAX_POSITIO}}"),
        "no code is called `ABOVE_MAX_POSITIO`; a number or a name is expected, did you mean `ABOVE_MAX_POSITION`?"
    );
    assert_eq!(
        bad("{event: {kind: latch}, count: 1, min: ^1}"),
        "count and min stand side by side; one of them is expected"
    );
    assert_eq!(bad("{event: {kind: latch}, min: 3, max: ^2}"), "max is below min 3");
    assert_eq!(bad("{event: {kind: latch}, count: ^-1}"), "count is -1; 0..9223372036854775807 is allowed");
    assert_eq!(bad("{event: {^knid: latch}}"), "unknown key `knid` in event, did you mean `kind`?");
}
