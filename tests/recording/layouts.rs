//! Tests the layouts of Foxglove and PlotJuggler for the demo: every path in them exists in a bag of the demo.

use std::fs;

use super::bench::{Bench, count, demo, root};
use crate::support::bag_check::{bag_check, bag_check_fails};

const FOXGLOVE: &str = "launch-configs/demo.foxglove.json";
const PLOTJUGGLER: &str = "launch-configs/demo.plotjuggler.xml";

fn record(bench: &Bench) -> String {
    bench.record_scenario(&demo(), &root("launch-configs/scenarios/first_move.yaml"), "run.mcap")
}

#[test]
fn every_path_exists_in_the_demo() {
    let bench = Bench::new();
    let bag = record(&bench);
    for layout in [FOXGLOVE, PLOTJUGGLER] {
        let seen = bag_check(["layout", &root(layout), &bag]);
        assert!(count(&seen, &["paths"]) > 20, "{layout}: {seen}");
    }
}

#[test]
fn a_state_is_shown_by_its_name() {
    let bench = Bench::new();
    let bag = record(&bench);
    let seen = bag_check(["layout", &root(FOXGLOVE), &bag]);
    let numbers = seen["unlabelled"].as_array().unwrap();
    let states: Vec<_> = numbers.iter().filter(|path| path.as_str().unwrap().ends_with("].state")).collect();
    assert!(states.is_empty(), "Foxglove names a value by the constants right before its field: {states:?}");
}

/// Tests the check itself: an axis, a field or a topic that does not exist, and a panel that is not shown.
#[test]
fn invalid_path_is_found() {
    let bench = Bench::new();
    let bag = record(&bench);
    let wrong = [
        (FOXGLOVE, "axes[3].command_position", "axes[4].command_position"),
        (FOXGLOVE, "].following_error", "].folowing_error"),
        (FOXGLOVE, "/joint_states.", "/joint_state."),
        (FOXGLOVE, "\"Table!axes\": {", "\"Table!other\": {"),
        (PLOTJUGGLER, "axes[3]/command_position", "axes[4]/command_position"),
        (PLOTJUGGLER, "/joint_states/y/velocity", "/joint_states/z/velocity"),
        (PLOTJUGGLER, "count=\"3\"", "count=\"2\""),
    ];
    for (layout, from, to) in wrong {
        let text = fs::read_to_string(root(layout)).unwrap();
        assert!(text.contains(from), "{layout} has no {from}");
        let name = layout.rsplit('/').next().unwrap();
        let file = bench.write(name, &text.replace(from, to));
        let error = bag_check_fails(["layout", &file, &bag]);
        assert!(!error.is_empty(), "{from} -> {to}");
    }
}
