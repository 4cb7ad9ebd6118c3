//! Tests `~/home`, `~/home_axis` and `~/set_position` from a client on Cyclone DDS, and their recordings.

use std::{fs, process::Command};

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

const HOMING_NO_METHOD: u32 = 10302;
const HOMING_UNKNOWN_METHOD: u32 = 10303;
const HOMING_REQUIRED: u32 = 6;
const HOMING_INDEX_MISSED: u32 = 10307;

/// x and z home at their position when switched on (35, 37); y has no method; s moves to a switch 2 m away, at 20 mm/s;
/// t has a switch at 4 mm, and index pulses every 2 mm.
const CELL: &str = "
lineshaft: 1
cycle: 1 ms
ros: {autostart: true}
backends: {plant: {type: sim}}
axes:
  x: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 0, interface: position},
      max_velocity: 100 mm/s, max_acceleration: 1 m/s^2, homing: {method: 35}, sim: {model: ideal}}
  y: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 1, interface: position},
      max_velocity: 100 mm/s, max_acceleration: 1 m/s^2, sim: {model: ideal}}
  z: {type: rotary, unit: deg, scale: {increments: 36000, per: 360 deg}, drive: {backend: plant, address: 2,
      interface: position}, max_velocity: 90 deg/s, max_acceleration: 360 deg/s^2, homing: {method: 37}, sim: {model: ideal}}
  s: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 3, interface: position},
      max_velocity: 100 mm/s, max_acceleration: 1 m/s^2, homing: {method: 24, velocity: 20 mm/s},
      sim: {model: ideal, home_switch: {from: 2 m, to: 3 m}}}
  t: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, drive: {backend: plant, address: 4, interface: position},
      max_velocity: 100 mm/s, max_acceleration: 1 m/s^2,
      homing: {method: 3, velocity: 10 mm/s, index_velocity: 2 mm/s},
      sim: {model: ideal, home_switch: {from: 4 mm, to: 1 m}, index: {every: 2 mm, at: 1 mm}}}
";

/// A node of the cell, and its client.
struct Node {
    cyclone: Peer,
    program: Program,
    folder: tempfile::TempDir,
}

impl Node {
    fn start(cell: &str, args: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("cell.yaml");
        fs::write(&file, cell).expect("room for a file");
        let path = |arg: &str| arg.replace("BENCH", folder.path().to_str().expect("a path of text"));
        let args: Vec<String> =
            ["run", "BENCH/cell.yaml", "--flight-recorder", "0"].iter().chain(args).map(|arg| path(arg)).collect();
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let program = Program::start(&args.iter().map(String::as_str).collect::<Vec<_>>(), &domain);
        // Returns when the service is available.
        cyclone.run("lifecycle /lineshaft state");
        cyclone.run("events /lineshaft");
        if cell.contains("autostart: true") {
            cyclone.run("axis-states /lineshaft");
        }
        Self { cyclone, program, folder }
    }

    /// Starts the node with all axes on.
    fn enabled() -> Self {
        let mut node = Self::start(CELL, &[]);
        node.cyclone.run("axes /lineshaft enable");
        node
    }

    fn axis(&mut self, axis: &str) -> Value {
        self.cyclone.run("axis-states /lineshaft")["axes"][axis].clone()
    }

    #[track_caller]
    fn wait_until_at(&mut self, axis: &str, increments: i64) -> Value {
        let seen = self.axis(axis);
        assert_eq!((&seen["state"], &seen["command_increments"]), (&json!("STANDSTILL"), &json!(increments)), "{seen}");
        seen
    }

    #[track_caller]
    fn moves(&mut self, axis: &str, increments: i64) {
        self.cyclone.run(&format!("move /lineshaft --axis {axis} --units increments --position {increments} --wait"));
    }

    /// Returns the texts of new events of a kind.
    fn events(&mut self, kind: &str) -> Vec<String> {
        let seen = self.cyclone.run("events /lineshaft --seconds 0.3");
        let all = seen.all().iter().filter_map(|one| one.get("message")).filter(|one| one["kind"] == kind);
        all.map(|one| format!("{}: {}", one["source"].as_str().unwrap_or(""), one["text"].as_str().unwrap_or("")))
            .collect()
    }

    /// Returns the latched messages of `~/errors` for a late-joining reader.
    fn history(&mut self) -> Vec<Value> {
        let seen = self.cyclone.run("errors /lineshaft");
        seen.all().iter().filter_map(|one| one.get("message")).cloned().collect()
    }
}

