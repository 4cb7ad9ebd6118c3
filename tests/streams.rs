//! Tests `~/jog` and `~/setpoints` with publishers on Cyclone DDS and Fast DDS: motion, end of motion, refusals, and
//! the replay of a recording.

use std::{
    process::Command,
    thread,
    time::{Duration, Instant},
};

use crate::support::{
    domain::Domain,
    peer::{Observations, Peer},
    program::Program,
};
use serde_json::Value;

/// The built-in demo with x and y enabled, recorded, and its listener. Its axes have setpoint_timeout 100 ms.
struct Demo {
    listener: Peer,
    program: Program,
    domain: Domain,
    folder: tempfile::TempDir,
}

impl Demo {
    fn start() -> Self {
        let (domain, folder) = (Domain::take(), tempfile::tempdir().expect("room for a folder"));
        let mut listener = Peer::cyclone(&domain);
        let bag = folder.path().join("run").display().to_string();
        // Files of 2 s: a file may begin while setpoints are streamed.
        let arguments = ["run", "--flight-recorder", "0", "--record", &bag, "--max-bag-duration", "2"];
        let program = Program::start(&arguments, &domain);
        listener.run("axis-states /lineshaft");
        listener.run("events /lineshaft");
        listener.run("axes /lineshaft enable x y");
        Self { listener, program, domain, folder }
    }

    fn axis(&mut self, axis: &str) -> Value {
        self.listener.run("axis-states /lineshaft")["axes"][axis].clone()
    }

    fn position(&mut self, axis: &str) -> i64 {
        self.axis(axis)["command_increments"].as_i64().expect("whole increments")
    }

    /// Waits until an axis is at rest; returns its position.
    #[track_caller]
    fn wait_for_standstill(&mut self, axis: &str) -> i64 {
        for _ in 0..100 {
            let seen = self.axis(axis);
            if seen["state"] == "STANDSTILL" {
                assert_eq!(seen["command_velocity"], 0.0, "{seen}");
                return seen["command_increments"].as_i64().expect("whole increments");
            }
            thread::sleep(Duration::from_millis(50));
        }
        panic!("{axis} does not come to rest");
    }

    /// Returns the texts of all events of a kind since the last call.
    fn events(&mut self, kind: &str) -> Vec<String> {
        self.events_of(&[kind])
    }

    /// Returns the texts of all events of these kinds since the last call.
    fn events_of(&mut self, kinds: &[&str]) -> Vec<String> {
        thread::sleep(Duration::from_millis(200));
        let seen = self.listener.run("events /lineshaft");
        let messages = seen.all().iter().filter_map(|one| one.get("message"));
        let wanted = messages.filter(|message| kinds.iter().any(|kind| message["kind"] == *kind));
        wanted.filter_map(|message| message["text"].as_str().map(str::to_owned)).collect()
    }

    /// Ends the run with the signal of Ctrl-C; the recording must replay without a difference.
    #[track_caller]
    fn end(mut self) {
        self.program.end();
        let bag = self.folder.path().join("run");
        let replay = Command::new(env!("CARGO_BIN_EXE_lineshaft")).arg("replay").arg(bag).output();
        let output = replay.expect("the program starts");
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{text}");
    }
}

#[test]
fn jog_moves_while_streamed_and_its_timeout_is_a_controlled_stop() {
    let mut demo = Demo::start();
    let mut hand = Peer::cyclone(&demo.domain);
    let start = demo.position("x");
    hand.run("stream /lineshaft jog --axis x=0.05 --seconds 1");
    let end = demo.wait_for_standstill("x");
    // 50 mm in 1 s, and 5 mm more until the timeout; with two computers under load many messages may be late.
    assert!(end > start, "{start} to {end}");
    // Once, or more often if the publisher itself was delayed.
    let warnings = demo.events("warning");
    assert!(!warnings.is_empty() && warnings.len() <= 10, "{warnings:?}");
    assert!(warnings.iter().all(|text| text == "x: streamed setpoints stopped coming"), "{warnings:?}");
    // The jog lasts as long as its message requests, and ends without a warning.
    hand.run("stream /lineshaft jog --axis x=-0.05 --duration 0.05");
    assert!(demo.wait_for_standstill("x") < end);
    assert_eq!(demo.events("warning"), [""; 0]);
    demo.end();
}

