//! Tests verbs whose axis is given separately from their arguments.

use super::*;
use crate::scenario::vocabulary_command;
use lineshaft_core::command::Action;
use lineshaft_core::parameter::{Change, Row, Value as Set};

const X: u16 = 1;

fn read(axis: &str, verb: &str, arguments: &str) -> Result<Action, String> {
    let cell = cell();
    let machine = Machine::new(cell.machine.clone()).unwrap();
    vocabulary_command(axis, verb, arguments, &cell.machine, machine.directory())
}

#[track_caller]
fn refused(axis: &str, verb: &str, arguments: &str) -> String {
    let sentence = read(axis, verb, arguments).expect_err(arguments);
    assert!(!sentence.contains('\n'), "one sentence: {sentence}");
    assert!(sentence.len() < 400, "{sentence}");
    sentence
}

fn change(key: &str, value: Set) -> Change {
    Change { axis: X, row: Row::find(key).unwrap().0, value }
}

#[test]
fn axis_key_of_a_step_is_the_axis_of_the_verb() {
    let axis_of = |result: Result<Action, String>| match result {
        Ok(Action::Vocabulary(request)) => request.axis(),
        other => panic!("{other:?}"),
    };
    for (verb, asked) in [("saia", "commands: [fstart]"), ("wf", "start: true")] {
        for axis in ["", "axis: x, ", "axis: 'x', "] {
            assert_eq!(axis_of(read("x", verb, &format!("{{{axis}{asked}}}"))), X, "{verb} {axis}");
        }
        assert_eq!(axis_of(read("x", verb, &format!("axis: x\n{asked}\n"))), X, "{verb}");
        let sentence = refused("x", verb, &format!("{{axis: turret, {asked}}}"));
        assert_eq!(sentence, "arguments:1:8: axis is `turret`; `x` was given beside, leave it out");
        let sentence = refused("x", verb, &format!("\naxis: [x]\n{asked}"));
        assert_eq!(sentence, "arguments:2:7: axis is a list; a text is expected");
    }
}

#[test]
fn parameters_are_named_without_the_axis_in_flow_or_block() {
    let expected = Action::SetParameters(
        [change("max_velocity", Set::Real(80_000.0)), change("error_reaction", Set::Int(3))].into(),
    );
    for arguments in ["{max_velocity: 80 mm/s, error_reaction: 3}", "max_velocity: 80 mm/s\nerror_reaction: 3\n"] {
        assert_eq!(read("x", "set_parameters", arguments).as_ref(), Ok(&expected), "{arguments}");
    }
    assert_eq!(
        refused("x", "set_parameters", "max_velocity: 80 mm/s\nmax_speed: 3"),
        "arguments:2:12: no parameter is called `x.max_speed`"
    );
    assert_eq!(refused("x", "set_parameters", "{axis: x}"), "arguments:1:8: no parameter is called `x.axis`");
    assert_eq!(
        refused("x", "set_parameters", "{x.max_velocity: 1}"),
        "arguments:1:18: no parameter is called `x.x.max_velocity`, `x` stands twice"
    );
    assert!(refused("x", "set_parameters", "").starts_with("arguments:1:1: set_parameters is empty"));
}

/// Success would mean that something was executed.
#[test]
fn a_verb_that_asks_for_nothing_is_refused() {
    for (verb, given) in [
        ("saia", &["", "{}", "~", "{axis: x}", "axis: x\n", "{set: {}, commands: []}"][..]),
        ("wf", &["", "{}", "~", "{axis: x}", "axis: x\n", "{start: false}", "{reset: false}"]),
    ] {
        for arguments in given {
            let sentence = format!("arguments:1:1: {verb} asks for nothing; keys beside `axis` are expected");
            assert_eq!(refused("x", verb, arguments), sentence, "{arguments}");
        }
    }
    let text =
        "scenario: s\ncycles: 10\nsteps:\n  - {at: 0, do: {wf: {axis: x}}}\n  - {at: 1, do: {saia: {axis: x}}}\n";
    let told = crate::scenario::tests::problems(text);
    assert!(
        told.contains("4:") && told.contains("wf asks for nothing") && told.contains("saia asks for nothing"),
        "{told}"
    );
}

#[test]
fn what_is_wrong_is_one_sentence_with_its_place() {
    for (axis, verb, arguments, sentence) in [
        ("q", "saia", "{}", "no axis is called `q`; there are line, x, turret"),
        ("", "saia", "{}", "no axis is called ``; there are"),
        ("x", "saja", "{}", "verb is `saja`; saia, wf, set_parameters are allowed, did you mean `saia`?"),
        ("x", "halt", "{}", "verb is `halt`; saia, wf, set_parameters are allowed"),
        ("x", "saia", "{", "arguments:1:1: this is not YAML: `}` is missing for `{` at 1:1"),
        ("x", "saia", "a: b\n c: d", "arguments:2:3: this is not YAML: "),
        ("x", "saia", "[1]", "arguments:1:1: saia is a list; a mapping is expected"),
        ("x", "wf", "fast", "arguments:1:1: wf is `fast`; a mapping is expected"),
        ("x", "wf", "{zzz: 1, yyy: 2}", "arguments:1:2: unknown key `zzz` in wf"),
        ("x", "wf", "{start: true}\n---\n{}", "arguments:2:1: a second document starts here; a file holds one"),
        ("x", "set_parameters", "[a]", "arguments:1:1: set_parameters is a list; a mapping is expected"),
    ] {
        let told = refused(axis, verb, arguments);
        assert!(told.starts_with(sentence), "{arguments}: {told}");
    }
    assert!(refused("x", "wf", "{zzz: 1, yyy: 2}").ends_with("; there is 1 more problem"));
}

#[test]
fn arguments_made_to_hurt_are_refused_at_once() {
    let long = "a".repeat(10_000_000);
    assert_eq!(refused("x", "saia", &long), "the arguments are 10000000 bytes long; 65536 are allowed");
    assert!(refused("x", "saia", &"[".repeat(60_000)).ends_with("nested deeper than 64 levels"));
    assert!(refused("x", "wf", &"{a: ".repeat(15_000)).ends_with("nested deeper than 64 levels"));
    refused("x", "wf", &"- ".repeat(30_000));
    refused("x", "wf", &format!("{{{}}}", "a: 1,".repeat(12_000)));
    refused("x", "wf", &format!("a: &a {}\nb: [{}]", "x".repeat(30_000), "*a,".repeat(10_000)));
    refused(&long, "saia", "{}");
    refused("x", &long, "{}");
}
