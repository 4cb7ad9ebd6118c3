//! Tests homing of the example cells.

use super::*;
use std::path::PathBuf;

/// Axes that the simulation cannot home: their drives home by themselves, and no switch is simulated for them.
const IN_DRIVE: [&str; 2] = ["can/epos4.yaml x", "can/mixed.yaml x"];

/// Returns all cells of a folder and of its subfolders: files with a section `axes`.
fn cells(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(cells(&path));
        } else if path.extension().is_some_and(|extension| extension == "yaml")
            && std::fs::read_to_string(&path).unwrap().lines().any(|line| line.starts_with("axes:"))
        {
            found.push(path);
        }
    }
    found
}

/// Homes the axis; the command position in each cycle from zero on must be within its software limits.
fn homes_within_limits(cell: &Cell, axis: &str, [min, max]: [Option<i64>; 2]) {
    let bound = |key: &str, limit: Option<i64>| limit.map_or(String::new(), |limit| format!(", {key}: {limit} inc"));
    let text = format!(
        "
scenario: homing of {axis}
for: 30 s
steps:
  - {{at: 0, do: {{enable: {{axes: [{axis}]}}}}}}
  - {{name: home, when: {{signal: {axis}.state, is: STANDSTILL}}, do: {{home_axis: {{axis: {axis}}}}}}}
  - {{name: homed, when: {{all: [{{signal: {axis}.homed, is: 1}}, {{signal: {axis}.state, is: STANDSTILL}}]}},
     do: {{halt: {{axes: [{axis}]}}}}}}
expect:
  - {{signal: {axis}.command.position, since: homed, from: 0{}{}}}
",
        bound("min", min),
        bound("max", max)
    );
    let scenario = Scenario::parse("homing.yaml", &text, cell).unwrap_or_else(|problems| panic!("{problems}"));
    let report = simulate(cell, &scenario, &Options::default()).unwrap();
    assert!(report.passed(), "{axis}: {report}");
}

#[test]
fn every_axis_of_the_examples_is_within_its_software_limits_after_homing() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../launch-configs");
    let (mut homed, mut in_drive) = (Vec::new(), Vec::new());
    for path in cells(&folder) {
        let cell = Cell::load(&path).unwrap_or_else(|problems| panic!("{problems}"));
        for axis in &cell.machine.axes {
            let parameters = &axis.parameters;
            let name = format!("{} {}", path.strip_prefix(&folder).unwrap().display(), axis.name);
            if parameters.homing.in_drive {
                in_drive.push(name);
            } else if parameters.homing.method != 0
                && (parameters.min_position.is_some() || parameters.max_position.is_some())
            {
                homes_within_limits(&cell, &axis.name, [parameters.min_position, parameters.max_position]);
                homed.push(name);
            }
        }
    }
    homed.sort();
    in_drive.sort();
    assert_eq!(
        homed,
        ["can/drive.yaml x", "demo.yaml x", "demo.yaml y", "new/gantry.yaml portal", "shaft/04_gantry.yaml portal"]
    );
    assert_eq!(in_drive, IN_DRIVE);
}
