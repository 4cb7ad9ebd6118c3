//! Plays the scenarios of the sources, one folder for each source.

use crate::support::{domain::Domain, machine::share};
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the cell of the command line in a scenario's comment: `#   lineshaft sim CELL --scenario FILE`.
fn named_cell(scenario: &str) -> Option<&str> {
    let line = scenario.lines().find_map(|line| line.strip_prefix('#')?.trim().strip_prefix("lineshaft sim "))?;
    line.split_whitespace().next()
}

/// Plays every scenario of `scenarios/NAME`, with `NAME.yaml` or with the cell that its comment names; returns their
/// number.
fn plays(name: &str) -> usize {
    plays_in(&format!("launch-configs/scenarios/{name}"), ".yaml", &format!("launch-configs/{name}.yaml"))
}

/// Plays every file of a folder whose name ends with `ending`; returns their number.
fn plays_in(folder: &str, ending: &str, usual: &str) -> usize {
    let folder = root().join(folder);
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("a folder that can be read").path())
        .filter(|path| path.to_string_lossy().ends_with(ending))
        .collect();
    files.sort();
    let play = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).expect("a scenario");
        play(&root().join(named_cell(&text).unwrap_or(usual)), file).err()
    };
    let failed: Vec<String> = files.iter().filter_map(play).collect();
    assert!(failed.is_empty(), "{} of {} fail:\n{}", failed.len(), files.len(), failed.join("\n"));
    files.len()
}

/// # Errors
/// The output of the program, if its exit code is not 0.
fn play(cell: &Path, scenario: &Path) -> Result<(), String> {
    let _machine = share();
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new(env!("CARGO_BIN_EXE_lineshaft"))
        .arg("sim")
        .arg(cell)
        .arg("--scenario")
        .arg(scenario)
        .current_dir(folder.path())
        .env("ROS_HOME", folder.path())
        .output()
        .expect("the program starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.code() == Some(0) {
        return Ok(());
    }
    Err(format!("{}\n{}{}", scenario.display(), text(&output.stdout), text(&output.stderr)))
}

#[test]
fn the_layers_of_parameters_play_their_scenarios() {
    assert!(plays("parameters") >= 6);
}

#[test]
fn the_words_of_macs_play_their_scenarios() {
    assert!(plays("macs") >= 4);
}

#[test]
fn the_reference_selector_plays_its_scenarios() {
    assert!(plays("amc") >= 8);
}

#[test]
fn the_blocks_of_wf_play_their_scenarios() {
    assert!(plays("wf") >= 12);
}

#[test]
fn the_functions_of_amk_play_their_scenarios() {
    assert!(plays("amk") >= 6);
}

#[test]
fn the_commands_of_saia_play_their_scenarios() {
    assert!(plays("saia") >= 7);
}

#[test]
fn every_way_of_homing_plays_its_scenario() {
    assert!(plays("homing") >= 6);
}

#[test]
fn encoders_of_every_kind_play_their_scenarios() {
    assert!(plays("encoders") >= 4);
}

#[test]
fn masters_of_several_play_their_scenarios() {
    assert!(plays("masters") >= 1);
}

#[test]
fn the_terminals_of_a_machine_play_their_scenarios() {
    assert!(plays("io") >= 6);
}

/// Each cell of the examples has a scenario in the same folder, whose comment names it.
#[test]
fn function_slots_and_cams_play_their_examples() {
    for (folder, fewest) in [("launch-configs/functions", 4), ("launch-configs/cams", 2), ("launch-configs/shaft", 2)] {
        let cells = std::fs::read_dir(root().join(folder)).expect("the folder of the examples");
        let names =
            cells.map(|entry| entry.expect("a folder that can be read").file_name().to_string_lossy().into_owned());
        let cells = names.filter(|name| name.ends_with(".yaml") && !name.contains(".scenario.")).count();
        assert_eq!(plays_in(folder, ".scenario.yaml", "a cell that no comment names"), cells);
        assert!(cells >= fewest, "{folder}");
    }
}

#[test]
fn arm_plays_its_plan() {
    assert_eq!(plays_in("launch-configs/arm6", ".scenario.yaml", "launch-configs/arm6/arm6.yaml"), 1);
}

/// A cell whose drives and terminals are on a CAN bus that does not exist on this machine: `run` reports this and ends,
/// `run --sim` runs it with its switches, its brake and its load, up to the end of a scenario.
#[test]
fn run_with_sim_rehearses_a_real_cell() {
    let (folder, domain) = (tempfile::tempdir().expect("a folder"), Domain::take());
    // Never the interface of the machine that runs the tests: real devices may be connected to it.
    let text = std::fs::read_to_string(root().join("launch-configs/io.yaml")).expect("it is there");
    let (cell, scenario) = (folder.path().join("io.yaml"), root().join("launch-configs/scenarios/io/switches.yaml"));
    std::fs::write(&cell, text.replace("socketcan:can0", "slcan-tcp:127.0.0.1:1")).expect("room for a file");
    let run = |args: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_lineshaft"))
            .args(args)
            .arg(&cell)
            .arg("--scenario")
            .arg(&scenario)
            .args(["--store", "none", "--flight-recorder", "0"])
            .current_dir(folder.path())
            .env("ROS_HOME", folder.path())
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            .env("ROS_DOMAIN_ID", domain.to_string())
            .output()
            .expect("the program starts");
        (
            output.status.code(),
            [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat(),
        )
    };
    let (code, text) = run(&["run"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("backend bus: slcan-tcp:127.0.0.1:1 cannot be opened: "), "{text}");
    let (code, text) = run(&["run", "--sim"]);
    assert_eq!(code, Some(0), "{text}");
}
