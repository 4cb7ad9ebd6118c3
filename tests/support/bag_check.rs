//! Reads bags with independent libraries: `bag_check.py`.

use std::{
    ffi::OsStr,
    process::{Command, Output},
};

use serde_json::Value;

use super::{machine::share, setup};

/// Runs a command of `bag_check.py` and returns its observation; panics with its message when it fails.
#[track_caller]
pub(crate) fn bag_check<A: AsRef<OsStr>>(args: impl IntoIterator<Item = A>) -> Value {
    match run(args) {
        (Some(seen), None) => seen,
        (seen, error) => panic!("{}; observed: {seen:?}", error.unwrap_or_else(|| "it said nothing".to_owned())),
    }
}

/// Does the same for a command that must fail; returns its message.
#[track_caller]
pub(crate) fn bag_check_fails<A: AsRef<OsStr>>(args: impl IntoIterator<Item = A>) -> String {
    match run(args) {
        (_, Some(error)) => error,
        (seen, None) => panic!("it should have failed; observed: {seen:?}"),
    }
}

/// Returns the first observation, and the message of a failure.
#[track_caller]
fn run<A: AsRef<OsStr>>(args: impl IntoIterator<Item = A>) -> (Option<Value>, Option<String>) {
    let _machine = share();
    let mut command = Command::new(setup::python());
    command.arg("-B").arg(setup::sources().join("bag_check.py")).args(args);
    let Output { status, stdout, stderr } = command.output().expect("the interpreter was just found");
    let stdout = String::from_utf8_lossy(&stdout);
    let lines = stdout.lines().map(|line| match serde_json::from_str::<Value>(line) {
        Ok(value) => value,
        Err(e) => panic!("bag_check.py wrote no JSON ({e}): {line}"),
    });
    let (errors, seen): (Vec<_>, Vec<_>) = lines.partition(|line| line.get("error").is_some());
    let error = errors.first().map(|line| line["error"].as_str().unwrap_or_default().to_owned());
    assert!(status.success() == error.is_none(), "{status}: {}", String::from_utf8_lossy(&stderr));
    (seen.into_iter().next(), error)
}