#[test]
fn present_position_becomes_zero_and_the_result_has_the_shift() {
    let mut node = Node::enabled();
    node.moves("x", 12_345);
    assert_eq!(node.axis("x")["homed"], false);
    let seen = node.cyclone.run("home-axis /lineshaft --axis x");
    assert_eq!(seen["result"], json!({"code": 0, "message": "", "shift_increments": 12_345}));
    let x = node.wait_until_at("x", 0);
    assert_eq!((&x["homed"], &x["position_increments"]), (&json!(true), &json!(0)), "{x}");
    let homed = node.events("homed");
    assert!(homed.len() == 1 && homed[0].starts_with("x: "), "{homed:?}");

    // By a method number, whatever the cell has, also for an axis without a method.
    node.moves("x", -700);
    let seen = node.cyclone.run("home-axis /lineshaft --axis x --scheme cia402 --method 37");
    assert_eq!(seen["result"]["shift_increments"], -700);
    node.wait_until_at("x", 0);
    node.moves("y", 5);
    let seen = node.cyclone.run("home-axis /lineshaft --axis y --scheme cia402 --method 35");
    assert_eq!(seen["result"]["shift_increments"], 5);
    assert_eq!(node.wait_until_at("y", 0)["homed"], true);
    assert_eq!(node.axis("z")["homed"], false, "one axis homes, not all");
}

#[test]
fn the_phases_come_as_feedback_in_their_order_and_the_end_is_exact() {
    let mut node = Node::enabled();
    // Method 3: onto the switch, back off it, and on to the first index pulse next to it, which is at 3 mm.
    let seen = node.cyclone.run("home-axis /lineshaft --axis t");
    let phases = seen["phases"].as_array().expect("a list");
    // Short phases may occur between two messages.
    assert_eq!((phases.first(), phases.last()), (Some(&json!(1)), Some(&json!(3))), "{phases:?}");
    assert!(phases.iter().all(|phase| [1, 2, 3].map(|known| json!(known)).contains(phase)), "{phases:?}");
    assert_eq!(seen["result"], json!({"code": 0, "message": "", "shift_increments": 3_000}));
    let positions = seen["positions"].as_array().expect("a list");
    let furthest = positions.iter().filter_map(Value::as_f64).fold(0.0, f64::max);
    assert!((0.002..0.006).contains(&furthest), "positions are told in m, in the old coordinate: {positions:?}");
    assert_eq!(node.axis("t")["homed"], true);
}

#[test]
fn cancel_stops_homing_and_gives_no_zero() {
    let mut node = Node::enabled();
    let seen = node.cyclone.run("home-axis /lineshaft --axis s --cancel-in-phase 1 --expect CANCELED");
    assert_eq!(seen["result"]["shift_increments"], 0);
    let s = node.axis("s");
    assert_eq!((&s["state"], &s["homed"], &s["command_velocity"]), (&json!("STANDSTILL"), &json!(false), &json!(0.0)));
    assert_eq!(node.events("homed"), [""; 0]);
}

#[test]
fn what_is_wrong_in_itself_is_rejected_and_what_the_state_forbids_is_aborted() {
    let mut node = Node::start(CELL, &[]);
    for goal in ["--axis q", "--axis x --scheme 3", "--axis x --scheme 200"] {
        let error = node.cyclone.fails(&format!("home-axis /lineshaft {goal}"));
        assert_eq!(error, "the goal was rejected", "{goal}");
    }
    let refused = node.events("refused");
    let sentence = "machine: home_axis: goal rejected: no axis is called `q`; there are x, y, z, s, t";
    assert_eq!((refused.len(), refused.first().map(String::as_str)), (3, Some(sentence)), "{refused:?}");

    let seen = node.cyclone.run("home-axis /lineshaft --axis x --expect ABORTED");
    assert_ne!(seen["result"]["message"], "", "it is off");
    node.cyclone.run("axes /lineshaft enable");
    for (goal, code) in [
        ("--axis y", HOMING_NO_METHOD),
        ("--axis x --scheme cia402 --method 15", HOMING_UNKNOWN_METHOD),
        ("--axis x --scheme cia402 --method -1", HOMING_UNKNOWN_METHOD),
        ("--axis x --scheme macs --method 4", HOMING_UNKNOWN_METHOD),
    ] {
        let seen = node.cyclone.run(&format!("home-axis /lineshaft {goal} --expect ABORTED"));
        assert_eq!(seen["result"]["code"], code, "{goal}: {seen:?}");
        assert_eq!(seen["result"]["shift_increments"], 0);
    }
    for axis in ["x", "y"] {
        assert_eq!(node.wait_until_at(axis, 0)["homed"], false);
    }
}

