//! Tests writing and reading files of limits.

use super::*;
use crate::cell_file::{EditError, Edited, edited};
use crate::document::Document;
use proptest::prelude::*;
use std::path::Path;

const CELL: &str = "\
lineshaft: 1
cycle: 1 ms
backends: {plant: {type: sim}}
axes:
  line: {type: linear, drive: virtual, scale: {increments: 1000, per: 1 m}, max_velocity: 1 m/s, max_acceleration: 1 m/s^2}
  arm: # turns
    type: rotary
    unit: deg
    scale: {increments: 36000, per: 360 deg}
    drive: {backend: plant, address: 0, interface: position}
    min_position: -170 deg # to the stop
    max_position: 170 deg
    max_velocity: 180 deg/s # of the motor
    max_acceleration: 400 deg/s^2
    max_deceleration: 300 deg/s^2
  lift:
    type: linear
    unit: mm
    scale: {increments: 1000, per: 1 mm}
    drive: {backend: plant, address: 1, interface: position}
    max_position: 500 mm
    max_velocity: 0.25 m/s # slow
    max_acceleration: 2 m/s^2
    max_jerk: 20 m/s^3
groups: {robot: [arm], both: [lift, arm]}
";

/// Degrees of the cell times pi / 180.
const JOINTS: &str = "\
joint_limits:
  arm:
    has_position_limits: true
    min_position: -2.9670597283903604
    max_position: 2.9670597283903604
    has_velocity_limits: true
    max_velocity: 3.141592653589793
    has_acceleration_limits: true
    max_acceleration: 5.235987755982989
    has_jerk_limits: false
  lift:
    has_position_limits: true
    max_position: 0.5
    has_velocity_limits: true
    max_velocity: 0.25
    has_acceleration_limits: true
    max_acceleration: 2.0
    has_jerk_limits: true
    max_jerk: 20.0
";

fn cell(text: &str) -> Cell {
    Cell::parse("cell.yaml", text).unwrap_or_else(|problems| panic!("{problems}\n{text}"))
}

fn written(cell: &Cell) -> String {
    limits_text(cell, &joints(cell, None).unwrap())
}

fn read(text: &str, file: &str) -> Result<Edited, String> {
    let cell = cell(text);
    let settings = read_limits(Document::parse("l.yaml", file), &cell, &joints(&cell, None).unwrap());
    let settings = settings.map_err(|problems| problems.to_string())?;
    edited(Path::new("cell.yaml"), text, &settings).map_err(|error| error.to_string())
}

/// Checks the text of the cell after the file was read.
#[track_caller]
fn becomes(file: &str, expected: &str) {
    assert_eq!(read(CELL, file).unwrap().text, expected);
}

#[track_caller]
fn refused(file: &str, problems: &str) {
    assert_eq!(read(CELL, file).unwrap_err(), problems);
}

#[test]
fn limits_are_written_in_si_units_and_virtual_axes_left_out() {
    let text = written(&cell(CELL));
    assert!(
        text.contains("\ndefault_velocity_scaling_factor: 0.1\ndefault_acceleration_scaling_factor: 0.1\n\n"),
        "{text}"
    );
    let (_, joints) = text.split_once("joint_limits:\n").expect("the section");
    for (line, expected) in joints.lines().zip(JOINTS.lines().skip(1)) {
        let number = |line: &str| {
            line.split_once(": ").and_then(|(key, value)| Some((key.to_owned(), value.parse::<f64>().ok()?)))
        };
        match (number(line), number(expected)) {
            (Some((key, number)), Some((expected_key, expected))) => {
                assert_eq!(key, expected_key);
                assert!((number - expected).abs() < 1e-15 * expected.abs(), "{line}, not {expected}");
            }
            _ => assert_eq!(line, expected),
        }
    }
    assert_eq!(joints.lines().count(), JOINTS.lines().count() - 1);
}

