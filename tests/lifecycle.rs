//! Tests the ROS 2 lifecycle, /diagnostics and ~/cycle_statistics, with a peer on Eclipse Cyclone DDS.

use std::{
    fs,
    path::Path,
    process::Command,
    time::{Duration, Instant},
};

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A node and its client.
struct Node {
    cyclone: Peer,
    program: Program,
    folder: TempDir,
}

impl Node {
    /// Starts the built-in demo; with `autostart` false it waits to be configured.
    fn start(autostart: bool, args: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml");
        let text = fs::read_to_string(demo).expect("the demo");
        let text = text.replace("autostart: true", &format!("autostart: {autostart}"));
        let cell = folder.path().join("cell.yaml");
        fs::write(&cell, text).expect("room for a file");
        let path = |arg: &str| arg.replace("BENCH", folder.path().to_str().expect("a path of text"));
        let args: Vec<String> =
            ["run", "BENCH/cell.yaml", "--flight-recorder", "0"].iter().chain(args).map(|arg| path(arg)).collect();
        let domain = Domain::take();
        let cyclone = Peer::cyclone(&domain);
        let program = Program::start(&args.iter().map(String::as_str).collect::<Vec<_>>(), &domain);
        let mut node = Self { cyclone, program, folder };
        // Returns when the service is available.
        node.state();
        node
    }

    /// Starts it unconfigured, with a subscriber of all transitions.
    fn watched(args: &[&str]) -> Self {
        let mut node = Self::start(false, args);
        node.cyclone.run("transition-events /lineshaft");
        node
    }

    fn inactive() -> Self {
        let mut node = Self::start(false, &[]);
        node.change("configure");
        node
    }

    #[track_caller]
    fn state(&mut self) -> String {
        let seen = self.cyclone.run("lifecycle /lineshaft state");
        seen["state"]["label"].as_str().expect("a label").to_owned()
    }

    /// Makes a transition, which must succeed.
    #[track_caller]
    fn change(&mut self, transition: &str) {
        let seen = self.cyclone.run(&format!("change-state /lineshaft {transition}"));
        assert_eq!(seen["success"], json!([true]), "{transition}: {}", self.program.log());
    }

    #[track_caller]
    fn refuses(&mut self, transition: &str) {
        let seen = self.cyclone.run(&format!("change-state /lineshaft {transition}"));
        assert_eq!(seen["success"], json!([false]), "{transition}");
    }

    /// Waits until turret has the commanded 1.5 rad/s.
    fn turns(&mut self) {
        let end = Instant::now() + Duration::from_secs(20);
        while self.axis("turret")["command_velocity"].as_f64().is_none_or(|velocity| velocity < 1.499) {
            assert!(Instant::now() < end, "{}", self.axis("turret"));
        }
    }

    fn axis(&mut self, axis: &str) -> Value {
        self.cyclone.run("axis-states /lineshaft")["axes"][axis].clone()
    }
}

fn labels(seen: &Value) -> Vec<String> {
    let all = seen.as_array().expect("a list").iter();
    all.map(|one| one.as_array().expect("a list").last().expect("a label").as_str().expect("a text").to_owned())
        .collect()
}

/// Returns the transitions of rcl_lifecycle: ID, label, start, goal.
fn graph() -> Value {
    json!([
        [1, "configure", "unconfigured", "configuring"],
        [10, "transition_success", "configuring", "inactive"],
        [11, "transition_failure", "configuring", "unconfigured"],
        [12, "transition_error", "configuring", "errorprocessing"],
        [2, "cleanup", "inactive", "cleaningup"],
        [20, "transition_success", "cleaningup", "unconfigured"],
        [21, "transition_failure", "cleaningup", "inactive"],
        [22, "transition_error", "cleaningup", "errorprocessing"],
        [3, "activate", "inactive", "activating"],
        [30, "transition_success", "activating", "active"],
        [31, "transition_failure", "activating", "inactive"],
        [32, "transition_error", "activating", "errorprocessing"],
        [4, "deactivate", "active", "deactivating"],
        [40, "transition_success", "deactivating", "inactive"],
        [41, "transition_failure", "deactivating", "active"],
        [42, "transition_error", "deactivating", "errorprocessing"],
        [5, "shutdown", "unconfigured", "shuttingdown"],
        [6, "shutdown", "inactive", "shuttingdown"],
        [7, "shutdown", "active", "shuttingdown"],
        [50, "transition_success", "shuttingdown", "finalized"],
        [51, "transition_failure", "shuttingdown", "finalized"],
        [52, "transition_error", "shuttingdown", "errorprocessing"],
        [60, "transition_success", "errorprocessing", "unconfigured"],
        [61, "transition_failure", "errorprocessing", "finalized"],
        [62, "transition_error", "errorprocessing", "finalized"]
    ])
}

