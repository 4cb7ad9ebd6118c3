//! Runs one homing in the simulation.

use super::Panel;
use lineshaft::cell::Cell;
use lineshaft::scenario::{Options, Scenario, simulate};
use std::path::PathBuf;

/// Distance between two points of a drawn path, in cycles.
const STEP: u64 = 10;

pub(super) fn root() -> PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Path of an axis during homing.
pub(super) struct Path {
    pub start: i64,
    /// Phase, then cycles since the start and positions.
    pub legs: Vec<(usize, Vec<(u64, i64)>)>,
    /// Position of the zero that was found.
    pub zero: i64,
}

/// Plays one method from a start position.
pub(super) fn path(panel: &Panel, start: i64) -> Path {
    let cell = Cell::load(&root().join("launch-configs/homing.yaml")).unwrap_or_else(|problems| panic!("{problems}"));
    let (axis, scheme, method) = (panel.fixtures.axis, panel.scheme.verb(), panel.number);
    let rests = format!("when: {{signal: {axis}.state, is: STANDSTILL}}");
    let text = format!(
        "scenario: drawing\nfor: 12 s\ntrace: [{axis}.actual.count, {axis}.actual.position, {axis}.homing.phase]\n\
         steps:\n  - {{at: 0, do: {{enable: {{axes: [{axis}]}}}}}}\n  - {{{rests}, do: {{move_axis: {{axis: {axis}, units: increments, \
         position: {start}}}}}}}\n  - {{{rests}, after: 100 ms, do: {{home_axis: {{axis: {axis}, scheme: {scheme}, method: {method}}}}}}}\n\
         expect: [{{signal: {axis}.homed, at: end, is: 1}}]\n"
    );
    let scenario = Scenario::parse("drawing", &text, &cell).unwrap_or_else(|problems| panic!("{problems}"));
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("trace.csv");
    let options = Options { csv: Some(csv.clone()), ..Options::default() };
    let report = simulate(&cell, &scenario, &options).expect("a run");
    assert!(report.passed(), "method {method} of {axis} from {start}: {report}");
    read(&std::fs::read_to_string(csv).expect("a trace"), start)
}

/// Parses rows of cycle, count, position, phase.
fn read(csv: &str, start: i64) -> Path {
    let number = |text: &str| text.parse::<i64>().expect("whole numbers");
    let head: Vec<&str> = csv.lines().next().expect("a head").split(',').collect();
    let columns = ["cycle", ".actual.count", ".actual.position", ".homing.phase"]
        .map(|name| head.iter().position(|column| column.ends_with(name)).expect("its column"));
    let rows: Vec<[i64; 4]> = csv
        .lines()
        .skip(1)
        .map(|row| {
            let parts: Vec<&str> = row.split(',').collect();
            columns.map(|place| number(parts[place]))
        })
        .collect();
    let last = rows.last().expect("a trace");
    let mut path = Path { start, legs: Vec::new(), zero: last[1] - last[2] };
    let Some(begin) = rows.iter().position(|row| row[3] != 0) else { return path };
    let end = rows.iter().rposition(|row| row[3] != 0).unwrap_or(begin);
    for row in &rows[begin..=end] {
        let (since, phase) = ((row[0] - rows[begin][0]).unsigned_abs(), usize::try_from(row[3]).expect("a phase"));
        let point = (since, row[1]);
        match path.legs.last_mut() {
            Some((known, points)) if *known == phase => {
                if since % STEP == 0 {
                    points.push(point);
                }
            }
            other => {
                // Legs are connected.
                if let Some((_, points)) = other {
                    points.push(point);
                }
                path.legs.push((phase, vec![point]));
            }
        }
    }
    if let (Some((_, points)), row) = (path.legs.last_mut(), &rows[end]) {
        points.push(((row[0] - rows[begin][0]).unsigned_abs(), row[1]));
    }
    path
}
