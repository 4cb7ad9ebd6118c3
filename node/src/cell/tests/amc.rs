//! Tests the keys of the reference selector.

use super::{HEAD, good, said};
use lineshaft_core::object::{Leader, Object};

const SOME: &str = "io:\n  mark: {type: di, backend: plant, address: 0, latch: true}\n  plain: {type: di, backend: plant, address: 1}\n  lamp: {type: do, backend: plant, address: 0}\nencoders:\n  belt: {backend: plant, address: 0, type: linear, scale: {increments: 1, per: 1 mm}}\n";

/// Returns a cell with two linear axes `x` and `y` and a virtual `line`, with keys for x and y; x is in line 13, y in
/// line 14.
fn cell(x: &str, y: &str) -> String {
    let axis = |name, address, keys: &str| {
        let drive = format!("{{backend: plant, address: {address}}}");
        let scale = "{increments: 1000, per: 1 mm}";
        let rates = "max_velocity: 1 m/s, max_acceleration: 1 m/s^2";
        let comma = if keys.is_empty() { "" } else { ", " };
        format!("  {name}: {{{keys}{comma}unit: mm, type: linear, drive: {drive}, scale: {scale}, {rates}}}\n")
    };
    let line = "  line: {type: linear, drive: virtual, scale: {increments: 1000, per: 1 mm}, max_velocity: 1 m/s, max_acceleration: 1 m/s^2}\n";
    format!("{HEAD}{SOME}axes:\n{}{}{line}", axis("x", 0, x), axis("y", 1, y))
}

#[test]
fn master_and_freeze_are_resolved() {
    for (master, leader) in [
        ("belt", Leader::Encoder(0)),
        ("line", Leader::AxisCommand(2)),
        ("y.command", Leader::AxisCommand(1)),
        ("x.actual", Leader::AxisActual(0)),
    ] {
        let cell = good(&cell(&format!("amc: {{master: {master}}}"), ""));
        assert_eq!(cell.machine.axes[0].vocabularies.amc.master, Some(leader), "{master}");
    }
    for (freeze, object) in [("mark", Object::Io(0)), ("belt", Object::Encoder(0)), ("y", Object::Axis(1))] {
        let cell = good(&cell(&format!("amc.freeze: {freeze}"), ""));
        assert_eq!(cell.machine.axes[0].vocabularies.amc.freeze, Some(object), "{freeze}");
    }
}

#[test]
fn what_cannot_lead_or_latch_is_refused() {
    for (keys, expected) in [
        (
            "amc: {master: mark}",
            "13:21: master is `mark`, which is an input or output; axis, encoder, master is allowed",
        ),
        ("amc: {master: y.target}", "13:21: master is `y.target`; `y`, `y.command` or `y.actual` is allowed"),
        ("amc: {master: belt.velocity}", "13:21: master is `belt.velocity`; `belt` is allowed"),
        ("amc: {freeze: plain}", "13:21: freeze is `plain`, which does not latch, give it `latch: true`"),
        ("amc: {freeze: lamp}", "13:21: freeze is `lamp`, which is no digital input"),
        ("amc: {freeze: line}", "13:21: freeze is `line`, which has no drive to latch"),
    ] {
        assert_eq!(said(&cell(keys, "")), expected);
    }
    let twice = said(&cell("amc: {master: belt}, amc.master: belt", ""));
    assert!(twice.contains("amc.master stands in section amc too"), "{twice}");
}

#[test]
fn masters_that_close_a_loop_are_refused_and_an_actual_position_closes_none() {
    let expected = "14:21: reference selectors follow each other's axes in a loop: y -> x -> y, follow `x.actual`";
    assert_eq!(said(&cell("amc: {master: y}", "amc: {master: x}")), expected);
    assert!(said(&cell("amc: {master: x}", "")).contains("in a loop: x -> x"));
    good(&cell("amc: {master: y}", "amc: {master: x.actual}"));
}

#[test]
fn parameters_that_do_not_fit_the_axis_are_refused_where_they_stand() {
    for (keys, expected) in [
        (
            "amc: {reference_select: 3}",
            "13:31: amc.reference_select 3 follows a master; give `amc: {master: ..}` in the cell",
        ),
        (
            "amc: {reference_select: 3, master: belt}",
            "13:31: amc.reference_select 3 follows a master by a table; give `amc: {cam: ..}` in the cell",
        ),
        ("amc: {cam: knive}", "13:18: cam is `knive`; no table has that name, there is none"),
        (
            "amc: {reference_select: 4}",
            "13:31: amc.reference_select 4 follows a master; give `amc: {master: ..}` in the cell",
        ),
        (
            "amc: {action_on_event: 2, master: belt}",
            "13:30: amc.action_on_event 2 waits for a latch; give `amc: {freeze: ..}` in the cell",
        ),
        ("amc: {speed_reference: -2 m/s}", "13:30: velocity 2000 mm/s exceeds max_velocity 1000 mm/s"),
        (
            "amc: {reference_select_trigger: 1}",
            "13:39: amc.reference_select_trigger is 0 when the machine starts, leave it out",
        ),
        ("amc: {stop_mode: 4}", "13:24: amc.stop_mode is `4`; 0 to 3 is allowed"),
    ] {
        assert_eq!(said(&cell(keys, "")), expected);
    }
}

#[test]
fn a_table_that_is_no_cam_is_refused_where_it_is_named() {
    let with = |table: &str| format!("{}tables:\n  t: {table}\n", cell("amc: {cam: t}", ""));
    for (table, sentence) in [
        ("{form: words, words: [1, 2]}", "cam is `t`: words of a data block are no cam; form y and form xy are"),
        (
            "{form: y, points: [0, 5]}",
            "cam is `t`: a cam of form y has no length; its length in increments of the master is needed",
        ),
        ("{form: xy, points: [[1, 0], [5, 5]]}", "cam is `t`: point 1 of a cam is at 1; the first is at 0"),
    ] {
        let said = said(&with(table));
        assert!(said.starts_with("13:18: ") && said.contains(sentence), "{said}");
    }
    good(&with("{form: xy, points: [[0, 0], [5, 5]]}"));
}

/// Numbers without unit are user units: mm, and mm per ms.
///
/// Proves: AMC-PAR-03, AMC-PAR-06
#[test]
fn bare_numbers_are_user_units() {
    let cell = good(&cell("amc: {position_reference: -2.5, speed_reference: 0.5, following_error_window: 3}", ""));
    let p = cell.machine.axes[0].parameters.vocabularies.amc;
    assert_eq!((p.position_reference, p.speed_reference, p.following_error_window), (-2500, 500_000.0, Some(3000)));
}
