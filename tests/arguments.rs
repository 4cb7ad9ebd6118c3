//! Tests the arguments of a node as `ros2 run` and launch files give them, `--ros-args`, and the standard features of
//! every ROS 2 node: its own parameters, simulation time, logger levels, `/rosout`.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use crate::support::{domain::Domain, peer::Peer, program::Program};
use serde_json::{Value, json};

/// Much longer than the program needs to end.
const EXIT: Duration = Duration::from_secs(20);

/// A running demo with arguments, and its client.
struct Bench {
    cyclone: Peer,
    program: Program,
    domain: Domain,
    node: String,
}

impl Bench {
    /// Starts the node, and returns when it publishes under the name `node`.
    fn start(node: &str, arguments: &str) -> Self {
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let words = ["run", "--store", "none", "--ros-args"].into_iter().chain(arguments.split_whitespace());
        let program = Program::start(&words.collect::<Vec<_>>(), &domain);
        cyclone.run(&format!("axis-states {node}"));
        Self { cyclone, program, domain, node: node.to_owned() }
    }

    fn get(&mut self, name: &str) -> Value {
        self.cyclone.run(&format!("params {} get {name}", self.node))["get"][0].clone()
    }

    /// Returns the results of setting each parameter separately.
    fn set(&mut self, values: &str) -> Value {
        self.cyclone.run(&format!("params {} set {values}", self.node))["set"]["results"].clone()
    }

    fn set_together(&mut self, values: &str) -> Value {
        self.cyclone.run(&format!("params {} set_atomically {values}", self.node))["set_atomically"]["result"].clone()
    }
}

/// Returns the message with which the program refuses to start.
#[track_caller]
fn refused(arguments: &str) -> String {
    let words = ["run", "--store", "none", "--ros-args"].into_iter().chain(arguments.split_whitespace());
    let mut program = Program::start(&words.collect::<Vec<_>>(), &Domain::take());
    let status = program.wait_exit(EXIT);
    assert_eq!(status.code(), Some(2), "{arguments}: {}", program.log());
    program.log()
}

/// Creates a parameter file for one test.
fn file(name: &str, text: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("arguments-{}-{name}.yaml", std::process::id()));
    fs::write(&path, text).expect("the folder of the tests can be written to");
    path
}

#[test]
fn node_topics_services_and_actions_get_other_names() {
    let rules = "-r __node:=shaft -r __ns:=/cell -r joint_states:=/robot/joint_states -r ~/enable:={ns}/on \
                 -r shaft:rosservice://~/disable:=off -r ~/move_axis:=mover -r other:~/axis_states:=nowhere \
                 -r rosservice://~/events:=/wrong";
    let mut bench = Bench::start("/cell/shaft", rules);
    bench.cyclone.run("stamps --topic /robot/joint_states --system");
    let seen = bench.cyclone.run("graph /cell/shaft");
    let has = |kind: &str, topic: &str| seen[kind].as_array().unwrap().contains(&json!(topic));
    for topic in [
        "rt/robot/joint_states",
        "rt/cell/shaft/axis_states",
        "rt/cell/shaft/events",
        "rr/cell/onReply",
        "rr/cell/offReply",
        "rr/cell/shaft/haltReply",
        "rr/cell/mover/_action/send_goalReply",
        "rt/cell/mover/_action/feedback",
        "rt/cell/mover/_action/status",
    ] {
        assert!(has("writes", topic), "{topic} in {seen:?}");
    }
    for topic in ["rt/joint_states", "rt/cell/joint_states", "rr/cell/shaft/enableReply", "rt/wrong"] {
        assert!(!has("writes", topic), "{topic} in {seen:?}");
    }
    // The peer uses the last part of a name as verb or action.
    let bench_of = |rules: &str| Bench::start("/lineshaft", rules);
    let mut bench = bench_of("-r ~/enable:=/elsewhere/enable -r ~/move_axis:=/elsewhere/move_axis");
    bench.cyclone.run("axes /elsewhere enable x");
    bench.cyclone.run("move /elsewhere --axis x --units increments --position 1000 --wait");
    let seen = bench.cyclone.run("axis-states /lineshaft");
    assert_eq!(seen["axes"]["x"]["command_increments"], 1000);
}

