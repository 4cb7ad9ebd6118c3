//! Tests `~/set_output` and `~/abort` from a client on Cyclone DDS, and their recordings.

use std::{fs, path::Path, process::Command};

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

const ABORTED: u32 = 10228;

struct Node {
    cyclone: Peer,
    program: Program,
    folder: tempfile::TempDir,
}

impl Node {
    /// Starts the lift of launch-configs/io.yaml, simulated and recorded, with a scenario.
    fn start(scenario: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name).to_str().expect("a path of text").to_owned();
        fs::write(path("s.yaml"), scenario).expect("room for a file");
        let cell = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/io.yaml");
        let cell = cell.to_str().expect("a path of text");
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let (scenario, bag) = (path("s.yaml"), path("run.mcap"));
        let args = ["run", cell, "--sim", "--store", "none", "--flight-recorder", "0", "--scenario", &scenario];
        let program = Program::start(&[&args[..], &["--record", &bag]].concat(), &domain);
        cyclone.run("axis-states /lineshaft");
        cyclone.run("events /lineshaft");
        Self { cyclone, program, folder }
    }

    fn axis(&mut self, axis: &str) -> Value {
        self.cyclone.run("axis-states /lineshaft")["axes"][axis].clone()
    }

    fn states(&mut self) -> [Value; 2] {
        ["lift", "slide"].map(|axis| self.axis(axis)["state"].clone())
    }

    /// Ends it with the signal of Ctrl-C, and replays the recording.
    #[track_caller]
    fn ends_and_replays(&mut self) {
        self.program.end();
        let bag = self.folder.path().join("run.mcap");
        let replay = Command::new(env!("CARGO_BIN_EXE_lineshaft")).arg("replay").arg(&bag).output().expect("it starts");
        let text = String::from_utf8_lossy(&replay.stdout).into_owned() + &String::from_utf8_lossy(&replay.stderr);
        assert_eq!(replay.status.code(), Some(0), "{text}");
    }
}

/// Proves: MACS-CMD-27, MACS-IO-03
#[test]
fn outputs_are_set_together_or_not_at_all() {
    // The drive of slide fails once any of them is set, that of lift once alarm is 0 again.
    let mut node = Node::start(
        "scenario: s
for: 600 s
steps:
  - {when: {any: [{signal: lamp, is: 1}, {signal: alarm, is: 1}, {signal: speed, not: 0 V}]},
     do: {inject: {fault: {axis: slide, code: 1}}}}
  - {when: {all: [{signal: lamp, is: 1}, {signal: alarm, is: 0}, {signal: speed, is: 2.5 V}]},
     do: {inject: {fault: {axis: lift, code: 1}}}}
",
    );
    node.cyclone.run("axes /lineshaft enable");
    for (request, sentence) in [
        ("", "no output is named; one or more, each with a value, are expected"),
        ("lamp=1 q=1", "no output is called `q`; there are alarm, moves, brake, clamp, lamp, speed"),
        ("clear=1", "no output is called `clear`; there are alarm, moves, brake, clamp, lamp, speed"),
        ("speed=2.5 lamp=2", "lamp is `2`; 0 or 1 is expected"),
        ("lamp=1 speed=nan", "speed is `NaN`; -10 V to 10 V is expected"),
        ("speed=12", "speed is `12`; -10 V to 10 V is expected"),
        ("speed=inf", "speed is `inf`; -10 V to 10 V is expected"),
        ("lamp=1 lamp=1", "output `lamp` stands twice; once is allowed"),
        ("lamp=1 speed", "outputs holds 2, values 1; as many of both are needed"),
        ("lamp=1 brake=1", "brake: 1 may not be set, nor any value: lift switches this output by itself"),
    ] {
        assert_eq!(node.cyclone.fails(&format!("set-output /lineshaft {request}")), sentence, "{request}");
    }
    let seen = node.cyclone.run("events /lineshaft --seconds 0.3");
    let refused = seen.all().iter().filter(|one| one["message"]["kind"] == "refused").count();
    assert_eq!(refused, 10, "each refusal is an event: {seen:?}");
    assert_eq!(node.states(), ["STANDSTILL", "STANDSTILL"], "what is refused sets nothing");
    node.cyclone.run("set-output /lineshaft lamp=1 speed=2.5 alarm=1");
    node.cyclone.run("events /lineshaft --until error --seconds 10");
    assert_eq!(node.states(), ["STANDSTILL", "ERROR_STOP"], "they are set");
    // An output with a function may be set: alarm shows the error of slide.
    node.cyclone.run("set-output /lineshaft alarm=0");
    node.cyclone.run("events /lineshaft --until error --seconds 10");
    assert_eq!(node.states(), ["ERROR_STOP", "ERROR_STOP"]);
    node.ends_and_replays();
}

/// Proves: MACS-ERR-09
#[test]
fn abort_answers_when_all_axes_stand_and_are_locked() {
    let mut node = Node::start("scenario: s\nfor: 600 s\nsteps: []\n");
    node.cyclone.run("axes /lineshaft enable");
    // The brake of slide: nothing else opens it.
    node.cyclone.run("set-output /lineshaft clamp=1");
    let goal = node.cyclone.run("move /lineshaft --axis slide --mode velocity --velocity 0.2");
    let goal = goal["goal"].as_str().expect("a goal").to_owned();
    let seen = node.cyclone.run("abort /lineshaft");
    assert_eq!(seen["message"], "2 axes stopped and locked; ~/reset_errors unlocks");
    for axis in ["lift", "slide"] {
        let seen = node.axis(axis);
        assert_eq!((&seen["state"], &seen["command_velocity"]), (&json!("STOPPING"), &json!(0.0)), "{axis}: {seen}");
    }
    let seen = node.cyclone.run(&format!("result /lineshaft move_axis {goal} --expect ABORTED"));
    assert_eq!(seen["result"]["code"], ABORTED);
    let seen = node.cyclone.run("move /lineshaft --axis lift --mode relative --position 0.001 --wait --expect ABORTED");
    assert_eq!(seen["result"]["message"], "lift: abort has stopped the axis; reset_errors lets it go on");
    node.cyclone.run("axes /lineshaft reset_errors");
    let seen = node.cyclone.run("move /lineshaft --axis lift --mode relative --position 0.001 --wait");
    assert_eq!(seen["result"]["code"], 0);
    node.ends_and_replays();
}
