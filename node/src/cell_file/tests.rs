//! Tests edited cells.

use super::*;
use crate::tune::{Gain, by_hand, settings};
use proptest::prelude::*;

const CELL: &str = "\
# A cell with remarks.
lineshaft: 1
cycle: 1 ms

backends:
  plant: {type: sim}

axes:
  # The first one.
  x:
    type: rotary
    unit: rev
    scale: {increments: 2000, per: 1 rev} # ENCODER 500
    drive: {backend: plant, address: 0, interface: velocity, regulator: pid}
    max_velocity: 3000 rpm # VELMAX
    max_acceleration: 400 rev/s^2
    kprop: 30   # as it came
    ffvel: 1000
    sim: {model: velocity, time_constant: 2 ms}

  y:
    {type: rotary, unit: rev, scale: {increments: 2000, per: 1 rev}, max_velocity: 3000 rpm, max_acceleration: 400 rev/s^2,
     drive: {backend: plant, address: 1, interface: velocity}, position_loop: {kv: 20}, sim: {model: velocity}}
";

fn gain(key: &'static str, new: f64) -> Gain {
    Gain { key, old: None, new }
}

fn edit(text: &str, axis: &str, gains: &[Gain]) -> Result<(String, Vec<Setting>), EditError> {
    let Edited { text, cell, written } = edited(Path::new("cell.yaml"), text, &settings(axis, gains)?)?;
    assert_eq!(cell.text, text);
    Ok((text, written))
}

#[track_caller]
fn refused(text: &str, axis: &str, gains: &[Gain], sentence: &str) {
    assert_eq!(edit(text, axis, gains).unwrap_err().to_string(), sentence);
}

const GAINS: [Gain; 4] = [
    Gain { key: "kprop", old: Some(30.0), new: 131.0 },
    Gain { key: "kder", old: Some(0.0), new: 772.0 },
    Gain { key: "ffvel", old: Some(1000.0), new: 1000.0 },
    Gain { key: "timer", old: Some(1.0), new: 1.0 },
];

#[test]
fn gains_that_are_others_are_written_and_nothing_else() {
    let (text, written) = edit(CELL, "x", &GAINS).unwrap();
    let expected = CELL.replace("kprop: 30 ", "kprop: 131 ").replace("ffvel: 1000\n", "ffvel: 1000\n    kder: 772\n");
    assert_eq!(text, expected);
    assert_eq!(written.iter().map(|gain| gain.key).collect::<Vec<_>>(), ["kprop", "kder"]);
    let axis = &Cell::parse("c", text).unwrap().machine.axes[0].parameters;
    assert_eq!((axis.pid.proportional, axis.pid.derivative, axis.pid.velocity), (131, 772, 1000));
}

/// A new line changes the locations in the warnings about such numbers.
#[test]
fn cell_with_number_without_unit_is_edited() {
    let bare = CELL.replace("max_velocity: 3000 rpm, ", "max_velocity: 300, ");
    assert_eq!(Cell::parse("c", bare.as_str()).unwrap().bare_numbers.len(), 1);
    let (text, _) = edit(&bare, "x", &GAINS).unwrap();
    assert!(text.contains("    kder: 772\n") && text.contains("max_velocity: 300, "), "{text}");
}

#[test]
fn a_servo_gain_is_written_in_its_section() {
    let (text, _) = edit(CELL, "y", &[gain("position_loop.kv", 72.45)]).unwrap();
    assert_eq!(text, CELL.replace("{kv: 20}", "{kv: 72.45}"));
    let without = CELL.replace("position_loop: {kv: 20}, ", "");
    let (text, _) = edit(&without, "y", &[gain("position_loop.kv", 72.45)]).unwrap();
    assert_eq!(text, without.replace("velocity}}\n", "velocity}, position_loop.kv: 72.45}\n"));
    assert_eq!(Cell::parse("c", text).unwrap().machine.axes[1].parameters.position_loop.kv, 72.45);
}

#[test]
fn another_view_of_the_value_is_refused_with_its_line() {
    let with_view = CELL.replace("position_loop: {kv: 20}", "wf: {md22: 2}");
    refused(
        &with_view,
        "y",
        &[gain("position_loop.kv", 72.45)],
        "cell.yaml, line 23: wf.md22 gives the same value as position_loop.kv; take it out first",
    );
}