#[test]
fn parameters_of_files_and_of_the_line_are_in_force_before_anything_else() {
    let file = file(
        "good",
        "/**:\n  ros__parameters:\n    x.max_velocity: 0.25\n    y: {max_velocity: 1, profile: jerk}\n    frame_prefix: left/\n\
         /*/lineshaft:\n  ros__parameters: {x.max_velocity: 0.1}\n\
         other:\n  ros__parameters: {x.max_velocity: 0.2}\n\
         /lineshaft:\n  ros__parameters:\n    x: {min_position: -0.01}\n    turret.max_acceleration: 2.0\n",
    );
    let arguments =
        format!("--params-file {} -p turret.max_acceleration:=3.0 -p other:x.profile:=jerk", file.display());
    let mut bench = Bench::start("/lineshaft", &arguments);
    for (name, value) in [
        ("x.max_velocity", json!(0.25)),
        ("y.max_velocity", json!(1.0)),
        ("y.profile", json!("jerk")),
        ("x.profile", json!("trapezoid")),
        ("turret.max_acceleration", json!(3.0)),
    ] {
        assert_eq!(bench.get(name), value, "{name}");
    }
    let low = bench.get("x.min_position").as_f64().unwrap();
    assert!((low + 0.01).abs() < 1e-8, "{low}");
    let log = bench.program.log();
    assert!(log.contains("WARN") && log.contains("no parameter is called `frame_prefix`"), "{log}");
    fs::remove_file(file).unwrap();
}

/// A wrong parameter of the node is reported before the machine starts: no cycle runs, and there is no bag.
#[test]
fn nothing_has_begun_when_a_parameter_of_the_node_is_refused() {
    for (number, wrong) in ["use_sim_tim:=true", "use_sim_time:=1", "constraints.goal_time:=-1.0"].iter().enumerate() {
        let bag =
            PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("refused-{number}-{}.mcap", std::process::id()));
        let path = bag.to_str().unwrap();
        let log = refused(&format!("-p {wrong} -- --record {path}"));
        assert!(!bag.exists(), "{wrong}: {log}");
        assert!(!log.contains(" cycles, "), "{wrong}: {log}");
    }
}

/// Given values are commands like any other: they are in the bag, and in its replay.
#[test]
fn what_was_given_is_recorded_and_replays() {
    let bag = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("arguments-{}.mcap", std::process::id()));
    let domain = Domain::take();
    let mut cyclone = Peer::cyclone(&domain);
    let path = bag.to_str().unwrap();
    // The longest cycle that a cell may have, so that a recorder without processor time for a while loses no cycle.
    let demo = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml"));
    let slow = file("slow", &demo.expect("the built-in cell").replace("\ncycle: 1 ms", "\ncycle: 20 ms"));
    let mut program = Program::start(
        &[
            "run",
            slow.to_str().unwrap(),
            "--store",
            "none",
            "--record",
            path,
            "--ros-args",
            "-p",
            "x.max_velocity:=0.25",
            "-p",
            "x.profile:=jerk",
        ],
        &domain,
    );
    cyclone.run("axis-states /lineshaft");
    cyclone.run("axes /lineshaft enable x");
    // Within the limits of the cell, beyond the given ones.
    let seen = cyclone.run("move /lineshaft --axis x --position 0.1 --velocity 0.3 --wait --expect ABORTED");
    assert!(seen["result"]["message"].as_str().unwrap().contains("max_velocity"), "{seen:?}");
    cyclone.run("move /lineshaft --axis x --position 0.01 --wait");
    program.interrupt();
    assert_eq!(program.wait_exit(EXIT).code(), Some(0), "{}", program.log());
    let mut replay = Program::start(&["replay", path], &domain);
    assert_eq!(replay.wait_exit(EXIT * 3).code(), Some(0), "{}", replay.log());
    fs::remove_file(slow).unwrap();
    fs::remove_file(bag).unwrap();
}

#[test]
fn the_help_of_run_names_the_ros_arguments() {
    let mut program = Program::start(&["run", "--help"], &Domain::take());
    assert_eq!(program.wait_exit(EXIT).code(), Some(0));
    for word in ["--ros-args", "--params-file", "use_sim_time", "--log-level"] {
        assert!(program.log().contains(word), "{word}: {}", program.log());
    }
}

