//! Tests the machine, its clients and its goals while the ROS side is frozen, killed or attacked.

use std::{
    path::PathBuf,
    process::Command,
    thread,
    time::{Duration, Instant},
};

use crate::support::{domain::Domain, namespace, peer::Peer, program::Program, setup};
use rustix::process::{Signal, kill_process};
use serde_json::Value;

/// A client gets an answer again within this time.
const AGAIN: &str = "answered /lineshaft --seconds 20";

fn seconds(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds)
}

/// Returns the demo cell with additional keys in `ros`.
fn cell(folder: &tempfile::TempDir, ros: &str) -> String {
    let demo = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml");
    let demo = std::fs::read_to_string(demo).expect("the demo cell");
    let changed = demo.replace("  joint_states_rate: 100 ", &format!("  {ros}\n  joint_states_rate: 100 "));
    assert_ne!(demo, changed);
    let path = folder.path().join("cell.yaml");
    std::fs::write(&path, changed).expect("a folder of this test");
    path.to_str().expect("a name of this test").to_owned()
}

#[track_caller]
fn wait_for(program: &Program, line: &str, limit: Duration) -> Duration {
    let begun = Instant::now();
    while !program.log().contains(line) {
        assert!(begun.elapsed() < limit, "no `{line}` within {limit:?}: {}", program.log());
        thread::sleep(seconds(0.005));
    }
    begun.elapsed()
}

fn axis(peer: &mut Peer, name: &str) -> Value {
    peer.run("axis-states /lineshaft").all().last().expect("a sample")["axes"][name].clone()
}

/// Starts a node whose turret turns at 0.5 rad/s, and a client.
fn start_turning(domain: &Domain) -> (Program, Peer) {
    let program = Program::start(&["run"], domain);
    let mut peer = Peer::cyclone(domain);
    peer.run("axes /lineshaft enable turret");
    peer.run("move /lineshaft --axis turret --mode velocity --velocity 0.5");
    peer.until_axis("turret", "at its velocity", |turret| turret["command_velocity"] == 0.5);
    (program, peer)
}

/// An axis runs at a velocity, and its ROS side stops: no client could halt the axis.
#[test]
fn axes_halt_when_the_ros_side_is_frozen_and_another_one_answers() {
    let domain = Domain::take();
    let (program, mut peer) = start_turning(&domain);
    let side = program.ros_side();
    kill_process(side, Signal::STOP).expect("a child of the program");
    let told = wait_for(&program, "all axes halt", seconds(5.0));
    println!("told after {told:?}");
    peer.run(AGAIN);
    program.ros_side_after(side);
    let mut late = Peer::cyclone(&domain);
    let turret = axis(&mut late, "turret");
    assert_eq!((&turret["state"], &turret["command_velocity"]), (&"STANDSTILL".into(), &0.0.into()), "{turret}");
    late.run("move /lineshaft --axis turret --mode relative --units increments --position 5000 --wait");
    Peer::fastdds(&domain).run("axes /lineshaft disable turret");
}

/// `on_loss: none`: the goal continues, and the client that has sent it gets its result from the next participant.
#[test]
fn goals_continue_without_the_ros_side_if_the_cell_allows_it() {
    let (domain, folder) = (Domain::take(), tempfile::tempdir().expect("a folder"));
    let program = Program::start(&["run", &cell(&folder, "on_loss: none")], &domain);
    let (mut peer, mut watcher) = (Peer::cyclone(&domain), Peer::cyclone(&domain));
    peer.run("axes /lineshaft enable turret");
    watcher.run("axis-states /lineshaft");
    let target = 9_000;
    peer.tell(&format!("move /lineshaft --axis turret --units increments --position {target} --velocity 3000 --wait"));
    watcher.until_axis("turret", "on its way", |turret| turret["command_increments"].as_i64() > Some(target / 3));
    kill_process(program.ros_side(), Signal::KILL).expect("a child of the program");
    let (seen, error) = peer.answer();
    assert_eq!(error, None, "{seen:?}; {}", program.log());
    let mut late = Peer::cyclone(&domain);
    assert_eq!(axis(&mut late, "turret")["command_increments"], target);
    program.wait_for_log("the axes go on (on_loss: none)");
}

/// Ctrl-Z and fg, strace, a debugger: ROS continues, and requests from the time of the freeze are not executed
/// afterwards.
#[test]
fn requests_during_a_freeze_are_not_executed() {
    let domain = Domain::take();
    let program = Program::start(&["run"], &domain);
    let mut peer = Peer::cyclone(&domain);
    peer.run("axes /lineshaft disable x");
    peer.run("axes /lineshaft enable y");
    for pause in [0.001, 0.1, 1.0] {
        program.freeze();
        thread::sleep(seconds(pause));
        program.thaw();
        peer.run("axes /lineshaft reset_errors x");
    }
    program.freeze();
    peer.tell("axes /lineshaft enable x");
    thread::sleep(seconds(2.5));
    program.thaw();
    let (_, error) = peer.answer();
    let error = error.expect("it is refused");
    assert!(error.contains("request_timeout of the cell is 2 s"), "{error}");
    assert_eq!(axis(&mut peer, "x")["state"], "DISABLED");
    // A request to stop never expires.
    program.freeze();
    peer.tell("axes /lineshaft disable y");
    thread::sleep(seconds(2.5));
    program.thaw();
    assert_eq!(peer.answer().1, None);
    assert_eq!(axis(&mut peer, "y")["state"], "DISABLED");
    // On a busy machine a late answer may be reported; the ROS side is not treated as lost for that reason.
    assert!(!program.log().contains("all axes halt"), "it was lost for nothing: {}", program.log());
}