#[test]
fn a_group_has_its_joints_in_its_order() {
    let cell = cell(CELL);
    let names = |group| {
        let text = limits_text(&cell, &joints(&cell, Some(group)).unwrap());
        let lines = text.lines().filter_map(|line| line.strip_prefix("  ")?.strip_suffix(':'));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!((names("robot"), names("both")), (vec!["arm".into()], vec!["lift".into(), "arm".into()]));
    assert_eq!(joints(&cell, Some("robo")).unwrap_err(), "no group is called `robo`; there are robot, both");
}

#[test]
fn joints_have_their_joint_names_and_object_names_are_refused() {
    let renamed = CELL.replace("    type: rotary", "    joint: 'left \"arm\" \\ 1: é'\n    type: rotary");
    let file = written(&cell(&renamed));
    assert!(file.contains("\n  \"left \\\"arm\\\" \\\\ 1: é\":\n"), "{file}");
    assert_eq!(read(&renamed, &file).unwrap().text, renamed);
    assert_eq!(
        read(&renamed, "joint_limits: {arm: {}}").unwrap_err(),
        "l.yaml:1:16: no joint is called `arm`, the joint name of axis arm is `left \"arm\" \\ 1: é`\n"
    );
}

#[test]
fn numbers_and_names_are_those_of_yaml_1_1_and_parameters_of_ros() {
    let number = super::text::number_text;
    let numbers =
        [(3.0, "3.0"), (0.5, "0.5"), (-2.5e-7, "-2.5e-7"), (1e-9, "1.0e-9"), (1e16, "1.0e+16"), (1.25e20, "1.25e+20")];
    numbers.iter().for_each(|(given, expected)| assert_eq!(number(*given), *expected));
    let name = super::text::name_text;
    let names = [
        ("j1", "j1"),
        ("left/arm_1", "left/arm_1"),
        ("y", "\"y\""),
        ("NO", "\"NO\""),
        ("1", "\"1\""),
        ("a: b", "\"a: b\""),
    ];
    names.iter().for_each(|(given, expected)| assert_eq!(name(given), *expected));
}

#[test]
fn what_was_written_changes_nothing_when_it_is_read() {
    becomes(&written(&cell(CELL)), CELL);
    becomes(JOINTS, CELL);
    becomes("joint_limits: {}", CELL);
}

#[test]
fn limits_are_set_in_their_places_and_comments_stay() {
    becomes(
        "robot_description_planning:\n  joint_limits:\n    arm: {has_velocity_limits: true, max_velocity: 2.175, min_position: -1}\n    \
         lift: {has_jerk_limits: true, max_jerk: 10, min_position: 0, max_effort: 3, has_effort_limits: true}\n",
        &CELL
            .replace("-170 deg # to", "-1 rad # to")
            .replace("180 deg/s # of", "2.175 rad/s # of")
            .replace("20 m/s^3\n", "10 m/s^3\n    min_position: 0 m\n"),
    );
}

/// MoveIt's own files switch off unknown limits, with a value of 0.
#[test]
fn a_limit_that_is_off_leaves_that_of_the_cell() {
    let off = "has_velocity_limits: false, max_velocity: 0, has_acceleration_limits: false, max_acceleration: 0, has_jerk_limits: false";
    becomes(&format!("joint_limits: {{lift: {{{off}, has_position_limits: false}}}}"), CELL);
}

#[test]
fn the_one_acceleration_of_moveit_is_the_lower_of_both() {
    let acceleration =
        |value: f64| format!("joint_limits: {{arm: {{has_acceleration_limits: true, max_acceleration: {value}}}}}");
    // Both are 300 and 400 deg/s^2: 5.24 and 6.98 rad/s^2.
    let both = |acceleration: &str, deceleration: &str| {
        CELL.replace("400 deg/s^2", acceleration).replace("300 deg/s^2", deceleration)
    };
    becomes(&acceleration(5.0), &both("5 rad/s^2", "300 deg/s^2"));
    becomes(&acceleration(5.5), &both("5.5 rad/s^2", "5.5 rad/s^2"));
    becomes(&acceleration(9.0), &both("9 rad/s^2", "9 rad/s^2"));
    // The default of the deceleration is the acceleration.
    let file = "joint_limits: {lift: {has_acceleration_limits: true, max_acceleration: 3}}";
    becomes(file, &CELL.replace("2 m/s^2", "3 m/s^2"));
    for value in [5.0, 5.5, 9.0] {
        let new = read(CELL, &acceleration(value)).unwrap();
        assert!(written(&new.cell).contains(&format!("max_acceleration: {value:?}\n")), "{value}");
    }
}

#[test]
fn bad_files_are_refused_all_at_once_by_joint_and_line() {
    refused(
        "joint_limits:
  arn: {}
  line: {}
  arm:
    has_velocity_limits: true
    max_velocity: -1
    has_acceleration_limits: true
    max_acceleration: .nan
    has_jerk_limits: true
    max_jerk: 0
    max_torque: 1
  lift:
    has_velocity_limits: 1
    max_velocity: 1
    has_position_limits: false
    min_position: 0
    max_position: 1e30
    max_acceleration: 1
    has_jerk_limits: true
",
        "l.yaml:2:3: no joint is called `arn`, did you mean `arm`?\n\
         l.yaml:3:3: no joint is called `line`, there are arm, lift\n\
         l.yaml:6:19: arm: max_velocity is -1; 0 and above is allowed\n\
         l.yaml:8:23: arm: max_acceleration is `.nan`; a finite number is expected\n\
         l.yaml:10:15: arm: max_jerk is 0 rad/s^3; more than 0 up to 174532925000 rad/s^3 is allowed\n\
         l.yaml:11:5: unknown key `max_torque` in joint `arm`\n\
         l.yaml:13:26: has_velocity_limits is `1`; true or false is allowed, write `true`\n\
         l.yaml:15:26: lift: has_position_limits is false, but MoveIt reads a position limit wherever it is given, write true, or leave the limits out\n\
         l.yaml:17:19: lift: max_position: `1e30 m` is 1e36 increments; a position stays below 2^62 = 4611686018427387904 increments\n\
         l.yaml:18:23: lift: has_acceleration_limits is missing: MoveIt does not read max_acceleration, add `has_acceleration_limits: true`\n\
         l.yaml:19:22: lift: has_jerk_limits is true; max_jerk is missing\n",
    );
    refused(
        "joints: {}",
        "l.yaml:1:1: missing key `joint_limits` in the file of joint limits\nl.yaml:1:1: unknown key `joints` in the file of joint limits, known are robot_description_planning, joint_limits, default_velocity_scaling_factor, default_acceleration_scaling_factor\n",
    );
}

#[test]
fn limits_that_contradict_each_other_or_the_cycle_are_refused() {
    let file = |text: &str| format!("joint_limits:\n  lift: {{{text}}}\n");
    refused(&file("min_position: 0.6"), "l.yaml:2:24: min_position 0.6 m exceeds max_position 0.5 m\n");
    // 2^31 inc in a cycle of 1 ms, at 1e6 inc/m.
    refused(
        &file("has_velocity_limits: true, max_velocity: 3e6"),
        "l.yaml:2:51: lift: max_velocity is 3000000 m/s; more than 0 up to 2147483.648 m/s is allowed\n",
    );
    let with_default = CELL.replace("max_jerk: 20 m/s^3", "default_velocity: 0.2 m/s");
    let slower = file("has_velocity_limits: true, max_velocity: 0.1");
    assert_eq!(
        read(&with_default, &slower).unwrap_err(),
        "l.yaml:2:51: default_velocity 0.2 m/s exceeds max_velocity 0.1 m/s\n"
    );
}

#[test]
fn a_cell_that_cannot_be_edited_stays() {
    let file = "joint_limits: {lift: {has_velocity_limits: true, max_velocity: 0.3}}";
    let view = CELL.replace("max_velocity: 0.25 m/s", "velmax: 250");
    let refused = |text: &str| read(text, file).unwrap_err();
    let named = EditError::View { name: "cell.yaml".into(), line: 22, view: "velmax", key: "max_velocity" };
    assert_eq!(refused(&view), named.to_string());
    let shared = CELL.replace("0.25 m/s", "&v 0.25 m/s").replace("max_jerk", "default_velocity: *v\n    max_jerk");
    assert!(refused(&shared).starts_with("cell.yaml, line 22: "), "{}", refused(&shared));
}

/// A cell with two joints, with these numbers (mm and deg, or inc).
fn any_cell() -> impl Strategy<Value = String> {
    let rate = || (1..1_000_000_u32, 0..4_i32).prop_map(|(digits, places)| f64::from(digits) / 10_f64.powi(places));
    let limits = (
        any::<bool>(),
        rate(),
        rate(),
        proptest::option::of(rate()),
        proptest::option::of(rate()),
        -1_000_000..1_000_000_i64,
    );
    let axis = (limits, 1..20_000_000_u32, prop_oneof![Just("inc"), Just("")]);
    [axis.clone(), axis].prop_map(|axes| {
        let mut text = "lineshaft: 1\ncycle: 1 ms\nbackends: {plant: {type: sim}}\naxes:\n".to_owned();
        for (place, ((has_limits, velocity, acceleration, deceleration, jerk, position), increments, unit)) in axes.into_iter().enumerate() {
            let (kind, native) = if place == 0 { ("rotary", "deg") } else { ("linear", "mm") };
            let unit = if unit.is_empty() { native } else { unit };
            text += &format!("  a{place}: # axis {place}\n    type: {kind}\n    scale: {{increments: {increments}, per: 360 {native}}}\n");
            text += &format!("    drive: {{backend: plant, address: {place}, interface: position}}\n    max_velocity: {velocity} {unit}/s # v\n");
            text += &format!("    max_acceleration: {acceleration} {unit}/s^2\n");
            text += &deceleration.map_or(String::new(), |value| format!("    max_deceleration: {value} {unit}/s^2 # d\n"));
            text += &jerk.map_or(String::new(), |value| format!("    max_jerk: {value} {unit}/s^3\n"));
            if has_limits {
                text += &format!("    min_position: {position} inc # from\n    max_position: {} inc\n", position + 7);
            }
        }
        text
    })
}

/// Returns the numbers of a file, by joint and key.
fn numbers(text: &str) -> Vec<(String, f64)> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("    ")?.split_once(": "));
    lines.filter_map(|(key, value)| Some((key.to_owned(), value.parse().ok()?))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn limits_of_any_cell_written_and_read_back_change_nothing(text in any_cell()) {
        let file = written(&cell(&text));
        prop_assert_eq!(read(&text, &file).unwrap().text, text);
    }

    /// A file is read into another cell with the same axes; that cell then has the same limits, and its comments.
    #[test]
    fn limits_that_were_read_are_written_again(text in any_cell(), velocity in 1e-3..10.0_f64, acceleration in 1e-3..100.0_f64, jerk in 1e-3..1e3_f64) {
        let rates = [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)];
        let limits: String = rates.iter().map(|(name, rate)| format!("    has_{name}_limits: true\n    max_{name}: {rate:?}\n")).collect();
        let file = format!("joint_limits:\n  a0:\n{limits}  a1:\n{limits}");
        let new = read(&text, &file).unwrap();
        prop_assert_eq!(new.text.matches('#').count(), text.matches('#').count());
        let again = numbers(&written(&new.cell));
        let rates = |numbers: Vec<(String, f64)>| numbers.into_iter().filter(|(key, _)| !key.ends_with("position")).collect::<Vec<_>>();
        for ((key, given), (_, again)) in rates(numbers(&file)).into_iter().zip(rates(again)) {
            // The velocity of an axis is a double in inc/s: its last digits may differ.
            prop_assert!((again / given - 1.0).abs() < 1e-15, "{key}: {given} becomes {again}");
        }
        prop_assert_eq!(read(&new.text, &file).unwrap().text, new.text);
    }
}
