//! Tests the steps of docs/moveit.md: `lineshaft limits` on the command line, and the files of launch-configs/arm6,
//! which must agree with its cell.

use crate::support::{domain::Domain, machine::share, peer::Peer, program::Program};
use std::path::{Path, PathBuf};
use std::process::Command;

const CELL: &str = "launch-configs/arm6/arm6.yaml";
const JOINTS: [&str; 6] = ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6"];

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A folder with the cell of the arm and its description.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["arm6.yaml", "arm6.urdf"] {
            std::fs::copy(root("launch-configs/arm6").join(name), folder.path().join(name)).expect("a copy");
        }
        Self(folder)
    }

    /// Returns exit code, output and error output of a command line in that folder.
    fn run(&self, line: &str) -> (Option<i32>, String, String) {
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        let output = command.args(line.split(' ')).current_dir(&self.0).env("ROS_HOME", self.0.path()).output();
        let output = output.expect("the program starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    }

    #[track_caller]
    fn good(&self, line: &str) -> String {
        let (code, said, complaints) = self.run(line);
        assert_eq!((code, complaints.as_str()), (Some(0), ""), "{line}: {said}");
        said
    }

    #[track_caller]
    fn bad(&self, line: &str) -> String {
        let (code, said, complaints) = self.run(line);
        assert_eq!((code, said.as_str()), (Some(2), ""), "{line}: {complaints}");
        complaints
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).expect("written");
    }

    fn cell(&self) -> String {
        std::fs::read_to_string(self.0.path().join("arm6.yaml")).expect("the cell")
    }
}

#[test]
fn limits_go_from_the_cell_to_moveit_and_back() {
    let bench = Bench::new();
    let file = bench.good("limits arm6.yaml --group arm");
    assert_eq!(file, bench.good("limits arm6.yaml"), "the arm is all axes");
    bench.write("joint_limits.yaml", &file);
    assert_eq!(bench.good("limits arm6.yaml --from joint_limits.yaml"), "nothing changes\n");
    let cell = bench.cell();
    assert_eq!(cell, read(CELL));

    // The first joint, from 180 deg/s and 400 deg/s^2: 3.14 rad/s and 6.98 rad/s^2.
    let mut slower = file;
    for (key, old, new) in [("max_velocity: ", "3.141", "2.175"), ("max_acceleration: ", "6.981", "3.75")] {
        let start = slower.find(key).expect("a limit") + key.len();
        let end = start + slower[start..].find('\n').expect("its end");
        assert!(slower[start..end].starts_with(old), "{slower}");
        slower.replace_range(start..end, new);
    }
    bench.write("joint_limits.yaml", &slower);
    let said = bench.good("limits arm6.yaml --group arm --from joint_limits.yaml");
    assert_eq!(
        said,
        "joint1.max_velocity: 180 deg/s -> 124.61832 deg/s\n\
         joint1.max_acceleration: 400 deg/s^2 -> 214.859173 deg/s^2\n\
         arm6.yaml: 2 values written\n"
    );
    let expected = cell.replacen("max_velocity: 180 deg/s", "max_velocity: 2.175 rad/s", 1);
    assert_eq!(bench.cell(), expected.replacen("max_acceleration: 400 deg/s^2", "max_acceleration: 3.75 rad/s^2", 1));
    // The URDF still has the faster one.
    let (code, _, complaints) = bench.run("check arm6.yaml");
    assert!(code == Some(0) && complaints.contains("joint1 has max_velocity 2.175 in SI"), "{complaints}");
}

#[test]
fn bad_limits_change_nothing() {
    let bench = Bench::new();
    let cell = bench.cell();
    bench.write(
        "l.yaml",
        "joint_limits:\n  joint1: {has_velocity_limits: true, max_velocity: 1}\n  joint7: {max_jerk: -1}\n",
    );
    assert_eq!(
        bench.bad("limits arm6.yaml --from l.yaml"),
        "l.yaml:3:3: no joint is called `joint7`, did you mean `joint1`?\n"
    );
    assert!(bench.bad("limits arm6.yaml --from none.yaml").starts_with("none.yaml:1:1: cannot read the file: "));
    assert_eq!(bench.bad("limits arm6.yaml --group leg"), "error: --group: no group is called `leg`; there are arm\n");
    assert!(bench.bad("limits none.yaml").starts_with("none.yaml:1:1: cannot read the file: "));
    assert_eq!(bench.cell(), cell);
    let (code, help, _) = bench.run("limits --help");
    assert_eq!(code, Some(0));
    for part in ["lineshaft limits cell.yaml --group arm > joint_limits.yaml", "--from <FILE>", "Exit codes: "] {
        assert!(help.contains(part), "{part}: {help}");
    }
}

