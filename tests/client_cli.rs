//! Tests commands to a node without ROS: `lineshaft state`, `enable`, `move`, `home`, `jog` and so on.

use crate::support::domain::Domain;
use crate::support::program::Program;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

/// Longer than the discovery of a node takes on a busy machine.
const TIMEOUT: [&str; 2] = ["--timeout", "30 s"];
/// Longer than any motion here.
const PATIENCE: Duration = Duration::from_secs(60);

/// Runs a command to its end; returns exit code, standard output, standard error.
fn client(domain: &Domain, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_lineshaft"))
        .args(arguments)
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_DOMAIN_ID", domain.to_string())
        .env_remove("ROS_LOCALHOST_ONLY")
        .env_remove("RUST_LOG")
        .output()
        .expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status.code().expect("it ended by itself"), text(output.stdout), text(output.stderr))
}

/// Arguments of `run`: a jog whose messages are late by more than `setpoint_timeout` ends, and 100 ms are too short on a busy machine.
const PATIENT_JOG: [&str; 3] = ["--ros-args", "-p", "x.setpoint_timeout:=2.0"];

/// The built-in demo as a node.
struct Demo {
    program: Program,
    domain: Domain,
}

impl Demo {
    fn start() -> Self {
        Self::start_with(&[])
    }

    fn start_with(arguments: &[&str]) -> Self {
        let domain = Domain::take();
        let program = Program::start(&[&["run"], arguments].concat(), &domain);
        Self { program, domain }
    }

    fn client(&self, arguments: &[&str]) -> (i32, String, String) {
        client(&self.domain, &[arguments, &TIMEOUT].concat())
    }

    /// Runs a command that succeeds; returns its output.
    #[track_caller]
    fn good(&self, arguments: &[&str]) -> String {
        let (code, out, error) = self.client(arguments);
        assert_eq!((code, error.as_str()), (0, ""), "{arguments:?}: {out}");
        out
    }

    /// Runs a command that fails with this code; returns its message.
    #[track_caller]
    fn fails(&self, with: i32, arguments: &[&str]) -> String {
        let (code, out, error) = self.client(arguments);
        assert_eq!((code, out.as_str()), (with, ""), "{arguments:?}: {error}");
        error
    }

    /// Returns the state of an axis.
    #[track_caller]
    fn axis(&self, name: &str) -> Value {
        let value: Value = serde_json::from_str(&self.good(&["state", "--json"])).expect("JSON");
        let axes = value["axes"].as_array().expect("a list");
        axes.iter().find(|axis| axis["name"] == name).expect("the axis").clone()
    }

    #[track_caller]
    fn increments(&self, axis: &str) -> i64 {
        self.axis(axis)["position_increments"].as_i64().expect("a whole number")
    }

    /// Waits until the axis is in this state.
    #[track_caller]
    fn until(&self, axis: &str, state: &str) {
        let end = Instant::now() + PATIENCE;
        loop {
            let seen = self.axis(axis);
            if seen["state"] == state {
                return;
            }
            assert!(Instant::now() < end, "{axis} is not in {state}: {seen}");
        }
    }

    /// Starts a command that does not end by itself.
    fn begin(&self, arguments: &[&str]) -> Program {
        Program::start(&[arguments, &TIMEOUT].concat(), &self.domain)
    }
}