#[test]
fn lifecycle_services_and_topic_report_all_states() {
    let mut node = Node::watched(&[]);
    assert_eq!(node.state(), "unconfigured");
    let states = node.cyclone.run("lifecycle /lineshaft states");
    let known = json!([
        [0, "unknown"],
        [1, "unconfigured"],
        [2, "inactive"],
        [3, "active"],
        [4, "finalized"],
        [10, "configuring"],
        [11, "cleaningup"],
        [12, "shuttingdown"],
        [13, "activating"],
        [14, "deactivating"],
        [15, "errorprocessing"]
    ]);
    assert_eq!(states["states"], known);
    assert_eq!(node.cyclone.run("lifecycle /lineshaft graph")["graph"], graph());
    let from_here = |node: &mut Node| {
        let seen = node.cyclone.run("lifecycle /lineshaft transitions")["transitions"].clone();
        seen.as_array().expect("a list").iter().map(|one| one[0].as_u64().expect("an id")).collect::<Vec<_>>()
    };
    assert_eq!(from_here(&mut node), [1, 5]);

    // Transitions that are not possible here, by ID and by label.
    for wrong in ["3", "activate", "2", "4", "0", "7", "10", "transition_success", "nonsense"] {
        node.refuses(wrong);
    }
    assert_eq!(node.state(), "unconfigured");

    node.change("1");
    assert_eq!((node.state().as_str(), from_here(&mut node)), ("inactive", vec![2, 3, 6]));
    node.change("activate");
    assert_eq!((node.state().as_str(), from_here(&mut node)), ("active", vec![4, 7]));
    node.change("4");
    node.change("cleanup");
    assert_eq!(node.state(), "unconfigured");
    node.change("configure");
    node.change("3");
    node.change("shutdown");
    assert_eq!((node.state().as_str(), from_here(&mut node)), ("finalized", vec![]));
    node.refuses("configure");
    node.refuses("shutdown");

    let seen = node.cyclone.run("transition-events /lineshaft --until finalized");
    let steps = [
        "configuring",
        "inactive",
        "activating",
        "active",
        "deactivating",
        "inactive",
        "cleaningup",
        "unconfigured",
        "configuring",
        "inactive",
        "activating",
        "active",
        "shuttingdown",
        "finalized",
    ];
    assert_eq!(labels(&seen["events"]), steps);
    assert_eq!(seen["stamped"], true);
    let all = graph();
    for event in seen["events"].as_array().unwrap() {
        assert!(all.as_array().unwrap().contains(event), "{event}");
    }
    // The process runs until it is ended.
    node.program.end();
}

#[test]
fn autostart_is_active_by_itself() {
    let mut node = Node::start(true, &[]);
    node.cyclone.run("axis-states /lineshaft");
    assert_eq!(node.state(), "active");
    node.cyclone.run("axes /lineshaft enable x");
    node.change("shutdown");
    assert_eq!(node.state(), "finalized");
    node.program.end();
}