#[test]
fn home_answers_while_the_axes_still_home() {
    let mut node = Node::enabled();
    node.moves("x", 800);
    // s needs another 100 s.
    let seen = node.cyclone.run("home /lineshaft x s");
    assert_eq!(seen["message"], "x, s have started homing");
    assert_eq!(node.axis("s")["state"], "HOMING");
    assert_eq!(node.wait_until_at("x", 0)["homed"], true);
    node.cyclone.run("axes /lineshaft halt s");
    assert_eq!(node.axis("s")["homed"], false);

    // All axes with a method: y has none, and is not homed.
    let seen = node.cyclone.run("home /lineshaft");
    assert_eq!(seen["message"], "x, z, s, t have started homing");
    let error = node.cyclone.fails("home /lineshaft y x");
    let [refused, others] = error.split("; ").collect::<Vec<_>>().try_into().expect("two parts");
    assert!(refused.contains('y') && others == "x has started homing", "{error}");
    // s is homing already.
    let error = node.cyclone.fails("home /lineshaft s");
    assert!(error.contains('s') && !error.contains("started"), "{error}");
    assert!(node.cyclone.fails("home /lineshaft q x").contains("no axis is called `q`"));
}

#[test]
fn home_without_a_method_is_refused() {
    let without = CELL.replace("homing: {method: 35}, ", "").replace("homing: {method: 37}, ", "");
    let axes = without.find("  s: ").expect("the last axes");
    let mut node = Node::start(&without[..axes], &[]);
    node.cyclone.run("axes /lineshaft enable");
    assert_eq!(node.cyclone.fails("home /lineshaft"), "no axis has a homing method");
    // The method in force is used, not that of the cell.
    node.cyclone.run("params /lineshaft set z.homing.method=35");
    assert_eq!(node.cyclone.run("home /lineshaft")["message"], "z has started homing");
}

#[test]
fn a_position_is_set_and_nothing_moves() {
    let mut node = Node::enabled();
    node.moves("x", 100);
    for (position, units, increments) in [
        ("0.25", "si", 250_000),
        ("-3.5", "axis_unit", -3_500),
        ("2000000001", "increments", 2_000_000_001),
        ("0", "si", 0),
    ] {
        let seen = node.cyclone.run(&format!("set-position /lineshaft --axis x --position {position} --units {units}"));
        assert_eq!(seen["message"], "");
        let x = node.wait_until_at("x", increments);
        assert_eq!(
            (&x["position_increments"], &x["following_error_increments"]),
            (&json!(increments), &json!(0)),
            "{x}"
        );
    }
    // Goals are in the new coordinates.
    node.moves("x", 40);
    node.wait_until_at("x", 40);

    for (request, part) in [
        ("--axis q", "no axis is called `q`"),
        ("--axis x --position nan", "position"),
        ("--axis x --position 1e300", "position"),
        ("--axis x --units 3", "units"),
    ] {
        let error = node.cyclone.fails(&format!("set-position /lineshaft {request}"));
        assert!(error.contains(part), "{request}: {error}");
    }
    node.cyclone.run("home-axis /lineshaft --axis s --leave");
    let error = node.cyclone.fails("set-position /lineshaft --axis s --position 0");
    assert!(error.starts_with("s"), "it moves: {error}");
    node.wait_until_at("x", 40);
}

#[test]
fn an_inactive_node_does_not_home() {
    let mut node = Node::start(&CELL.replace("autostart: true", "autostart: false"), &[]);
    node.cyclone.run("change-state /lineshaft configure");
    let error = node.cyclone.fails("home /lineshaft x");
    assert!(error.contains("activate"), "{error}");
    let seen = node.cyclone.run("home-axis /lineshaft --axis x --expect ABORTED");
    assert!(seen["result"]["message"].as_str().expect("a text").contains("activate"), "{seen:?}");
    assert_eq!(node.axis("x")["homed"], false);
}

#[test]
fn switches_show_in_the_state_of_their_axis() {
    let scenario = "{scenario: s, for: 600 s, steps: [\n\
                    {when: {signal: x.enabled, is: 1}, do: {inject: {stuck_switch: {axis: y, positive: 1}}}},\n\
                    {at: 0, do: {inject: {stuck_switch: {axis: z, negative: 1}}}}]}";
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("stuck.yaml");
    fs::write(&file, scenario).expect("room for a file");
    let mut node = Node::start(CELL, &["--scenario", file.to_str().expect("a path of text")]);
    let limits = |axis: Value| [axis["negative_limit"] == true, axis["positive_limit"] == true];
    assert_eq!(["x", "y", "z"].map(|axis| limits(node.axis(axis))), [[false, false], [false, false], [true, false]]);
    node.cyclone.run("axes /lineshaft enable x");
    assert_eq!(["x", "y", "z"].map(|axis| limits(node.axis(axis))), [[false, false], [false, true], [true, false]]);
}

