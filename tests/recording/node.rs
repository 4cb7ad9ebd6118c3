//! Tests `lineshaft run --record` and `~/record`: runs in real time, with random goals.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use super::bench::{Bench, count, is_long, reads_in_time_order};
use crate::support::{bag_check::bag_check, domain::Domain, peer::Peer, program::Program};

const EXIT: Duration = Duration::from_secs(30);

/// Returns a peer command that sends random goals to all axes of the demo.
fn random_goals(seconds: u64, seed: u64) -> String {
    let axes = "--axis x=-0.04:0.8 --axis y=0:0.4 --axis turret=-1.5:1.5 --master line";
    format!("random-goals /lineshaft {axes} --seconds {seconds} --seed {seed}")
}

/// The built-in demo as a node, with or without recording, and its client.
struct Demo {
    bench: Bench,
    peer: Peer,
    program: Program,
}

impl Demo {
    /// Starts the demo, and returns when it publishes.
    fn start(args: &[&str]) -> Self {
        let bench = Bench::new();
        let (domain, flight) = (Domain::take(), bench.path("flight"));
        let mut peer = Peer::cyclone(&domain);
        let args: Vec<_> = args.iter().map(|arg| arg.replace("BENCH", &bench.path(""))).collect();
        let args: Vec<_> =
            ["run", "--flight-folder", &flight].into_iter().chain(args.iter().map(String::as_str)).collect();
        let program = Program::start(&args, &domain);
        peer.run("axis-states /lineshaft");
        Self { bench, peer, program }
    }

    /// Ends it with the signal of Ctrl-C.
    #[track_caller]
    fn end(&mut self) {
        self.program.interrupt();
        let status = self.program.wait_exit(EXIT);
        assert_eq!(status.code(), Some(0), "{}", self.program.log());
    }

    #[track_caller]
    fn replays(&self, bag: &str) {
        self.bench.lineshaft(&["replay", bag]).expect_code(0);
    }
}

#[test]
fn a_run_with_random_goals_replays_and_one_changed_bit_is_found() {
    let mut demo = Demo::start(&["--record", "BENCH/run.mcap"]);
    demo.peer.run(&random_goals(if is_long() { 80 } else { 8 }, 1));
    for seed in 2..if is_long() { 9 } else { 2 } {
        demo.peer.run(&random_goals(80, seed));
    }
    demo.end();
    let bag = demo.bench.path("run.mcap");
    demo.replays(&bag);

    let seen = bag_check(["mcap", &bag]);
    assert_eq!(reads_in_time_order([&bag]), count(&seen, &["messages"]));
    let cycles = count(&seen, &["counts", "/lineshaft/inputs"]);
    assert!(cycles > 5000, "{cycles} cycles");
    assert!(count(&seen, &["counts", "/lineshaft/commands"]) > 10, "{seen}");
    // Topics that the node publishes in addition to the data of the cycles.
    for topic in
        ["/rosout", "/diagnostics", "/robot_description", "/lineshaft/cycle_statistics", "/lineshaft/transition_event"]
    {
        assert!(count(&seen, &["counts", topic]) > 0, "{topic}: {seen}");
    }
    assert_eq!(seen["types"]["/robot_description"], "std_msgs/msg/String");
    assert!(count(&seen, &["start_ns"]) > 1_700_000_000_000_000_000, "wall time: {seen}");
    let (cycle, changed) = ((cycles / 2).to_string(), demo.bench.path("changed.mcap"));
    bag_check(["flip", &bag, &changed, "--cycle", &cycle, "--field", "drive_count[1]", "--bit", "2"]);
    demo.bench.lineshaft(&["replay", &changed]).expect_code(3).expect_text(&[&cycle, "y."]);
}

/// After cleanup no cycle runs: no cycle follows the last messages of the node.
#[test]
fn messages_after_the_last_cycle_are_at_the_end_of_the_bag() {
    let mut demo = Demo::start(&["--record", "BENCH/run.mcap"]);
    for transition in ["deactivate", "cleanup"] {
        let seen = demo.peer.run(&format!("change-state /lineshaft {transition}"));
        assert_eq!(seen["success"][0], true, "{transition}: {}", demo.program.log());
    }
    demo.end();
    let bag = demo.bench.path("run.mcap");
    let seen = bag_check(["mcap", &bag]);
    // Two for each of the transitions configure, activate, deactivate and cleanup.
    assert_eq!(count(&seen, &["counts", "/lineshaft/transition_event"]), 8, "{seen}");
    assert_eq!(reads_in_time_order([&bag]), count(&seen, &["messages"]));
    demo.replays(&bag);
}

#[test]
fn a_folder_is_split_by_time_and_rosbags_reads_all_of_it() {
    let mut demo = Demo::start(&["--record", "BENCH/bag", "--max-bag-duration", "2"]);
    demo.peer.run(&random_goals(7, 20));
    demo.end();
    let files = demo.bench.bag_files("bag");
    let bag = demo.bench.path("bag");
    let seen = bag_check(["rosbags", &bag]);
    // 2000 cycles of 1 ms for each file; missed cycles count, too.
    let whole = count(&seen, &["counts", "/lineshaft/inputs"]) as usize / 2000;
    assert!(whole >= 3 && (whole..=whole + 2).contains(&files.len()), "{files:?} for {whole} times 2 s");
    let parts: u64 =
        files.iter().map(|file| count(&bag_check(["mcap".as_ref(), file.as_os_str()]), &["messages"])).sum();
    assert_eq!(count(&seen, &["messages"]), parts);
    assert_eq!(reads_in_time_order(&files), parts);
    demo.replays(&bag);
    // Each later file begins with the state of the machine.
    for file in &files[1..] {
        demo.replays(file.to_str().unwrap());
    }
}

