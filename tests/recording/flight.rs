//! Tests the flight recorder: an axis error saves a bag of the preceding seconds, which replays without differences.

use std::time::Duration;

use super::bench::{Bench, count, demo, reads_in_time_order};
use crate::support::{bag_check::bag_check, domain::Domain, program::Program};

/// Returns a scenario with an axis error every two seconds, from the third second on.
fn faults(number: u32) -> String {
    let mut text = format!("scenario: {number} faults\nfor: {} s\nsteps:\n", 4 + 2 * number);
    for fault in 0..number {
        let second = 2 * fault;
        text += &format!(
            "  - {{at: {second}.1 s, do: {{reset_errors: {{}}}}}}\n  \
             - {{at: {second}.3 s, do: {{enable: {{axes: [x, turret]}}}}}}\n  \
             - {{at: {second}.6 s, do: {{move_axis: {{axis: x, mode: relative, position: 20 mm}}}}}}\n  \
             - {{at: {}.0 s, do: {{inject: {{fault: {{axis: x, code: 0x8611}}}}}}}}\n",
            second + 1
        );
    }
    text
}

/// Runs a scenario on the demo in real time and waits for its end.
#[track_caller]
fn run(bench: &Bench, scenario: &str, options: &[&str]) {
    let (scenario, flight) = (bench.write("scenario.yaml", scenario), bench.path("flight"));
    let demo = demo();
    let mut args = vec!["run", &demo, "--scenario", &scenario, "--flight-folder", &flight];
    args.extend(options);
    let mut program = Program::start(&args, &Domain::take());
    let status = program.wait_exit(Duration::from_secs(120));
    assert!(status.code().is_some(), "{}", program.log());
}

#[test]
fn a_fault_leaves_a_bag_that_replays() {
    let bench = Bench::new();
    run(&bench, &faults(1), &["--flight-recorder", "5"]);
    let bags = bench.list("flight");
    assert_eq!(bags.len(), 1, "{bags:?}");
    assert!(bags[0].starts_with("flight_"), "{bags:?}");
    let bag = bench.path(&format!("flight/{}", bags[0]));
    let seen = bag_check(["rosbags", &bag]);
    assert_eq!(reads_in_time_order(bench.bag_files(&bag)), count(&seen, &["messages"]));
    assert!(count(&seen, &["counts", "/lineshaft/inputs"]) >= 1000, "the second before the fault is in it: {seen}");
    bench.lineshaft(&["replay", &bag]).expect_code(0);
}

#[test]
fn a_run_without_a_fault_leaves_none() {
    let bench = Bench::new();
    run(&bench, "scenario: nothing\nfor: 2 s\n", &[]);
    assert!(bench.list("flight").is_empty(), "{:?}", bench.list("flight"));
}

#[test]
fn a_flight_recorder_of_0_s_is_off() {
    let bench = Bench::new();
    run(&bench, &faults(1), &["--flight-recorder", "0"]);
    assert!(bench.list("flight").is_empty(), "{:?}", bench.list("flight"));
}

#[test]
fn unwritable_folder_is_reported_before_the_start() {
    let bench = Bench::new();
    let file = bench.write("file", "");
    for folder in [file, "/proc/flight".to_owned()] {
        bench
            .lineshaft(&["run", "--flight-folder", &folder])
            .expect_code(2)
            .expect_text(&["--flight-folder: cannot write", &folder]);
    }
}

#[test]
fn only_the_requested_number_of_newest_bags_is_kept() {
    let bench = Bench::new();
    run(&bench, &faults(5), &["--flight-recorder", "1", "--flight-keep", "2"]);
    let bags = bench.list("flight");
    assert_eq!(bags.len(), 2, "{bags:?}");
    let mut last = 0;
    for bag in bags {
        let bag = bench.path(&format!("flight/{bag}"));
        let end = count(&bag_check(["rosbags", &bag]), &["end_ns"]);
        assert!(end > last, "names sort by time");
        last = end;
        bench.lineshaft(&["replay", &bag]).expect_code(0);
    }
    // The last of five errors is 9 s after the first one, the previous error 2 s earlier.
    let kept = count(&bag_check(["rosbags", &bench.path(&format!("flight/{}", bench.list("flight")[0]))]), &["end_ns"]);
    assert!(last - kept < 4_000_000_000, "the two newest ones stay");
}
