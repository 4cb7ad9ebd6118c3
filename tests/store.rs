//! Tests that saved parameters persist: restarts, kills at any moment, damaged files, recordings.
//!
//! `LINESHAFT_LONG=1` kills the program a thousand times.

mod killed;
mod node;
mod restarted;

use crate::support::machine::share;
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use lineshaft::{cell::Cell, store::Store};
use lineshaft_core::parameter::AxisParameters;
use tempfile::TempDir;

/// Returns the path of the cell of all these tests.
fn cell() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs/parameters.yaml")
}

/// A folder with scenarios and stores.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("room for a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        fs::write(self.path(name), text).expect("the folder can be written");
        self.path(name)
    }

    /// Runs `lineshaft sim` with these steps and the store; returns its exit code and its output.
    fn sim(&self, store: &str, steps: &str) -> (Option<i32>, String) {
        let _machine = share();
        let scenario = self.write("scenario.yaml", &format!("scenario: test\nfor: 300 ms\nsteps:\n{steps}"));
        let mut command = lineshaft();
        command.arg("sim").arg(cell()).arg("--scenario").arg(scenario).arg("--store").arg(self.path(store));
        said(&command.output().expect("the program starts"))
    }

    /// Like [`Bench::sim`]; panics unless the scenario passes.
    #[track_caller]
    fn plays(&self, store: &str, steps: &str) -> String {
        let (code, text) = self.sim(store, steps);
        assert_eq!(code, Some(0), "{text}");
        text
    }
}

fn lineshaft() -> Command {
    Command::new(env!("CARGO_BIN_EXE_lineshaft"))
}

fn said(output: &Output) -> (Option<i32>, String) {
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (output.status.code(), text)
}

/// Returns the contents of a store as the library reads it: its generation, and the parameters of line and x at the
/// start.
fn read(path: &Path) -> (u64, AxisParameters, AxisParameters) {
    let mut machine = Cell::load(&cell()).expect("the cell").machine;
    let store = Store::open(path).unwrap_or_else(|error| panic!("{error}"));
    store.load(&mut machine).unwrap_or_else(|error| panic!("{error}"));
    (store.generation(), machine.axes[0].power_on(), machine.axes[1].power_on())
}
