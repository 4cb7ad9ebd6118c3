//! Tests verb `set_position` of a moving axis.

use super::*;

/// x moves at 50 mm/s from cycle 200 on: in cycle 300 it is at 7500 inc.
fn running(rest: &str) -> String {
    format!(
        "scenario: s\ncycles: 1200\nsteps:\n\
         - {{at: 0, do: {{enable: {{axes: [x, turret]}}}}}}\n\
         - {{name: go, at: 100, do: {{move_axis: {{id: v, axis: x, mode: velocity, velocity: 50 mm/s}}}}}}\n{rest}"
    )
}

#[test]
fn set_position_of_a_moving_axis_keeps_its_velocity() {
    passes(&running(
        "- {at: 300, do: {set_position: {axis: x, position: -10 mm}}}\n\
         - {at: 400, do: {set_position: {axis: x, relative: true, position: 1.5 mm}}}\n\
         - {at: 500, do: {cancel: {id: v}}}\n\
         expect:\n\
         - {signal: x.command.position, at: 299, is: 7450 inc}\n\
         - {signal: x.command.position, from: 300, values: [-10000, -9950, -9900]}\n\
         - {signal: x.command.position, at: 400, is: -3500 inc}\n\
         - {signal: x.command.velocity, from: 200, to: 500, is: 50 mm/s}\n\
         - {signal: x.command.acceleration, from: 201, to: 499, is: 0}\n\
         - {signal: x.following_error, from: 0, to: end, is: 0}\n\
         - {signal: x.output.position, at: 450, is: 15000 inc}\n\
         - {parameter: x.max_position, at: end, is: 834 mm}\n\
         - {event: {kind: done, source: x, code: CANCELLED}, count: 1}\n",
    ));
}

#[test]
fn what_refers_to_the_old_coordinate_is_named() {
    passes(&running(
        "- {at: 300, do: {move_axis: {axis: turret, position: 90 deg}}}\n\
         - {at: 310, do: {set_position: {axis: turret, position: 0 deg}}, refused: {code: COORDINATE_IN_USE, text: a goal to a target refers}}\n\
         - {at: 320, do: {touch_probe: {axis: x, event: mark, first_position: 1 mm, last_position: 2 mm}}}\n\
         - {at: 330, do: {set_position: {axis: x, relative: true, position: 1 mm}}, refused: a touch probe with a window refers}\n\
         - {at: 340, do: {abort_trigger: {axis: x}}}\n\
         - {at: 350, do: {set_position: {axis: x, position: 0 mm}}}\n",
    ));
}

#[test]
fn a_distance_is_for_axes() {
    let wrong = |arguments: &str| problem("steps", &format!("{{at: 1, do: {arguments}}}"));
    let sentence = wrong("{set_position: {axis: ^belt, relative: true, position: 1 mm}}");
    assert!(sentence.starts_with("no axis is called `belt`"), "{sentence}");
    assert_eq!(wrong("{set_position: {axis: x, relative: ^2}}"), "relative is `2`; true or false is allowed");
}
