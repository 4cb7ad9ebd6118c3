//! Tests that cells, scenarios, stores and bags of earlier versions can be used unchanged.
//!
//! Each folder of tests/compat has the files of one version. docs/releasing.md describes how the next one is made.
//!
//! A change that breaks one of them is listed in [`REFUSED`] with a part of its message, which must name the required
//! change.

use crate::support::machine::share;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Files that the present version refuses: version, command, and the part of the message with the required change.
const REFUSED: &[(&str, &str, &str)] = &[];

/// Files of an earlier version.
struct Version {
    name: String,
    folder: PathBuf,
}

/// Returns all versions that have files, sorted by name.
fn versions() -> Vec<Version> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/compat");
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut found: Vec<_> = entries
        .map(|entry| entry.expect("the folder can be read"))
        .filter(|entry| entry.path().is_dir())
        .map(|entry| Version { name: entry.file_name().to_string_lossy().into_owned(), folder: entry.path() })
        .collect();
    found.sort_by(|a, b| a.name.cmp(&b.name));
    assert!(found.iter().any(|version| version.name == "0.1.0"), "{}", folder.display());
    found
}

impl Version {
    /// Runs a command on copies of the files, in a separate folder, and returns its output; panics unless the result is
    /// that of the earlier version.
    #[track_caller]
    fn works(&self, arguments: &[&str]) -> String {
        let copy = tempfile::tempdir().expect("room for a temporary folder");
        for entry in fs::read_dir(&self.folder).expect("the folder can be read") {
            let path = entry.expect("the folder can be read").path();
            let name = path.file_name().expect("a file has a name");
            fs::copy(&path, copy.path().join(name)).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        }
        let output = lineshaft(copy.path(), arguments);
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        let refused = REFUSED.iter().find(|(version, command, _)| *version == self.name && *command == arguments[0]);
        match refused {
            None => assert_eq!(output.status.code(), Some(0), "{} {arguments:?}: {said}", self.name),
            Some((_, _, words)) => {
                assert_ne!(output.status.code(), Some(0), "{} {arguments:?} works: {said}", self.name);
                assert!(said.contains(*words), "{} {arguments:?}: {said}", self.name);
            }
        }
        said
    }

    /// Whether a command is one of those that the present version refuses.
    fn refuses(&self, command: &str) -> bool {
        REFUSED.iter().any(|(version, refused, _)| *version == self.name && *refused == command)
    }
}

fn lineshaft(folder: &Path, arguments: &[&str]) -> Output {
    let _machine = share();
    Command::new(env!("CARGO_BIN_EXE_lineshaft"))
        .args(arguments)
        .current_dir(folder)
        .env("ROS_HOME", folder)
        .output()
        .expect("the program starts")
}

#[test]
fn cells_and_scenarios_of_earlier_versions_are_good() {
    for version in versions() {
        version.works(&["check", "cell.yaml", "--scenario", "scenario.yaml"]);
    }
}

/// The scenario expects the refusal of a velocity and a target that only the limits in the store forbid.
#[test]
fn scenarios_of_earlier_versions_pass_with_the_values_of_their_stores() {
    for version in versions() {
        let said = version.works(&["sim", "cell.yaml", "--scenario", "scenario.yaml", "--store", "store.yaml"]);
        assert!(version.refuses("sim") || said.contains("PASSED"), "{said}");
    }
}

#[test]
fn a_scenario_fails_without_the_store_that_it_was_written_for() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/compat/0.1.0");
    let output = lineshaft(&folder, &["sim", "cell.yaml", "--scenario", "scenario.yaml"]);
    let report = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{report}");
    // The steps that only the limits in the store forbid are accepted.
    assert!(report.contains("scenario.yaml:11:") && report.contains("scenario.yaml:12:"), "{report}");
}

#[test]
fn bags_of_earlier_versions_open_and_replay_without_a_difference() {
    for version in versions() {
        let info = version.works(&["bag", "info", "run.mcap"]);
        let recorded = format!("version: {}", version.name);
        assert!(version.refuses("bag") || info.contains(&recorded), "{info}");
        version.works(&["replay", "run.mcap"]);
    }
}
