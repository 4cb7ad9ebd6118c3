//! Tests verb `follow_joint_trajectory`.

use super::*;

/// 10 mm in 400 ms and 4 mm back in 400 ms, cubic, and 90 deg in 800 ms on a straight line.
#[test]
fn joints_follow_their_points() {
    passes(
        "scenario: s\ncycles: 1000\nsteps:\n\
         - {at: 0, do: {enable: {axes: [x, turret]}}}\n\
         - {name: go, at: 100, do: {follow_joint_trajectory: {id: t, joints: [x, turret], start: 1.5 ms, points: [\
              {time: 0.4 s, positions: [10 mm, 0.01 rad], velocities: [0, 0]}, \
              {time: 800 ms, positions: [0.006, 3 deg], velocities: [0 mm/s, 0], accelerations: [0, 0]}], \
              path_tolerance: {x: 1 mm, turret: {position: 2 deg, velocity: 100 deg/s}}, \
              goal_tolerance: {x: 0.1 mm}, goal_time: 1 s}}}\n\
         expect:\n\
         - {signal: x.reference, since: go, at: 0, is: TRAJECTORY}\n\
         - {signal: x.target.position, since: go, at: 0, is: 6 mm}\n\
         - {signal: x.command.position, since: go, at: 2, is: 0}\n\
         - {signal: x.command.position, since: go, at: 201, is: 4981 inc, within: 20 inc}\n\
         - {signal: x.command.position, since: go, at: 802, is: 6 mm}\n\
         - {signal: turret.command.position, since: go, at: 802, is: 300}\n\
         - {event: {kind: accepted, source: machine}, since: go, from: 0, to: 0, count: 1}\n\
         - {event: {kind: done, source: machine, code: 0}, since: go, from: 802, to: 803, count: 1}\n",
    );
}

/// In a cell with joint names both names of an axis are accepted, and a recording has the object name.
#[test]
fn joints_have_joint_names_or_object_names() {
    let text =
        CELL.replacen("  x: {", "  x: {joint: left/arm_1, ", 1).replacen("  turret: {", "  turret: {joint: J2, ", 1);
    let cell = Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}"));
    let read = |arguments: &str| {
        let text =
            format!("scenario: s\ncycles: 1000\nsteps:\n- {{at: 0, do: {{follow_joint_trajectory: {arguments}}}}}\n");
        Scenario::parse("s.yaml", &text, &cell)
    };
    let points = "points: [{time: 1 s, positions: [10 mm, 3 deg]}]";
    let by_joint =
        read(&format!("{{joints: [left/arm_1, J2], {points}, path_tolerance: {{left/arm_1: 1 mm, turret: 1 deg}}}}"));
    let by_object = read(&format!("{{joints: [x, turret], {points}, path_tolerance: {{x: 1 mm, J2: 1 deg}}}}"));
    let (by_joint, by_object) = (by_joint.unwrap(), by_object.unwrap());
    let commands = |scenario: &Scenario| format!("{:?}", scenario.0.acts[0].deed);
    assert_eq!(commands(&by_joint), commands(&by_object));
    recorded::plays_the_same_as_json(&cell, &by_joint);
    let said = |arguments: String| read(&arguments).unwrap_err().to_string();
    let twice = said(format!("{{joints: [left/arm_1, x], {points}}}"));
    assert!(twice.contains("`x` twice"), "{twice}");
    let twice = said(format!("{{joints: [left/arm_1, J2], {points}, goal_tolerance: {{x: 1 mm, left/arm_1: 2 mm}}}}"));
    assert!(twice.contains("axis x has a tolerance already, by its other name"), "{twice}");
}

#[test]
fn it_is_cancelled_by_id_and_refused_with_a_part_of_its_sentence() {
    passes(
        "scenario: s\ncycles: 600\nsteps:\n\
         - {at: 0, do: {enable: {axes: [x]}}}\n\
         - {at: 100, do: {follow_joint_trajectory: {id: t, joints: [x], points: [{time: 1 s, positions: [10 mm], velocities: [0]}]}}}\n\
         - {at: 300, do: {cancel: {id: t}}}\n\
         - {at: 400, do: {follow_joint_trajectory: {joints: [x], units: axis_unit, points: [{time: 1 ms, positions: [50]}]}}, refused: max_velocity}\n\
         - {at: 400, do: {follow_joint_trajectory: {joints: [x, x], points: []}}, refused: twice}\n\
         expect:\n\
         - {event: {kind: done, source: machine, code: CANCELLED}, count: 1}\n\
         - {signal: x.state, at: end, is: STANDSTILL}\n",
    );
}

#[test]
fn what_is_wrong_with_it_is_told_at_its_place() {
    let wrong = |arguments: &str| problem("steps", &format!("{{at: 1, do: {{follow_joint_trajectory: {arguments}}}}}"));
    assert_eq!(wrong("^{joints: [x]}"), "missing key `points` in follow_joint_trajectory");
    assert_eq!(
        wrong("^{joints: [z], points: [{time: 1, positions: [1]}]}"),
        "no axis is called `z`; there are line, x, turret"
    );
    assert_eq!(wrong("{joints: [x], points: [^{positions: [1]}]}"), "missing key `time` in a point");
    assert_eq!(
        wrong("{joints: [x], points: [{time: 1, positions: [1]}], path_tolerance: {^y: 1 mm}}"),
        "`y` is no joint of this trajectory, joints are x"
    );
    assert_eq!(
        wrong("^{joints: [x], points: [{time: 1, positions: [1, 2]}]}"),
        "points[0].positions has 2 numbers; one for each joint (1) is expected"
    );
    assert_eq!(
        wrong("{joints: [x], points: [{time: ^-1 ms, positions: [1]}]}"),
        "time is `-1 ms`; 0 and above is allowed"
    );
}
