//! Tests that a client does not disturb other clients of the node: high load, a frozen process, late and short
//! participants, invalid data.
//!
//! `LINESHAFT_LONG=1` loads the node for a minute, freezes a subscriber for 30 s and starts 200 short clients.
//! docs/node.md contains the figures that the tests print (`--nocapture`).

use std::{
    env, fs,
    path::Path,
    process::Command,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use crate::support::{
    domain::Domain,
    machine::alone,
    peer::{Observations, Peer},
    program::Program,
};
use rustix::{
    fs::{CWD, Mode, mkfifoat},
    io::ioctl_fionread,
};
use serde_json::Value;

const EXIT: Duration = Duration::from_secs(20);
const NODE: &str = "/lineshaft";

fn is_long() -> bool {
    env::var("LINESHAFT_LONG").is_ok_and(|value| value == "1")
}

/// Returns the usual length, or the long one with `LINESHAFT_LONG=1`.
fn length(usual: u64, long: u64) -> u64 {
    if is_long() { long } else { usual }
}

fn seconds(length: u64) -> Duration {
    Duration::from_secs(length)
}

/// Ends the program as a user does; returns the line with its timing statistics, and the complete log.
fn ended(mut program: Program) -> (String, String) {
    program.interrupt();
    let status = program.wait_exit(EXIT);
    let log = program.log();
    assert_eq!(status.code(), Some(0), "{log}");
    let line = log.lines().find_map(|line| line.split_once("INFO").map(|(_, said)| said.trim().to_owned()));
    let times = log.lines().find(|line| line.contains(" missed; lateness ")).map(str::to_owned).or(line);
    (times.expect("a line about the cycles"), log)
}

#[track_caller]
fn finished(peer: &mut Peer, what: &str) -> Value {
    let (seen, error) = peer.answer();
    if let Some(error) = error {
        panic!("{what}: {error}; observed: {seen:?}");
    }
    seen.all().last().expect("what was observed").clone()
}

/// Starts the program in a new domain; `watchers` peers are started before it.
fn start(args: &[&str], watchers: usize) -> (Program, Vec<Peer>, Domain) {
    let domain = Domain::take();
    let mut peers: Vec<Peer> = (0..watchers).map(|_| Peer::cyclone(&domain)).collect();
    let program = Program::start(args, &domain);
    for peer in &mut peers {
        peer.run(&format!("watch {NODE} --seconds 0.5"));
    }
    (program, peers, domain)
}

/// Two clients of each RMW call all services and send goals at the same time, each for its own axis.
#[test]
fn no_request_under_load_is_lost_or_duplicated() {
    let _alone = alone();
    let time = length(10, 60);
    let (program, _idle_watchers, _domain) = start(&["run"], 1);
    thread::sleep(seconds(time));
    let (idle, _) = ended(program);

    let (program, mut watchers, domain) = start(&["run"], 1);
    let mut clients = [
        (Peer::cyclone(&domain), "x"),
        (Peer::cyclone(&domain), "y"),
        (Peer::fastdds(&domain), "turret"),
        (Peer::fastdds(&domain), "line"),
    ];
    let before = program.figures();
    watchers[0].tell(&format!("watch {NODE} --seconds {}", time + 3));
    for (seed, (client, axis)) in clients.iter_mut().enumerate() {
        client.tell(&format!("hammer {NODE} --axis {axis} --seconds {time} --seed {seed}"));
    }
    let seen: Vec<Value> = clients.iter_mut().map(|(client, axis)| finished(client, axis)).collect();
    let watched = finished(&mut watchers[0], "a subscriber meanwhile");
    let after = program.figures();
    let (busy, log) = ended(program);
    assert!(!log.contains("does not keep up"), "{log}");

    for ((_, axis), seen) in clients.iter().zip(&seen) {
        let answered = seen["answered"].as_u64().expect("a number");
        println!("hammer on {axis}: {answered} requests answered in {time} s: {}", seen["each"]);
        assert!(answered > 50 * time, "{axis}: {seen}");
    }
    println!("events meanwhile: {}", watched["events"]);
    println!("memory: {:.1} MiB before, {:.1} MiB after", before.memory, after.memory);
    println!("work: {:.2} s of {time} s", after.worked - before.worked);
    println!("idle for {time} s: {idle}");
    println!("hammered for {time} s: {busy}");
    let answered: u64 = seen.iter().filter_map(|seen| seen["answered"].as_u64()).sum();
    let grown = after.memory - before.memory;
    assert!(grown < 200.0, "{grown} MiB for {answered} requests");
}

/// One client writes 200 requests to a service before it reads any answer, all for one axis: each is executed, and of
/// 200 goals the last one remains in force.
#[test]
fn two_hundred_requests_at_once_are_all_done() {
    let _alone = alone();
    let (program, _, domain) = start(&["run"], 0);
    let mut peer = Peer::cyclone(&domain);
    let seen = peer.run(&format!("burst {NODE} --count 200 --axis x"));
    println!("200 requests at once: {seen:?}");
    let (_, log) = ended(program);
    assert!(!log.contains("does not keep up") && !log.contains("too many"), "{log}");
}

/// A process may have two clients of one service, which rmw_cyclonedds distinguishes by an identifier: an answer to
/// both of them is received twice.
#[test]
fn answers_reach_only_the_requesting_client() {
    let _alone = alone();
    let (program, _, domain) = start(&["run"], 0);
    Peer::cyclone(&domain).run(&format!("twins {NODE} --axis x"));
    Peer::cyclone(&domain).run(&format!("twins {NODE} --axis x --apart"));
    drop(program);
}

/// Answered requests are not stored: the memory of a node that runs for months must not grow with the number of
/// requests.
#[test]
fn requests_are_not_kept() {
    let _alone = alone();
    let (program, _, domain) = start(&["run"], 0);
    let mut peer = Peer::cyclone(&domain);
    peer.run(&format!("many-requests {NODE} --count 300"));
    let before = program.figures().memory;
    peer.run(&format!("many-requests {NODE} --count 2000"));
    let after = program.figures().memory;
    println!("2000 requests of 50 kB: {before:.1} MiB before, {after:.1} MiB after");
    // The requests have 100 MB.
    assert!(after - before < 40.0, "{before} MiB before, {after} MiB after");
}

/// An earlier version sampled only the newest signals in a timer of ROS, which omitted samples when its thread was
/// delayed.
#[test]
fn each_cycle_of_the_rate_is_published_on_a_busy_machine() {
    let _alone = alone();
    let (program, mut watchers, _domain) = start(&["run"], 1);
    let is_over = AtomicBool::new(false);
    let seen = thread::scope(|scope| {
        for _ in 0..6 {
            scope.spawn(|| {
                while !is_over.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let seen = watchers[0].run(&format!("watch {NODE} --seconds 10"));
        is_over.store(true, Ordering::Relaxed);
        seen
    });
    let (_, log) = ended(program);
    assert!(!log.contains("left out"), "{log}");
    let runs = seen["cycles"].as_array().expect("runs of cycles");
    assert!(runs.len() == 1 && runs[0][1] == 10, "{runs:?}");
}

/// Returns the built-in cell with states at 1 kHz.
fn fast_cell(folder: &Path) -> String {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/demo.yaml");
    let cell = fs::read_to_string(demo).expect("the built-in cell");
    let fast = cell.replace("axis_states_rate: 100", "axis_states_rate: 1000");
    assert_ne!(cell, fast);
    let path = folder.join("fast.yaml");
    fs::write(&path, fast).expect("a folder of this test");
    path.to_str().expect("a name of this test").to_owned()
}

/// The end of the old participant of a resumed process may be reported together with its new participant, which the
/// node then announces again.
fn works_again(sleeper: &mut Peer) {
    let join = format!("join {NODE} --count 1 --axis y");
    let errors: Vec<_> = (0..3)
        .map_while(|_| {
            sleeper.tell(&join);
            sleeper.answer().1
        })
        .collect();
    assert!(errors.len() < 3, "{errors:?}");
}

/// A subscriber is frozen for longer than its DDS lease, another one joins after more samples than a writer of the DDS
/// library keeps by default, and others join and leave.
#[test]
fn no_client_loses_samples_because_of_another() {
    let _alone = alone();
    let folder = tempfile::tempdir().expect("a folder");
    let (frozen, visits) = (length(15, 30), length(40, 200));
    let (program, mut watchers, domain) = start(&["run", &fast_cell(folder.path())], 2);
    let mut sleeper = Peer::cyclone(&domain);
    sleeper.run(&format!("listen {NODE}"));
    let mut asker = Peer::cyclone(&domain);
    asker.run(&format!("axes {NODE} enable x"));

    let begun = Instant::now();
    let (before, time) = (program.figures(), frozen + 8 + visits / 4);
    for watcher in &mut watchers {
        watcher.tell(&format!("watch {NODE} --seconds {time}"));
    }
    sleeper.freeze();
    let mut most = before.memory;
    let mut asked = 0;
    while begun.elapsed() < seconds(frozen) {
        asker.run(&format!("axes {NODE} disable x"));
        asker.run(&format!("axes {NODE} enable x"));
        asked += 2;
        most = most.max(program.figures().memory);
    }
    sleeper.thaw();
    // An endpoint created earlier may not discover the node for a long time (docs/known-limits.md).
    await_lines(&program, BACK, 1, Duration::from_secs(30));
    works_again(&mut sleeper);
    let thawed = program.figures();

    // By now the writer has written more than 10,000 samples.
    let mut late = Peer::cyclone(&domain);
    let joined = late.run(&format!("watch {NODE} --seconds 1"));
    assert!(joined["states"].as_u64().expect("a number") > 300, "{joined:?}");
    let visited = late.run(&format!("join {NODE} --count {visits} --axis y"));
    let after = program.figures();

    let seen: Vec<Value> = watchers.iter_mut().map(|watcher| finished(watcher, "a watcher")).collect();
    let (times, log) = ended(program);
    assert!(!log.contains("does not keep up"), "{log}");
    assert!(!log.contains("so far)"), "{log}");
    // Only for the frozen client.
    assert_eq!(log.matches("it counts as gone").count(), 1, "{log}");
    let last = joined["last"].as_u64().expect("a cycle");
    assert!(last > 10_000, "the late subscriber came in cycle {last}");
    same_stream(&seen[0], &seen[1]);
    for seen in &seen {
        assert!(seen["last"].as_u64() >= joined["last"].as_u64(), "it was there all the time: {seen}");
        assert!(seen["events"].as_u64().expect("a number") >= 2 * asked, "accepted and done of each: {seen}");
    }
    println!("states watched: {}, longest pause {} s", seen[0]["states"], seen[0]["longest_pause_s"]);
    println!("{asked} requests while a subscriber was frozen for {frozen} s, events {}", seen[0]["events"]);
    let worst = |name: &str| visited[name].as_array().and_then(|all| all.last()).cloned().expect("some visits");
    println!("{visits} visits: first sample after at most {} s", worst("first_sample_s"));
    println!("{visits} visits: first answer after at most {} s", worst("first_answer_s"));
    let (before, thawed, after) = (before.memory, thawed.memory, after.memory);
    println!("memory: {before:.1} MiB before, at most {most:.1} while frozen, {thawed:.1} then, {after:.1} at the end");
    println!("{times}");
    // 1000 samples of 800 bytes a second, and the same number of all other samples, until the lease of the frozen
    // client expires.
    assert!(most - before < 100.0 && after - before < 100.0, "MiB: {before}, {most}, {thawed}, {after}");
}

/// Two clients are stopped until their leases expire, one of them twice: after that, their existing endpoints work
/// again.
#[test]
fn clients_that_were_frozen_beyond_their_lease_work_again() {
    let (program, _, domain) = start(&["run"], 0);
    let mut clients = [Peer::cyclone as fn(&_) -> _, Peer::fastdds].map(|begin| {
        let mut client = begin(&domain);
        client.run(&format!("axes {NODE} enable turret"));
        client.run("joint-states --count 20 --seconds 10");
        step(&mut client);
        client
    });
    // A request that is not answered before the client is frozen.
    clients[0].tell(&format!("axes {NODE} reset_errors turret"));
    for (round, frozen) in [(1, 2), (2, 1)] {
        let before = [program.log().matches(GONE).count(), program.log().matches(BACK).count()];
        let frozen = &mut clients[..frozen];
        frozen.iter().for_each(|client| client.freeze());
        await_lines(&program, GONE, before[0] + frozen.len(), Duration::from_secs(60));
        frozen.iter().for_each(|client| client.thaw());
        let thawed = Instant::now();
        await_lines(&program, BACK, before[1] + frozen.len(), Duration::from_secs(30));
        println!("round {round}: back after {:?}", thawed.elapsed());
        if round == 1 {
            // Whether it was answered has no influence on the rest of the test.
            drop(frozen[0].answer());
        }
        for client in frozen.iter_mut() {
            let moved = step(client);
            println!("round {round}: {moved:?} after {:?}", thawed.elapsed());
            // Samples from before the freeze are read first.
            client.run("joint-states --seconds 1");
            client.run("joint-states --count 100 --seconds 10");
        }
    }
    // The readers that the client had before received feedback and the latched status of goals.
    let moved = step(&mut clients[0]);
    assert!(moved["feedback"]["count"].as_u64() > Some(0), "{moved:?}");
    assert_eq!(moved["statuses"].as_array().and_then(|all| all.last()), Some(&"SUCCEEDED".into()), "{moved:?}");
    // No goal was executed twice.
    let seen = clients[0].run(&format!("axis-states {NODE}"));
    let position = &seen.all().last().expect("a sample")["axes"]["turret"]["command_increments"];
    assert_eq!(position, &Value::from(6 * STEP), "{seen:?}");
    let (_, log) = ended(program);
    assert!(!log.contains("ROS side"), "{log}");
}

const GONE: &str = "it counts as gone";
const BACK: &str = "speaks again";
const STEP: i64 = 500;

/// Moves an axis by [`STEP`], and waits for the result.
#[track_caller]
fn step(client: &mut Peer) -> Observations {
    let how = format!("--axis turret --mode relative --units increments --position {STEP} --wait");
    client.run(&format!("move {NODE} {how}"))
}

/// Waits until the log contains a line this number of times.
#[track_caller]
fn await_lines(program: &Program, line: &str, count: usize, patience: Duration) {
    let begun = Instant::now();
    while program.log().matches(line).count() < count {
        assert!(begun.elapsed() < patience, "not {count} times `{line}`: {}", program.log());
        thread::sleep(Duration::from_millis(50));
    }
}

/// Checks that both have received the same samples while both were active.
#[track_caller]
fn same_stream(one: &Value, other: &Value) {
    let cycles = |seen: &Value| -> Vec<u64> {
        let runs = seen["cycles"].as_array().expect("runs of cycles");
        let runs = runs.iter().map(|run| [0, 1, 2].map(|part| run[part].as_u64().expect("a number")));
        runs.flat_map(|[first, step, count]| (0..count).map(move |n| first + n * step)).collect()
    };
    let (one, other) = (cycles(one), cycles(other));
    let first = one[0].max(other[0]);
    let last = one[one.len() - 1].min(other[other.len() - 1]);
    let both = |seen: &[u64]| -> Vec<u64> { seen.iter().copied().filter(|c| (first..=last).contains(c)).collect() };
    let (one, other) = (both(&one), both(&other));
    assert!(one.len() > 5000, "{} samples were seen by both", one.len());
    let missed: Vec<_> = one.iter().filter(|cycle| other.binary_search(cycle).is_err()).take(5).collect();
    let missed_too: Vec<_> = other.iter().filter(|cycle| one.binary_search(cycle).is_err()).take(5).collect();
    assert!(missed.is_empty() && missed_too.is_empty(), "only one of them has seen {missed:?} and {missed_too:?}");
}

/// Sends samples that are no messages to everything that the node reads, and texts of 10 MB in each text field.
#[test]
fn invalid_samples_are_refused() {
    let _alone = alone();
    let (program, _, domain) = start(&["run"], 0);
    let mut peer = Peer::cyclone(&domain);
    peer.run(&format!("axes {NODE} enable x")); // so that a motion would be possible
    let before = program.figures();
    let read = peer.run(&format!("everything-read {NODE} --axis x --megabytes 10"));
    let between = program.figures();
    peer.run(&format!("long-strings {NODE} --axis x --megabytes 10"));
    let after = program.figures();
    for mut peer in [peer, Peer::fastdds(&domain)] {
        peer.run(&format!("move {NODE} --axis x --mode relative --units increments --position 1000 --wait"));
    }
    let (times, log) = ended(program);
    println!("{} topics, slowest answer to another client after {} s", read["topics"], read["slowest_answer_s"]);
    let (before, between, after) = (before.memory, between.memory, after.memory);
    println!("memory: {before:.1} MiB before, {between:.1} after nonsense, {after:.1} after long texts");
    println!("log of {} bytes; {times}", log.len());
    assert!(log.len() < 200_000, "the log is {} bytes long: {}", log.len(), &log[..10_000]);
    assert!(!log.contains("panicked"), "{log}");
    let longest = log.lines().map(str::len).max().unwrap_or(0);
    assert!(longest < 3000, "a line of {longest} bytes");
    // The DDS library keeps them although they were taken, see Qos::depth and docs/node.md: several hundred MB.
    assert!(after - before < 2500.0, "{before} MiB before, {after} MiB after");
}

/// A full disk, a stopped terminal, or a slow journal: an earlier version delayed requests until the log was written.
#[test]
fn blocked_log_does_not_delay_requests() {
    let _alone = alone();
    let folder = tempfile::tempdir().expect("a folder");
    let pipe = folder.path().join("stderr");
    mkfifoat(CWD, &pipe, Mode::RUSR | Mode::WUSR).expect("a pipe in a folder of this test");
    // Opened for reading and writing, so that the pipe has a reader when the program opens it.
    let unread = fs::OpenOptions::new().read(true).write(true).open(&pipe).expect("it was just made");
    let mut command = Command::new("sh");
    command.args(["-c", "exec \"$0\" run --ros-args --log-level debug 2>\"$1\"", env!("CARGO_BIN_EXE_lineshaft")]);
    command.arg(&pipe);
    let domain = Domain::take();
    let mut program = Program::start_by(command, &domain);
    let mut peer = Peer::cyclone(&domain);
    peer.run(&format!("hammer {NODE} --axis y --seconds 3"));
    let waiting = ioctl_fionread(&unread).expect("a pipe");
    assert!(waiting > 60_000, "the pipe is not full: {waiting} bytes");
    peer.run(&format!("axes {NODE} halt y"));
    program.interrupt();
    assert_eq!(program.wait_exit(EXIT).code(), Some(0));
}
