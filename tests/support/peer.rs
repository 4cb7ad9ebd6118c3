//! Controls the peers: processes on independent DDS implementations that execute commands from standard input.

use std::{
    io::Write,
    ops::Index,
    process::{ChildStdin, Command, Stdio},
    time::{Duration, Instant},
};

use rustix::process::Signal;
use serde_json::Value;

use super::{child::Captured, domain::Domain, setup};

/// Longer than any single timeout inside a peer, so that the peer's own message is shown.
const PATIENCE: Duration = Duration::from_secs(90);

/// A running peer in `serve` mode: one participant for all commands.
pub(crate) struct Peer {
    process: Captured,
    stdin: ChildStdin,
}

/// Observations of a peer during one command.
#[derive(Debug)]
pub(crate) struct Observations(Vec<Value>);

impl Observations {
    /// Returns all observations, oldest first.
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
    /// Starts the Eclipse Cyclone DDS peer, with all commands of `lineshaft_peer.py`.
    pub(crate) fn cyclone(domain: &Domain) -> Self {
        Self::cyclone_with(domain, Vec::new())
    }

    /// Does the same with additional environment variables.
    pub(crate) fn cyclone_with(domain: &Domain, variables: Vec<(&str, String)>) -> Self {
        let mut command = Command::new(setup::python());
        command.arg("-B").arg(setup::sources().join("lineshaft_peer.py")).envs(variables);
        Self::start("the Cyclone DDS peer", command, domain)
    }

    /// Starts the Fast DDS peer, with the commands of `fastdds_peer.cpp`.
    pub(crate) fn fastdds(domain: &Domain) -> Self {
        Self::fastdds_with(domain, Vec::new())
    }

    /// Does the same with additional environment variables.
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

    /// Stops the process, as a debugger or a lack of memory would.
    #[track_caller]
    pub(crate) fn freeze(&self) {
        self.process.signal(Signal::STOP);
    }

    /// Continues a frozen process.
    #[track_caller]
    pub(crate) fn thaw(&self) {
        self.process.signal(Signal::CONT);
    }

    /// Executes `command`, words separated by blanks; panics with the peer's message when it fails.
    #[track_caller]
    pub(crate) fn run(&mut self, command: &str) -> Observations {
        let (seen, error) = self.talk(command);
        if let Some(error) = error {
            panic!("`{command}`: {error}; observed: {seen:?}");
        }
        seen
    }

    /// Executes `command` and returns its error message; panics when it does not fail.
    #[track_caller]
    pub(crate) fn fails(&mut self, command: &str) -> String {
        let (seen, error) = self.talk(command);
        let Some(error) = error else { panic!("`{command}` should have failed; observed: {seen:?}") };
        error
    }

    /// Waits until an axis in a sample of `/lineshaft/axis_states` satisfies `holds`, and returns its state.
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

    /// Begins `command` without waiting; `answer` has to be called before the next command.
    #[track_caller]
    pub(crate) fn tell(&mut self, command: &str) {
        if let Err(e) = writeln!(self.stdin, "{command}") {
            panic!("the peer does not take `{command}`: {e}");
        }
    }

    /// Returns the observations of the command that `tell` has begun, and its message when it has failed.
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
