//! Tests the built-in demo on ROS 2 with peers on Eclipse Cyclone DDS and Fast DDS.
//!
//! The demo is the node /lineshaft with x and y (linear), turret (rotary) and the virtual axis line.

use std::{thread, time::Duration};

use crate::support::{domain::Domain, peer::Peer, program::Program};
use lineshaft_msgs::action::MoveAxis;
use lineshaft_msgs::foreign::action_msgs::{msg::GoalStatusArray, srv::CancelGoal};
use lineshaft_msgs::foreign::sensor_msgs::msg::JointState;
use lineshaft_msgs::msg::AxisStates;
use lineshaft_msgs::srv::AxesCommand;
use lineshaft_msgs::{Action, GetResult, Message, SendGoal, Service};
use serde_json::{Value, json};

/// Much longer than the program needs to end.
const EXIT: Duration = Duration::from_secs(20);

/// A running demo and its clients.
struct Demo {
    cyclone: Peer,
    program: Program,
    domain: Domain,
}

impl Demo {
    /// Starts the demo, and returns when it publishes.
    fn start() -> Self {
        let domain = Domain::take();
        let mut cyclone = Peer::cyclone(&domain);
        let program = Program::start(&["run"], &domain);
        cyclone.run("axis-states /lineshaft");
        Self { cyclone, program, domain }
    }

    /// Starts the demo with x and turret enabled.
    fn enabled() -> Self {
        let mut demo = Self::start();
        demo.cyclone.run("axes /lineshaft enable x turret");
        for axis in ["x", "turret"] {
            let state = demo.axis(axis);
            assert_eq!(state["enabled"], true, "{axis}: {state}");
            assert_eq!(state["state"], "STANDSTILL", "{axis}: {state}");
        }
        demo
    }

    /// Returns the present state of an axis from axis_states.
    fn axis(&mut self, axis: &str) -> Value {
        self.cyclone.run("axis-states /lineshaft")["axes"][axis].clone()
    }
}

fn command(axis: &Value) -> i64 {
    axis["command_increments"].as_i64().expect("a whole number of increments")
}

#[test]
fn both_peers_see_joint_states_at_100_hz() {
    let Demo { cyclone, program: _program, domain } = Demo::start();
    let fastdds = Peer::fastdds(&domain);
    for mut peer in [cyclone, fastdds] {
        let seen = peer.run("joint-states --count 200 --seconds 20");
        assert_eq!(seen["last"]["name"], json!(["x", "y", "turret"]), "all axes but virtual ones, in file order");
        for field in ["position", "velocity"] {
            assert_eq!(seen["last"][field].as_array().map(Vec::len), Some(3), "{field}");
        }
        let rate = seen["rate"].as_f64().unwrap();
        assert!((50.0..=120.0).contains(&rate), "{rate} joint states per second");
    }
}

/// A subscription without history gets none: an old status or error would look like a new one.
#[test]
fn volatile_reader_of_a_latched_topic_gets_only_new_samples() {
    let mut demo = Demo::enabled();
    let status = "samples /lineshaft/move_axis/_action/status action_msgs::msg::dds_::GoalStatusArray_";
    let (mut latched, mut volatile) = (Peer::fastdds(&demo.domain), Peer::fastdds(&demo.domain));
    latched.run(&format!("{status} --latched 1"));
    demo.cyclone.run("move /lineshaft --axis x --units increments --position 2000 --wait");
    assert!(latched.run(status)["samples"].as_u64().unwrap() > 0, "the status was published");
    assert_eq!(volatile.run(status)["samples"], 0, "before it came");
    demo.cyclone.run("move /lineshaft --axis x --units increments --position 0 --wait");
    assert!(volatile.run(status)["samples"].as_u64().unwrap() > 0);
}

#[test]
fn the_graph_shows_the_node_and_only_endpoints_that_exist() {
    let mut demo = Demo::start();
    let seen = demo.cyclone.run("graph /lineshaft");
    let has = |kind: &str, topic: &str| seen[kind].as_array().unwrap().contains(&json!(topic));
    for topic in ["rt/joint_states", "rt/lineshaft/axis_states", "rt/lineshaft/events", "rr/lineshaft/enableReply"] {
        assert!(has("writes", topic), "{topic} in {seen:?}");
    }
    for topic in ["rq/lineshaft/enableRequest", "rq/lineshaft/move_axis/_action/send_goalRequest"] {
        assert!(has("reads", topic), "{topic} in {seen:?}");
    }
}

