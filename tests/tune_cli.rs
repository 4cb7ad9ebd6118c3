//! Tests `lineshaft tune` on the command line: its messages, drawings, files and exit codes.

use crate::support::machine::share;
use std::path::Path;
use std::process::{Command, Output};

const CELL: &str = include_str!("../launch-configs/torque.yaml");

/// A folder with a cell.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new(cell: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("cell.yaml"), cell).expect("written");
        Self(folder)
    }

    fn run(&self, line: &[&str]) -> Output {
        let _machine = share();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
        command.args(line).current_dir(&self.0);
        command.output().expect("the program starts")
    }

    fn tune(&self, more: &[&str]) -> (Option<i32>, String, String) {
        let output = self.run(&[&["tune", "cell.yaml"], more].concat());
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    }

    fn cell(&self) -> String {
        std::fs::read_to_string(self.path("cell.yaml")).expect("the cell")
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        Path::new(self.0.path()).join(name)
    }
}

/// Gains are printed, drawn, and written on request; a second run finds the same gains, and nothing new to write.
#[test]
fn gains_are_found_drawn_and_written() {
    let bench = Bench::new(CELL);
    let (code, first, complaints) = bench.tune(&["x", "--output", "x.svg", "--record", "x.mcap"]);
    assert_eq!((code, complaints.as_str()), (Some(0), ""), "{first}");
    for part in ["axis x, 65536 inc in 1 rev", "acceleration at full command", "phase margin", "velkprop", "x.svg"] {
        assert!(first.contains(part), "{part}: {first}");
    }
    assert!(std::fs::read_to_string(bench.path("x.svg")).expect("a figure").starts_with("<svg"));
    assert_eq!(bench.cell(), CELL, "nothing is written unasked");
    let replayed = bench.run(&["replay", "x.mcap"]);
    assert_eq!(replayed.status.code(), Some(0), "{replayed:?}");

    let (code, said, complaints) = bench.tune(&["x", "--apply"]);
    assert_eq!((code, complaints.as_str()), (Some(0), ""), "{said}");
    let written = bench.cell();
    assert!(said.contains("cell.yaml: ") && said.contains("written for x"), "{said}");
    assert_ne!(written, CELL);
    assert_eq!(written.lines().next(), CELL.lines().next());
    assert!(written.contains("# the output 1 of the position loop, and the error 1 of the velocity loop"));
    assert_eq!(bench.run(&["check", "cell.yaml"]).status.code(), Some(0));
    let (code, again, _) = bench.tune(&["x", "--apply"]);
    assert_eq!(code, Some(0));
    assert!(again.contains("nothing new written"), "{again}");
    assert_eq!(bench.cell(), written);
}

#[test]
fn errors_are_reported_before_any_motion() {
    let bench = Bench::new(CELL);
    for (line, code, part) in [
        (&["y"][..], 2, "no axis is called `y`; there are x"),
        (&["x", "--travel", "3 furlongs"], 2, "--travel: "),
        (&["x", "--travel", "1 inc"], 2, "x: travel is 1 inc; 100 to"),
        (&["x", "--velocity", "60 rev/s"], 2, "x: velocity is 3932160 inc/s"),
        (&["x", "--effort", "2"], 2, "x: effort is 2 of the largest effort; 0.01 to 1"),
        (&["x", "--duration", "1 h"], 2, "duration"),
        (
            &["x", "--inertia-ratio", "-1"],
            2,
            "x: inertia_ratio is -1; 0 to 1000 times the inertia of the motor is allowed",
        ),
        (&["x", "--inertia-ratio", "NaN"], 2, "x: inertia_ratio is NaN; 0 to 1000"),
        (&["x", "--output", "x.gif"], 2, "x.gif"),
    ] {
        let (found, said, complaints) = bench.tune(line);
        assert_eq!((found, said.as_str()), (Some(code), ""), "{line:?}: {complaints}");
        assert!(complaints.contains(part), "{line:?}: {complaints}");
    }
    assert_eq!(bench.cell(), CELL);
}

/// Backlash in the coupling of an axis: the message names the option, and with the option gains are found.
#[test]
fn play_asks_for_the_ratio_of_inertias() {
    let bench = Bench::new(include_str!("../launch-configs/play.yaml"));
    let (code, said, _) = bench.tune(&["x", "--velocity", "4 rev/s"]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("there is play before the load") && said.contains("--inertia-ratio"), "{said}");
    let (code, said, complaints) = bench.tune(&["x", "--velocity", "4 rev/s", "--inertia-ratio", "3"]);
    assert_eq!((code, complaints.as_str()), (Some(0), ""), "{said}");
    assert!(said.contains("told to have 3 times the inertia of the motor"), "{said}");
}

#[test]
fn an_axis_without_gains_ends_with_a_sentence() {
    // Half of the torque that its friction requires.
    let bench = Bench::new(&CELL.replace("static_friction: 0.03 Nm", "static_friction: 2 Nm"));
    let (code, _, complaints) = bench.tune(&["x"]);
    assert_eq!(code, Some(1), "{complaints}");
    assert!(complaints.contains("x: the axis does not move at a command of "), "{complaints}");
    let bench = Bench::new(&CELL.replace("interface: torque, regulator: pid", "interface: position"));
    let (code, _, complaints) = bench.tune(&["x"]);
    assert_eq!(code, Some(2), "{complaints}");
}
