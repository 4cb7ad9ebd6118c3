//! Tests the services of controller_manager, called by a peer on Eclipse Cyclone DDS like `ros2 control` and MoveIt.
//!
//! The demo is the node /lineshaft with x, y and turret; the group arm has turret and x, the group hand has y.

use std::path::PathBuf;
use std::{fs, path::Path};

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

/// MoveIt derives `/lineshaft/arm/follow_joint_trajectory` from this name and the name of a controller.
const MANAGER: &str = "/lineshaft/controller_manager";
const GROUPS: &str = "\ngroups:\n  arm: [turret, x]\n  hand: [y]\n";

/// A running machine and its client.
struct Bench {
    cyclone: Peer,
    program: Program,
    _domain: Domain,
}

/// Returns the demo with a controller manager and these groups.
fn cell(name: &str, manager: &str, groups: &str) -> PathBuf {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml");
    let text = fs::read_to_string(demo).expect("the demo");
    let text = text.replacen("  autostart: true", &format!("  controller_manager: {manager}\n  autostart: true"), 1);
    let cell = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&cell, text + groups).expect("a file");
    cell
}

impl Bench {
    fn start(arguments: &[&str]) -> Self {
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let program = Program::start(arguments, &domain);
        cyclone.run("axis-states /lineshaft");
        Self { cyclone, program, _domain: domain }
    }

    /// Starts it with arm and hand, all drives enabled.
    fn with_groups(name: &str) -> Self {
        let mut bench = Self::start(&["run", cell(name, MANAGER, GROUPS).to_str().expect("a path of text")]);
        bench.cyclone.run("axes /lineshaft enable x y turret");
        bench
    }

    #[track_caller]
    fn list(&mut self, what: &str) -> Value {
        self.cyclone.run(&format!("controller-manager {MANAGER} {what}")).all()[0].clone()
    }

    /// Returns names and states of the controllers.
    #[track_caller]
    fn states(&mut self) -> Value {
        let all = self.list("list_controllers")["controller"].clone();
        let all = all.as_array().expect("a list").iter();
        Value::Array(all.map(|one| json!([one["name"], one["state"]])).collect())
    }

    /// Switches controllers, which must succeed; returns the message.
    #[track_caller]
    fn switch(&mut self, how: &str) -> String {
        let seen = self.cyclone.run(&format!("switch-controller {MANAGER} {how}"));
        seen["message"].as_str().expect("a text").to_owned()
    }

    /// Whether a line of /rosout has this text.
    fn logs(&mut self, text: &str) -> bool {
        let seen = self.cyclone.run("log --seconds 1");
        seen.all().iter().any(|line| line["message"]["msg"].as_str().is_some_and(|line| line.contains(text)))
    }
}

fn arm(x: f64) -> String {
    format!("follow /lineshaft --group arm --joint x --joint turret --point 1:{x},0.3:0,0")
}