#[test]
fn an_inactive_node_refuses_at_every_door_what_could_switch_on_or_move_and_still_publishes() {
    let mut node = Node::inactive();
    let before = node.axis("x")["command_increments"].clone();
    let inactive = "the machine is inactive; activate it first";
    for door in [
        "axes /lineshaft enable x",
        "axes /lineshaft enable",
        "move /lineshaft --axis x --mode relative --units increments --position 1000 --wait",
        "move /lineshaft --axis line --mode velocity --velocity 0.1 --wait",
        "probe /lineshaft --axis x --event x --mode relative --units increments --position 1000",
        "vocabulary /lineshaft x saia {set: {destp: 1000}, commands: [axinit, fldda, fstart]}",
        "vocabulary /lineshaft x wf {mode: mdi, enable: true}",
    ] {
        let sentence = node.cyclone.fails(door);
        assert!(sentence.contains(inactive), "{door}: {sentence}");
    }
    // A refused coupling never begins.
    node.cyclone.fails("synchronize /lineshaft --axis x --master line --numerator 1 --denominator 1");
    let after = node.axis("x");
    assert_eq!((&after["command_increments"], &after["enabled"]), (&before, &json!(false)));
    for axis in ["line", "x", "y", "turret"] {
        assert_eq!(node.axis(axis)["command_velocity"], 0.0);
    }

    // Reading works, parameters may be set, stops are accepted.
    let seen = node.cyclone.run("joint-states --count 20 --seconds 20");
    assert_eq!(seen["received"], 20);
    let seen = node.cyclone.run("params /lineshaft set x.max_velocity=0.5");
    assert_eq!(seen["set"]["results"][0]["successful"], true);
    node.cyclone.run("axes /lineshaft halt");

    node.change("activate");
    node.cyclone.run("axes /lineshaft enable x");
    assert_eq!(node.axis("x")["state"], "STANDSTILL");
    node.program.end();
}

#[test]
fn deactivation_stops_what_moves_under_control_and_ends_its_goal() {
    let mut node = Node::inactive();
    node.change("activate");
    node.cyclone.run("axes /lineshaft enable turret");
    let seen = node.cyclone.run("move /lineshaft --axis turret --mode velocity --velocity 1.5");
    let goal = seen["goal"].as_str().unwrap().to_owned();
    node.turns();
    node.cyclone.run("axis-states /lineshaft --all");
    node.change("deactivate");
    let seen = node.cyclone.run("axis-states /lineshaft --all");
    let turret = |sample: &Value| sample["axes"]["turret"].clone();
    let samples: Vec<Value> = seen.all().iter().map(turret).collect();
    let speed = |sample: &Value| sample["command_velocity"].as_f64().unwrap();
    assert!(samples.iter().any(|one| speed(one) > 1.4), "it moved");
    // 1.5 rad/s at 360 deg/s^2 need 0.24 s to stop: samples during the deceleration are seen.
    assert!(samples.iter().any(|one| speed(one) > 0.1 && speed(one) < 1.4 && one["enabled"] == true), "{samples:?}");
    let seen = node.cyclone.run(&format!("result /lineshaft move_axis {goal} --expect ABORTED"));
    assert_eq!(seen["result"]["code"], 10105);
    let last = node.axis("turret");
    assert_eq!((&last["state"], &last["enabled"], speed(&last)), (&json!("DISABLED"), &json!(false), 0.0));
    assert_eq!(node.state(), "inactive");
    node.program.end();
}

#[test]
fn there_is_one_transition_at_a_time() {
    let mut node = Node::inactive();
    node.change("activate");
    node.cyclone.run("axes /lineshaft enable turret");
    node.cyclone.run("move /lineshaft --axis turret --mode velocity --velocity 1.5");
    node.turns();
    // The stop takes 0.24 s: requests during it are refused immediately.
    let seen = node.cyclone.run("change-state /lineshaft deactivate shutdown deactivate");
    assert_eq!(seen["success"], json!([true, false, false]));
    assert_eq!(node.state(), "inactive");
    node.program.end();
}