/// A node that is frozen for longer than any timeout of its ROS side, 5 times `loss_timeout`, has not lost that
/// process when it continues.
#[test]
#[ignore = "long: .ci/nightly runs it"]
fn a_program_that_was_frozen_for_long_has_not_lost_its_ros_side() {
    let domain = Domain::take();
    let (program, _peer) = start_turning(&domain);
    program.freeze();
    thread::sleep(seconds(13.0));
    program.thaw();
    Peer::cyclone(&domain).run("axes /lineshaft reset_errors x");
    let turret = axis(&mut Peer::cyclone(&domain), "turret");
    assert_eq!(turret["state"], "CONTINUOUS_MOTION", "{}", program.log());
    assert!(!program.log().contains("ROS side"), "it was lost for nothing: {}", program.log());
}

/// Both processes are killed, so no process announces the end of the participant: the next node announces it.
#[test]
fn request_to_killed_node_is_not_executed_by_its_successor() {
    let (domain, home) = (Domain::take(), tempfile::tempdir().expect("a folder"));
    let start = || {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.args(["run", "--store", "none"]).env("ROS_HOME", home.path());
        Program::start_by(command, &domain)
    };
    let mut peer = Peer::cyclone(&domain);
    for _ in 0..2 {
        let program = start();
        peer.run("answered /lineshaft --seconds 10");
        peer.run("axes /lineshaft enable x");
        peer.run("move /lineshaft --axis x --units increments --position 1000 --wait");
        program.kill_both();
    }
    let program = start();
    peer.run("answered /lineshaft --seconds 10");
    thread::sleep(seconds(1.0));
    let x = axis(&mut peer, "x");
    assert_eq!((&x["state"], &x["command_increments"]), (&"DISABLED".into(), &0.into()), "{}", program.log());
}

/// In an earlier version one datagram could fill the memory of the process, or block its thread forever.
#[test]
fn forged_datagrams_cost_the_ros_side_and_not_the_machine() {
    let domain = Domain::take();
    let program = Program::start(&["run"], &domain);
    for kind in ["heartbeat", "gap", "fragment"] {
        // After its samples were declared irrelevant, the node receives nothing more from that client.
        let mut peer = Peer::cyclone(&domain);
        peer.run(AGAIN);
        let begun = Instant::now();
        peer.run(&format!("forge /lineshaft --kind {kind}"));
        thread::sleep(seconds(0.2));
        Peer::cyclone(&domain).run(AGAIN);
        let memory = program.figures().memory;
        println!("{kind}: answered after {:?}, {memory:.0} MiB", begun.elapsed());
        assert!(memory < 1300.0, "{memory} MiB after {kind}");
    }
    let lines = program.log().lines().count();
    assert!(lines < 60, "{lines} lines of log: {}", program.log());
}

/// The DDS library waits for the acknowledgement of every reader, and best-effort readers never acknowledge: with one
/// of them and a reliable one it kept all samples.
#[test]
fn a_best_effort_reader_next_to_a_reliable_one_keeps_no_sample() {
    let (domain, folder) = (Domain::take(), tempfile::tempdir().expect("a folder"));
    let demo = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml");
    let fast = std::fs::read_to_string(demo)
        .expect("the demo cell")
        .replace("joint_states_rate: 100 ", "joint_states_rate: 1000 ");
    let cell = folder.path().join("cell.yaml");
    std::fs::write(&cell, fast).expect("a folder of this test");
    let program = Program::start(&["run", cell.to_str().expect("a name of this test")], &domain);
    let (mut best_effort, mut reliable) = (Peer::cyclone(&domain), Peer::cyclone(&domain));
    best_effort.run("stamps --system --best-effort");
    reliable.run("joint-states --seconds 4");
    let before = program.memory_of_ros_side();
    let seen = reliable.run("joint-states --seconds 12");
    let grown = program.memory_of_ros_side() - before;
    let received = seen["received"].as_u64().expect("a number");
    println!("{received} samples, {grown:.1} MiB more");
    // A third of the published samples: a busy machine omits some.
    assert!(received > 4000, "{seen:?}");
    // A kept sample took 0.6 kB.
    assert!(grown < received as f64 * 2e-4, "{grown} MiB for {received} samples");
}

