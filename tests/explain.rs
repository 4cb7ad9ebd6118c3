//! Tests `lineshaft explain` on the command line: output and exit codes.

use crate::support::machine::share;
use std::process::Command;

/// Returns exit code, standard output and standard error.
fn said(name: &str) -> (i32, String, String) {
    let _machine = share();
    let output = Command::new(env!("CARGO_BIN_EXE_lineshaft")).args(["explain", name]).output().expect("it starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status.code().expect("it ended by itself"), text(output.stdout), text(output.stderr))
}

#[test]
fn a_name_is_explained_on_standard_output() {
    for (name, line) in [
        ("E10205", "code 10205 ENABLE_TIMEOUT: an error of an axis"),
        ("x.max_velocity", "max_velocity: a parameter"),
        ("x.actual.position", "AXIS.actual.position: a signal of an axis"),
        ("varsync.m1", "m1: a field of function type varsync"),
        ("move_axis", "move_axis: a verb of scenarios"),
        ("lineshaft_msgs/AxisStates", "lineshaft_msgs/msg/AxisStates"),
    ] {
        let (code, text, problems) = said(name);
        assert_eq!((code, problems.as_str()), (0, ""), "{name}");
        assert!(text.lines().any(|known| known == line), "{name}: {text}");
        // To a pipe: no line exceeds the default width without a terminal.
        assert!(text.lines().all(|line| line.chars().count() <= 120), "{name}: {text}");
    }
}

#[test]
fn an_unknown_name_is_one_sentence_and_exit_code_2() {
    let (code, text, problems) = said("max_velocty");
    assert_eq!((code, text.as_str(), problems.lines().count()), (2, "", 1));
    assert!(problems.starts_with("error: `max_velocty` is unknown; did you mean `max_velocity`"), "{problems}");
    assert_eq!(said("777").0, 2);
}
