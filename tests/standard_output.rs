//! Tests errors of standard output: a full disk is reported with exit code 1, a closed pipe ends a command without a
//! message.

use crate::support::machine::share;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Commands that print and need neither a bus nor ROS; the files that they read are in the folder of [`Bench`].
const PRINT: [&str; 44] = [
    "--help",
    "--version",
    "help",
    "run --help",
    "can --help",
    "can sdo read --help",
    "check demo.yaml",
    "check demo.yaml --scenario first_move.yaml",
    "check demo.yaml --preset amkasyn",
    "signals demo.yaml",
    "params",
    "params --name max_velocity",
    "params --markdown",
    "params demo.yaml",
    "params demo.yaml --changed",
    "params demo.yaml --export",
    "params demo.yaml --import p.yaml",
    "limits demo.yaml",
    "limits demo.yaml --from limits.yaml",
    "functions",
    "functions varsync",
    "functions sak --cycle 0.002 --gain 1000",
    "functions --markdown",
    "interfaces",
    "interfaces MoveAxis",
    "interfaces --markdown",
    "sim demo.yaml --scenario first_move.yaml",
    "sim demo.yaml --scenario first_move.yaml --events",
    "bag info a.mcap",
    "replay a.mcap",
    "validate a.mcap --against a.mcap",
    "plot a.mcap --signals x.* --output x.svg",
    "tune torque.yaml x",
    "table make knife.yaml --output knife.csv",
    "table check knife.yaml",
    "program new speed",
    "completions bash",
    "demo",
    "explain 10205",
    "new gear made.yaml",
    "schema cell",
    "check demo.yaml --json",
    "program check copy.wasm",
    "program run copy.wasm in.csv",
];

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// A folder with one file of each kind that a command reads.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().expect("a folder"));
        for (from, to) in [
            ("launch-configs/demo.yaml", "demo.yaml"),
            ("launch-configs/scenarios/first_move.yaml", "first_move.yaml"),
            ("launch-configs/torque.yaml", "torque.yaml"),
            ("launch-configs/functions/tables/knife.yaml", "knife.yaml"),
            ("program/tests/modules/template.wasm", "copy.wasm"),
        ] {
            fs::copy(root(from), bench.path(to)).unwrap_or_else(|error| panic!("{from}: {error}"));
        }
        fs::write(bench.path("p.yaml"), "x.max_velocity: 0.8 m/s\n").expect("written");
        fs::write(bench.path("in.csv"), "inputs,source\n1,100\n").expect("written");
        let limits = bench.run("limits demo.yaml", Stdio::piped());
        fs::write(bench.path("limits.yaml"), limits.stdout).expect("written");
        bench.run("sim demo.yaml --scenario first_move.yaml --record a.mcap", Stdio::piped());
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, line: &str, stdout: Stdio) -> Output {
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.args(line.split(' ')).current_dir(&self.0).env("ROS_HOME", self.0.path());
        command
            .stdout(stdout)
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts")
            .wait_with_output()
            .expect("it ends")
    }

    /// Removes the output of `program new` and `new`, so that they can run again.
    fn clear(&self) {
        let _ = fs::remove_dir_all(self.path("speed"));
        for name in ["made.yaml", "made.scenario.yaml"] {
            let _ = fs::remove_file(self.path(name));
        }
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn full_disk_gives_one_sentence_and_exit_code_1_for_every_command_that_prints() {
    let bench = Bench::new();
    for line in PRINT {
        let usual = bench.run(line, Stdio::piped());
        bench.clear();
        assert!(usual.status.success() && !usual.stdout.is_empty(), "{line}: {}", text(&usual.stderr));
        let full = File::options().write(true).open("/dev/full").expect("every Linux has it");
        let output = bench.run(line, full.into());
        bench.clear();
        let expected = format!(
            "{}error: cannot write standard output: No space left on device (os error 28)\n",
            text(&usual.stderr)
        );
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(1), expected), "{line}");
    }
}

#[test]
fn closed_pipe_ends_every_command_quietly_with_its_usual_exit_code() {
    let bench = Bench::new();
    for line in PRINT {
        let usual = bench.run(line, Stdio::piped());
        bench.clear();
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = bench.run(line, writer.into());
        bench.clear();
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), text(&usual.stderr)), "{line}");
    }
}

/// A failed command keeps its exit code: 2 is a bad file, even if its report could not be written.
#[test]
fn failed_command_keeps_its_exit_code_on_a_full_disk() {
    let bench = Bench::new();
    let scenario = fs::read_to_string(bench.path("first_move.yaml")).expect("a scenario");
    fs::write(bench.path("bad.yaml"), format!("{scenario}\nunknown: 1\n")).expect("written");
    let full = File::options().write(true).open("/dev/full").expect("every Linux has it");
    let output = bench.run("check demo.yaml --scenario bad.yaml", full.into());
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("unknown key `unknown`") && said.contains("cannot write standard output: "), "{said}");
}

/// As in `lineshaft check bad.yaml 2>&1 | head -1`.
#[test]
fn closed_standard_error_keeps_the_exit_code() {
    let _machine = share();
    let folder = tempfile::tempdir().expect("a folder");
    for line in ["check none.yaml", "signals none.yaml", "params --name velmx", "replay none.mcap", "chekc"] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.args(line.split(' ')).current_dir(folder.path()).stdout(Stdio::null()).stderr(writer);
        assert_eq!(command.status().expect("the program starts").code(), Some(2), "{line}");
    }
}

/// A new command has to be added to [`PRINT`], or here with the reason.
#[test]
fn every_command_of_the_help_is_tried() {
    // `run` prints a report only after a scenario in real time; `can` needs a bus, the next ones a node; `man` prints
    // nothing.
    let other = ["run", "can", "state", "enable", "disable", "reset", "home", "halt", "move", "jog", "activate", "man"];
    let help = text(&Bench::new().run("--help", Stdio::piped()).stdout);
    let commands = help.split("Commands:\n").nth(1).and_then(|rest| rest.split("\n\n").next()).expect("a list");
    // Lines of longer descriptions have a deeper indent.
    let names = commands.lines().filter_map(|line| line.strip_prefix("  ").filter(|line| !line.starts_with(' ')));
    let names: BTreeSet<_> = names.filter_map(|line| line.split(' ').next()).collect();
    let tried: BTreeSet<_> = PRINT.iter().filter_map(|line| line.split(' ').next()).chain(other).collect();
    let missing: Vec<_> = names.difference(&tried).collect();
    assert!(names.len() > 10 && missing.is_empty(), "{missing:?} of {names:?}");
}
