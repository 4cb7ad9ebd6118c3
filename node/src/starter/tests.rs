//! Tests that starters pass, and that they change no other file.

use super::*;
use crate::cell::Cell;
use crate::scenario::{Options, Scenario, simulate};

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Every kind in an otherwise empty folder, with a name other than that of the kind.
#[test]
fn each_starter_passes_alone_in_its_folder() {
    for kind in &KINDS {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("line-2.b.yaml");
        let starter = Starter::new(kind, &file).unwrap();
        starter.write(false).unwrap();
        assert_eq!(names(folder.path()).len(), kind.files.len(), "{}", kind.name);
        let cell = Cell::load(&file).unwrap_or_else(|problems| panic!("{problems}"));
        let scenario = Scenario::load(&starter.paths[1], &cell).unwrap_or_else(|problems| panic!("{problems}"));
        let report = simulate(&cell, &scenario, &Options::default()).unwrap();
        assert!(report.passed(), "{}: {report}", kind.name);
        assert_eq!(report.steps_fired, report.steps, "{}: {report}", kind.name);
        let is_real = cell.backends.iter().any(|backend| !backend.is_simulated());
        assert_eq!(is_real, kind.is_real, "{}", kind.name);
    }
}

/// Each text of the tables is in a file, and no file refers to another one by its old name.
#[test]
fn a_starter_names_its_own_files_only() {
    for kind in &KINDS {
        assert_eq!([kind.files[0].0, kind.files[1].0], [".yaml", ".scenario.yaml"], "{}", kind.name);
        for (from, _) in kind.replaced {
            assert!(kind.files.iter().any(|(_, text)| text.contains(from)), "{}: {from}", kind.name);
        }
        for text in &Starter::new(kind, Path::new("folder/mine.yaml")).unwrap().texts {
            assert!(!text.contains("launch-configs"), "{}: {text}", kind.name);
            for (end, _) in kind.files {
                assert!(!text.contains(&format!("{}{end}", kind.name)), "{}: {end}", kind.name);
            }
        }
    }
}

/// The name of a cell may be one of the replaced texts: nothing is replaced twice.
#[test]
fn a_cell_may_be_called_like_a_kind() {
    let gear = StarterKind::find("gear").unwrap();
    let made = |name: &str| Starter::new(gear, Path::new(name)).unwrap().texts;
    let texts: Vec<_> = gear.files.iter().map(|(_, text)| (*text).to_owned()).collect();
    assert_eq!(made("gear.yaml"), texts);
    assert!(made("my.gear.yaml")[0].contains("lineshaft sim my.gear.yaml --scenario my.gear.scenario.yaml\n"));
}

/// The printed demo is the one that runs, and its description is the file that is written with it.
#[test]
fn the_demo_that_is_printed_is_the_built_in_one() {
    let cell = Cell::parse("demo.yaml", demo(false)).unwrap();
    assert_eq!(cell.machine, Cell::demo().machine);
    assert!(demo(true).contains("scenario: first moves\n"));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("demo.yaml");
    Starter::new(StarterKind::find("DEMO").unwrap(), &file).unwrap().write(false).unwrap();
    assert_eq!(Cell::load(&file).unwrap().robot.map(|robot| robot.text), Cell::demo().robot.map(|robot| robot.text));
}

#[test]
fn an_existing_file_is_replaced_with_force_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let starter = Starter::new(StarterKind::find("cam").unwrap(), &path("m.yaml")).unwrap();
    fs::write(path("m.csv"), "mine").unwrap();
    let sentence = format!("{}: exists already; nothing was written. --force replaces it", path("m.csv").display());
    assert_eq!(starter.write(false), Err(sentence));
    assert_eq!(names(folder.path()), ["m.csv"]);
    assert_eq!(fs::read_to_string(path("m.csv")).unwrap(), "mine");
    starter.write(true).unwrap();
    assert_eq!(names(folder.path()), ["m.csv", "m.scenario.yaml", "m.table.yaml", "m.yaml"]);
    assert!(fs::read_to_string(path("m.csv")).unwrap().starts_with("# form y, 81 points"));
    // A broken symbolic link is an existing file, too.
    std::os::unix::fs::symlink("nowhere", path("n.yaml")).unwrap();
    let starter = Starter::new(StarterKind::find("gear").unwrap(), &path("n.yaml")).unwrap();
    assert!(
        starter.write(false).unwrap_err().ends_with("n.yaml: exists already; nothing was written. --force replaces it")
    );
    assert!(!path("nowhere").exists() && !path("n.scenario.yaml").exists());
}

#[test]
fn a_folder_in_the_way_and_a_folder_that_is_missing_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let gear = StarterKind::find("gear").unwrap();
    let missing = folder.path().join("none/m.yaml");
    for replace in [false, true] {
        let sentence = Starter::new(gear, &missing).unwrap().write(replace).unwrap_err();
        assert!(sentence.ends_with("none/m.yaml: its folder does not exist; nothing was written"), "{sentence}");
    }
    fs::create_dir(folder.path().join("m.scenario.yaml")).unwrap();
    let sentence = Starter::new(gear, &folder.path().join("m.yaml")).unwrap().write(true).unwrap_err();
    assert!(sentence.ends_with("m.scenario.yaml: is a folder; nothing was written"), "{sentence}");
    assert_eq!(names(folder.path()), ["m.scenario.yaml"]);
}

#[test]
fn a_name_that_no_cell_may_have_is_refused() {
    let said = |name: &str| Starter::new(&KINDS[0], Path::new(name)).unwrap_err();
    let suffix = ": the file of a cell must end in .yaml, such as machine.yaml";
    for name in ["machine", "machine.yml", ".yaml", "folder/", "", ".."] {
        assert_eq!(said(name), format!("{name}{suffix}"));
    }
    assert_eq!(said("a.scenario.yaml"), "a.scenario.yaml: is the name of a scenario; give that of the cell, a.yaml");
    let signs = ": the name must be a letter or digit, then letters, digits, `_`, `-` and `.`";
    for name in ["a b.yaml", "-a.yaml", "a:b.yaml", "a#.yaml", "[a].yaml"] {
        assert_eq!(said(name), format!("{name}{signs}"));
    }
}

#[test]
fn a_kind_is_found_in_capitals_or_not() {
    assert_eq!(StarterKind::find("Gear").map(|kind| kind.name), Some("gear"));
    assert!(StarterKind::find("gears").is_none());
    let names: std::collections::BTreeSet<_> = KINDS.iter().map(|kind| kind.name).collect();
    assert_eq!(names.len(), KINDS.len());
}
