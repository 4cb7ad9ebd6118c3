//! Tests MoveIt, MoveIt Servo and rqt_joint_trajectory_controller as clients of the arm of launch-configs/arm6: no goal
//! and no message has an unexpected result.
//!
//! A peer on Eclipse Cyclone DDS imitates the clients and sends the same messages as their source code of ROS 2 Jazzy:
//! tests/peers/users.py. The peer stops at the first failed check, so most tests only run its commands.

use std::fs;
use std::path::Path;

use crate::support::{domain::Domain, machine::alone, peer::Peer, program::Program};

/// Runs these commands of the peer one after the other, with the arm enabled.
///
/// The test runs alone: MoveIt has a time limit for each goal, and messages of MoveIt Servo expire 0.1 s after their
/// creation.
#[track_caller]
fn run(commands: &[&str]) {
    let _alone = alone();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/arm6");
    let folder = tempfile::tempdir().expect("a folder");
    let read = |name: &str| fs::read_to_string(source.join(name)).expect("a file of the arm");
    let (before, after) = ("\nros:\n", "\nros:\n  controller_manager: /lineshaft/controller_manager\n");
    let cell = read("arm6.yaml").replacen(before, after, 1);
    fs::write(folder.path().join("arm6.urdf"), read("arm6.urdf")).expect("a written file");
    let path = folder.path().join("arm6.yaml");
    fs::write(&path, cell).expect("a written file");

    let domain = Domain::take();
    let mut peer = Peer::cyclone(&domain);
    let _program = Program::start(&["run", path.to_str().expect("a path of text")], &domain);
    peer.run("axis-states /lineshaft");
    peer.run("axes /lineshaft enable");
    for command in commands {
        // Lateness, final error, and similar figures.
        println!("{command}: {:?}", peer.run(command));
    }
}

/// The controller is active, each goal ends within 1.2 times its duration and 0.5 s, and the arm is within 0.01 rad of
/// its target.
#[test]
fn moveit_plans_succeed_in_time_and_end_at_their_targets() {
    run(&["as-moveit /lineshaft --goals 5"]);
}

#[test]
fn moveit_servo_messages_are_followed_without_a_refusal() {
    run(&["as-servo /lineshaft --goals 10"]);
}

/// The user turns the spin box, whose values have six decimals.
#[test]
fn rqt_joint_trajectory_controller_messages_are_followed_without_a_refusal() {
    run(&["as-rqt /lineshaft --spin-box --goals 5"]);
}

#[test]
#[ignore = "long: .ci/nightly runs it"]
fn hundred_moveit_plans_succeed_in_time_and_end_at_their_targets() {
    run(&["as-moveit /lineshaft --goals 100"]);
}

#[test]
#[ignore = "long: .ci/nightly runs it"]
fn hundred_moveit_servo_messages_are_followed_without_a_refusal() {
    run(&["as-servo /lineshaft --goals 100", "as-servo /lineshaft --goals 100 --single-point"]);
}

/// The user moves the slider of joint1 to its upper limit and back, then the spin box, whose six decimals exceed that
/// limit.
#[test]
#[ignore = "long: .ci/nightly runs it"]
fn hundred_rqt_joint_trajectory_controller_messages_are_followed_without_a_refusal() {
    run(&["as-rqt /lineshaft --goals 100", "as-rqt /lineshaft --goals 100 --spin-box"]);
}