#[test]
fn a_publisher_that_is_killed_stops_its_axis_and_no_other() {
    let mut demo = Demo::start();
    let (mut hand, mut machine) = (Peer::cyclone(&demo.domain), Peer::cyclone(&demo.domain));
    // Both are started and matched, so that they begin together on a busy machine, too.
    machine.run("stream /lineshaft setpoints --axis y=0.01");
    hand.run("stream /lineshaft jog --axis x=0.02");
    demo.wait_for_standstill("x");
    demo.wait_for_standstill("y");
    demo.events("warning");
    machine.tell("stream /lineshaft setpoints --axis y=0.01 --seconds 8 --rate 100");
    hand.tell("stream /lineshaft jog --axis x=0.02 --seconds 60 --rate 100");
    let moves = |demo: &mut Demo, axis| demo.axis(axis)["state"] == "CONTINUOUS_MOTION";
    let end = Instant::now() + Duration::from_secs(6);
    let both = std::iter::repeat_with(|| moves(&mut demo, "x") && moves(&mut demo, "y"))
        .take_while(|_| Instant::now() < end)
        .any(|both| both);
    assert!(both, "both move at once");
    drop(hand);
    demo.wait_for_standstill("x");
    let before = demo.position("y");
    thread::sleep(Duration::from_millis(300));
    let after = demo.position("y");
    assert!(after > before || !moves(&mut demo, "y"), "y goes on: {before} to {after}");
    assert_eq!(machine.answer().1, None);
    demo.wait_for_standstill("y");
    let warnings = demo.events("warning");
    assert!(warnings.contains(&"x: streamed setpoints stopped coming".to_owned()), "{warnings:?}");
    demo.end();
}

#[test]
fn refused_messages_cause_no_motion_and_report_the_reason() {
    let mut demo = Demo::start();
    let mut hand = Peer::cyclone(&demo.domain);
    let start = demo.position("x");
    for (message, part) in [
        ("jog --axis x=0.01 --axis w=0.01", "joint_names has the joint `w`"),
        ("jog --axis x=0.01 --axis x=0.01", "joint_names has the joint `x` twice"),
        ("jog --axis x=nan", "velocity of `x` is NaN"),
        ("jog --axis x=-inf", "velocity of `x` is -inf"),
        ("jog --axis x=100", "velocity 100 m/s (100000 mm/s) of x exceeds max_velocity 1.2 m/s (1200 mm/s)"),
        ("jog --axis x=0.01 --displacements 1", "displacements has 1 entries"),
        ("jog --axis x=0.01 --duration -1", "duration is -1 s"),
        ("jog", "no axis is named"),
        ("setpoints --axis x=0.01 --axis x=0.01", "axis `x` stands twice"),
        ("setpoints --axis x=0.01 --age 5", "ms old by its stamp"),
    ] {
        // The node limits the rate of equal warnings to one per second.
        thread::sleep(Duration::from_millis(1100));
        hand.run(&format!("stream /lineshaft {message} --seconds 0.1 --rate 200"));
        let refused = demo.events("refused");
        let topic = message.split(' ').next().unwrap_or_default();
        assert!(!refused.is_empty() && refused.len() <= 2, "{message}: {refused:?}");
        for sentence in refused {
            assert!(sentence.contains(part) && sentence.contains(topic), "{message}: {sentence}");
        }
        assert_eq!(demo.position("x"), start, "{message}");
    }
    // A present time stamp is accepted.
    hand.run("stream /lineshaft setpoints --axis x=0.02 --age 0 --seconds 0.2");
    assert!(demo.wait_for_standstill("x") > start);
    demo.end();
}

#[test]
fn stream_to_a_disabled_axis_is_reported_once() {
    let mut demo = Demo::start();
    let mut hand = Peer::cyclone(&demo.domain);
    hand.run("stream /lineshaft jog --axis turret=0.1 --seconds 0.4 --rate 100");
    let off = "turret: streamed setpoints are not followed: the axis is not enabled; enable it first";
    let warnings = demo.events("warning");
    // Under load there may have been a gap.
    assert!(!warnings.is_empty() && warnings.len() < 10 && warnings.iter().all(|text| text == off), "{warnings:?}");
    demo.listener.run("move /lineshaft --axis x --position 0.5 --velocity 0.05");
    hand.run("stream /lineshaft jog --axis x=-0.05 --seconds 0.4 --rate 100");
    let busy = "x: streamed setpoints are not followed: something else moves the axis";
    let warnings = demo.events("warning");
    assert!(!warnings.is_empty() && warnings.iter().all(|text| text.starts_with(busy)), "{warnings:?}");
    assert_eq!(demo.axis("x")["state"], "DISCRETE_MOTION", "the goal moves on");
    demo.listener.run("axes /lineshaft halt x");
    demo.end();
}

/// The limit of x is -50 mm, with 1048576 inc for 10 mm.
const LIMIT: i64 = -5 * 1_048_576;