/// The DDS library keeps some memory for all data that it receives: a ROS side that has grown is replaced by another
/// one, while clients of both implementations send requests, join and leave.
#[test]
fn a_ros_side_that_has_grown_hands_over_unnoticed() {
    let domain = Domain::take();
    let (program, mut peer) = start_turning(&domain);
    let (side, fresh) = (program.ros_side(), program.figures().memory);
    let mut clients = [(Peer::cyclone(&domain), "x"), (Peer::fastdds(&domain), "y")];
    for (client, axis) in &mut clients {
        client.tell(&format!("hammer /lineshaft --axis {axis} --seconds 20 --rate 300"));
    }
    let mut visitors = Peer::fastdds(&domain);
    visitors.tell("visits /lineshaft --count 100");
    // Each adds 1 MB. The limit is 256 MiB, checked every 10 s.
    for _ in 0..1000 {
        peer.fails("import /lineshaft nothing --pad 1000000");
        if program.log().contains("MiB, and hands over to a new one") {
            break;
        }
    }
    wait_for(&program, "the new ROS side is in charge", seconds(30.0));
    for (client, axis) in &mut clients {
        let (seen, error) = client.answer();
        assert_eq!(error, None, "{axis}: {seen:?}; {}", program.log());
    }
    assert_eq!(visitors.answer().1, None, "{}", program.log());
    program.ros_side_after(side);
    assert_eq!(axis(&mut peer, "turret")["state"], "CONTINUOUS_MOTION", "{}", program.log());
    let small = program.figures().memory;
    println!("{fresh:.0} MiB before, {small:.0} MiB after");
    assert!(small < fresh + 150.0, "{fresh} MiB before, {small} MiB after");
    for line in ["axes halt", "has a node /lineshaft", "the new ROS side has", "does not keep up"] {
        assert!(!program.log().contains(line), "{line}: {}", program.log());
    }
}

/// Clients of both implementations join and leave for 12 s, read latched topics and call the node, while others stay.
/// The loopback interface shows nothing that either implementation rejects (tests/peers/rtps_check.py); if a reader of
/// Fast DDS hangs, the visits fail.
#[test]
fn other_dds_implementations_accept_node_traffic() {
    if !namespace::is_inside(
        "ros_side::other_dds_implementations_accept_node_traffic",
        &[setup::python, setup::fastdds_peer],
    ) {
        return;
    }
    // As on Ethernet: the description of the node in the graph is longer than a datagram, and is sent in fragments.
    let status = Command::new("ip").args(["link", "set", "lo", "mtu", "1500"]).status();
    assert!(status.expect("ip was there for the namespace").success());
    let domain = Domain::take();
    let program = Program::start(&["run"], &domain);
    let mut lasting = Peer::cyclone(&domain);
    lasting.run("listen /lineshaft");
    let mut sniffer = Peer::cyclone(&domain);
    let mut visitors = Peer::fastdds(&domain);
    sniffer.run("rtps-watch");
    visitors.tell("visits /lineshaft --count 25");
    let mut fresh = Peer::cyclone(&domain);
    let begun = Instant::now();
    let mut other_visitors = Peer::fastdds(&domain);
    while begun.elapsed() < seconds(12.0) {
        fresh.run("first-replies /lineshaft --clients 3");
        other_visitors.run("newcomer /lineshaft");
        // A latched value that changes while clients join: the status of goals.
        lasting.run("axes /lineshaft enable turret");
        lasting.run("move /lineshaft --axis turret --mode relative --units increments --position 10 --wait");
    }
    assert_eq!(visitors.answer().1, None, "{}", program.log());
    let seen = sniffer.run("rtps-check");
    assert!(seen["fragmented"].as_u64() >= Some(25) && seen["others"].as_u64() > Some(30), "{seen:?}");
    assert!(seen["with_hash"].as_u64() > Some(100), "the endpoints are announced with their type hashes: {seen:?}");
}

/// Returns the logs of two nodes with the same name, whose endpoints are created and deleted for a while; `None` if a
/// ROS side was restarted: the new process is another participant, for which the duplicate name is reported again.
fn logs_of_namesakes(told: &str) -> Option<[String; 2]> {
    let domain = Domain::take();
    let programs = [Program::start(&["run"], &domain), Program::start(&["run"], &domain)];
    for program in &programs {
        wait_for(program, told, seconds(20.0));
    }
    // New and deleted endpoints announce the node again.
    let mut peer = Peer::cyclone(&domain);
    peer.run("answered /lineshaft --seconds 20");
    let logs = programs.map(|mut program| {
        program.interrupt();
        program.wait_exit(seconds(20.0));
        program.log()
    });
    logs.iter().all(|log| !log.contains("it is started again")).then_some(logs)
}

/// Clients reach either of two nodes of one name: each node reports this once.
#[test]
fn duplicate_node_name_is_reported_once_by_each_node() {
    let told = "has a node /lineshaft, too";
    // On a very busy machine a ROS side may be restarted.
    let logs = (0..3).find_map(|_| logs_of_namesakes(told)).expect("three runs, and in each a ROS side began anew");
    for log in logs {
        assert_eq!(log.matches(told).count(), 1, "once each: {log}");
    }
}