/// Output of `ros2 control list_controllers`, `list_controller_types`, `list_hardware_components` and
/// `list_hardware_interfaces`.
#[test]
fn controllers_and_hardware_are_listed() {
    let mut bench = Bench::with_groups("controllers_listed.yaml");
    let listed = bench.list("list_controllers");
    let shown = |name: &str, joints: &[&str]| {
        let commands: Vec<_> = joints.iter().map(|joint| format!("{joint}/position")).collect();
        let states: Vec<_> =
            joints.iter().flat_map(|joint| ["position", "velocity"].map(|what| format!("{joint}/{what}"))).collect();
        json!({
            "name": name, "state": "active", "type": "joint_trajectory_controller/JointTrajectoryController",
            "is_async": false, "update_rate": 1000, "claimed_interfaces": commands,
            "required_command_interfaces": commands, "required_state_interfaces": states, "is_chainable": false,
            "is_chained": false, "exported_state_interfaces": [], "reference_interfaces": [], "chain_connections": []
        })
    };
    assert_eq!(listed, json!({"controller": [shown("arm", &["turret", "x"]), shown("hand", &["y"])]}));
    let types = json!({
        "types": ["joint_trajectory_controller/JointTrajectoryController"],
        "base_classes": ["controller_interface::ControllerInterface"]
    });
    assert_eq!(bench.list("list_controller_types"), types);

    bench.switch("--deactivate hand");
    let interface = |name: &str, is_claimed: bool| json!({"name": name, "data_type": "double", "is_available": true, "is_claimed": is_claimed});
    let commands = [("x/position", true), ("y/position", false), ("turret/position", true)];
    let commands: Vec<_> = commands.map(|(name, is_claimed)| interface(name, is_claimed)).into();
    let states = ["x/position", "x/velocity", "y/position", "y/velocity", "turret/position", "turret/velocity"];
    let states: Vec<_> = states.map(|name| interface(name, false)).into();
    let interfaces = json!({"command_interfaces": commands, "state_interfaces": states});
    assert_eq!(bench.list("list_hardware_interfaces"), interfaces);
    let component = json!({
        "name": "lineshaft", "type": "system", "is_async": false, "rw_rate": 1000, "class_type": "lineshaft",
        "plugin_name": "lineshaft", "state": {"id": 3, "label": "active"},
        "command_interfaces": commands, "state_interfaces": states
    });
    assert_eq!(bench.list("list_hardware_components"), json!({"component": [component]}));
    bench.program.end();
}

#[test]
fn inactive_group_rejects_goals_and_takes_them_again_once_it_is_active() {
    let mut bench = Bench::with_groups("controllers_switched.yaml");
    assert_eq!(bench.switch("--deactivate arm"), "controller arm is inactive");
    assert_eq!(bench.states(), json!([["arm", "inactive"], ["hand", "active"]]));
    assert!(bench.cyclone.fails(&arm(0.05)).contains("rejected"));
    let how = "group arm is inactive; activate it first (`ros2 control switch_controllers -c \
               /lineshaft/controller_manager --activate arm`)";
    assert!(bench.logs(&format!("/lineshaft/arm/follow_joint_trajectory: goal rejected: {how}")));
    let message = arm(0.05).replacen("follow", "publish-trajectory", 1);
    bench.cyclone.run(&message);
    assert!(bench.logs(&format!("/lineshaft/arm/joint_trajectory: message refused: {how}")));
    // The other group is not affected.
    bench.cyclone.run("follow /lineshaft --group hand --joint y --point 1:0.02:0");

    let before = bench.cyclone.run("axis-states /lineshaft")["axes"].clone();
    assert_eq!(before["x"]["command_increments"], 0, "nothing has moved");
    // One by one and twice; a controller that is active already is no error.
    assert_eq!(bench.switch("--activate arm hand"), "controllers arm, hand are active");
    let after = bench.cyclone.run("axis-states /lineshaft")["axes"].clone();
    for axis in ["x", "turret"] {
        assert_eq!(before[axis]["command_increments"], after[axis]["command_increments"], "activation moves nothing");
    }
    let seen = bench.cyclone.run(&arm(0.05));
    assert_eq!((&seen["status"], &seen["error"]), (&json!("SUCCEEDED"), &json!("SUCCESSFUL")));
    assert_eq!(bench.cyclone.run("axis-states /lineshaft")["axes"]["x"]["command_increments"], 5 * 1_048_576);
    bench.program.end();
}