/// The encoder of t loses its index when t is switched on: homing ends with the error of HOME-05, which the client
/// gets, and every late-joining reader of the history.
///
/// Proves: MACS-HOME-05
#[test]
fn lost_index_aborts_homing_and_is_in_the_error_history() {
    let scenario = "{scenario: s, for: 600 s, steps: [\n\
                    {when: {signal: t.enabled, is: 1}, do: {inject: {index_lost: {axis: t}}}}]}";
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lost.yaml");
    fs::write(&file, scenario).expect("room for a file");
    let cell = CELL.replace("index_velocity: 2 mm/s}", "index_velocity: 2 mm/s, index_distance: 3 mm}");
    let mut node = Node::start(&cell, &["--scenario", file.to_str().expect("a path of text")]);
    assert_eq!(node.history(), [] as [Value; 0], "nothing has happened yet");
    node.cyclone.run("axes /lineshaft enable");
    let seen = node.cyclone.run("home-axis /lineshaft --axis t --expect ABORTED");
    assert_eq!(seen["result"]["code"], HOMING_INDEX_MISSED, "{seen:?}");
    let sentence = "no index pulse came within homing.index_distance 3 mm";
    let told = seen["result"]["message"].as_str().expect("a text");
    assert!(told.contains(sentence), "{told}");
    assert_eq!(seen["result"]["shift_increments"], 0);
    let t = node.axis("t");
    assert_eq!((&t["state"], &t["homed"]), (&json!("ERROR_STOP"), &json!(false)), "{t}");
    assert_eq!(t["error_code"], HOMING_INDEX_MISSED);

    // With the state of the axis, and the remedy.
    let [kept] = node.history().try_into().expect("one error");
    assert_eq!(
        (&kept["kind"], &kept["source"], &kept["code"]),
        (&json!("error"), &json!("t"), &json!(10307)),
        "{kept}"
    );
    let text = kept["text"].as_str().expect("a text");
    let stood = format!("(cycle {}: command ", kept["cycle"]);
    for part in [sentence, &stood, "actual ", "following error ", "). Check the encoder's index and its cable"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    node.cyclone.run("axes /lineshaft reset_errors t");
    let kinds: Vec<_> = node.history().iter().map(|one| one["kind"].clone()).collect();
    assert_eq!(kinds, ["error", "reset"]);
    node.wait_until_at("x", 0);
}

/// HOME_FORCE: without a zero no goal moves the axis; homing does, and then permits goals.
///
/// Proves: MACS-HOME-09
#[test]
fn an_axis_that_must_home_refuses_goals_until_it_has() {
    let mut node = Node::start(&CELL.replace("homing: {method: 35}", "homing: {method: 35, required: true}"), &[]);
    node.cyclone.run("axes /lineshaft enable");
    let seen = node.cyclone.run("move /lineshaft --axis x --units increments --position 100 --wait --expect ABORTED");
    assert_eq!(seen["result"]["code"], HOMING_REQUIRED, "{seen:?}");
    let message = seen["result"]["message"].as_str().expect("a text");
    assert!(message.contains("homing is required and has not been done; home the axis first"), "{message}");
    node.wait_until_at("x", 0);
    node.moves("y", 5);
    node.cyclone.run("home-axis /lineshaft --axis x");
    node.moves("x", 100);
    node.wait_until_at("x", 100);
}

#[test]
fn a_run_with_homing_and_new_positions_replays() {
    let mut node = Node::start(CELL, &["--record", "BENCH/run.mcap"]);
    node.cyclone.run("axes /lineshaft enable");
    node.moves("x", 4_321);
    node.cyclone.run("home-axis /lineshaft --axis x");
    node.cyclone.run("home-axis /lineshaft --axis t");
    node.cyclone.run("home-axis /lineshaft --axis s --cancel-in-phase 1 --expect CANCELED");
    node.cyclone.run("set-position /lineshaft --axis x --position 7.5 --units axis_unit");
    node.moves("x", -20);
    node.cyclone.run("home /lineshaft x z");
    node.program.end();
    let bag = node.folder.path().join("run.mcap");
    let replay = Command::new(env!("CARGO_BIN_EXE_lineshaft")).arg("replay").arg(&bag).output().expect("it starts");
    let text = String::from_utf8_lossy(&replay.stdout).into_owned() + &String::from_utf8_lossy(&replay.stderr);
    assert_eq!(replay.status.code(), Some(0), "{text}");
    let seen = crate::support::bag_check::bag_check(["mcap", bag.to_str().expect("a path of text")]);
    assert!(seen["counts"]["/lineshaft/commands"].as_u64().is_some_and(|count| count >= 9), "{seen}");
}
