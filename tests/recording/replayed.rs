//! Tests `lineshaft replay` and `lineshaft validate`: equal runs are reported as equal, and changes are found.

use super::bench::{Bench, demo, root};
use crate::support::bag_check::bag_check;

#[test]
fn what_was_recorded_replays() {
    let bench = Bench::new();
    for bag in [bench.record("run.mcap"), bench.record("bag")] {
        bench.lineshaft(&["replay", &bag]).expect_code(0);
    }
    for scenario in ["first_move", "stop", "sync", "home"] {
        let scenario_file = root(&format!("launch-configs/scenarios/{scenario}.yaml"));
        let bag = bench.record_scenario(&demo(), &scenario_file, scenario);
        bench.lineshaft(&["replay", &bag]).expect_code(0);
    }
}

/// A changed input: its field, the bit that is inverted, and names of which the report contains one.
const CHANGES: [(&str, &str, &[&str]); 12] = [
    ("digital[0]", "0", &["start"]),
    ("digital[0]", "1", &["mark"]),
    ("analog[0]", "0", &["tension"]),
    ("encoder_count[0]", "0", &["belt"]),
    ("encoder_valid[0]", "0", &["belt"]),
    ("drive_count[0]", "0", &["x."]),
    ("drive_velocity[1]", "0", &["turret."]),
    // Bit 2 of 60FDh is the reference switch.
    ("drive_inputs[0]", "2", &["x."]),
    // Bit 3 of the status word is the fault bit of the drive.
    ("drive_status[0]", "3", &["x."]),
    // Bit 14 is manufacturer-specific: no signal shows it.
    ("drive_status[1]", "14", &["inputs", "drive_status"]),
    ("missed", "0", &["missed", "overruns"]),
    ("latches_lost", "0", &["inputs", "latches_lost"]),
];

#[test]
fn one_changed_bit_of_an_input_is_found_in_its_cycle() {
    let bench = Bench::new();
    let bag = bench.record("run.mcap");
    for (number, (field, bit, names)) in CHANGES.into_iter().enumerate() {
        let cycle = (1203 + 7 * number).to_string();
        let changed = bench.path(&format!("changed_{number}.mcap"));
        bag_check(["flip", &bag, &changed, "--cycle", &cycle, "--field", field, "--bit", bit]);
        let ended = bench.lineshaft(&["replay", &changed]).expect_code(3).expect_text(&[&cycle]);
        assert!(names.iter().any(|name| ended.text.contains(name)), "{field}: none of {names:?} in:\n{}", ended.text);
    }
}

#[test]
fn the_first_and_the_last_cycle_are_compared_too() {
    let bench = Bench::new();
    let bag = bench.record("run.mcap");
    for cycle in ["0", "2999"] {
        let changed = bench.path(&format!("{cycle}.mcap"));
        bag_check(["flip", &bag, &changed, "--cycle", cycle, "--field", "drive_count[0]", "--bit", "4"]);
        bench.lineshaft(&["replay", &changed]).expect_code(3).expect_text(&[cycle, "x."]);
    }
}

#[test]
fn bag_without_inputs_of_a_cycle_is_reported() {
    let bench = Bench::new();
    let bag = bench.record("run.mcap");
    let lacking = bench.path("lacking.mcap");
    bag_check(["drop", &bag, &lacking, "--cycle", "1234"]);
    let ended = bench.lineshaft(&["replay", &lacking]).expect_text(&["1234"]);
    assert_eq!(ended.code, Some(2), "{ended:?}");
}

#[test]
fn what_rosbag2_records_cannot_be_replayed_but_validated() {
    let bench = Bench::new();
    let bag = bench.record("run.mcap");
    let topics = bench.path("topics.mcap");
    bag_check(["topics-only", &bag, &topics]);
    bench.lineshaft(&["replay", &topics]).expect_code(2).expect_text(&["cell.yaml", "lineshaft validate"]);
    bench.lineshaft(&["bag", "info", &topics]).expect_code(0).expect_text(&["/joint_states"]);
    for (run, expected) in [(&topics, &bag), (&bag, &topics), (&topics, &topics)] {
        bench.lineshaft(&["validate", run, "--against", expected]).expect_code(0);
    }
}

#[test]
fn validate_finds_another_trajectory_and_tolerates_what_it_may() {
    let bench = Bench::new();
    let scenario = |position: &str| {
        let step = format!("  - {{at: 100 ms, do: {{move_axis: {{axis: x, position: {position}}}}}}}\n");
        let enable = "  - {at: 0, do: {enable: {axes: [x]}}}\n";
        let text = format!("scenario: to {position}\nfor: 2 s\nsteps:\n{enable}{step}");
        let name = position.replace(' ', "_");
        let file = bench.write(&format!("{name}.yaml"), &text);
        bench.record_scenario(&demo(), &file, &name)
    };
    let (expected, other) = (scenario("100 mm"), scenario("101 mm"));
    let ended = bench.lineshaft(&["validate", &other, "--against", &expected]).expect_text(&["x"]);
    assert!(!matches!(ended.code, Some(0) | None), "{ended:?}");
}

#[test]
fn replay_of_something_else_is_bad_usage() {
    let bench = Bench::new();
    let text = bench.write("text.mcap", "this is no bag");
    for bag in [text, bench.path("no_such_bag"), bench.path("no_such.mcap"), bench.path("")] {
        for command in [&["replay", &bag][..], &["bag", "info", &bag], &["validate", &bag, "--against", &bag]] {
            let ended = bench.lineshaft(command).expect_code(2);
            assert!(!ended.text.is_empty() && !ended.text.contains("panicked"), "{command:?}: {}", ended.text);
        }
    }
}