#[test]
fn unconfigured_node_runs_no_cycle_and_continues_at_its_position() {
    let mut node = Node::inactive();
    node.change("activate");
    node.cyclone.run("axes /lineshaft enable x");
    node.cyclone.run("move /lineshaft --axis x --units increments --position 100000 --wait");
    node.change("deactivate");
    let before = node.cyclone.run("axis-states /lineshaft")["cycle"].as_u64().unwrap();
    node.change("cleanup");

    let last = |node: &mut Node| node.cyclone.run("cycle-statistics /lineshaft")["statistics"][0].clone();
    last(&mut node);
    let (first, second) = (last(&mut node), last(&mut node));
    assert_eq!((&first["cycles"], &second["period_cycles"]), (&second["cycles"], &json!(0)), "no cycle runs");
    let unconfigured = "the node is unconfigured and no cycle runs";
    for door in [
        "axes /lineshaft enable x",
        "axes /lineshaft halt",
        "axes /lineshaft disable",
        "axes /lineshaft reset_errors",
        "move /lineshaft --axis x --units increments --position 5 --wait",
        "vocabulary /lineshaft x saia commands: [axinit]",
        "layers /lineshaft save x",
        "layers /lineshaft reset x",
        "import /lineshaft x.max_velocity: 0.25 m/s",
        "record /lineshaft start --path never",
    ] {
        let sentence = node.cyclone.fails(door);
        assert!(sentence.contains(unconfigured), "{door}: {sentence}");
    }
    let seen = node.cyclone.run("params /lineshaft set x.max_velocity=0.25");
    assert!(seen["set"]["results"][0]["reason"].as_str().unwrap().contains(unconfigured));
    // Parameters may be read.
    assert_eq!(node.cyclone.run("params /lineshaft get x.max_velocity")["get"][0], 1.2);

    node.change("configure");
    let state = node.cyclone.run("axis-states /lineshaft");
    assert!(state["cycle"].as_u64().unwrap() > before);
    assert_eq!(state["axes"]["x"]["position_increments"], 100_000, "the machine has kept its state");
    // Requests before the configuration were refused, and are not executed later.
    assert_eq!(state["axes"]["x"]["enabled"], false);
    let pause = last(&mut node);
    assert_eq!(pause["missed"].as_u64().unwrap() / 1000, 0, "the pause of some seconds is no missed cycle: {pause}");
    node.change("activate");
    node.cyclone.run("axes /lineshaft enable x");
    node.cyclone.run("move /lineshaft --axis x --units increments --position 5 --wait");
    assert_eq!(node.axis("x")["command_increments"], 5);
    node.program.end();
}

#[test]
fn ctrl_c_ends_it_in_every_state() {
    for transitions in [&[][..], &["configure"], &["configure", "cleanup"], &["shutdown"], &["configure", "shutdown"]] {
        let mut node = Node::start(false, &[]);
        transitions.iter().for_each(|transition| node.change(transition));
        node.program.end();
    }
}

#[test]
fn a_run_that_was_configured_activated_and_cleaned_up_replays() {
    let mut node = Node::start(false, &["--record", "BENCH/run.mcap"]);
    node.change("configure");
    node.cyclone.fails("axes /lineshaft enable x");
    node.change("activate");
    node.cyclone.run("axes /lineshaft enable x");
    node.cyclone.run("move /lineshaft --axis x --units increments --position 100000 --wait");
    node.change("deactivate");
    node.change("cleanup");
    node.change("configure");
    node.cyclone.fails("axes /lineshaft enable x");
    node.program.end();
    let bag = node.folder.path().join("run.mcap");
    let replay = Command::new(env!("CARGO_BIN_EXE_lineshaft")).arg("replay").arg(&bag).output().unwrap();
    let text = String::from_utf8_lossy(&replay.stdout).into_owned() + &String::from_utf8_lossy(&replay.stderr);
    assert_eq!(replay.status.code(), Some(0), "{text}");
    let seen = crate::support::bag_check::bag_check(["mcap", bag.to_str().unwrap()]);
    assert!(seen["counts"]["/lineshaft/commands"].as_u64().unwrap() >= 8, "{seen}");
}

#[test]
fn diagnostics_are_published_once_a_second_even_without_cycles() {
    let mut node = Node::start(false, &[]);
    let seen = node.cyclone.run("diagnostics /lineshaft --until machine=3");
    assert_eq!(
        seen["names"],
        json!(["lineshaft: machine", "lineshaft: x", "lineshaft: y", "lineshaft: turret", "lineshaft: recorder"])
    );
    assert_eq!(seen["last"]["lineshaft: machine"]["message"], "no cycle runs; the node is unconfigured");
    assert_eq!(seen["last"]["lineshaft: x"]["level"], 3);
    node.change("configure");
    let seen = node.cyclone.run("diagnostics /lineshaft --until machine=0");
    assert_eq!(seen["last"]["lineshaft: machine"]["message"], "inactive");
    let turret = &seen["last"]["lineshaft: turret"];
    assert_eq!((&turret["level"], &turret["hardware_id"]), (&json!(0), &json!("plant:2")), "{turret}");
    assert_eq!(
        (&turret["message"], &turret["values"]["drive state"]),
        (&json!("DISABLED"), &json!("SWITCH_ON_DISABLED"))
    );
    assert_eq!(turret["values"]["position"], "0 deg");
    assert_eq!(seen["last"]["lineshaft: recorder"]["message"], "not recording");
    let seen = node.cyclone.run("diagnostics /lineshaft --seconds 5.5");
    let count = seen["count"].as_u64().unwrap();
    assert!((4..=9).contains(&count), "{count} in 5.5 s: {}", seen["times"]);
    node.change("cleanup");
    node.cyclone.run("diagnostics /lineshaft --until machine=3");
    node.program.end();
}