#[test]
fn a_shared_axis_is_refused_with_its_line() {
    let shared = "lineshaft: 1\ncycle: 1 ms\nbackends: {plant: {type: sim}}\naxes:\n  x:\n    type: rotary\n    unit: rev\n    \
                  scale: {increments: 2000, per: 1 rev}\n    drive: {backend: plant, address: 0, interface: velocity, regulator: pid}\n    \
                  max_velocity: 3000 rpm\n    max_acceleration: 400 rev/s^2\n    kprop: &k 30\n    kint: *k\n";
    refused(
        shared,
        "x",
        &[gain("kprop", 131.0)],
        "cell.yaml, line 12: what stands here has an anchor and is repeated elsewhere, where it would change, too",
    );
    refused(
        shared,
        "x",
        &[gain("kint", 3.0)],
        "cell.yaml, line 13: an alias stands here; what it repeats belongs to other places, too",
    );
    assert_eq!(
        by_hand(&[gain("kprop", 131.0), gain("position_loop.kv", 7.5)]),
        "    kprop: 131\n    position_loop.kv: 7.5\n"
    );
}

#[test]
fn what_no_cell_takes_is_refused() {
    refused(CELL, "z", &GAINS, "cell.yaml has no axis z");
    refused(CELL, "x", &[gain("kprop", 1e9)], "kprop is 1000000000, which no cell takes");
    refused(CELL, "x", &[gain("kprop", 1.5)], "kprop is 1.5, which no cell takes");
    refused(CELL, "x", &[gain("kpropp", 1.0)], "kpropp is 1, which no cell takes");
    refused(
        &format!("{CELL}nonsense: 1\n"),
        "x",
        &GAINS,
        "cell.yaml is no cell without errors; lineshaft check says more",
    );
    refused(
        &format!("{CELL}---\n{CELL}"),
        "x",
        &GAINS,
        "cell.yaml is no cell without errors; lineshaft check says more",
    );
    // A gain of another control law would make the cell invalid.
    refused(
        CELL,
        "y",
        &[gain("kder", 5.0)],
        "with these values the cell has errors; nothing is written\n\
         cell.yaml:23:119: kder is for axes with interface velocity, torque or voltage and regulator pid, leave it out\n",
    );
}

#[test]
fn cells_are_compared_by_what_they_say() {
    let cell = |text: &str| Cell::parse("c", text).unwrap();
    let same = |text: String| is_same(&cell(&text), &cell(CELL));
    assert!(same(CELL.replace("# A cell with remarks.", "# Another remark.")));
    assert!(same(CELL.replace("3000 rpm", "50 rev/s")));
    assert!(!same(CELL.replace("kprop: 30", "kprop: 31")));
    assert!(!same(CELL.replace("{kv: 20}", "{kv: 21}")));
    assert!(!same(CELL.replace("time_constant: 2 ms", "time_constant: 3 ms")));
}

#[test]
fn a_file_is_replaced_whole_with_its_permissions_through_a_link() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (path, link) = (folder.path().join("cell.yaml"), folder.path().join("link.yaml"));
    let text = CELL.replace('\n', "\r\n");
    fs::write(&path, &text).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("cell.yaml", &link).unwrap();
    assert_eq!(apply(&link, &text, &settings("x", &GAINS).unwrap()).unwrap().written.len(), 2);
    let expected = text.replace("kprop: 30 ", "kprop: 131 ").replace("1000\r\n", "1000\r\n    kder: 772\r\n");
    assert_eq!(fs::read_to_string(&path).unwrap(), expected);
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    // The second time nothing changes.
    assert_eq!(crate::tune::apply(&path, &expected, "x", &GAINS), Ok(Vec::new()));
}

#[test]
fn a_file_that_has_changed_meanwhile_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.yaml");
    fs::write(&path, "new").unwrap();
    let refused = replace(&path, "old", "edited").unwrap_err();
    assert!(matches!(refused, EditError::Changed { .. }));
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    fs::write(&path, CELL).unwrap();
    let since = apply(&path, &CELL.replace("3000 rpm", "2000 rpm"), &settings("x", &GAINS).unwrap()).unwrap_err();
    assert!(matches!(since, EditError::Changed { .. }), "since the trial");
    assert_eq!(fs::read_to_string(&path).unwrap(), CELL);
    let missing = apply(&folder.path().join("none.yaml"), CELL, &settings("x", &GAINS).unwrap()).unwrap_err();
    assert!(matches!(missing, EditError::Cell { .. }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// For any gains, the cell has them, and as many comments as before.
    #[test]
    fn cell_has_the_requested_values(kprop in 0..65_000_i64, kder in 0..65_000_i64, kint in 0..65_000_i64, timer in 1..1000_i64) {
        let wanted = [("kprop", kprop), ("kder", kder), ("kint", kint), ("timer", timer)];
        let gains = wanted.map(|(key, value)| gain(key, value as f64));
        let (text, _) = edit(CELL, "x", &gains).unwrap();
        prop_assert_eq!(text.matches('#').count(), CELL.matches('#').count());
        let pid = Cell::parse("c", text).unwrap().machine.axes[0].parameters.pid;
        prop_assert_eq!((pid.proportional, pid.derivative, pid.integral, pid.period_ms), (kprop, kder, kint, timer));
    }
}