#[test]
fn what_is_given_and_cannot_be_ends_the_program_with_a_sentence() {
    let wrong = file("wrong", "/lineshaft:\n  ros__parameters:\n    x.max_speed: 1\n");
    let broken = file("broken", "/lineshaft:\n  ros__parameters: [\n");
    for (arguments, sentence) in [
        ("-p x.max_velocity:=-1.0", "x: max_velocity is -1000 mm/s; more than 0 up to"),
        ("-p x.max_velocity:=fast", "error: -p x.max_velocity: x.max_velocity cannot be a string; a number is needed"),
        ("-p x.posfact_z:=2", "x.posfact_z is read-only: part of the cell"),
        ("-p x.velmaxqc:=2", "x.velmaxqc is read-only: computed from other parameters"),
        ("-p x.max_speed:=1", "-p x.max_speed: parameter `x.max_speed` has not been declared"),
        ("-p use_sim_tim:=true", "-p use_sim_tim: no parameter is called `use_sim_tim`"),
        ("-p use_sim_time:=1", "use_sim_time cannot be an integer; a bool is needed"),
        ("-p qos_overrides./joint_states.publisher.depth:=0", "the value is 0; 1 to 65535 is allowed"),
        (
            "-p qos_overrides./joint_state.publisher.depth:=1",
            "no parameter is called `qos_overrides./joint_state.publisher",
        ),
        ("--params-file /no/such.yaml", "error: --params-file /no/such.yaml: "),
        ("--log-config-file x", "--log-config-file is not supported: "),
        ("--log-level loud", r#"--log-level is followed by "loud""#),
        ("-r __node:=a-b", "'-' is not allowed"),
        ("-r ~/enable:=~/disable", "~/enable and ~/disable are both called /lineshaft/disable"),
        ("-r joint_states:=/a/", "a word between two slashes is empty"),
        ("--what", r#"ROS argument "--what" is not known"#),
    ] {
        let log = refused(arguments);
        assert!(log.contains(sentence), "{arguments}: {log}");
    }
    let log = refused(&format!("--params-file {}", wrong.display()));
    assert!(log.contains("wrong.yaml:3:5: parameter `x.max_speed` has not been declared"), "{log}");
    let log = refused(&format!("--params-file {}", broken.display()));
    assert!(log.contains("broken.yaml:") && log.contains("this is not YAML"), "{log}");
    for file in [wrong, broken] {
        fs::remove_file(file).unwrap();
    }
}

#[test]
fn own_parameters_stand_among_those_of_the_machine() {
    let mut bench = Bench::start("/lineshaft", "");
    let listed = bench.cyclone.run("params /lineshaft list")["list"]["names"].clone();
    let names: Vec<&str> = listed.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert!(names.is_sorted() && names.contains(&"use_sim_time") && names.contains(&"x.max_velocity"), "{names:?}");
    let qos = "qos_overrides./joint_states.publisher";
    let seen =
        bench.cyclone.run(&format!("params /lineshaft get use_sim_time {qos}.depth {qos}.reliability x.profile"));
    assert_eq!(seen["get"], json!([false, 10, "reliable", "trapezoid"]));
    let seen = bench.cyclone.run(&format!("params /lineshaft describe use_sim_time {qos}.history"));
    assert_eq!((&seen["describe"][0]["type"], &seen["describe"][0]["read_only"]), (&json!(1), &json!(false)));
    assert_eq!((&seen["describe"][1]["type"], &seen["describe"][1]["read_only"]), (&json!(4), &json!(true)));
    let seen = bench.cyclone.run("params /lineshaft list --depth 1");
    let top = [
        "action_monitor_rate",
        "allow_integration_in_goal_trajectories",
        "allow_nonzero_velocity_at_trajectory_end",
        "allow_partial_joints_goal",
        "angle_wraparound",
        "controller_state_rate",
        "max_duration",
        "robot_description",
        "use_sim_time",
    ];
    assert_eq!((&seen["list"]["names"], &seen["list"]["prefixes"]), (&json!(top), &json!([])));

    let results = bench.set(&format!("use_sim_time=1 {qos}.depth=5 x.max_velocity=0.5 use_sim_time=false"));
    let done: Vec<bool> = results.as_array().unwrap().iter().map(|result| result["successful"] == true).collect();
    assert_eq!(done, [false, false, true, true], "{results}");
    assert!(results[1]["reason"].as_str().unwrap().contains("is read-only: it is given at the start"), "{results}");

    bench.cyclone.run("parameter-events /lineshaft");
    // The machine refuses one of them, so none is set.
    let result = bench.set_together("use_sim_time=true x.max_velocity=-1.0");
    assert_eq!(result["successful"], false, "{result}");
    assert_eq!((bench.get("use_sim_time"), bench.get("x.max_velocity")), (json!(false), json!(0.5)));
    let result = bench.set_together("use_sim_time=true x.max_velocity=0.25 y.max_speed=1");
    assert_eq!((result["successful"].clone(), bench.get("use_sim_time")), (json!(false), json!(false)));
    let result = bench.set_together("x.max_velocity=0.25 use_sim_time=true");
    assert_eq!(result["successful"], true, "{result}");
    assert_eq!((bench.get("use_sim_time"), bench.get("x.max_velocity")), (json!(true), json!(0.25)));
    let seen = bench.cyclone.run("parameter-events /lineshaft --until use_sim_time");
    let changed = seen["events"].as_array().unwrap().iter().find_map(|event| event["changed"].get("use_sim_time"));
    assert_eq!(changed, Some(&json!(true)), "{seen:?}");
}

#[test]
fn stamps_follow_the_clock_of_a_simulation_and_the_cycle_does_not() {
    let mut bench = Bench::start("/lineshaft", "-p use_sim_time:=true");
    bench.cyclone.run("stamps --sec 0");
    bench.cyclone.run("clock --sec 100 --nanosec 5");
    bench.cyclone.run("stamps --sec 100 --nanosec 5");
    // While the simulation time is stopped, the machine continues.
    let state = |bench: &mut Bench| bench.cyclone.run("axis-states /lineshaft");
    let (first, second) = (state(&mut bench), state(&mut bench));
    assert!(second["cycle"].as_u64() > first["cycle"].as_u64(), "{first:?} {second:?}");
    assert_eq!(second["stamp"], json!({"sec": 100, "nanosec": 5}));
    bench.cyclone.run("events /lineshaft");
    bench.cyclone.run("axes /lineshaft enable x");
    bench.cyclone.run("move /lineshaft --axis x --units increments --position 5000 --wait");
    let seen = bench.cyclone.run("events /lineshaft --until done --seconds 10");
    for event in seen.all() {
        assert_eq!(event["message"]["header"]["stamp"], json!({"sec": 100, "nanosec": 5}), "{event}");
    }
    // Forward and back.
    for sec in [5000, 7] {
        bench.cyclone.run(&format!("clock --sec {sec}"));
        bench.cyclone.run(&format!("stamps --sec {sec}"));
    }
    bench.cyclone.fails("axes /lineshaft enable no_such_axis");
    let seen = bench.cyclone.run("rosout --text no_axis_is_called");
    assert_eq!(seen["lines"][0]["stamp"], json!({"sec": 7, "nanosec": 0}), "{seen:?}");

    // Switched off and on again at run time: the subscription is removed and created.
    let mut fastdds = Peer::fastdds(&bench.domain);
    let readers = "readers /clock rosgraph_msgs::msg::dds_::Clock_";
    fastdds.run(&format!("{readers} 1"));
    bench.set("use_sim_time=false");
    bench.cyclone.run("stamps --system");
    bench.cyclone.run("clock --nobody");
    fastdds.run(&format!("{readers} 0"));
    bench.set("use_sim_time=true");
    bench.cyclone.run("stamps --sec 0");
    fastdds.run(&format!("{readers} 1"));
    bench.cyclone.run("clock --sec 42");
    bench.cyclone.run("stamps --sec 42");
    bench.set("use_sim_time=false");
    fastdds.run(&format!("{readers} 0"));
    // Discovery data of other readers is still received.
    bench.set("use_sim_time=true");
    fastdds.run(&format!("{readers} 1"));
}

#[test]
fn levels_of_loggers_choose_the_lines_at_once() {
    let mut bench = Bench::start("/cell/lineshaft", "-r __ns:=/cell --log-level rustdds:=error");
    let seen = bench.cyclone.run("logger-levels /cell/lineshaft cell.lineshaft rustdds other");
    assert_eq!(seen["levels"], json!({"cell.lineshaft": 0, "rustdds": 40, "other": 0}));

    bench.cyclone.fails("axes /cell/lineshaft enable q1");
    let seen = bench.cyclone.run("rosout --text `q1`");
    let lines = seen["lines"].as_array().unwrap();
    assert_eq!(lines.len(), 1, "told once: {lines:?}");
    assert_eq!((&lines[0]["level"], &lines[0]["name"]), (&json!(30), &json!("cell.lineshaft")));

    let seen = bench.cyclone.run("logger-levels /cell/lineshaft cell.lineshaft=50 cell.lineshaft=7");
    assert_eq!(seen["results"][0]["successful"], true);
    assert_eq!(
        seen["results"][1]["reason"],
        "level is 7; 0 unset, 10 debug, 20 info, 30 warn, 40 error, 50 fatal are allowed"
    );
    assert_eq!(seen["levels"]["cell.lineshaft"], 50);
    bench.cyclone.fails("axes /cell/lineshaft enable q2");
    bench.cyclone.run("rosout --text `q2` --seconds 0.5 --none");
    assert!(bench.program.log().contains("`q1`") && !bench.program.log().contains("`q2`"), "{}", bench.program.log());

    bench.cyclone.run("logger-levels /cell/lineshaft cell.lineshaft=10");
    bench.cyclone.run("axes /cell/lineshaft enable x");
    let end = Instant::now() + EXIT;
    while !bench.program.log().contains(" DEBUG ") {
        assert!(Instant::now() < end, "{}", bench.program.log());
        std::thread::sleep(Duration::from_millis(10));
    }
    bench.cyclone.run("logger-levels /cell/lineshaft cell.lineshaft=0");
    bench.cyclone.fails("axes /cell/lineshaft enable q3");
    bench.cyclone.run("rosout --text `q3`");
}

#[test]
fn log_lines_are_published_once_on_rosout() {
    let mut bench = Bench::start("/lineshaft", "");
    bench.cyclone.run("rosout --text ROS_2_node");
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("rosout-{}", std::process::id()));
    bench.cyclone.run(&format!("record /lineshaft start --path {}", folder.display()));
    bench.cyclone.run("record /lineshaft stop");
    let seen = bench.cyclone.run("rosout --text recorded");
    let line = &seen["lines"][0];
    assert_eq!((&line["level"], &line["name"]), (&json!(20), &json!("lineshaft")), "{line}");
    assert!(line["file"].as_str().unwrap().ends_with(".rs") && line["line"].as_u64().unwrap() > 0, "{line}");
    assert!(line["function"].as_str().unwrap().starts_with("lineshaft::run"), "{line}");
    // A refusal by the machine is in the log and in the events, and once on /rosout.
    bench
        .cyclone
        .run("move /lineshaft --axis x --mode relative --units increments --position 1000 --wait --expect ABORTED");
    std::thread::sleep(Duration::from_millis(300));
    let seen = bench.cyclone.run("rosout --text not_enabled");
    assert_eq!(seen["lines"].as_array().unwrap().len(), 1, "{seen:?}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn logs_may_be_switched_off() {
    let mut bench = Bench::start("/lineshaft", "--disable-rosout-logs --disable-stdout-logs");
    let seen = bench.cyclone.run("graph /lineshaft");
    assert!(!seen["writes"].as_array().unwrap().contains(&json!("rt/rosout")), "{seen:?}");
    bench.cyclone.fails("axes /lineshaft enable q");
    assert_eq!(bench.program.log(), "");
}

#[test]
fn qos_of_topics_is_given_at_the_start() {
    let qos = "qos_overrides./joint_states.publisher";
    let mut bench = Bench::start(
        "/lineshaft",
        &format!(
            "-p {qos}.reliability:=best_effort -p {qos}.depth:=3 -p qos_overrides./parameter_events.publisher.depth:=7 \
             -p qos_overrides./clock.subscription.reliability:=reliable -p use_sim_time:=true"
        ),
    );
    bench.cyclone.run("stamps --best-effort --sec 0");
    // A reliable reader is not matched with a best-effort writer.
    let error = Peer::cyclone(&bench.domain).fails("stamps --sec 0");
    assert!(error.contains("nobody publishes /joint_states"), "{error}");
    assert_eq!(
        (bench.get(&format!("{qos}.reliability")), bench.get(&format!("{qos}.depth"))),
        (json!("best_effort"), json!(3))
    );
    bench.cyclone.run("clock --reliable --sec 3");
    bench.cyclone.run("stamps --best-effort --sec 3");

    let mut bench = Bench::start("/lineshaft", &format!("-p {qos}.durability:=transient_local"));
    bench.cyclone.run("stamps --transient-local --system");
    std::thread::sleep(Duration::from_millis(1500));
    let age = Peer::cyclone(&bench.domain).run("late")["oldest_age"].as_f64().unwrap();
    assert!(age > 0.05, "samples from before it came: the oldest is {age} s old");
}
