//! Tests joint names of axes in ROS 2, with a peer on Eclipse Cyclone DDS: messages of other packages have joint names,
//! those of Lineshaft have object names.

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// The maximum length of a joint name.
const LONGEST: &str = "a_joint_name_of_sixty_four_characters_as_long_as_it_may_be_0_1_2";
/// Longer than any motion here takes, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);

/// Returns a cell with four axes of 1000 inc/mm.
fn cell() -> String {
    let axis = |(address, (name, joint)): (usize, (&str, &str))| {
        format!(
            "  {name}: {{joint: {joint}, type: linear, unit: mm, scale: {{increments: 1000, per: 1 mm}}, max_velocity: 1 m/s, \
             max_acceleration: 8 m/s^2, drive: {{backend: plant, address: {address}}}, sim: {{model: ideal}}}}\n"
        )
    };
    let axes = [("shoulder", "Shoulder_Pan"), ("elbow", "left/arm_1"), ("wrist", "J1"), ("tool", LONGEST)];
    let axes: String = axes.into_iter().enumerate().map(axis).collect();
    format!(
        "lineshaft: 1\ncycle: 1 ms\nros: {{robot_description: arm.urdf}}\nbackends: {{plant: {{type: sim}}}}\naxes:\n{axes}"
    )
}

const URDF: &str = "<robot name='arm'><link name='a'/><link name='b'/><link name='c'/>
<joint name='Shoulder_Pan' type='prismatic'><parent link='a'/><child link='b'/><limit lower='0' upper='1' velocity='1' effort='1'/></joint>
<joint name='elbow' type='prismatic'><parent link='b'/><child link='c'/><limit lower='0' upper='1' velocity='1' effort='1'/></joint>
</robot>";

struct Bench {
    cyclone: Peer,
    program: Program,
    _domain: Domain,
    _folder: tempfile::TempDir,
}

impl Bench {
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("room for a folder");
        let path = folder.path().join("cell.yaml");
        std::fs::write(&path, cell()).expect("a cell");
        std::fs::write(folder.path().join("arm.urdf"), URDF).expect("a description");
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let cell = path.to_str().expect("a path");
        let program = Program::start(&["run", cell, "--ros-args", "-p", "constraints.left/arm_1.goal:=0.25"], &domain);
        cyclone.run("axis-states /lineshaft");
        cyclone.run("events /lineshaft --seconds 0");
        cyclone.run("axes /lineshaft enable shoulder elbow wrist tool");
        Self { cyclone, program, _domain: domain, _folder: folder }
    }

    fn command(&mut self, axis: &str) -> i64 {
        let states = self.cyclone.run("axis-states /lineshaft");
        states["axes"][axis]["command_increments"].as_i64().expect("whole increments")
    }

    fn refusals(&mut self) -> Vec<String> {
        let seen = self.cyclone.run("events /lineshaft --seconds 1");
        let refused = |event: &&Value| event["message"]["kind"] == "refused";
        let text = |event: &Value| event["message"]["text"].as_str().expect("a text").to_owned();
        seen.all().iter().filter(refused).map(text).collect()
    }
}

/// Returns a goal for the four joints: positions in m, at standstill there after one second.
fn goal(joints: [&str; 4], positions: &str) -> String {
    let joints = joints.map(|joint| format!("--joint {joint}")).join(" ");
    format!("follow /lineshaft {joints} --point {positions}")
}

#[test]
fn messages_of_ros_have_joint_names_and_all_others_object_names() {
    let mut bench = Bench::start();
    let names = json!(["Shoulder_Pan", "left/arm_1", "J1", LONGEST]);
    let seen = bench.cyclone.run("joint-states --count 1 --seconds 5");
    assert_eq!(seen["last"]["name"], names);
    let states = bench.cyclone.run("axis-states /lineshaft");
    let mut axes: Vec<&String> = states["axes"].as_object().expect("axes").keys().collect();
    axes.sort();
    assert_eq!(axes, ["elbow", "shoulder", "tool", "wrist"]);
    // The description is compared by joint names; the axes have no position limits.
    let log = bench.program.log();
    assert!(log.contains("joint elbow: the joint name of axis elbow is left/arm_1"), "{log}");
    assert!(!log.contains("joint Shoulder_Pan: no axis"), "{log}");

    // In another order than that of the cell: 10, 20, 30, 40 mm.
    let seen = bench.cyclone.run(&goal(["J1", LONGEST, "Shoulder_Pan", "left/arm_1"], "1:0.03,0.04,0.01,0.02:0,0,0,0"));
    assert_eq!((&seen["status"], &seen["error"]), (&json!("SUCCEEDED"), &json!("SUCCESSFUL")));
    let feedback = seen["feedback"].as_array().expect("a list");
    assert!(!feedback.is_empty() && feedback.iter().all(|message| message["joint_names"] == names), "{feedback:?}");
    for (axis, increments) in [("shoulder", 10_000), ("elbow", 20_000), ("wrist", 30_000), ("tool", 40_000)] {
        assert_eq!(bench.command(axis), increments, "{axis}");
    }
    let seen = bench.cyclone.run("joint-states --count 1 --seconds 5");
    assert_eq!(seen["last"]["position"], json!([0.01, 0.02, 0.03, 0.04]));

    bench.cyclone.run("stream /lineshaft jog --axis left/arm_1=0.02 --seconds 0.3 --rate 100");
    let end = Instant::now() + PATIENCE;
    while bench.command("elbow") == 20_000 {
        assert!(Instant::now() < end, "the axis follows no jog");
    }
    assert_eq!(bench.command("wrist"), 30_000);
}

