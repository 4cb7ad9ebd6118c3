//! The scenarios of the sources: a folder of them for each, played by the program.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The cell of the command line in a scenario's comment: `#   lineshaft sim CELL --scenario FILE`.
fn named_cell(scenario: &str) -> Option<&str> {
    let line = scenario.lines().find_map(|line| line.strip_prefix('#')?.trim().strip_prefix("lineshaft sim "))?;
    line.split_whitespace().next()
}

/// Plays every scenario of `scenarios/NAME`, on `NAME.yaml` or on the cell that its comment names; how many there are.
fn plays(name: &str) -> usize {
    let folder = root().join("launch-configs/scenarios").join(name);
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("a folder that can be read").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "yaml"))
        .collect();
    files.sort();
    let usual = format!("launch-configs/{name}.yaml");
    let play = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).expect("a scenario");
        play(&root().join(named_cell(&text).unwrap_or(&usual)), file).err()
    };
    let failed: Vec<String> = files.iter().filter_map(play).collect();
    assert!(failed.is_empty(), "{} of {} fail:\n{}", failed.len(), files.len(), failed.join("\n"));
    files.len()
}

/// # Errors
/// What the program said, where it did not end with 0.
fn play(cell: &Path, scenario: &Path) -> Result<(), String> {
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
    assert!(plays("wf") >= 11);
}

#[test]
fn the_commands_of_saia_play_their_scenarios() {
    assert!(plays("saia") >= 7);
}