/// 9000 of the 36000 inc of a revolution are 90 deg; 1048576 inc of x are 10 mm. The turret is at its command position
/// of one cycle ago.
#[test]
fn axis_is_enabled_and_moved_to_its_exact_position_without_ros() {
    let demo = Demo::start();
    assert_eq!(demo.good(&["enable", "x", "turret"]), "2 axes enabled\n");
    assert_eq!(demo.good(&["move", "turret", "90 deg"]), "turret: 1.570796327 rad (90 deg), 9000 inc\n");
    let turret = demo.axis("turret");
    assert_eq!((&turret["position_increments"], &turret["position_in_unit"]), (&json!(9000), &json!("90 deg")));
    assert_eq!(
        (&turret["unit"], &turret["state"], &turret["enabled"]),
        (&json!("rad"), &json!("STANDSTILL"), &json!(true))
    );
    assert_eq!(
        demo.good(&["move", "turret", "-30 deg", "--relative", "--velocity", "45 deg/s"]),
        "turret: 1.047197551 rad (60 deg), 6000 inc\n"
    );
    assert_eq!(demo.good(&["move", "x", "50 mm"]), "x: 0.05 m (50 mm), 5242880 inc\n");
    assert_eq!(demo.good(&["move", "x", "20 mm"]), "x: 0.02 m (20 mm), 2097152 inc\n");
    assert_eq!(demo.good(&["move", "x", "1048576 inc"]), "x: 0.01 m (10 mm), 1048576 inc\n");
    let table = demo.good(&["state"]);
    let lines: Vec<_> = table.lines().collect();
    assert_eq!(lines.len(), 5, "{table}");
    assert!(lines[0].starts_with("axis") && lines[2].starts_with("x ") && lines[2].contains("STANDSTILL"), "{table}");
    assert_eq!(demo.good(&["halt"]), "4 axes halted\n");
    assert_eq!(demo.good(&["reset", "--all"]), "4 axes reset\n");
    assert_eq!(demo.good(&["disable", "x"]), "1 axis disabled\n");
    assert_eq!(demo.axis("x")["state"], "DISABLED");
    assert_eq!(demo.good(&["disable", "line"]), "line: virtual, always enabled\n");
}

/// A wrong name must not keep a motion going.
#[test]
fn halt_stops_the_known_axes_and_reports_the_unknown_one() {
    let demo = Demo::start();
    demo.good(&["enable", "x"]);
    // It takes 16 s.
    let mut motion = demo.begin(&["move", "x", "800 mm", "--velocity", "50 mm/s"]);
    demo.until("x", "DISCRETE_MOTION");
    let (code, out, error) = demo.client(&["halt", "x", "xx"]);
    assert_eq!((code, out.as_str()), (1, "1 axis halted\n"));
    assert_eq!(error, "error: no axis is called `xx`; there are line, x, y, turret\n");
    assert_eq!(motion.wait_exit(PATIENCE).code(), Some(1), "{}", motion.log());
    assert_eq!(demo.axis("x")["state"], "STANDSTILL");
    let nothing = "error: no axis is called `xx`; there are line, x, y, turret; nothing was stopped\n";
    assert_eq!(demo.fails(1, &["stop", "xx"]), nothing);
}

#[test]
fn refused_motion_moves_nothing_and_prints_the_sentence_of_the_node() {
    let demo = Demo::start();
    let disabled = demo.fails(1, &["move", "turret", "10 deg"]);
    assert!(disabled.starts_with("error: turret: the axis is not enabled; enable it first"), "{disabled}");
    let disabled = demo.fails(1, &["jog", "turret", "10 deg/s"]);
    assert!(disabled.contains("turret: the axis is not enabled"), "{disabled}");
    demo.good(&["enable", "turret", "x"]);
    let (x, turret) = (demo.increments("x"), demo.increments("turret"));
    let beyond = demo.fails(1, &["move", "x", "900 mm"]);
    assert!(beyond.starts_with("error: x: ") && beyond.contains("max_position"), "{beyond}");
    let fast = demo.fails(1, &["move", "turret", "90 deg", "--velocity", "100 deg/s"]);
    assert!(fast.contains("max_velocity") || fast.contains("100 deg/s"), "{fast}");
    let fast = demo.fails(1, &["jog", "x", "2 m/s"]);
    assert!(fast.contains("max_velocity"), "{fast}");
    // Wrong usage: nothing is sent.
    assert!(demo.fails(2, &["move", "x", "90 deg"]).starts_with("error: POSITION: `90 deg` is an angle; a length"));
    assert!(demo.fails(2, &["move", "x", "10mm"]).contains("write `10 mm`"));
    // 50 may mean 50 m or 50 mm: the hint has the unit of the axis.
    assert_eq!(demo.fails(2, &["move", "x", "50"]), "error: POSITION: `50` has no unit; did you mean `50 mm`?\n");
    assert_eq!(demo.fails(2, &["jog", "turret", "5"]), "error: VELOCITY: `5` has no unit; did you mean `5 deg/s`?\n");
    assert!(demo.fails(2, &["move", "x", "1 mm", "--velocity", "0"]).contains("must exceed 0"));
    assert_eq!(
        demo.fails(1, &["enable", "missing"]),
        "error: no axis is called `missing`; there are line, x, y, turret\n"
    );
    assert!(demo.fails(1, &["move", "missing", "1 mm"]).starts_with("error: node /lineshaft has no axis `missing`"));
    assert!(demo.fails(1, &["home", "turret", "missing"]).contains("has no axis `missing`"));
    assert_eq!((demo.increments("x"), demo.increments("turret")), (x, turret));
}

