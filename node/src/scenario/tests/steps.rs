//! Tests when steps fire.

use super::*;

/// Returns the cycles in which the memory cell `gain` changed, with its new value.
fn changes(cycles: u64, rest: &str) -> String {
    let values = values("gain", cycles, rest);
    let before = std::iter::once("0.5").chain(values.iter().map(String::as_str));
    let changed = before.zip(&values).enumerate().filter(|(_, (before, now))| before != now);
    changed.map(|(cycle, (_, now))| format!("{cycle}:{now}")).collect::<Vec<_>>().join(" ")
}

fn set(value: &str) -> String {
    format!("do: {{set_memory: {{gain: {value}}}}}")
}

#[test]
fn at_steps_fire_in_their_cycle_in_any_order() {
    let steps =
        format!("steps:\n- {{at: 7, {}}}\n- {{at: 2 ms, {}}}\n- {{at: 2.5 ms, {}}}", set("1"), set("2"), set("3"));
    assert_eq!(changes(10, &steps), "2:2.0 3:3.0 7:1.0");
    assert_eq!(changes(10, &format!("steps: [{{at: end, {}}}]", set("1"))), "9:1.0");
}

#[test]
fn a_when_step_is_judged_at_the_end_of_a_cycle_and_acts_in_the_next_one() {
    let drive = "drive: [{signal: feed, at: 5, values: [1]}]\n";
    let step = |after: &str| format!("{drive}steps: [{{when: {{signal: feed, is: 1}}{after}, {}}}]", set("1"));
    assert_eq!(changes(20, &step("")), "6:1.0");
    assert_eq!(changes(20, &step(", after: 3")), "9:1.0");
    assert_eq!(changes(20, &step(", after: 3.5 ms")), "10:1.0");
    // A condition that is true from the start acts in cycle 1.
    assert_eq!(changes(5, &format!("steps: [{{when: {{signal: feed, is: 7}}, {}}}]", set("1"))), "1:1.0");
}

#[test]
fn a_when_step_arms_when_the_step_before_it_has_fired() {
    let when = "when: {signal: feed, min: 0}";
    let steps =
        format!("steps:\n- {{at: 10, {}}}\n- {{{when}, {}}}\n- {{{when}, after: 2, {}}}", set("1"), set("2"), set("3"));
    assert_eq!(changes(20, &steps), "10:1.0 11:2.0 14:3.0");
    // The pulse at 5 is before the step at 10: it does not count.
    let pulse = "drive: [{signal: start, at: 5, values: [1, 0]}, {signal: start, at: 15, values: [1]}]\n";
    let steps =
        format!("{pulse}steps:\n- {{at: 10, {}}}\n- {{when: {{signal: start, is: 1}}, {}}}", set("1"), set("2"));
    assert_eq!(changes(20, &steps), "10:1.0 16:2.0");
}

#[test]
fn a_command_is_seen_by_the_when_step_behind_it_in_its_own_cycle() {
    // The move changes the state in its own cycle, so the condition refers to its end, not to the standstill before it.
    let text = "scenario: s\ncycles: 1000\nsteps:\n\
        - {at: 0, do: {enable: {axes: [x]}}}\n\
        - {name: go, when: {signal: x.state, is: STANDSTILL}, do: {move_axis: {axis: x, position: 10 mm}}}\n\
        - {name: there, when: {signal: x.state, is: STANDSTILL}, do: {set_memory: {gain: 1}}}\n\
        expect:\n\
        - {signal: gain, since: go, at: 300, is: 0.5}\n\
        - {signal: x.state, since: go, from: 0, to: 299, is: DISCRETE_MOTION}\n\
        - {signal: gain, since: go, at: 301, is: 1}\n\
        - {signal: gain, since: there, at: 0, is: 1}\n";
    passes(text);
}

#[test]
fn steps_repeat_every_so_often() {
    let ramp = "drive: [{signal: feed, ramp: {per_cycle: 1}}]\n";
    let count = |text: &str| {
        let text =
            format!("scenario: s\ncycles: 20\n{ramp}steps: [{{{text}, do: {{inject: {{latch: {{input: mark}}}}}}}}]");
        let report = run(&format!("{text}\nexpect: [{{event: {{kind: latch}}, count: 99}}]"));
        report.failures[0].sentence.split("in cycle ").nth(1).unwrap().to_owned()
    };
    assert_eq!(count("at: 3, every: 5, count: 2"), "3, 8");
    assert_eq!(count("at: 3, every: 4.5 ms"), "3, 8, 13, 18");
    assert_eq!(count("when: {signal: feed, is: 3}, every: 2, count: 3"), "4, 6, 8");
    assert_eq!(count("at: 1, every: 1"), "1, 2, 3, 4, 5, 6, 7, 8, ..");
}

