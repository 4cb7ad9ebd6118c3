//! Tests axes in tenths of a unit.

use super::*;

/// Returns a cell with x in tenths of a millimetre (100 inc) and the turret in tenths of a degree (10 inc).
fn tenths() -> Cell {
    let text = CELL.replace("unit: mm", "unit: 0.1 mm").replace("unit: deg", "unit: 0.1 deg");
    Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"))
}

fn report(text: &str) -> Report {
    let cell = tenths();
    let scenario = Scenario::parse("s.yaml", text, &cell).unwrap_or_else(|problems| panic!("{problems}"));
    simulate(&cell, &scenario, &Options::default()).unwrap()
}

/// 50 tenths of a millimetre are 5 mm, 5000 inc; 900 tenths of a degree are 90 deg, 9000 inc.
#[test]
fn goals_and_words_in_the_axis_unit_follow_it() {
    let report = report(
        "scenario: tenths\ncycles: 8000\nsteps:\n\
         - {at: 0, do: {enable: {axes: [x, turret]}}}\n\
         - {at: 100, do: {move_axis: {axis: x, units: axis_unit, position: 50, velocity: 500}}}\n\
         - {at: 100, do: {move_axis: {axis: turret, units: axis_unit, position: 900, velocity: 450}}}\n\
         - {at: 4000, do: {set_parameters: {x.amc.position_reference: 60, x.amc.reference_select: 1, \
             x.wf.zero_offset: 7}}}\n\
         expect:\n\
         - {signal: x.command.velocity, max: 50 mm/s}\n\
         - {signal: x.command.velocity, is: 50 mm/s, within: 1e-6, mode: eventually}\n\
         - {signal: turret.command.velocity, is: 45 deg/s, within: 1e-6, mode: eventually}\n\
         - {signal: x.command.position, at: 3999, is: 5000}\n\
         - {signal: turret.command.position, at: 3999, is: 9000}\n\
         - {signal: x.command.position, at: end, is: 6000}\n\
         - {parameter: x.amc.position_reference, at: end, is: 60}\n\
         - {parameter: x.amc.position_reference, at: end, is: 6 mm}\n\
         - {parameter: x.wf.zero_offset, at: end, is: 0.7 mm}\n",
    );
    assert!(report.passed(), "{report}");
}

#[test]
fn messages_show_values_in_the_axis_unit() {
    let report = report(
        "scenario: tenths\ncycles: 99\nsteps:\n\
         - {at: 0, do: {enable: {axes: [x]}}}\n\
         - {at: 50, do: {move_axis: {axis: x, units: axis_unit, position: 9000}}}\n\
         expect:\n- {signal: x.command.position, at: end, is: 50}\n\
         - {parameter: x.max_velocity, at: end, is: 90 mm/s}",
    );
    let told: Vec<_> = report.failures.iter().map(|failure| failure.sentence.as_str()).collect();
    assert_eq!(
        told,
        [
            "move_axis was refused: x: target 9000 * 0.1 mm exceeds max_position 8500 * 0.1 mm; in cycle 50 (0.05 s)",
            "x.command.position is 0 inc (0 * 0.1 mm) in cycle 98 (0.098 s); 50 inc (0.5 * 0.1 mm) was expected",
            "x.max_velocity is 1000 * 0.1 mm/s in cycle 98 (0.098 s); 900 * 0.1 mm/s was expected",
        ]
    );
    let cell = tenths();
    let bare = "scenario: s\ncycles: 9\nexpect: [{signal: x.command.position, at: end, is: 0.5}]";
    assert_eq!(
        Scenario::parse("s.yaml", bare, &cell).unwrap_err().to_string(),
        "s.yaml:3:52: x.command.position is 0.5; whole increments, or a position with its unit is allowed, a number \
         without a unit is in increments; `0.5 m` is `500 mm`\n"
    );
}
