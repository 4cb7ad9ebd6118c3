//! Tests what remains of a recording if the program is killed while it records, or if the disk is full.

use crate::support::machine::share;
use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use super::bench::{Bench, count, demo, is_long};
use crate::support::{bag_check::bag_check, domain::Domain, peer::Peer, program::Program};

/// A scenario that moves all the time and is still running when the program is killed.
const LONG: &str = "scenario: back and forth
for: 10 min
steps:
  - {at: 0, do: {enable: {axes: [x, y, turret]}}}
  - {at: 100 ms, every: 2 s, count: 299, do: {move_axis: {axis: x, position: 300 mm}}}
  - {at: 1100 ms, every: 2 s, count: 299, do: {move_axis: {axis: x, position: 10 mm}}}
";

/// Returns a pseudorandom delay below `range_ms`, the same in every run of the test.
fn moment(number: u64, range_ms: u64) -> Duration {
    let mixed = (number + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
    Duration::from_millis(mixed % range_ms)
}

/// Waits until the file contains data; panics after a timeout.
#[track_caller]
fn wait_for_data(file: &Path) {
    let end = Instant::now() + Duration::from_secs(60);
    while fs::metadata(file).map_or(0, |metadata| metadata.len()) == 0 {
        assert!(Instant::now() < end, "{} stays empty", file.display());
        thread::sleep(Duration::from_millis(2));
    }
}

/// Checks a bag whose writer was killed; returns the number of cycles in its complete chunks.
#[track_caller]
fn judge(bench: &Bench, file: &str) -> u64 {
    let left = bag_check(["torn", file]);
    assert_eq!(left["finished"], false, "{file} was finished before the kill: {left}");
    let cycles = count(&left, &["cycles"]);
    // rosbag2 reads an unfinished file in the order in which it was written, which is the order of time.
    let scanned = bag_check(["indexed", file]);
    let messages: u64 = left["counts"].as_object().into_iter().flatten().filter_map(|(_, count)| count.as_u64()).sum();
    assert_eq!((count(&scanned, &["messages"]), &scanned["in_order"]), (messages, &true.into()), "{file}");
    let info = bench.lineshaft(&["bag", "info", file]);
    let replay = bench.lineshaft(&["replay", file]);
    for ended in [&info, &replay] {
        assert!(!ended.text.is_empty() && !ended.text.contains("panicked"), "{file}: {}", ended.text);
    }
    if cycles > 0 {
        let info = info.expect_code(0).expect_text(&[&cycles.to_string()]);
        let told = ["lost", "not finished", "unfinished", "killed"];
        assert!(told.iter().any(|word| info.text.contains(word)), "it does not say what is lost:\n{}", info.text);
        replay.expect_code(0).expect_text(&[&cycles.to_string()]);
    }
    cycles
}

fn kills(few: u64) -> u64 {
    if is_long() { few * 10 } else { few }
}

#[test]
fn a_simulation_that_was_killed_is_read_up_to_its_last_whole_chunk() {
    let _machine = share();
    let bench = Bench::new();
    let scenario = bench.write("long.yaml", LONG);
    let mut cycles = 0;
    for number in 0..kills(15) {
        let file = bench.path(&format!("{number}.mcap"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.args(["sim", &demo(), "--scenario", &scenario, "--record", &file]);
        let mut program = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_for_data(Path::new(&file));
        thread::sleep(moment(number, 700));
        program.kill().unwrap();
        program.wait().unwrap();
        cycles += judge(&bench, &file);
        fs::remove_file(&file).unwrap();
    }
    assert!(cycles > 0, "every bag was empty");
}

#[test]
fn a_node_that_was_killed_leaves_all_but_the_last_moment() {
    let bench = Bench::new();
    let domain = Domain::take();
    let mut peer = Peer::cyclone(&domain);
    for number in 0..kills(5) {
        let file = bench.path(&format!("{number}.mcap"));
        let mut program = Program::start(&["run", "--record", &file, "--flight-recorder", "0"], &domain);
        wait_for_data(Path::new(&file));
        peer.run("axis-states /lineshaft");
        thread::sleep(Duration::from_secs(1) + moment(number, 3000));
        program.kill();
        program.wait_exit(Duration::from_secs(10));
        judge(&bench, &file);
    }
}

/// Simulates a full disk: no file of the program may exceed a size, and a write beyond it fails instead of ending the
/// program.
fn with_small_files(kibibytes: u32, args: &[&str]) -> Command {
    let mut command = Command::new("bash");
    let limited = format!("trap '' XFSZ; ulimit -f {kibibytes}; exec \"$0\" \"$@\"");
    command.args(["-c", &limited, env!("CARGO_BIN_EXE_lineshaft")]).args(args);
    command
}

#[test]
fn a_full_disk_ends_the_bag_with_one_event_and_not_the_cycle() {
    let bench = Bench::new();
    let bag = bench.path("bag");
    let domain = Domain::take();
    let mut peer = Peer::cyclone(&domain);
    let args = ["run", "--record", &bag, "--flight-recorder", "0"];
    let mut program = Program::start_by(with_small_files(200, &args), &domain);
    peer.run("axis-states /lineshaft");
    peer.run("events /lineshaft");
    let mut told = Vec::new();
    for seed in 0..20 {
        // Motion makes the bag grow.
        peer.run(&format!("random-goals /lineshaft --axis x=0:0.8 --axis y=0:0.4 --seconds 2 --seed {seed}"));
        let events = peer.run("events /lineshaft");
        let texts = events.all().iter().filter_map(|seen| seen["message"]["text"].as_str());
        told.extend(texts.filter(|text| text.contains(&bag) || text.contains("record")).map(str::to_owned));
        if !told.is_empty() && seed > 3 {
            break;
        }
    }
    assert_eq!(told.len(), 1, "one event: {told:?}");
    let seen = peer.run("joint-states --count 100 --seconds 20");
    assert!(seen["rate"].as_f64().unwrap() > 50.0, "the cycle goes on: {seen:?}");
    let status = peer.run("record /lineshaft status");
    assert_eq!(status["recording"], false, "{status:?}");
    program.interrupt();
    program.wait_exit(Duration::from_secs(20));

    bag_check(["metadata", &bag]);
    let files = bench.bag_files("bag");
    let file = files.first().and_then(|path| path.to_str()).expect("the bag was begun");
    let cycles = count(&bag_check(["torn", file]), &["cycles"]);
    assert!(cycles > 0, "nothing was kept");
    bench.lineshaft(&["replay", file]).expect_code(0).expect_text(&[&cycles.to_string()]);
}

#[test]
fn a_simulation_on_a_full_disk_fails_with_a_sentence() {
    let bench = Bench::new();
    let scenario = bench.write("long.yaml", LONG);
    let file = bench.path("run.mcap");
    let output = with_small_files(200, &["sim", &demo(), "--scenario", &scenario, "--record", &file]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(1 | 2)), "{}: {text}", output.status);
    assert!(text.contains("run.mcap") && !text.contains("panicked"), "{text}");
}