#[test]
fn a_folder_is_split_by_size() {
    let mut demo = Demo::start(&["--record", "BENCH/bag", "--max-bag-size", "100000"]);
    demo.peer.run(&random_goals(6, 30));
    demo.end();
    assert!(demo.bench.bag_files("bag").len() > 1, "{:?}", demo.bench.list("bag"));
    let bag = demo.bench.path("bag");
    let seen = bag_check(["rosbags", &bag]);
    assert_eq!(reads_in_time_order(demo.bench.bag_files("bag")), count(&seen, &["messages"]));
    demo.replays(&bag);
}

/// Threads that use all processor time that they can get, until this value is dropped.
struct Load {
    stop: &'static AtomicBool,
    threads: Vec<thread::JoinHandle<()>>,
}

impl Load {
    fn start(threads: usize) -> Self {
        let stop: &'static AtomicBool = Box::leak(Box::new(AtomicBool::new(false)));
        let busy = || while !stop.load(Ordering::Relaxed) {};
        Self { stop, threads: (0..threads).map(|_| thread::spawn(busy)).collect() }
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for one in self.threads.drain(..) {
            one.join().expect("a busy thread does not panic");
        }
    }
}

#[test]
fn a_run_on_a_loaded_machine_replays() {
    let mut demo = Demo::start(&["--record", "BENCH/run.mcap", "--cpu", "any"]);
    let load = Load::start(2 * thread::available_parallelism().map_or(2, usize::from));
    demo.peer.run(&random_goals(if is_long() { 60 } else { 6 }, 40));
    drop(load);
    demo.end();
    let bag = demo.bench.path("run.mcap");
    demo.replays(&bag);
    bag_check(["mcap", &bag]);
}

#[test]
fn the_service_starts_and_stops_bags() {
    let mut demo = Demo::start(&[]);
    assert_eq!(demo.peer.run("record /lineshaft status")["recording"], false);
    for name in ["one", "two.mcap"] {
        let bag = demo.bench.path(name);
        let seen = demo.peer.run(&format!("record /lineshaft start --path {bag}"));
        assert_eq!((&seen["recording"], &seen["path"]), (&true.into(), &bag.as_str().into()), "{seen:?}");
        let error = demo.peer.fails("record /lineshaft start --path somewhere_else");
        assert!(error.contains(&bag), "one bag at a time: {error}");
        demo.peer.run(&random_goals(3, 50));
        let seen = demo.peer.run("record /lineshaft status");
        assert_eq!(seen["recording"], true);
        assert!(seen["cycles"].as_u64().unwrap() > 1000, "{seen:?}");
        let seen = demo.peer.run("record /lineshaft stop");
        assert_eq!((&seen["recording"], &seen["lost"]), (&false.into(), &0.into()), "{seen:?}");
        assert_eq!(seen["replayable"], true, "{seen:?}");
        assert!(seen["size"].as_u64().unwrap() > 0, "{seen:?}");
        // A bag that begins during a run begins with the state of the machine.
        demo.replays(&bag);
    }
    bag_check(["rosbags", &demo.bench.path("one")]);
    let seen = bag_check(["mcap", &demo.bench.path("two.mcap")]);
    assert_eq!(count(&seen, &["counts", "/robot_description"]), 1, "it was published before the bag began: {seen}");
    reads_in_time_order(demo.bench.bag_files("one"));
    reads_in_time_order([demo.bench.path("two.mcap")]);
    demo.end();
}

#[test]
fn the_service_splits_and_refuses_what_it_cannot_write() {
    let mut demo = Demo::start(&[]);
    let bag = demo.bench.path("bag");
    demo.peer.run(&format!("record /lineshaft start --path {bag} --max-bag-duration 1"));
    let end = Instant::now() + Duration::from_secs(60);
    while demo.bench.bag_files("bag").len() < 3 {
        assert!(Instant::now() < end, "{:?}", demo.bench.list("bag"));
        thread::sleep(Duration::from_millis(50));
    }
    demo.peer.run("record /lineshaft stop");
    demo.replays(&bag);

    let file = demo.bench.write("file", "");
    for place in [bag, format!("{file}/bag")] {
        let error = demo.peer.fails(&format!("record /lineshaft start --path {place}"));
        assert!(error.contains(&place), "{error}");
    }
    let error = demo.peer.fails("record /lineshaft stop");
    assert!(!error.is_empty());
    demo.end();
}

#[test]
fn the_service_saves_what_the_flight_recorder_holds() {
    let mut demo = Demo::start(&["--flight-recorder", "2"]);
    demo.peer.run(&random_goals(5, 60));
    let seen = demo.peer.run("record /lineshaft save");
    let bag = seen["path"].as_str().unwrap().to_owned();
    assert!(bag.starts_with(&demo.bench.path("flight/flight_")), "{seen:?}");
    let seen = bag_check(["rosbags", &bag]);
    assert_eq!(reads_in_time_order(demo.bench.bag_files(&bag)), count(&seen, &["messages"]));
    let cycles = count(&seen, &["counts", "/lineshaft/inputs"]);
    // Two seconds, and up to one more second to the preceding state of the machine.
    assert!((1000..=4000).contains(&cycles), "{cycles}");
    demo.replays(&bag);
    demo.end();
}