/// After a change of the cell:
/// `lineshaft limits launch-configs/arm6/arm6.yaml --group arm > launch-configs/arm6/joint_limits.yaml`.
#[test]
fn files_of_the_arm_agree_with_its_cell() {
    let bench = Bench::new();
    let limits = bench.good("limits arm6.yaml --group arm");
    assert_eq!(read("launch-configs/arm6/joint_limits.yaml"), limits, "write it again from the cell");
    // Without a warning about the robot description, whose limits are equal to those of the cell.
    let (_, said, complaints) = bench.run("check arm6.yaml");
    assert!(!(said.clone() + &complaints).contains("robot_description"), "{said}{complaints}");
    let urdf = read("launch-configs/arm6/arm6.urdf");
    let document = roxmltree::Document::parse(&urdf).expect("XML");
    let moved =
        document.descendants().filter(|node| node.has_tag_name("joint") && node.attribute("type") != Some("fixed"));
    let mut names = Vec::new();
    for joint in moved {
        let name = joint.attribute("name").expect("a name");
        let limit = joint.children().find(|node| node.has_tag_name("limit")).expect("limits");
        let given = |attribute| limit.attribute(attribute).expect("a limit").parse::<f64>().expect("a number");
        let (_, of_joint) = limits.split_once(&format!("  {name}:\n")).expect("the joint");
        let of_joint = of_joint.split("\n  joint").next().unwrap();
        for (attribute, key) in [("lower", "min_position"), ("upper", "max_position"), ("velocity", "max_velocity")] {
            let line =
                of_joint.lines().find_map(|line| line.trim().strip_prefix(&format!("{key}: "))).expect("a limit");
            let difference = (line.parse::<f64>().expect("a number") - given(attribute)).abs();
            assert!(difference < 1e-12, "{name}: {attribute}: {line}");
        }
        names.push(name.to_owned());
    }
    assert_eq!(names, JOINTS);
    assert!(!urdf.contains("package://") && !urdf.contains("<mesh"), "it needs no other file");
    let controllers = read("launch-configs/arm6/moveit_controllers.yaml");
    assert!(controllers.contains(&format!("joints: [{}]", JOINTS.join(", "))), "{controllers}");
    assert!(read(CELL).contains(&format!("arm: [{}]", JOINTS.join(", "))));
}

/// The action has the name in moveit_controllers.yaml: MoveIt joins the name of the controller and action_ns by a
/// slash.
#[test]
fn arm_has_the_action_that_moveit_looks_for() {
    let controllers = read("launch-configs/arm6/moveit_controllers.yaml");
    let value = |key: &str| {
        let line = controllers.lines().find_map(|line| line.trim().strip_prefix(key)).expect("a line of it");
        line.split(" #").next().unwrap().trim().to_owned()
    };
    let action = format!("{}/{}", value("- "), value("action_ns:"));
    let domain = Domain::take();
    let cell = root(CELL);
    let _program = Program::start(&["run", cell.to_str().unwrap()], &domain);
    let mut peer = Peer::cyclone(&domain);
    peer.run("axis-states /lineshaft");
    peer.run(&format!("axes /lineshaft enable {}", JOINTS.join(" ")));
    let seen = peer.run("graph /lineshaft");
    let reads: Vec<_> = seen["reads"].as_array().unwrap().iter().filter_map(|topic| topic.as_str()).collect();
    assert!(reads.contains(&format!("rq/{action}/_action/send_goalRequest").as_str()), "{action}: {reads:?}");
    assert!(reads.contains(&"rt/lineshaft/arm/joint_trajectory"), "the topic of MoveIt Servo: {reads:?}");
    let joints: String = JOINTS.iter().map(|joint| format!(" --joint {joint}")).collect();
    let goal = peer.run(&format!("follow /lineshaft --group arm{joints} --point 1:0.2,0.1,0,0,0.3,0.2:0,0,0,0,0,0"));
    assert_eq!((goal["status"].as_str(), goal["error"].as_str()), (Some("SUCCEEDED"), Some("SUCCESSFUL")));
    // The joint states that move the model in RViz.
    let moved = peer.run("joint-states --count 1 --seconds 5");
    let names: Vec<_> = moved["last"]["name"].as_array().unwrap().iter().filter_map(|name| name.as_str()).collect();
    assert_eq!(names, JOINTS);
}

/// docs/images/arm6.svg is the run of the plan. `LINESHAFT_RENEW=1 cargo test --workspace --test end_to_end moveit` draws it again.
#[test]
fn plan_is_played_recorded_replayed_and_drawn() {
    let bench = Bench::new();
    for name in ["arm6.scenario.yaml", "plan.yaml"] {
        std::fs::copy(root("launch-configs/arm6").join(name), bench.0.path().join(name)).expect("a copy");
    }
    bench.good("sim arm6.yaml --scenario arm6.scenario.yaml --record arm6.mcap");
    bench.good("replay arm6.mcap");
    bench.good(
        "plot arm6.mcap --signals joint*.command.position --signals joint*.command.velocity -o arm6.svg --width 900",
    );
    let drawn = std::fs::read_to_string(bench.0.path().join("arm6.svg")).expect("the figure");
    let kept = root("docs/images/arm6.svg");
    if std::env::var_os("LINESHAFT_RENEW").is_some() {
        std::fs::write(&kept, &drawn).expect("docs can be written");
    }
    let is_same = std::fs::read_to_string(&kept).is_ok_and(|kept| kept == drawn);
    assert!(is_same, "draw it again: LINESHAFT_RENEW=1 cargo test --workspace --test end_to_end moveit");

    // The same plan from a position that makes it too fast: the error message, and exit code 1.
    let plan =
        read("launch-configs/arm6/plan.yaml").replacen("sec: 5, nanosec: 600000000", "sec: 5, nanosec: 500000001", 1);
    bench.write("plan.yaml", &plan);
    let (code, said, complaints) = bench.run("sim arm6.yaml --scenario arm6.scenario.yaml");
    assert_eq!(code, Some(1), "{said}{complaints}");
    assert!(said.contains("exceeds max_velocity"), "{said}");
    let wrong = read("launch-configs/arm6/plan.yaml").replacen("joint3", "joint9", 1);
    bench.write("plan.yaml", &wrong);
    let (code, _, complaints) = bench.run("sim arm6.yaml --scenario arm6.scenario.yaml");
    assert_eq!(code, Some(2));
    assert!(
        complaints.starts_with("plan.yaml:10:14: joint_names has the joint `joint9`; there are joint1, "),
        "{complaints}"
    );
}