#[test]
fn interrupted_motion_is_canceled_and_its_axis_halts() {
    let demo = Demo::start();
    demo.good(&["enable", "x"]);
    // It takes 16 s.
    let mut motion = demo.begin(&["move", "x", "800 mm", "--velocity", "50 mm/s"]);
    demo.until("x", "DISCRETE_MOTION");
    motion.interrupt();
    assert_eq!(motion.wait_exit(PATIENCE).code(), Some(1), "{}", motion.log());
    assert!(motion.log().contains("command position 0."), "{}", motion.log());
    let x = demo.axis("x");
    assert_eq!(x["state"], "STANDSTILL");
    assert!(x["position"].as_f64().expect("a number") < 0.7, "{x}");
    assert_eq!(x["enabled"], true);
}

#[test]
fn jog_stops_at_its_time_at_a_signal_and_when_it_is_killed() {
    let demo = Demo::start_with(&PATIENT_JOG);
    demo.good(&["enable", "x"]);
    let begin = demo.increments("x");
    let (code, out, error) = demo.client(&["jog", "x", "20 mm/s", "--for", "500 ms"]);
    assert!(code == 0 && out.starts_with("x: 0.0"), "{code}: {out}{error}");
    let first = demo.increments("x");
    // 10 mm, and less on a busy machine; 1048576 inc are 10 mm.
    assert!(first > begin + 100_000 && first < begin + 3_000_000, "{begin} to {first}");
    assert_eq!(demo.axis("x")["state"], "STANDSTILL");

    let mut jog = demo.begin(&["jog", "x", "20 mm/s"]);
    demo.until("x", "CONTINUOUS_MOTION");
    jog.interrupt();
    assert_eq!(jog.wait_exit(PATIENCE).code(), Some(0), "{}", jog.log());
    assert_eq!(demo.axis("x")["state"], "STANDSTILL");
    let second = demo.increments("x");
    assert!(second > first, "{first} to {second}");

    let mut jog = demo.begin(&["jog", "x", "-20 mm/s"]);
    demo.until("x", "CONTINUOUS_MOTION");
    jog.kill();
    jog.wait_exit(PATIENCE);
    demo.until("x", "STANDSTILL");
    let third = demo.increments("x");
    thread::sleep(Duration::from_millis(300));
    // It may still settle by some micrometres: 1048 inc are 10 um.
    assert!((demo.increments("x") - third).abs() < 1048, "it moves on");
}

/// A stream would move an axis again after a halt; the command ends instead.
#[test]
fn jog_ends_for_good_when_the_axis_is_halted_or_disabled() {
    let demo = Demo::start_with(&PATIENT_JOG);
    for stop in ["halt", "disable"] {
        demo.good(&["enable", "x"]);
        let mut jog = demo.begin(&["jog", "x", "5 mm/s"]);
        demo.until("x", "CONTINUOUS_MOTION");
        demo.good(&[stop, "x"]);
        assert_eq!(jog.wait_exit(PATIENCE).code(), Some(1), "{stop}: {}", jog.log());
        assert!(jog.log().contains("the jog has ended"), "{stop}: {}", jog.log());
        demo.good(&["enable", "x"]);
        let rest = demo.increments("x");
        thread::sleep(Duration::from_millis(300));
        // It may still settle by some micrometres: 1048 inc are 10 um.
        assert!((demo.increments("x") - rest).abs() < 1048, "{stop}: it moves again");
    }
}

#[test]
fn homing_is_waited_for() {
    let demo = Demo::start();
    let disabled = demo.fails(1, &["home", "x"]);
    assert!(disabled.contains("enable it first"), "{disabled}");
    demo.good(&["enable", "x", "y"]);
    assert_eq!(demo.axis("x")["homed"], false);
    // Axes that have a method: turret and line have none.
    assert_eq!(demo.good(&["home", "--all"]), "x: homed\ny: homed\n");
    assert_eq!((&demo.axis("x")["homed"], &demo.axis("y")["homed"]), (&json!(true), &json!(true)));
    // The command takes no method, so its message does not suggest to name one.
    demo.good(&["enable", "turret"]);
    assert_eq!(
        demo.fails(1, &["home", "turret"]),
        "error: turret: homing.method is 0: give the axis a method in its cell\n"
    );
}

