//! Shared parts of the recording tests: a folder, the program on the command line, and runs to record.

use crate::support::machine::share;
use std::{
    env,
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use serde_json::Value;
use tempfile::TempDir;

use crate::support::bag_check::bag_check;

/// Returns a file of the workspace.
pub(crate) fn root(path: &str) -> String {
    text_of(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path))
}

/// Returns the path of the built-in demo.
pub(crate) fn demo() -> String {
    root("launch-configs/demo.yaml")
}

/// Returns true if long tests are requested.
pub(crate) fn is_long() -> bool {
    env::var("LINESHAFT_LONG").is_ok_and(|value| value == "1")
}

fn text_of(path: &Path) -> String {
    path.to_str().expect("paths of the workspace and of temporary folders are text").to_owned()
}

/// Result of a command of the program.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    /// Standard output and standard error, one after the other.
    pub(crate) text: String,
}

impl Ended {
    /// Checks that the program ended with `code`.
    #[track_caller]
    pub(crate) fn expect_code(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}", self.text);
        self
    }

    /// Checks that the text contains each of `parts`.
    #[track_caller]
    pub(crate) fn expect_text(self, parts: &[&str]) -> Self {
        for part in parts {
            assert!(self.text.contains(part), "`{part}` is missing in:\n{}", self.text);
        }
        self
    }
}

/// A folder for the bags of one test.
pub(crate) struct Bench(TempDir);

impl Bench {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("the system has room for a temporary folder"))
    }

    /// Returns the path of a file in the folder.
    pub(crate) fn path(&self, name: &str) -> String {
        text_of(&self.0.path().join(name))
    }

    /// Returns the names in a subfolder, sorted.
    pub(crate) fn list(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.0.path().join(folder)).into_iter().flatten();
        let mut names: Vec<_> = entries
            .map(|entry| entry.expect("the folder can be read").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// Returns the MCAP files of a subfolder, sorted.
    pub(crate) fn bag_files(&self, folder: &str) -> Vec<PathBuf> {
        let names = self.list(folder).into_iter().filter(|name| name.ends_with(".mcap"));
        names.map(|name| self.0.path().join(folder).join(name)).collect()
    }

    /// Runs the program in the folder.
    pub(crate) fn lineshaft(&self, args: &[&str]) -> Ended {
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        let output = command.args(args).current_dir(self.0.path()).output();
        let Output { status, stdout, stderr } = output.expect("the program starts");
        let text = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
        Ended { code: status.code(), text }
    }

    /// Plays the scenario that contains every kind of data, records it as `bag` and traces all signals to `run.csv`.
    #[track_caller]
    pub(crate) fn record(&self, bag: &str) -> String {
        self.record_scenario(&root("tests/recording/cell.yaml"), &root("tests/recording/scenario.yaml"), bag)
    }

    /// Plays a scenario and records it as `bag`; returns the bag's path.
    #[track_caller]
    pub(crate) fn record_scenario(&self, cell: &str, scenario: &str, bag: &str) -> String {
        let bag = self.path(bag);
        let csv = self.path("run.csv");
        self.lineshaft(&["sim", cell, "--scenario", scenario, "--record", &bag, "--csv", &csv]).expect_code(0);
        bag
    }

    /// Writes a text file and returns its path.
    pub(crate) fn write(&self, name: &str, text: &str) -> String {
        let path = self.path(name);
        fs::write(&path, text).expect("the temporary folder can be written");
        path
    }
}

/// Number of cycles of `tests/recording/scenario.yaml`.
pub(crate) const CYCLES: u64 = 3000;

/// Checks that rosbag2 reads each file completely by its indexes, in the order of time; returns the number of messages.
#[track_caller]
pub(crate) fn reads_in_time_order<P: AsRef<OsStr>>(files: impl IntoIterator<Item = P>) -> u64 {
    let read = |file: P| {
        let seen = bag_check(["indexed".as_ref(), file.as_ref()]);
        assert_eq!((&seen["finished"], &seen["in_order"]), (&true.into(), &true.into()), "{seen}");
        count(&seen, &["messages"])
    };
    files.into_iter().map(read).sum()
}

/// Returns the count at a path of keys in an observation.
#[track_caller]
pub(crate) fn count(seen: &Value, keys: &[&str]) -> u64 {
    let value = keys.iter().fold(seen, |value, key| &value[key]);
    value.as_u64().unwrap_or_else(|| panic!("no count at {keys:?} in {seen}"))
}