/// With error_reaction 0, the default of a cell, an error switches the drive off.
#[test]
fn a_jog_into_a_software_limit_keeps_the_power_and_leads_away() {
    let mut demo = Demo::start();
    let mut hand = Peer::cyclone(&demo.domain);
    demo.listener.run("params /lineshaft set x.error_reaction=0");
    let jog_until = |demo: &mut Demo, hand: &mut Peer, is_there: fn(&Value) -> bool| {
        // If the publisher is delayed, the axis stops before the limit.
        let ends = (0..20).any(|_| {
            hand.run("stream /lineshaft jog --axis x=-0.1 --seconds 1");
            is_there(&demo.axis("x"))
        });
        assert!(ends, "{}", demo.axis("x"));
    };
    let is_at_limit = |x: &Value| x["command_increments"] == LIMIT;
    let silent = "x: streamed setpoints stopped coming";
    let told = |demo: &mut Demo| {
        let mut told = demo.events_of(&["limit", "warning", "error"]);
        told.retain(|text| text != silent);
        told
    };
    told(&mut demo);
    for _ in 0..2 {
        jog_until(&mut demo, &mut hand, is_at_limit);
        assert_eq!(demo.wait_for_standstill("x"), LIMIT);
        let axis = demo.axis("x");
        assert_eq!((axis["enabled"].as_bool(), axis["error_code"].as_i64()), (Some(true), Some(0)), "{axis}");
        assert_eq!(told(&mut demo), ["x: stopped at min_position -50 mm"]);
        // 50 more messages towards the limit, after a gap.
        jog_until(&mut demo, &mut hand, is_at_limit);
        assert_eq!((demo.wait_for_standstill("x"), told(&mut demo)), (LIMIT, Vec::new()));
        hand.run("stream /lineshaft jog --axis x=0.1 --seconds 0.3");
        assert!(demo.wait_for_standstill("x") > LIMIT + 100_000);
    }
    demo.listener.run("params /lineshaft set x.jog_at_limit=error");
    jog_until(&mut demo, &mut hand, |x| x["state"] == "ERROR_STOP");
    let axis = demo.axis("x");
    assert_eq!((axis["enabled"].as_bool(), axis["error_code"].as_i64()), (Some(false), Some(10203)), "{axis}");
    demo.end();
}

/// The same for a client on Fast DDS, the default of ROS 2, which jogs and receives the state of the axis and its one
/// event.
#[test]
fn jog_from_fast_dds_stops_at_the_software_limit_and_its_client_sees_it() {
    let mut demo = Demo::start();
    let mut hand = Peer::fastdds(&demo.domain);
    let starts = hand.run("axis-states /lineshaft")["axes"]["x"].clone();
    assert_eq!((&starts["state"], starts["command_increments"].as_i64()), (&"STANDSTILL".into(), Some(0)), "{starts}");
    hand.run("events /lineshaft");
    // If the publisher is delayed, the axis stops before the limit.
    let comes = (0..40).any(|_| {
        hand.run("stream /lineshaft jog --axis x=-0.1 --seconds 0.3");
        hand.run("axis-states /lineshaft")["axes"]["x"]["command_increments"] == LIMIT
    });
    assert!(comes, "{}", demo.axis("x"));
    let seen = hand.run("events /lineshaft --seconds 20 --until limit");
    let told = limits(&seen);
    let [limit] = told.as_slice() else { panic!("one event of the limit is expected: {told:?}") };
    assert_eq!(
        (&limit["source"], &limit["code"], &limit["increments"], &limit["text"]),
        (&"x".into(), &10_203.into(), &LIMIT.into(), &"x: stopped at min_position -50 mm".into())
    );
    // More messages towards the limit, after a gap: no motion, and no further report.
    hand.run("stream /lineshaft jog --axis x=-0.1 --seconds 0.3");
    let x = hand.until_axis("x", "stands at its limit", |x| x["state"] == "STANDSTILL");
    assert_eq!(
        (x["command_increments"].as_i64(), x["enabled"].as_bool(), x["error_code"].as_i64()),
        (Some(LIMIT), Some(true), Some(0)),
        "{x}"
    );
    let seen = hand.run("events /lineshaft --seconds 0.2");
    assert!(limits(&seen).is_empty(), "{seen:?}");
    hand.run("stream /lineshaft jog --axis x=0.1 --seconds 0.3");
    hand.until_axis("x", "stands away from its limit", |x| {
        x["state"] == "STANDSTILL" && x["command_increments"].as_i64() > Some(LIMIT + 100_000)
    });
    demo.end();
}

/// Returns the events of limits and errors that a peer has received.
fn limits(seen: &Observations) -> Vec<&Value> {
    let messages = seen.all().iter().filter_map(|one| one.get("message"));
    messages.filter(|message| message["kind"] == "limit" || message["kind"] == "error").collect()
}