#[test]
fn object_names_are_refused_where_joint_names_are_expected() {
    let mut bench = Bench::start();
    let object = |field: &str, axis: &str, joint: &str| {
        format!("{field} has `{axis}`, the object name of an axis; its joint name is `{joint}`")
    };
    let here = "1:0,0,0,0:0,0,0,0";
    let joints = ["Shoulder_Pan", "left/arm_1", "J1", LONGEST];
    for (goal, sentence) in [
        (goal(["shoulder", "left/arm_1", "J1", LONGEST], here), object("joint_names", "shoulder", "Shoulder_Pan")),
        (goal(["Shoulder_Pan", "left/arm_1", "J1", "tool"], here), object("joint_names", "tool", LONGEST)),
        (goal(joints, here) + " --path elbow:1", object("path_tolerance", "elbow", "left/arm_1")),
        (goal(joints, here) + " --goal wrist:1", object("goal_tolerance", "wrist", "J1")),
    ] {
        assert_eq!(bench.cyclone.fails(&goal), "the goal was rejected");
        let refusals = bench.refusals();
        assert!(refusals.iter().any(|text| text.contains(&sentence)), "`{sentence}` is not in {refusals:?}");
    }
    for (message, sentence) in [
        ("publish-trajectory /lineshaft --joint shoulder", object("joint_names", "shoulder", "Shoulder_Pan")),
        ("stream /lineshaft jog --axis wrist=0.02", object("joint_names", "wrist", "J1")),
        ("stream /lineshaft jog --axis J1=100 --seconds 1.5", " of J1 exceeds max_velocity ".to_owned()),
        ("stream /lineshaft setpoints --axis J1=0.02", "no axis is called `J1`; there are shoulder,".to_owned()),
    ] {
        bench.cyclone.run(message);
        let refusals = bench.refusals();
        assert!(refusals.iter().any(|text| text.contains(&sentence)), "`{sentence}` is not in {refusals:?}");
    }
    assert_eq!(["shoulder", "elbow", "wrist", "tool"].map(|axis| bench.command(axis)), [0; 4]);
}

#[test]
fn parameters_of_tolerances_have_joint_names_and_parameters_of_axes_object_names() {
    let mut bench = Bench::start();
    let given = bench.cyclone.run("params /lineshaft get constraints.left/arm_1.goal shoulder.max_velocity");
    assert_eq!(given["get"].as_array().expect("values").len(), 2);
    assert_eq!(given["get"][0], json!(0.25), "given at the start: {:?}", given["get"]);
    let unknown = bench.cyclone.run("params /lineshaft set constraints.shoulder.goal=0.006");
    let refused = "parameter `constraints.shoulder.goal` has not been declared; by the joint name it is \
                   `constraints.Shoulder_Pan.goal`";
    assert!(unknown["set"].to_string().contains(refused), "{:?}", unknown["set"]);

    // 5 mm away, and due immediately.
    let at_once = goal(["Shoulder_Pan", "left/arm_1", "J1", LONGEST], "0:0.005,0,0,0:0,0,0,0");
    let seen = bench.cyclone.run(&format!("{at_once} --expect ABORTED"));
    let text = seen["text"].as_str().expect("a text");
    assert!(text.starts_with("axis shoulder (joint Shoulder_Pan): the last point"), "{text}");
    bench.cyclone.run("params /lineshaft set constraints.Shoulder_Pan.goal=0.006");
    let seen = bench.cyclone.run(&at_once);
    assert_eq!(seen["status"], "SUCCEEDED");
}
