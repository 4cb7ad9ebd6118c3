//! The peers: processes on DDS implementations that are not the program's own, told what to do by lines of words.

use std::{
    io::Write,
    ops::Index,
    process::{ChildStdin, Command, Stdio},
    time::{Duration, Instant},
};

use rustix::process::Signal;
use serde_json::Value;

use super::{child::Captured, domain::Domain, setup};

/// Longer than any single wait inside a peer, so that its own sentence comes first.
const PATIENCE: Duration = Duration::from_secs(90);

/// A running peer in `serve` mode: one participant, kept over all commands.
pub(crate) struct Peer {
    process: Captured,
    stdin: ChildStdin,
}

/// What a peer has observed while it did one command.
#[derive(Debug)]
pub(crate) struct Observations(Vec<Value>);

impl Observations {
    /// All observations, oldest first.
    pub(crate) fn all(&self) -> &[Value] {
        &self.0
    }
}

/// The field `name` of the first observation that has it; panics when none has.
impl Index<&str> for Observations {
    type Output = Value;

    #[track_caller]
    fn index(&self, name: &str) -> &Value {
        match self.0.iter().find_map(|one| one.get(name)) {
            Some(value) => value,
            None => panic!("the peer has observed no `{name}`, only {:?}", self.0),
        }
    }
}

impl Peer {
    /// The Eclipse Cyclone DDS peer, with all commands of `lineshaft_peer.py`.
    pub(crate) fn cyclone(domain: &Domain) -> Self {
        Self::cyclone_with(domain, Vec::new())
    }

    /// The same with variables of its own.
    pub(crate) fn cyclone_with(domain: &Domain, variables: Vec<(&str, String)>) -> Self {
        let mut command = Command::new(setup::python());
        command.arg("-B").arg(setup::sources().join("lineshaft_peer.py")).envs(variables);
        Self::start("the Cyclone DDS peer", command, domain)
    }

    /// The Fast DDS peer, with the commands of `fastdds_peer.cpp`.
    pub(crate) fn fastdds(domain: &Domain) -> Self {
        Self::fastdds_with(domain, Vec::new())
    }

    /// The same with variables of its own.
    pub(crate) fn fastdds_with(domain: &Domain, variables: Vec<(&str, String)>) -> Self {
        let mut command = Command::new(setup::fastdds_peer());
        command.envs(variables);
        Self::start("the Fast DDS peer", command, domain)
    }

    fn start(name: &str, mut command: Command, domain: &Domain) -> Self {
        command.arg("serve");
        let mut process = Captured::start(name, command, domain, Stdio::piped());
        let stdin = process.stdin();
        Self { process, stdin }
    }

    /// Stops the process where it is, as a debugger or a machine without memory would.
    #[track_caller]
    pub(crate) fn freeze(&self) {
        self.process.signal(Signal::STOP);
    }

    /// Lets a frozen process go on.
    #[track_caller]
    pub(crate) fn thaw(&self) {
        self.process.signal(Signal::CONT);
    }

    /// Does `command`, words between blanks; panics with the peer's sentence when it fails.
    #[track_caller]
    pub(crate) fn run(&mut self, command: &str) -> Observations {
        let (seen, error) = self.talk(command);
        if let Some(error) = error {
            panic!("`{command}`: {error}; observed: {seen:?}");
        }
        seen
    }

    /// Does `command` and returns the sentence with which it fails; panics when it does not fail.
    #[track_caller]
    pub(crate) fn fails(&mut self, command: &str) -> String {
        let (seen, error) = self.talk(command);
        let Some(error) = error else { panic!("`{command}` should have failed; observed: {seen:?}") };
        error
    }

    /// Waits until a sample of `/lineshaft/axis_states` has an axis as `holds` says, and returns its state.
    #[track_caller]
    pub(crate) fn until_axis(&mut self, axis: &str, what: &str, holds: impl Fn(&Value) -> bool) -> Value {
        let end = Instant::now() + PATIENCE;
        loop {
            let seen = self.run("axis-states /lineshaft");
            let state = &seen.all().last().expect("a sample")["axes"][axis];
            if holds(state) {
                return state.clone();
            }
            assert!(Instant::now() < end, "{axis}: {what}? {state}");
        }
    }

    #[track_caller]
    fn talk(&mut self, command: &str) -> (Observations, Option<String>) {
        self.tell(command);
        self.answer()
    }

    /// Begins `command` without waiting; `answer` has to follow before the next command.
    #[track_caller]
    pub(crate) fn tell(&mut self, command: &str) {
        if let Err(e) = writeln!(self.stdin, "{command}") {
            panic!("the peer does not take `{command}`: {e}");
        }
    }

    /// The observations of the command begun with `tell`, and its sentence when it has failed.
    #[track_caller]
    pub(crate) fn answer(&mut self) -> (Observations, Option<String>) {
        let mut seen = Vec::new();
        loop {
            let line = self.process.line(PATIENCE);
            let value = match serde_json::from_str::<Value>(&line) {
                Ok(value) => value,
                Err(e) => panic!("the peer wrote no JSON ({e}): {line}"),
            };
            if value.get("done").is_none() {
                seen.push(value);
                continue;
            }
            let error = (value["ok"] != true).then(|| value["error"].as_str().unwrap_or_default().to_owned());
            return (Observations(seen), error);
        }
    }
}