#[test]
fn deactivation_halts_the_axes_and_ends_the_goal_of_the_group() {
    let mut bench = Bench::with_groups("controllers_halted.yaml");
    let leave = |bench: &mut Bench, goal: &str| {
        bench.cyclone.run(&format!("{goal} --leave"))["goal"].as_str().expect("an id").to_owned()
    };
    let slow = "follow /lineshaft --group arm --joint x --joint turret --point 20:0.4,3:0,0";
    let goal = leave(&mut bench, slow);
    let hand = leave(&mut bench, "follow /lineshaft --group hand --joint y --point 4:0.04:0");
    bench.cyclone.until_axis("x", "it moves", |axis| axis["command_velocity"].as_f64() > Some(0.01));
    assert_eq!(bench.switch("--deactivate arm"), "controller arm is inactive");
    let seen = bench.cyclone.run(&format!("followed /lineshaft {goal} --group arm --expect ABORTED"));
    assert_eq!(seen["error"], "INVALID_GOAL");
    for axis in ["x", "turret"] {
        let state = bench.cyclone.until_axis(axis, "it stands", |axis| axis["state"] == "STANDSTILL");
        assert_eq!((&state["enabled"], &state["error_code"]), (&json!(true), &json!(0)), "it holds its position");
    }
    // The other group continues.
    bench.cyclone.run(&format!("followed /lineshaft {hand} --group hand"));

    // Without a pause between goal and switch: in any order, nothing moves at the end.
    for _ in 0..5 {
        bench.switch("--activate arm");
        let goal = leave(&mut bench, slow);
        bench.switch("--deactivate arm");
        bench.cyclone.run(&format!("followed /lineshaft {goal} --group arm --expect ABORTED"));
        bench.cyclone.until_axis("x", "it stands", |axis| axis["state"] == "STANDSTILL");
    }
    bench.program.end();
}

#[test]
fn switches_that_cannot_be_meant_are_refused_by_name() {
    let mut bench = Bench::with_groups("controllers_refused.yaml");
    let refused = |bench: &mut Bench, how: &str| bench.cyclone.fails(&format!("switch-controller {MANAGER} {how}"));
    let unknown = "deactivate_controllers: controller `leg` is unknown, known are arm, hand";
    assert_eq!(refused(&mut bench, "--deactivate arm leg"), unknown);
    assert_eq!(refused(&mut bench, "--deactivate leg --strictness best-effort"), unknown);
    let both = "controller arm is in activate_controllers and in deactivate_controllers; one of them is allowed";
    assert_eq!(refused(&mut bench, "--activate arm --deactivate arm"), both);
    assert!(bench.logs(&format!("/lineshaft/controller_manager/switch_controller: {unknown}")));
    assert_eq!(bench.states(), json!([["arm", "active"], ["hand", "active"]]));
    let seen = bench.cyclone.run(&format!("load-controllers {MANAGER}"));
    let told = bench.cyclone.run("log --seconds 2");
    let lines: Vec<_> = told.all().iter().filter_map(|line| line["message"]["msg"].as_str()).collect();
    for service in ["load_controller", "unload_controller", "reload_controller_libraries"] {
        assert_eq!(seen[service], false);
        let sentence = "groups of the cell are the controllers; none is loaded or unloaded in a node that runs";
        assert!(lines.contains(&format!("{MANAGER}/{service}: {sentence}").as_str()), "{service}: {lines:?}");
    }
    let skipped = "controller arm is inactive; skipped because unknown: leg";
    assert_eq!(bench.switch("--deactivate arm leg --strictness best-effort"), skipped);
    bench.program.end();
}

#[test]
fn without_groups_the_controller_has_the_name_of_the_node() {
    let cell = cell("controllers_all.yaml", "/controller_manager", "");
    let mut bench = Bench::start(&["run", cell.to_str().expect("a path of text")]);
    bench.cyclone.run("axes /lineshaft enable x y turret");
    let seen = bench.cyclone.run("controller-manager /controller_manager list_controllers");
    let one = &seen["controller"][0];
    // MoveIt derives /lineshaft/follow_joint_trajectory from the namespace and this name.
    assert_eq!((&one["name"], &one["state"]), (&json!("lineshaft"), &json!("active")));
    assert_eq!(one["claimed_interfaces"], json!(["x/position", "y/position", "turret/position"]));
    bench.cyclone.run("switch-controller /controller_manager --deactivate lineshaft");
    let goal = "follow /lineshaft --joint x --joint y --joint turret --point 1:0.01,0.01,0.1:0,0,0";
    assert!(bench.cyclone.fails(goal).contains("rejected"));
    bench.cyclone.run("switch-controller /controller_manager --activate lineshaft");
    bench.cyclone.run(goal);
    bench.program.end();
}

