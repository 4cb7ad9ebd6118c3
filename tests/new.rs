//! Tests `lineshaft new` and `lineshaft demo`, with which a user starts from the program alone.

use crate::support::machine::share;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs the program in `folder`.
fn lineshaft(folder: &Path, arguments: &[&str]) -> Output {
    let _machine = share();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lineshaft"));
    command.args(arguments).current_dir(folder).env("ROS_HOME", folder).output().expect("the program starts")
}

/// Returns exit code, standard output and standard error.
fn said(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = lineshaft(folder, arguments);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status.code().expect("it ended by itself"), text(output.stdout), text(output.stderr))
}

/// Every kind in its own folder: the printed commands succeed, and no file is missing.
#[test]
fn each_new_cell_is_good_and_its_scenario_passes() {
    let (code, list, _) = said(Path::new("."), &["new", "--list"]);
    let kinds: Vec<_> = list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(code, 0);
    assert_eq!(kinds, ["demo", "can", "gantry", "cam", "gear", "register", "arm6", "function", "winder"]);
    for kind in kinds {
        let folder = tempfile::tempdir().unwrap();
        let (code, text, problems) = said(folder.path(), &["new", kind, "mine.yaml"]);
        assert_eq!((code, problems.as_str()), (0, ""), "{kind}");
        assert!(text.starts_with("wrote mine.yaml\nwrote mine.scenario.yaml\n"), "{text}");
        for file in fs::read_dir(folder.path()).unwrap() {
            let name = file.unwrap().file_name().into_string().unwrap();
            assert!(text.contains(&format!("wrote {name}\n")), "{kind}: {name}");
        }
        let (_, next) = text.split_once("\nnext:\n").expect("what to type next");
        let next: Vec<_> = next.lines().map(str::trim).collect();
        let run = if kind == "can" { "lineshaft run mine.yaml --sim" } else { "lineshaft run mine.yaml" };
        assert_eq!(next, ["lineshaft check mine.yaml", "lineshaft sim mine.yaml --scenario mine.scenario.yaml", run]);
        // The file of the drive does not exist yet.
        let warns = |problems: &str| {
            kind == "can"
                && problems.lines().count() == 1
                && problems.starts_with("warning: mine.yaml:")
                && problems.contains(": x: switches at the drive (node 1) are not read, so limit switches there cannot")
        };
        for command in &next[..2] {
            let arguments: Vec<_> = command.split(' ').skip(1).collect();
            let (code, text, problems) = said(folder.path(), &arguments);
            let is_good = problems.is_empty() || arguments[0] == "check" && warns(&problems);
            assert!(code == 0 && is_good, "{kind}: {command}: {text}{problems}");
        }
        let (code, text, problems) = said(folder.path(), &["check", "mine.yaml", "--scenario", "mine.scenario.yaml"]);
        assert!(code == 0 && (problems.is_empty() || warns(&problems)), "{kind}: {text}{problems}");
    }
}

/// The numbers of the cam must be those that `lineshaft table make` makes from the description that is written with
/// them.
#[test]
fn the_table_of_a_new_cam_is_made_of_its_description() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(said(folder.path(), &["new", "cam", "cam.yaml"]).0, 0);
    assert_eq!(said(folder.path(), &["table", "make", "cam.table.yaml", "-o", "again.csv"]).0, 0);
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("cam.csv") == read("again.csv"), "launch-configs/new/cam.csv is not made of cam.table.yaml");
}

#[test]
fn a_new_cell_never_overwrites_a_file_without_force() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    fs::write(folder.path().join("m.scenario.yaml"), "mine\n").unwrap();
    let sentence = "error: m.scenario.yaml: exists already; nothing was written. --force replaces it\n";
    assert_eq!(said(folder.path(), &["new", "gear", "m.yaml"]), (2, String::new(), sentence.to_owned()));
    assert!(file("m.scenario.yaml") == "mine\n" && !folder.path().join("m.yaml").exists());
    assert_eq!(said(folder.path(), &["new", "gear", "m.yaml", "--force"]).0, 0);
    assert!(file("m.scenario.yaml").contains("scenario: two rollers follow the line"));
}

#[test]
fn a_new_cell_that_cannot_be_written_is_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let cases: [(&[&str], &str); 6] = [
        (&["new", "none/m.yaml"], "none/m.yaml: its folder does not exist; nothing was written"),
        (
            &["new", "gear", "file/m.yaml"],
            "file/m.yaml: cannot be written: Not a directory (os error 20); nothing was written",
        ),
        (&["new", "gear"], "the file is missing: `lineshaft new gear gear.yaml`"),
        (
            &["new", "gaer", "m.yaml"],
            "kind `gaer` is unknown, allowed: demo, can, gantry, cam, gear, register, arm6, function, winder; did you mean `gear`?",
        ),
        (&["new", "machine"], "machine: the file of a cell must end in .yaml, such as machine.yaml"),
        (
            &["new", "my cell.yaml"],
            "my cell.yaml: the name must be a letter or digit, then letters, digits, `_`, `-` and `.`",
        ),
    ];
    for (arguments, sentence) in cases {
        assert_eq!(said(folder.path(), arguments), (2, String::new(), format!("error: {sentence}\n")), "{arguments:?}");
    }
    let (code, _, problems) = said(folder.path(), &["new"]);
    assert!(code == 2 && problems.contains("lineshaft new --list"), "{problems}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// `lineshaft demo` prints a cell, and its scenario passes with it.
#[test]
fn the_demo_can_be_printed_and_used() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, name) in [(&["demo"][..], "demo.yaml"), (&["demo", "--scenario"][..], "demo.scenario.yaml")] {
        let (code, text, problems) = said(folder.path(), arguments);
        assert_eq!((code, problems.as_str()), (0, ""));
        fs::write(folder.path().join(name), text).unwrap();
    }
    let (code, text, problems) = said(folder.path(), &["sim", "demo.yaml", "--scenario", "demo.scenario.yaml"]);
    assert_eq!((code, problems.as_str()), (0, ""), "{text}");
}
