//! Tests steps of the system clock, which libfaketime simulates for the node and its clients: the clock of the machine
//! is never set.

use std::{fs, path::PathBuf, process::Command};

use crate::support::{bag_check::bag_check, domain::Domain, machine::alone, peer::Peer, program::Program, setup};
use serde_json::Value;

/// Starts a peer with additional environment variables.
type Begin = fn(&Domain, Vec<(&str, String)>) -> Peer;

/// The built-in demo, recorded, and a client; both have the system clock of the file.
struct Bench {
    client: Peer,
    program: Program,
    domain: Domain,
    folder: tempfile::TempDir,
}

impl Bench {
    fn start(client: Begin) -> Self {
        let (domain, folder) = (Domain::take(), tempfile::tempdir().expect("room for a folder"));
        let file = folder.path().join("clock");
        fs::write(&file, "+0\n").expect("a file in a new folder");
        let mut program = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        // Files of 2 s: some begin after a step.
        program.args(["run", "--max-bag-duration", "2", "--record"]).arg(folder.path().join("run"));
        program.arg("--flight-folder").arg(folder.path().join("flight")).envs(fake(&file));
        let program = Program::start_by(program, &domain);
        // A participant of Fast DDS that starts together with the program may receive no topic of it.
        program.wait_for_log("the node is active");
        let mut client = client(&domain, fake(&file));
        client.run("axis-states /lineshaft");
        Self { client, program, domain, folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Sets the clock by these seconds, one after the other; it was ahead by `ahead` s.
    #[track_caller]
    fn steps(&mut self, ahead: f64, steps: &str) -> Vec<Value> {
        let file = self.path("clock");
        let seen = self.client.run(&format!("clock-steps /lineshaft {} {steps} --ahead {ahead}", file.display()));
        seen.all().iter().filter(|one| one.get("step").is_some()).cloned().collect()
    }

    /// A new client and the existing one move x forward and back.
    #[track_caller]
    fn works_for(&mut self, newcomer: &mut Peer) {
        for client in [newcomer, &mut self.client] {
            client.run("axes /lineshaft enable x");
            client.run("move /lineshaft --axis x --units increments --position 5000 --wait");
            client.run("move /lineshaft --axis x --units increments --position 0 --wait");
        }
    }

    /// Ends the run with the signal of Ctrl-C; the recording must replay without a difference.
    #[track_caller]
    fn end(&mut self) {
        self.program.end();
        let replay = Command::new(env!("CARGO_BIN_EXE_lineshaft")).arg("replay").arg(self.path("run")).output();
        let output = replay.expect("the program starts");
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{text}");
    }
}

/// Returns the environment variables that give a process the system clock of the file.
fn fake(file: &std::path::Path) -> Vec<(&'static str, String)> {
    vec![
        ("LD_PRELOAD", setup::fake_clock().display().to_string()),
        ("FAKETIME_TIMESTAMP_FILE", file.display().to_string()),
        ("FAKETIME_NO_CACHE", "1".to_owned()),
        ("FAKETIME_DONT_FAKE_MONOTONIC", "1".to_owned()),
    ]
}

/// Each step is reported within a second by one event and one line, before any stamp of joint_states, axis_states,
/// diagnostics or cycle_statistics shows it; events and lines of `/rosout` show it from then on. Bags keep steady log
/// times and replay.
#[test]
fn stamps_follow_the_system_clock_after_the_event_that_reports_it() {
    let _alone = alone();
    let mut bench = Bench::start(Peer::cyclone_with);
    let seen = bench.steps(0.0, "3600 -3600 5 -0.9");
    assert_eq!(seen.len(), 4, "{seen:?}");
    for (one, size) in seen.iter().zip(["forward by 3600.", "back by 3600.", "forward by 5.", "back by 0."]) {
        let text = one["text"].as_str().expect("a text");
        assert!(text.contains(&format!("the system clock was set {size}")), "{one}");
        assert_eq!((&one["kind"], &one["severity"]), (&"warning".into(), &1.into()), "{one}");
        let second = |value: &Value| value.as_f64().expect("a time") < 1.0;
        assert!(second(&one["event_s"]), "{one}");
        // The other topics are published once a second.
        assert!(
            ["/joint_states", "/lineshaft/axis_states"].iter().all(|topic| second(&one["shown_s"][topic])),
            "{one}"
        );
        let log = bench.program.log();
        assert_eq!(log.lines().filter(|line| line.contains(text)).count(), 1, "{log}");
    }
    bench.end();
    // The span of the log times does not exceed the duration of the run.
    let bag = bench.path("run");
    let span = bag_check(["rosbags", &bag.display().to_string()]);
    let (start, end) = (span["start_ns"].as_i64(), span["end_ns"].as_i64());
    let seconds = (end.expect("a time") - start.expect("a time")) / 1_000_000_000;
    assert!((1..300).contains(&seconds), "{span:?}");
}

/// The DDS library stops reading announcements of participants when time goes back: without a new ROS side the node
/// would lose this client after its lease (10 s), and never discover another one.
#[test]
fn node_works_on_after_steps_of_the_system_clock() {
    let mut bench = Bench::start(Peer::cyclone_with);
    let side = bench.program.ros_side();
    bench.steps(0.0, "3600");
    assert_eq!(bench.program.ros_side(), side, "a step forward does no harm");
    bench.steps(3600.0, "-3600");
    bench.program.ros_side_after(side);
    let mut newcomer = Peer::cyclone_with(&bench.domain, fake(&bench.path("clock")));
    bench.works_for(&mut newcomer);
    bench.end();
}

/// The same for clients on Fast DDS, the default of ROS 2: the event of each step, then the stamps of all topics that
/// follow it, and answers after a step back, for an existing client and for a new one.
#[test]
fn clients_on_fast_dds_see_stamps_follow_the_system_clock_and_work_on() {
    let mut bench = Bench::start(Peer::fastdds_with);
    let side = bench.program.ros_side();
    let seen = bench.steps(0.0, "5 -3600");
    assert_eq!(seen.len(), 2, "{seen:?}");
    for (one, size) in seen.iter().zip(["forward by 5.", "back by 3600."]) {
        let event = &one["event"];
        let text = event["text"].as_str().expect("a text");
        assert!(text.contains(&format!("the system clock was set {size}")), "{one}");
        assert_eq!((&event["kind"], &event["severity"]), (&"warning".into(), &1.into()), "{one}");
        let topics = ["/diagnostics", "/joint_states", "/lineshaft/axis_states", "/lineshaft/cycle_statistics"];
        assert_eq!(one["topics"], Value::from(topics.to_vec()), "{one}");
    }
    bench.program.ros_side_after(side);
    let mut newcomer = Peer::fastdds_with(&bench.domain, fake(&bench.path("clock")));
    bench.works_for(&mut newcomer);
    bench.end();
}