#[test]
fn predicates_read_all_they_may_ask() {
    let fires = |when: &str| {
        let text = format!(
            "scenario: s\ncycles: 21\ndrive: [{{signal: feed, ramp: {{per_cycle: 1}}}}, {{signal: level, ramp: {{per_cycle: 0.5}}}}]\n\
            steps: [{{name: n, optional: true, when: {when}, do: {{halt: {{}}}}}}]"
        );
        let report = run(&text);
        assert!(report.passed(), "{report}");
        report.steps_fired == 1
    };
    for (when, expected) in [
        ("{signal: feed, is: 19}", true),
        ("{signal: feed, is: 20}", false),
        ("{signal: feed, is: 22, within: 3}", true),
        ("{signal: feed, is: 22, within: 2}", false),
        ("{signal: feed, not: 0}", true),
        ("{signal: line.state, not: STANDSTILL}", false),
        ("{signal: line.state, is: 1}", true),
        ("{signal: feed, min: 19}", true),
        ("{signal: feed, min: 20}", false),
        ("{signal: feed, max: -1}", false),
        ("{signal: feed, min: 4, max: 4}", true),
        ("{signal: level, is: 9.5}", true),
        ("{signal: level, is: 9 V, within: 0 mV}", true),
        ("{signal: level, min: 9.6}", false),
        ("{signal: feed, minus: feed, not: 0}", false),
        ("{all: [{signal: feed, is: 4}, {signal: level, is: 2}]}", true),
        ("{all: [{signal: feed, is: 4}, {signal: level, is: 3}]}", false),
        ("{any: [{signal: feed, is: 99}, {all: [{signal: level, min: 3}]}]}", true),
        ("{any: [{signal: feed, is: 99}, {signal: level, is: 99}]}", false),
    ] {
        assert_eq!(fires(when), expected, "{when}");
    }
}

#[test]
fn a_step_that_never_fires_fails_the_scenario_unless_it_is_optional() {
    let never = "when: {signal: feed, is: 99}";
    assert_eq!(
        failure(&format!("steps: [{{name: go, {never}, {}}}]", set("1"))),
        "step `go` never fired: feed 99 never came"
    );
    passes(&format!("scenario: s\ncycles: 9\nsteps: [{{{never}, optional: true, {}}}]", set("1")));
    let told = run(&format!("scenario: s\ncycles: 9\nsteps:\n- {{{never}, optional: true, {}}}", set("1"))).to_string();
    assert!(
        told.ends_with("  optional and never fired:\n    s.yaml:4:3: the step never fired: feed 99 never came\n"),
        "{told}"
    );
    let all = failures(&format!(
        "scenario: s\ncycles: 9\nsteps:\n- {{{never}, optional: true, {}}}\n- {{when: {{signal: feed, is: 7}}, {}}}",
        set("1"),
        set("2")
    ));
    assert_eq!(all, ["5: the step never fired: the step before it never fired"]);
    assert_eq!(
        failure(&format!("steps: [{{when: {{signal: feed, is: 7}}, after: 1 s, {}}}]", set("1"))),
        "the step never fired: it was due in cycle 1001 (1.001 s), and the scenario ends with cycle 999 (0.999 s)"
    );
}

#[test]
fn errors_of_a_step_are_reported() {
    let bad = |step: &str| problem("steps", step);
    assert_eq!(bad("^{do: {halt: {}}}"), "a step has no time; one of at, when is expected");
    assert_eq!(
        bad("^{at: 1, when: {signal: feed, is: 1}, do: {halt: {}}}"),
        "at and when stand side by side; one of at, when is expected"
    );
    assert_eq!(bad("^{at: 1}"), "missing key `do` in a step");
    assert_eq!(bad("{at: 1, after: ^2, do: {halt: {}}}"), "after belongs to when, add it to `at`");
    assert_eq!(bad("{at: 1, count: ^2, do: {halt: {}}}"), "count needs every");
    assert_eq!(bad("{at: 1, every: ^0, do: {halt: {}}}"), "every is 0; 1..1000000000000 is allowed");
    assert_eq!(
        bad("^{at: 10, every: 10 ms, count: 10, do: {halt: {}}}"),
        "time 10 of 10 is cycle 100 (0.1 s); the scenario ends with cycle 99 (0.099 s)"
    );
    assert_eq!(bad("{at: 1, do: ^[]}"), "do is empty; one verb or more is expected");
    assert_eq!(bad("{at: 1, do: ^{halt: {}, enable: {}}}"), "2 verbs stand together; one is expected, write a list");
    assert_eq!(bad("{at: 1, do: ^halt}"), "halt has no arguments, write `halt: {}`");
    assert_eq!(bad("{at: 1, name: a, do: {halt: {}}}, {at: 2, name: ^a, do: {halt: {}}}"), "two steps are called `a`");
    assert_eq!(
        bad("{when: ^{signal: feed}, do: {halt: {}}}"),
        "nothing is asked of feed; is, not, min or max is expected"
    );
    assert_eq!(
        bad("{when: ^{signal: feed, is: 1, min: 2}, do: {halt: {}}}"),
        "one of is, not, or min with max is expected, not several"
    );
    assert_eq!(bad("{when: {signal: feed, min: 1, within: ^2}, do: {halt: {}}}"), "within belongs to is");
    assert_eq!(
        bad("{when: {signal: x.state, min: ^STANDSTILL}, do: {halt: {}}}"),
        "min has no meaning for a bit or an enum; is and not have"
    );
    assert_eq!(
        bad("{when: {signal: x.state, is: ^STANDSTIL}, do: {halt: {}}}"),
        "x.state is `STANDSTIL`; one of DISABLED, STANDSTILL, DISCRETE_MOTION, CONTINUOUS_MOTION, HOMING, \
         SYNCHRONIZED_MOTION, STOPPING, ERROR_STOP is allowed, did you mean `STANDSTILL`?"
    );
    assert_eq!(bad("{when: {any: ^[]}, do: {halt: {}}}"), "any has no conditions; one or more are expected");
    assert_eq!(
        bad("{when: {all: [{signal: feed, is: 1}], any: ^[{signal: feed, is: 1}]}, do: {halt: {}}}"),
        "all and any stand side by side; put one into the other"
    );
    assert_eq!(bad("{when: {signal: feed, min: ^3, max: 2}, do: {halt: {}}}"), "min 3 exceeds max 2");
    assert_eq!(
        bad("{when: {signal: feed, is: 3, within: ^-2}, do: {halt: {}}}"),
        "within is -2; 0 and above is allowed"
    );
}