/// Like `ros2 topic info -v` of ROS 2 Jazzy, on a participant that starts after the node.
#[test]
fn a_new_participant_sees_the_type_hash_of_every_endpoint() {
    let demo = Demo::start();
    // A datagram may get lost; its endpoint is then announced without a hash.
    let seen = (0..5)
        .map(|_| Peer::cyclone(&demo.domain).run("type-hashes /lineshaft"))
        .find(|seen| seen["missing"] == json!([]))
        .expect("a participant that sees all hashes");
    for (endpoint, hash) in [
        ("writes rt/joint_states", JointState::HASH),
        ("writes rt/lineshaft/axis_states", AxisStates::HASH),
        ("reads rq/lineshaft/enableRequest", AxesCommand::REQUEST_HASH),
        ("writes rr/lineshaft/enableReply", AxesCommand::RESPONSE_HASH),
        ("reads rq/lineshaft/move_axis/_action/send_goalRequest", SendGoal::<MoveAxis>::REQUEST_HASH),
        ("writes rr/lineshaft/move_axis/_action/get_resultReply", GetResult::<MoveAxis>::RESPONSE_HASH),
        ("reads rq/lineshaft/move_axis/_action/cancel_goalRequest", CancelGoal::REQUEST_HASH),
        ("writes rt/lineshaft/move_axis/_action/feedback", MoveAxis::FEEDBACK_MESSAGE_HASH),
        ("writes rt/lineshaft/move_axis/_action/status", GoalStatusArray::HASH),
    ] {
        assert_eq!(seen["hashes"][endpoint], format!("typehash={hash};"), "{endpoint}");
    }
}

#[test]
fn an_axis_is_enabled_and_disabled_by_both_peers() {
    let mut demo = Demo::start();
    let mut fastdds = Peer::fastdds(&demo.domain);
    assert_eq!(demo.axis("x")["state"], "DISABLED");
    assert_eq!(demo.axis("line")["enabled"], true, "a virtual axis is always enabled");

    fastdds.run("axes /lineshaft enable x");
    assert_eq!(demo.axis("x")["state"], "STANDSTILL");
    assert_eq!(demo.axis("turret")["state"], "DISABLED");
    demo.cyclone.run("axes /lineshaft disable x");
    assert_eq!(demo.axis("x")["state"], "DISABLED");

    for error in [
        demo.cyclone.fails("axes /lineshaft enable x no_such_axis"),
        fastdds.fails("axes /lineshaft enable x no_such_axis"),
    ] {
        assert!(error.contains("no_such_axis"), "{error}");
    }
    assert_eq!(demo.axis("x")["state"], "DISABLED", "a refused request changes nothing");
}

#[test]
fn a_disabled_axis_does_not_move() {
    let mut demo = Demo::start();
    let before = command(&demo.axis("x"));
    let seen = demo
        .cyclone
        .run("move /lineshaft --axis x --mode relative --units increments --position 1000 --wait --expect ABORTED");
    assert_ne!(seen["result"]["message"], "");
    assert_eq!(command(&demo.axis("x")), before);
}

#[test]
fn moves_end_on_the_exact_increment() {
    let mut demo = Demo::enabled();
    let mut fastdds = Peer::fastdds(&demo.domain);
    for (through_fastdds, target) in [(false, 12_345_679), (true, -1_234_567)] {
        let peer = if through_fastdds { &mut fastdds } else { &mut demo.cyclone };
        let seen = peer.run(&format!("move /lineshaft --axis x --units increments --position {target} --wait"));
        assert_eq!(seen["status"], "SUCCEEDED");
        assert_eq!(seen["result"]["code"], 0);
        assert!(seen["feedback"]["count"].as_u64().unwrap() > 1, "{seen:?}");
        assert_eq!(command(&demo.axis("x")), target);
    }
}

#[test]
fn a_canceled_move_halts() {
    let mut demo = Demo::enabled();
    let mut fastdds = Peer::fastdds(&demo.domain);
    for (through_fastdds, end) in [(false, 400_000_000.0), (true, -400_000_000.0)] {
        let before = command(&demo.axis("turret"));
        let peer = if through_fastdds { &mut fastdds } else { &mut demo.cyclone };
        let seen = peer.run(&format!(
            "move /lineshaft --axis turret --mode relative --units increments --position {end} --cancel-after 0.5"
        ));
        assert_eq!(seen["status"], "CANCELED");
        let halted = demo.axis("turret");
        assert_eq!(halted["state"], "STANDSTILL");
        assert_eq!(halted["command_velocity"], 0.0);
        assert_ne!(command(&halted), before, "it was on its way");
        assert_eq!(command(&demo.axis("turret")), command(&halted), "and stays where it has stopped");
    }
}