#[test]
fn a_fault_of_a_drive_is_diagnosed_at_once_with_its_sentence() {
    let scenario = "scenario: a fault\nfor: 60 s\nsteps:\n  - {at: 0, do: {enable: {axes: [x]}}}\n  - {at: 8 s, do: {inject: \
                    {fault: {axis: x, code: 0x2310}}}}\n";
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("fault.yaml");
    fs::write(&file, scenario).expect("room for a file");
    let mut node = Node::start(true, &["--scenario", file.to_str().unwrap()]);
    let seen = node.cyclone.run("diagnostics /lineshaft --seconds 30 --until x=2");
    let (x, machine) = (&seen["last"]["lineshaft: x"], &seen["last"]["lineshaft: machine"]);
    assert_eq!((&x["hardware_id"], &x["values"]["error code"]), (&json!("plant:0"), &json!("74512")), "{x}");
    assert!(x["message"].as_str().unwrap().contains("2310"), "{x}");
    assert_eq!((&machine["level"], &machine["message"]), (&json!(2), &json!("an axis is in error")));
    assert_eq!(seen["last"]["lineshaft: y"]["level"], 0);
    // An array that was published before the end of its second also has the order of the cell.
    node.cyclone.run("diagnostics /lineshaft --seconds 3");
    drop(node);
}

#[test]
fn statistics_of_the_cycle_come_once_a_second() {
    let mut node = Node::start(true, &[]);
    let seen = node.cyclone.run("cycle-statistics /lineshaft --count 3");
    let [first, second, third] = seen["statistics"].as_array().unwrap().as_slice() else { panic!("{seen:?}") };
    let of = |one: &Value, key: &str| one[key].as_f64().unwrap();
    for (before, now) in [(first, second), (second, third)] {
        assert_eq!(of(now, "cycles") - of(before, "cycles"), of(now, "period_cycles"));
        assert_eq!(of(now, "missed") - of(before, "missed"), of(now, "period_missed"));
        // One second of 1 ms cycles, on a machine with other load.
        let all = of(now, "period_cycles") + of(now, "period_missed");
        assert!((500.0..2000.0).contains(&all), "{now}");
        for what in ["lateness", "duration"] {
            let [mean, max, worst] = ["mean", "max", "worst"].map(|key| of(now, &format!("{what}_{key}")));
            assert!(0.0 < mean && mean <= max && max <= worst, "{now}");
            for (time, max) in [("", max), ("_since_start", worst)] {
                let [p50, p99, p999] = ["p50", "p99", "p999"].map(|key| of(now, &format!("{what}_{key}{time}")));
                assert!(0.0 < p50 && p50 <= p99 && p99 <= p999 && p999 <= max, "{now}");
            }
        }
        assert_eq!((of(now, "cycle_ns"), of(now, "events_lost")), (1e6, 0.0));
        assert!(of(now, "cycle") > of(before, "cycle"));
    }
    node.program.end();
}

#[test]
fn a_scenario_may_not_switch_the_activity_of_a_node() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scenario.yaml");
    fs::write(&file, "scenario: s\nfor: 1 s\nsteps:\n  - {at: 0, do: {deactivate: {}}}\n").expect("room for a file");
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        let command = command.args(args).arg("--scenario").arg(&file).env("ROS_HOME", folder.path());
        let output = command.current_dir(folder.path()).output().expect("the program starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = run(&["run"]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("activate and deactivate are not for `run`"), "{text}");
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml");
    assert_eq!(run(&["sim", demo.to_str().unwrap()]).0, Some(0));
}
