//! Tests the actions of grippers from a client on Cyclone DDS.

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};
use std::fs;

/// The thumb approaches its target slower than 1 mm/s, like one that holds an object.
const CELL: &str = "
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
axes:
  finger: {type: linear, unit: mm, joint: left_finger, scale: {increments: 1000, per: 1 mm}, sim: {model: ideal},
    drive: {backend: plant, address: 0, interface: position}, max_velocity: 100 mm/s, max_acceleration: 1 m/s^2}
  thumb: {type: linear, unit: mm, scale: {increments: 1000, per: 1 mm}, sim: {model: second_order, bandwidth: 0.02 Hz, damping: 1},
    max_following_error: 100 mm, drive: {backend: plant, address: 1, interface: position}, max_velocity: 100 mm/s, max_acceleration: 1 m/s^2}
groups:
  tight: {axes: [thumb], gripper: {allow_stalling: true}}
  strict: {axes: [thumb], gripper: {}}
  hand: {axes: [finger], gripper: {}}
  arm: {axes: [finger]}
";

#[test]
fn gripper_reaches_goals_of_both_types() {
    let folder = tempfile::tempdir().expect("a folder");
    let cell = folder.path().join("cell.yaml");
    fs::write(&cell, CELL).expect("room for a file");
    let domain = Domain::take();
    let mut cyclone = Peer::cyclone(&domain);
    let arguments = ["run", cell.to_str().expect("a path of text"), "--store", "none", "--flight-recorder", "0"];
    let program = Program::start(&arguments, &domain);
    cyclone.run("axis-states /lineshaft");
    let reads = cyclone.run("graph /lineshaft")["reads"].clone();
    assert!(!reads.to_string().contains("arm/gripper_cmd"), "{reads}");
    // Without power. The result has no field for the reason.
    assert_eq!(cyclone.run("gripper /lineshaft --group hand --position 0.02")["status"], "ABORTED");
    program.wait_for_log(
        "/lineshaft/hand/gripper_cmd: goal aborted: axis finger (joint left_finger): the axis is not enabled",
    );
    cyclone.run("axes /lineshaft enable");

    let seen = cyclone.run("gripper /lineshaft --group hand --position 0.02");
    assert_eq!((&seen["status"], &seen["result"]["reached_goal"]), (&json!("SUCCEEDED"), &json!(true)), "{seen:?}");
    // Within in_position_window, one increment.
    let is_at = |position: &Value, expected: f64| (position.as_f64().expect("a number") - expected).abs() < 1.5e-6;
    assert!(is_at(&seen["result"]["position"], 0.02), "{seen:?}");
    let goal = "gripper /lineshaft --group hand --parallel --joint left_finger --position 0.03 --velocity 0.05";
    let seen = cyclone.run(goal);
    assert_eq!((&seen["status"], &seen["result"]["reached_goal"]), (&json!("SUCCEEDED"), &json!(true)));
    let state = &seen["result"]["state"];
    assert!(state["name"] == json!(["left_finger"]) && is_at(&state["position"][0], 0.03), "{state}");
    assert!(seen["feedback"].as_u64() > Some(0), "{seen:?}");

    // 0.126/s * 10 mm / e = 0.46 mm/s at most, and less than 1 mm of travel within seconds.
    for (group, status, position) in [("tight", "SUCCEEDED", 0.01), ("strict", "ABORTED", -0.01)] {
        let seen = cyclone.run(&format!("gripper /lineshaft --group {group} --position {position}"));
        let (stalled, reached) = (&seen["result"]["stalled"], &seen["result"]["reached_goal"]);
        assert_eq!((&seen["status"], stalled, reached), (&json!(status), &json!(true), &json!(false)), "{seen:?}");
    }
    for (goal, sentence) in [
        ("--position 0.01 --effort 5", "the largest effort is 5; 0 is expected, as the axis has no limit of effort"),
        ("--parallel --joint thumb --position 0.01", "command.name is [\"thumb\"]; `left_finger` or none is expected"),
        ("--position nan", "NaN"),
    ] {
        assert_eq!(cyclone.fails(&format!("gripper /lineshaft --group hand {goal}")), "the goal was rejected");
        program.wait_for_log(sentence);
    }
    assert_eq!(cyclone.run("axis-states /lineshaft")["axes"]["finger"]["command_increments"], 30_000);
}