#[test]
fn a_synchronized_axis_follows_the_line_exactly() {
    let mut demo = Demo::enabled();
    let seen = demo
        .cyclone
        .run("synchronize /lineshaft --axis x --master line --mode position --numerator 355 --denominator 113");
    let goal = seen["goal"].as_str().unwrap().to_owned();
    assert_eq!(demo.axis("x")["state"], "SYNCHRONIZED_MOTION");
    let (x, line) = (command(&demo.axis("x")), command(&demo.axis("line")));

    for distance in [300_001, -200_003] {
        demo.cyclone.run("axis-states /lineshaft --all");
        demo.cyclone.run(&format!(
            "move /lineshaft --axis line --mode relative --units increments --position {distance} --wait"
        ));
        let seen = demo.cyclone.run("axis-states /lineshaft --all");
        assert!(seen.all().len() > 10, "{} samples of the motion", seen.all().len());
        for sample in seen.all() {
            let (slave, master) = (command(&sample["axes"]["x"]) - x, command(&sample["axes"]["line"]) - line);
            // The command of the line axis has a fraction, which the gear uses: it is between this increment and the
            // next one.
            let geared = |master: i64| (355 * master).div_euclid(113);
            let between = geared(master)..=geared(master + 1);
            assert!(between.contains(&slave), "cycle {}: line at {master}, slave at {slave}", sample["cycle"]);
        }
        let (slave, master) = (command(&demo.axis("x")) - x, command(&demo.axis("line")) - line);
        assert_eq!(slave, (355 * master).div_euclid(113), "at rest the line stands on whole increments");
    }
    assert_eq!(command(&demo.axis("line")) - line, 300_001 - 200_003);

    demo.cyclone.run(&format!("cancel /lineshaft synchronize {goal}"));
    demo.cyclone.run(&format!("result /lineshaft synchronize {goal} --expect CANCELED"));
    let uncoupled = command(&demo.axis("x"));
    demo.cyclone.run("move /lineshaft --axis line --mode relative --units increments --position 10000 --wait");
    assert_eq!(command(&demo.axis("x")), uncoupled, "the line no longer drives it");
}

#[test]
fn move_axis_behaves_as_ros_actions_do() {
    Demo::enabled().cyclone.run("action-conformance /lineshaft --axis x");
}

#[test]
fn move_axis_behaves_so_for_rmw_fastrtps_too() {
    let demo = Demo::enabled();
    Peer::fastdds(&demo.domain).run("action-conformance /lineshaft --axis x");
}

#[test]
fn bad_requests_move_nothing() {
    let mut demo = Demo::start();
    let mut fastdds = Peer::fastdds(&demo.domain);
    demo.cyclone.run("axes /lineshaft enable x"); // so that x could move; turret stays disabled
    let before = demo.axis("x");
    demo.cyclone.run("bad-requests /lineshaft --axis x --other turret");
    fastdds.run("bad-requests /lineshaft --axis x");
    let after = demo.axis("x");
    for field in ["command_increments", "state", "enabled"] {
        assert_eq!(after[field], before[field], "{field}");
    }
    for mut peer in [demo.cyclone, fastdds] {
        peer.run("move /lineshaft --axis x --mode relative --units increments --position 1000 --wait");
    }
}

#[test]
fn every_new_client_gets_its_first_reply() {
    Demo::start().cyclone.run("first-replies /lineshaft --clients 20");
}

#[test]
fn ctrl_c_ends_the_program_in_good_order() {
    let mut demo = Demo::enabled();
    demo.cyclone.run("move /lineshaft --axis turret --mode relative --units increments --position 400000000");
    demo.program.interrupt();
    let status = demo.program.wait_exit(EXIT);
    assert_eq!(status.code(), Some(0), "{}", demo.program.log());
}

/// `systemctl stop` and `podman stop` rely on it (packaging/lineshaft@.service, Containerfile).
#[test]
fn sigterm_stops_all_axes_before_the_program_ends() {
    let mut demo = Demo::enabled();
    demo.cyclone.run("move /lineshaft --axis turret --mode relative --units increments --position 400000000");
    demo.program.terminate();
    let status = demo.program.wait_exit(EXIT);
    assert_eq!(status.code(), Some(0), "{}", demo.program.log());
    demo.program.wait_for_log("halting all axes");
    assert!(!demo.program.log().contains("not all axes"), "{}", demo.program.log());
}

#[test]
fn a_second_ctrl_c_ends_it_at_once() {
    let mut demo = Demo::start();
    demo.program.interrupt();
    thread::sleep(Duration::from_millis(20));
    demo.program.interrupt();
    demo.program.wait_exit(Duration::from_secs(5));
}