/// With `autostart: false` the node waits unconfigured.
#[test]
fn node_that_waits_is_activated_without_ros() {
    let folder = tempfile::tempdir().expect("a folder");
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml");
    let text = fs::read_to_string(demo).expect("the demo");
    assert!(text.contains("autostart: true"), "{text}");
    let cell = folder.path().join("cell.yaml");
    fs::write(&cell, text.replace("autostart: true", "autostart: false")).expect("room for a file");
    let domain = Domain::take();
    let program = Program::start(&["run", cell.to_str().expect("a path of text")], &domain);
    let demo = Demo { program, domain };
    demo.program.wait_for_log("autostart is false: the node waits, unconfigured; `lineshaft activate` starts it");
    let refused = demo.fails(1, &["enable", "x"]);
    let remedy = "configure and activate it first (`lineshaft activate` with the name of the node, or ~/change_state)";
    assert!(refused.contains(remedy), "{refused}");
    assert_eq!(demo.good(&["activate"]), "node /lineshaft is active\n");
    // Nothing is to be done the second time.
    assert_eq!(demo.good(&["activate"]), "node /lineshaft is active\n");
    assert_eq!(demo.good(&["enable", "x"]), "1 axis enabled\n");
}

#[test]
fn command_without_a_node_reports_domain_and_name() {
    let domain = Domain::take();
    let (code, out, error) = client(&domain, &["state", "--timeout", "500 ms"]);
    assert_eq!((code, out.as_str()), (1, ""));
    let begin = format!(
        "error: no answer from node /lineshaft within 0.5 s (ROS_DOMAIN_ID {domain}, discovery range LOCALHOST: only this host); \
         check that `lineshaft run` runs"
    );
    assert!(error.starts_with(&begin), "{error}");
    assert_eq!(client(&domain, &["enable"]).0, 2);
    assert_eq!(client(&domain, &["state", "--node", "a-b"]).0, 2);
}

/// A command that acts needs the name of its node: discovery may be slow, and another machine would move.
#[test]
fn only_node_of_another_name_is_read_and_none_is_chosen_for_a_motion() {
    let demo = Demo::start_with(&["--ros-args", "-r", "__ns:=/a"]);
    demo.program.wait_for_log("ROS 2 node /a/lineshaft");
    let value: Value = serde_json::from_str(&demo.good(&["state", "--json"])).expect("JSON");
    assert_eq!(value["node"], "/a/lineshaft");
    assert!(demo.good(&["state"]).starts_with("node /a/lineshaft\naxis  "));
    let (code, _, error) = client(&demo.domain, &["enable", "--all", "--timeout", "10 s"]);
    assert_eq!(code, 1);
    assert!(error.contains("; other Lineshaft nodes are /a/lineshaft: choose one by --node; "), "{error}");
    assert_eq!(demo.good(&["enable", "x", "--node", "a/lineshaft"]), "1 axis enabled\n");
    let other = Program::start(&["run", "--ros-args", "-r", "__ns:=/b"], &demo.domain);
    other.wait_for_log("ROS 2 node /b/lineshaft");
    // Both are discovered by then.
    let found = demo.good(&["state", "--json", "--node", "/b/lineshaft"]);
    assert!(found.contains("\"/b/lineshaft\""), "{found}");
    let several = demo.fails(2, &["state"]);
    assert_eq!(several, "error: several Lineshaft nodes: /a/lineshaft, /b/lineshaft; choose one by --node\n");
}

#[test]
fn watch_prints_an_object_on_each_line_until_it_is_interrupted() {
    let demo = Demo::start();
    let mut watch = demo.begin(&["state", "--watch", "--json"]);
    let end = Instant::now() + PATIENCE;
    while watch.log().lines().count() < 3 {
        assert!(Instant::now() < end, "{}", watch.log());
        thread::sleep(Duration::from_millis(20));
    }
    watch.interrupt();
    assert_eq!(watch.wait_exit(PATIENCE).code(), Some(0));
    let cycles: Vec<u64> = watch
        .log()
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).expect("JSON")["cycle"].as_u64().expect("a number"))
        .collect();
    assert!(cycles.is_sorted() && cycles.first() < cycles.last(), "{cycles:?}");
}
