//! Tests the scenarios that come with the program.

use super::*;

fn passes_on_the_demo_cell(name: &str) {
    passes_on("demo.yaml", name);
}

fn passes_on(cell: &str, name: &str) {
    assert!(passes(cell, &format!("scenarios/{name}")) > 5);
}

/// Plays a scenario, also as recorded commands; returns the number of commands.
fn passes(cell: &str, scenario: &str) -> usize {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs");
    let cell = Cell::load(&folder.join(cell)).unwrap_or_else(|problems| panic!("{problems}"));
    let scenario = Scenario::load(&folder.join(scenario), &cell);
    let scenario = scenario.unwrap_or_else(|problems| panic!("{problems}"));
    let report = simulate(&cell, &scenario, &Options::default()).unwrap();
    assert!(report.passed(), "{report}");
    assert_eq!(report.steps_fired, report.steps, "{report}");
    recorded::plays_the_same_as_json(&cell, &scenario)
}

#[test]
fn first_move_passes() {
    passes_on_the_demo_cell("first_move.yaml");
}

#[test]
fn home_passes() {
    passes_on_the_demo_cell("home.yaml");
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
fn trajectory_passes() {
    passes_on_the_demo_cell("trajectory.yaml");
}

#[test]
fn motors_pass() {
    passes_on("motor.yaml", "loops/motor.yaml");
}

/// Proves: WF-INC-04
#[test]
fn the_screw_passes() {
    passes_on("screw.yaml", "loops/screw.yaml");
}

/// Proves: MACS-REG-01, MACS-REG-05, MACS-REG-08, MACS-REG-09, MACS-REG-12
#[test]
fn the_position_loop_of_macs_passes() {
    passes_on("macs_loop.yaml", "macs/position_loop.yaml");
}

/// Proves: MACS-AMP-01, MACS-AMP-04, MACS-AMP-08
#[test]
fn the_cascade_of_an_axis_with_interface_torque_passes() {
    passes_on("torque.yaml", "macs/torque_loop.yaml");
    passes_on("torque.yaml", "loops/out_an.yaml");
}

/// Proves: MACS-AMP-06
#[test]
fn an_axis_with_two_encoders_passes() {
    passes_on("dual.yaml", "loops/dual.yaml");
}

/// Proves: MACS-AMP-01, MACS-AMP-02, MACS-AMP-07, MACS-AMP-08, MACS-AMP-09, MACS-AMP-10
#[test]
fn the_structures_of_an_axis_with_interface_voltage_pass() {
    passes_on("voltage.yaml", "loops/voltage.yaml");
}

/// Proves: WF-CLC-04, MACS-CAN-01
#[test]
fn axes_whose_drives_are_given_voltages_pass() {
    passes_on("analog.yaml", "loops/analog.yaml");
}

/// Proves: MACS-REG-09, MACS-REG-10
#[test]
fn feed_forward_passes() {
    passes_on("macs_loop.yaml", "macs/feed_forward.yaml");
}

/// Proves: AMK-SAK-05, AMK-SIDIFF-12
#[test]
fn compensation_of_the_following_error_passes() {
    passes_on("loops.yaml", "amk/sak.yaml");
}

#[test]
fn wf_closed_loop_passes() {
    passes_on("wf_closed.yaml", "wf/closed_loop.yaml");
}

#[test]
fn what_stops_axes_passes() {
    passes_on("safety.yaml", "safety/stops.yaml");
}

#[test]
fn examples_of_function_slots_cams_and_shafts_pass() {
    for (folder, fewest) in [("functions", 4), ("cams", 2), ("shaft", 2)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs").join(folder);
        let files = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let scenarios: Vec<_> = files.filter(|name| name.ends_with(".scenario.yaml")).collect();
        assert!(scenarios.len() >= fewest, "{folder}");
        for name in scenarios {
            let cell = name.replace(".scenario.yaml", ".yaml");
            assert!(passes(&format!("{folder}/{cell}"), &format!("{folder}/{name}")) > 0, "{name}");
        }
    }
}

/// The steps of docs/can.md without ROS.
#[test]
fn first_move_of_a_drive_on_can_passes_in_simulation() {
    assert!(passes("can/drive.yaml", "can/first_move.scenario.yaml") >= 3);
}

#[test]
fn arm_follows_its_plan() {
    assert!(passes("arm6/arm6.yaml", "arm6/arm6.scenario.yaml") >= 2);
}

#[test]
fn no_scenario_is_forgotten_here() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/scenarios");
    let mut names: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    // The folders are those of the vocabularies and of homing, which tests/vocabularies.rs plays.
    names.retain(|name| name.ends_with(".yaml"));
    names.sort();
    assert_eq!(names, ["first_move.yaml", "home.yaml", "motion.yaml", "stop.yaml", "sync.yaml", "trajectory.yaml"]);
}

#[test]
fn a_difference_of_two_leads() {
    assert!(passes("masters.yaml", "scenarios/masters/difference.yaml") >= 5);
}

#[test]
fn a_flying_shear_cuts_with_its_web() {
    assert!(passes("shear.yaml", "scenarios/masters/shear.yaml") >= 11);
}

#[test]
fn a_virtual_master_leads_and_follows() {
    assert!(passes("vmaster.yaml", "scenarios/masters/virtual.yaml") >= 12);
}

#[test]
fn bus_off_scenario_passes() {
    passes_on("buses.yaml", "buses/bus_lost.yaml");
}
