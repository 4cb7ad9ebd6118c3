//! The scenarios that come with the program.

use super::*;

fn passes_on_the_demo_cell(name: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs");
    let cell = Cell::load(&folder.join("demo.yaml")).unwrap_or_else(|problems| panic!("{problems}"));
    let scenario = Scenario::load(&folder.join("scenarios").join(name), &cell);
    let scenario = scenario.unwrap_or_else(|problems| panic!("{problems}"));
    let report = simulate(&cell, &scenario, &Options::default()).unwrap();
    assert!(report.passed(), "{report}");
    assert_eq!(report.steps_fired, report.steps, "{report}");
    assert!(recorded::plays_the_same_as_json(&cell, &scenario) > 5);
}

#[test]
fn first_move_passes() {
    passes_on_the_demo_cell("first_move.yaml");
}

#[test]
fn stop_passes() {
    passes_on_the_demo_cell("stop.yaml");
}

#[test]
fn sync_passes() {
    passes_on_the_demo_cell("sync.yaml");
}

#[test]
fn no_scenario_is_forgotten_here() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/scenarios");
    let mut names: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["first_move.yaml", "stop.yaml", "sync.yaml"]);
}