#[test]
fn without_the_key_no_service_of_a_controller_manager_exists() {
    let mut bench = Bench::start(&["run"]);
    let seen = bench.cyclone.run("graph /lineshaft");
    let names = |seen: &str| -> bool { seen.contains("controller_manager") };
    for end in ["reads", "writes"] {
        let topics = seen[end].as_array().expect("a list");
        assert!(!topics.iter().filter_map(Value::as_str).any(names), "{topics:?}");
    }
    bench.program.end();
}

/// The same node with clients of rmw_fastrtps_cpp, the default of ROS 2: the actions of groups, controllers, touch
/// probe, positions.
#[test]
fn clients_of_fast_dds_move_groups_and_switch_them() {
    let domain = Domain::take();
    let mut fast = Peer::fastdds(&domain);
    let groups = "\ngroups:\n  arm: [turret, x]\n  hand: {axes: [y], gripper: {}}\n";
    let cell = cell("controllers_fast_dds.yaml", MANAGER, groups);
    let mut program = Program::start(&["run", cell.to_str().expect("a path of text")], &domain);
    fast.run("axes /lineshaft enable");
    let listed = fast.run(&format!("controllers {MANAGER}"))["controllers"].clone();
    let shown = |name: &str, joints: &[&str]| {
        let claimed: Vec<_> = joints.iter().map(|joint| format!("{joint}/position")).collect();
        json!({"name": name, "state": "active", "type": "joint_trajectory_controller/JointTrajectoryController",
            "claimed_interfaces": claimed})
    };
    assert_eq!(listed, json!([shown("arm", &["turret", "x"]), shown("hand", &["y"])]));

    let goal = "follow /lineshaft/arm x,turret 1:0.05,0.3:0,0";
    let reached = json!({"status": "SUCCEEDED", "error_code": 0, "error_string": "Goal successfully reached!"});
    assert_eq!(fast.run(goal).all(), [reached]);
    assert_eq!(fast.fails(&format!("query-state /lineshaft/arm {}000000000", i32::MAX)), "no trajectory runs");
    let seen = fast.run("gripper /lineshaft/hand 0.02");
    assert_eq!(
        (&seen["status"], &seen["reached_goal"], &seen["stalled"]),
        (&json!("SUCCEEDED"), &json!(true), &json!(false))
    );
    fast.run(&format!("switch-controllers {MANAGER} deactivate arm"));
    assert_eq!(fast.fails(goal), "the goal was rejected");
    fast.run(&format!("switch-controllers {MANAGER} activate arm"));
    // The point and its time, in SI units first; the lag of straight segments is part of the result.
    let seen = fast.run("follow /lineshaft/arm x,turret 1:5,0:0,0");
    let text = seen["error_string"].as_str().expect("a text");
    assert_eq!(seen["error_code"], -1, "{text}");
    assert!(
        text.starts_with("x: position 5 m (5000 mm) exceeds max_position 0.85 m (850 mm) at point 0 (1 s)"),
        "{text}"
    );
    let seen = fast.run("follow /lineshaft/arm x,turret 0.5:0.2,0.3 1:0.05,0.3");
    let text = seen["error_string"].as_str().expect("a text");
    let lags = "Goal successfully reached! x: straight segments make the axis lag up to ";
    assert!(text.starts_with(lags) && text.ends_with(" late; give velocities in the points"), "{text}");

    fast.run("touch-probe /lineshaft x y");
    assert_eq!(fast.fails("touch-probe /lineshaft x door"), "`door` does not latch; x, y, turret can");
    fast.run("set-position /lineshaft x 3");
    fast.run("set-position /lineshaft x 0.5 --relative 1");
    let seen = fast.run("joint-states --count 1");
    assert_eq!(seen["last"]["position"][0], 3.5, "{seen:?}");
    program.end();
}
